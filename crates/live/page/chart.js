// Curves of several runs over one axis, with the values under the pointer or, by arrow keys, under the cursor.
import { el, number, short, svg, withUnit } from "./words.js";

const HEIGHT = 300;
const NEAR = 24; // pixels between the pointer and a value that is told
const MARGIN = { left: 62, right: 12, top: 10, bottom: 30 };

// Round numbers from low to high, about so many.
function ticks(low, high, wanted) {
  const raw = (high - low) / wanted;
  const size = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((factor) => factor * size >= raw) * size;
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
  return found;
}

// Limits with some air; those of a single value are around it.
function limits(values, air) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value === null || !Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) return [0, 1];
  if (low === high) return [low - Math.max(Math.abs(low) * 0.05, 1e-9), high + Math.max(Math.abs(high) * 0.05, 1e-9)];
  return [low - air * (high - low), high + air * (high - low)];
}

// A path through the points that are known.
function path(xs, ys, x, y) {
  let text = "", pen = false;
  for (let i = 0; i < xs.length; i++) {
    if (ys[i] === null) { pen = false; continue; }
    text += `${pen ? "L" : "M"}${x(xs[i]).toFixed(1)} ${y(ys[i]).toFixed(1)}`;
    // A point alone is a short line.
    if (!pen && (i + 1 === xs.length || ys[i + 1] === null)) text += "h.1";
    pen = true;
  }
  return text;
}

export class Chart {
  constructor(element) {
    this.values = el("div", { className: "values", hidden: true });
    this.plot = el("div", { className: "plot", tabIndex: 0, role: "slider", "aria-valuenow": 0, "aria-valuemin": 0, "aria-valuemax": 0 });
    element.append(this.plot, this.values);
    this.cursor = null;
    this.plot.addEventListener("pointermove", (event) => this.point(event.clientX - this.plot.getBoundingClientRect().left));
    this.plot.addEventListener("pointerleave", () => this.move(null));
    this.plot.addEventListener("blur", () => this.move(null));
    this.plot.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(this.plot);
  }

  // lines: [{ name, mark, xs, ys }]; about: { label, unit, time }
  show(lines, about) {
    [this.lines, this.about] = [lines, about];
    this.draw();
  }

  draw() {
    const width = this.plot.clientWidth;
    if (!this.lines || width < 50) return;
    const all = (pick) => this.lines.flatMap(pick);
    const [x0, x1] = [0, Math.max(...all((line) => line.xs.at(-1) ?? 0), 1e-9)];
    const [y0, y1] = limits(all((line) => line.ys), 0.06);
    this.x = (value) => MARGIN.left + ((value - x0) / (x1 - x0)) * (width - MARGIN.left - MARGIN.right);
    this.back = (at) => x0 + ((at - MARGIN.left) / (width - MARGIN.left - MARGIN.right)) * (x1 - x0);
    this.y = (value) => HEIGHT - MARGIN.bottom - ((value - y0) / (y1 - y0)) * (HEIGHT - MARGIN.top - MARGIN.bottom);
    const picture = svg("svg", { width, height: HEIGHT, viewBox: `0 0 ${width} ${HEIGHT}`, "aria-hidden": "true" });
    for (const value of ticks(y0, y1, 5)) {
      const at = this.y(value);
      picture.append(svg("path", { class: "grid", d: `M${MARGIN.left} ${at}H${width - MARGIN.right}` }));
      picture.append(svg("text", { x: MARGIN.left - 8, y: at + 4, "text-anchor": "end" }, Math.abs(value) >= 1e4 ? short(value) : Number(value.toPrecision(6)).toLocaleString("en", { maximumFractionDigits: 9 }).replace("-", "−")));
    }
    for (const value of ticks(x0, x1, Math.max(2, width / 130))) {
      const at = this.x(value);
      if (at > width - 18) continue;
      picture.append(svg("path", { class: "grid", d: `M${at} ${HEIGHT - MARGIN.bottom}v4` }));
      picture.append(svg("text", { x: at, y: HEIGHT - 9, "text-anchor": "middle" }, this.along(value)));
    }
    for (const line of this.lines) {
      const { className, dash } = line.mark;
      picture.append(svg("path", { class: `line ${className}`, "stroke-dasharray": dash, d: path(line.xs, line.ys, this.x, this.y) }));
    }
    this.hair = svg("g");
    picture.append(this.hair);
    this.plot.replaceChildren(picture);
    this.plot.setAttribute("aria-label", `${this.about.label}; arrow keys move along it`);
    this.move(this.cursor);
  }

  along(value) {
    return this.about.time ? (value >= 600 ? `${short(value / 60)} min` : `${short(value)} s`) : short(value);
  }

  point(at) {
    if (!this.lines) return;
    this.move(this.back(at));
  }

  key(event) {
    // Along the longest of them.
    const xs = (this.lines ?? []).map((line) => line.xs).sort((a, b) => (b.at(-1) ?? 0) - (a.at(-1) ?? 0))[0];
    if (!xs?.length) return;
    const now = this.cursor === null ? xs.length - 1 : nearest(xs, this.cursor);
    const to = { ArrowLeft: now - 1, ArrowDown: now - 1, ArrowRight: now + 1, ArrowUp: now + 1, Home: 0, End: xs.length - 1, PageUp: now - 20, PageDown: now + 20 }[event.key];
    if (event.key === "Escape") this.move(null);
    if (to === undefined) return;
    event.preventDefault();
    this.move(xs[Math.max(0, Math.min(xs.length - 1, to))]);
  }

  // Shows the values of all runs nearest to a place of the axis; none where it is null.
  move(cursor) {
    this.cursor = cursor;
    if (!this.hair) return;
    this.hair.replaceChildren();
    const found = cursor === null ? [] : this.lines.flatMap((line) => {
      const i = line.xs.length ? nearest(line.xs, cursor) : -1;
      // A run that had ended by then has no value there.
      const near = i >= 0 && Math.abs(this.x(line.xs[i]) - this.x(cursor)) < NEAR;
      return near && line.ys[i] !== null ? [{ line, x: line.xs[i], y: line.ys[i] }] : [];
    });
    this.values.hidden = found.length === 0;
    if (found.length === 0) return;
    const place = found.reduce((a, b) => (Math.abs(a.x - cursor) <= Math.abs(b.x - cursor) ? a : b)).x;
    const at = this.x(place);
    this.hair.append(svg("path", { class: "hair", d: `M${at} ${MARGIN.top}V${HEIGHT - MARGIN.bottom}` }));
    for (const { line, x, y } of found) this.hair.append(svg("circle", { class: `dot ${line.mark.className}`, cx: this.x(x), cy: this.y(y), r: 3.5 }));
    const told = ({ line, y }) => [line.name, withUnit(number(y), this.about.unit)];
    this.values.replaceChildren(
      el("strong", {}, this.about.time ? this.along(place) : `${Math.round(place).toLocaleString("en")} steps`),
      ...found.map((one) => el("span", {}, el("i", { className: `swatch ${one.line.mark.className}` }), this.lines.length > 1 ? `${told(one)[0]}: ` : "", el("b", {}, told(one)[1]))),
    );
    const width = this.plot.clientWidth;
    this.values.style.left = at < width / 2 ? `${at + 10}px` : "auto";
    this.values.style.right = at < width / 2 ? "auto" : `${width - at + 10}px`;
    const [first] = this.lines;
    this.plot.setAttribute("aria-valuemax", first.xs.at(-1) ?? 0);
    this.plot.setAttribute("aria-valuenow", place);
    this.plot.setAttribute("aria-valuetext", `${this.along(place)}: ${found.map((one) => told(one).join(" ")).join(", ")}`);
  }
}

// The place of the value in a rising list that is nearest.
function nearest(xs, value) {
  let low = 0, high = xs.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (xs[middle] <= value) low = middle;
    else high = middle;
  }
  return Math.abs(xs[low] - value) <= Math.abs(xs[high] - value) ? low : high;
}

// A small curve without axes.
export function sparkline(values, className) {
  const [width, height] = [120, 32];
  const [low, high] = limits(values, 0.05);
  const x = (i) => 1 + (i / Math.max(1, values.length - 1)) * (width - 2);
  const y = (value) => height - ((value - low) / (high - low)) * height;
  const picture = svg("svg", { viewBox: `0 0 ${width} ${height}`, preserveAspectRatio: "none", "aria-hidden": "true", class: "spark" });
  picture.append(svg("path", { class: `line ${className}`, d: path(values.map((_, i) => i), values, x, y), "vector-effect": "non-scaling-stroke" }));
  return picture;
}
