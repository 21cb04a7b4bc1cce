// What stands about runs in words, bars and small curves. Each part is built once and then brought up to date, so that whoever
// moves a slider or reads along keeps his place.
import { sparkline } from "./chart.js";
import { count, duration, el, mark, number, short, spoken, tell, title, withUnit } from "./words.js";

const STATES = { training: "training", finished: "finished", interrupted: "interrupted", gone: "folder gone" };

// How far a run is, in a line.
export function facts(run) {
  const parts = [run.budget ? `${short(run.env_steps)} of ${short(run.budget)} steps` : `${short(run.env_steps)} steps`];
  if (run.steps_per_s) parts.push(`${short(run.steps_per_s)} steps/s`);
  if (run.state === "training" && run.budget && run.env_steps >= run.budget) parts.push("being evaluated");
  else if (run.left_s !== null) parts.push(`${duration(run.left_s)} left`);
  else if (run.wall_s) parts.push(duration(run.wall_s));
  if (run.return !== null) parts.push(`return ${number(run.return)}`);
  return parts.join(" · ");
}

// The list of runs: which one is looked at, and which are in the chart.
export class Runs {
  constructor(list, { pick, toggle }) {
    [this.list, this.pick, this.toggle, this.cards] = [list, pick, toggle, []];
  }

  show(runs, chosen, shown) {
    while (this.cards.length > runs.length) this.cards.pop().item.remove();
    for (const run of runs) {
      const card = this.cards[run.index] ?? this.card(run);
      tell(card.name, title(run.label));
      card.name.title = run.label;
      tell(card.state, STATES[run.state]);
      card.state.className = `state ${run.state}`;
      tell(card.facts, facts(run));
      tell(card.what, [run.experiment ?? run.problem, run.method, run.seed === null ? null : `seed ${run.seed}`].filter(Boolean).join(" · "));
      card.button.setAttribute("aria-pressed", String(run.index === chosen));
      card.item.classList.toggle("chosen", run.index === chosen);
      card.box.checked = shown.has(run.index);
      card.box.setAttribute("aria-label", `${title(run.label)} in the learning curve`);
      card.label.hidden = runs.length < 2;
      card.progress.value = run.budget ? Math.min(1, run.env_steps / run.budget) : 0;
      card.progress.setAttribute("aria-label", `Progress of ${title(run.label)}`);
    }
  }

  card(run) {
    const card = {
      name: el("span", { className: "name" }), state: el("span"), what: el("span", { className: "soft what" }),
      facts: el("p", { className: "facts" }), progress: el("progress", { max: 1 }), box: el("input", { type: "checkbox" }),
    };
    card.button = el("button", { type: "button", className: "pick" }, card.name, card.state, card.what);
    card.label = el("label", { className: "in-chart" }, card.box, el("i", { className: `swatch ${mark(run.index).className}` }));
    card.item = el("li", {}, card.label, card.button, card.progress, card.facts);
    card.button.addEventListener("click", () => this.pick(run.index));
    card.box.addEventListener("change", () => this.toggle(run.index, card.box.checked));
    this.list.append(card.item);
    return (this.cards[run.index] = card);
  }
}

// Columns of one kind as tiles with their last values; a click shows one in the chart.
export class Tiles {
  constructor(section, element, kind, choose) {
    [this.section, this.element, this.kind, this.choose, this.tiles, this.built] = [section, element, kind, choose, [], ""];
  }

  show(detail, chosen) {
    // What a training does not have, noise of efforts for one, is not known in any row.
    const columns = detail.curve.columns.filter((column) => column.kind === this.kind && column.last !== null);
    this.section.hidden = columns.length === 0;
    const names = columns.map((column) => column.name).join();
    if (names !== this.built) {
      this.built = names;
      this.tiles = columns.map((column) => this.tile(column));
      this.element.replaceChildren(...this.tiles.map((tile) => tile.button));
    }
    columns.forEach((column, i) => {
      const tile = this.tiles[i];
      tell(tile.value, number(column.last));
      tile.spark.replaceChildren(sparkline(column.values, mark(detail.index).className));
      tile.button.setAttribute("aria-pressed", String(column.name === chosen && column.kind === this.kind));
    });
  }

  tile({ name, meaning }) {
    const tile = { value: el("b"), spark: el("span") };
    tile.button = el("button", { type: "button", title: meaning || undefined }, el("span", {}, spoken(name)), tile.value, tile.spark);
    tile.button.addEventListener("click", () => this.choose(`${this.kind}/${name}`));
    return tile;
  }
}

// The design between its limits, as it is and as somebody would have it.
export class Design {
  constructor(element, note, moved) {
    [this.element, this.note, this.moved, this.built, this.rows, this.wanted] = [element, note, moved, "", new Map(), new Map()];
  }

  // `known`: the values of the newest controller by parameter, SI.
  show(detail, known) {
    // Two runs may have groups of the same name with other limits and counts.
    const kinds = detail.design.map(({ name, parameters, limits, unit, optimum }) => [name, parameters, limits, unit, optimum]);
    const key = JSON.stringify([detail.index, detail.curve.epoch, detail.simulates, kinds]);
    if (key !== this.built) this.build(detail, key);
    for (const group of detail.design) {
      const single = group.parameters.length === 1;
      group.parameters.forEach((name, i) => {
        const live = single ? (detail.state === "training" ? group.total : group.values?.[0] ?? group.total) : group.values?.[i];
        this.value(group, name, live ?? known?.get(name) ?? null);
      });
      this.total(group);
    }
  }

  build(detail, key) {
    [this.built, this.rows] = [key, new Map()];
    this.wanted.clear();
    const best = detail.design.some((group) => group.optimum !== null) ? ", the dashed one the best that is known" : "";
    tell(this.note, detail.design.length === 0 ? "Nothing is designed here." : detail.simulates ? `The black mark is the trained design${best}. Move a slider, and the robot with that value is simulated beside the trained one.` : `The black mark is the design between its limits${best}.`);
    this.element.replaceChildren(...detail.design.map((group) => this.group(group, detail.simulates)));
  }

  group(group, simulates) {
    const rows = group.parameters.map((name) => this.row(group, name, simulates));
    if (rows.length === 1) return rows[0];
    const head = { value: el("output"), track: this.track(group, rows.length) };
    head.element = el("div", { className: "param" }, el("span", { title: group.meaning || undefined }, `${spoken(group.name)}, total of ${rows.length}`), head.value, head.track, this.ends(group, rows.length));
    this.rows.set(`group ${group.name}`, head);
    return el("div", { className: "group" }, head.element,
      el("details", { open: rows.length <= 12 }, el("summary", {}, `each of the ${rows.length}`), ...rows));
  }

  row(group, name, simulates) {
    const id = `design-${name}`, [low, high] = group.limits;
    const row = { value: el("output", { for: id }), track: this.track(group, 1), current: null };
    if (simulates) {
      row.slider = el("input", { type: "range", id, min: low, max: high, step: (high - low) / 200, disabled: true });
      row.slider.addEventListener("input", () => this.want(group, name, Number(row.slider.value)));
      row.track.append(row.slider);
    }
    const label = el(simulates ? "label" : "span", { for: simulates ? id : null, title: group.meaning || undefined }, spoken(name));
    row.element = el("div", { className: "param" }, label, row.value, row.track, group.parameters.length === 1 ? this.ends(group, 1) : null);
    this.rows.set(`parameter ${name}`, row);
    return row.element;
  }

  track(group, times) {
    const track = el("div", { className: "track" }, el("i", { className: "now" }));
    if (group.optimum !== null && times === group.parameters.length) {
      track.append(el("i", { className: "best", title: `best known: ${this.told(group, group.optimum)}` }));
      this.place(track, "--best", group.optimum, group, times);
    }
    return track;
  }

  ends(group, times) {
    const told = (limit) => withUnit(Number(((limit * times) / group.to_si).toPrecision(4)).toLocaleString("en"), group.unit);
    return el("div", { className: "ends" }, ...group.limits.map((limit) => el("span", {}, told(limit))));
  }

  place(track, name, value, group, times) {
    const [low, high] = group.limits;
    const share = value === null ? -1 : (value / times - low) / (high - low);
    track.style.setProperty(name, share);
    track.classList.toggle("unknown", name === "--now" && value === null);
  }

  told(group, value) {
    return withUnit(number(value === null ? null : value / group.to_si), group.unit);
  }

  // Writes where a parameter is, and where it is wanted.
  value(group, name, current) {
    const row = this.rows.get(`parameter ${name}`), wanted = this.wanted.get(name);
    row.current = current;
    this.place(row.track, "--now", current, group, 1);
    this.change(row, group, current, wanted);
    if (!row.slider) return;
    row.slider.disabled = current === null;
    if (wanted === undefined && current !== null) row.slider.value = current;
    row.slider.setAttribute("aria-valuetext", row.value.textContent);
  }

  // Writes the total of a group of several, and what it would be.
  total(group) {
    const head = this.rows.get(`group ${group.name}`);
    if (!head) return;
    this.place(head.track, "--now", group.total, group, group.parameters.length);
    const current = group.parameters.map((name) => this.rows.get(`parameter ${name}`).current);
    const sum = (values) => values.reduce((a, b) => a + b, 0);
    const changed = group.parameters.some((name) => this.wanted.has(name)) && !current.includes(null);
    if (changed) this.change(head, group, sum(current), sum(group.parameters.map((name, i) => this.wanted.get(name) ?? current[i])));
    else this.change(head, group, group.total);
  }

  // Writes a value, and behind an arrow the one that is wanted in its place.
  change({ element, value }, group, current, wanted) {
    element.classList.toggle("changed", wanted !== undefined);
    tell(value, wanted === undefined ? this.told(group, current) : `${number(current === null ? null : current / group.to_si)} → ${this.told(group, wanted)}`);
  }

  want(group, name, value) {
    this.wanted.set(name, value);
    this.value(group, name, this.rows.get(`parameter ${name}`).current);
    this.total(group);
    this.moved(this.wanted);
  }

  // Forgets what was wanted.
  reset() {
    this.wanted.clear();
    this.moved(this.wanted);
  }
}

const interval = ({ mean, low, high }) => `${number(mean)}${low === undefined ? "" : ` [${number(low)}, ${number(high)}]`}`;
const share = (value) => `${(100 * value).toFixed(1)} %`;

// What a finished run is worth.
export function result(element, summary) {
  const { evaluation } = summary;
  const rows = [
    ["Return", interval(evaluation.return)],
    ["Discounted return", interval(evaluation.discounted_return)],
    ...(evaluation.success ?? []).map(({ kind, successes, episodes }) => [kind === "all" ? "Success" : `Success, ${spoken(kind)}`, `${share(successes / episodes)} (${successes} of ${episodes})`]),
    ["Training", `${count(summary.env_steps)} steps in ${duration(summary.wall_s)}`],
  ];
  element.replaceChildren(
    el("p", { className: "soft" }, `The deterministic controller on the hardware as built, ${count(evaluation.episodes)} held-out episodes; in brackets 95 % intervals.`),
    el("dl", {}, ...rows.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)])),
  );
}

// What a change of the design costs. `when`: how far its controller is.
export function cost(element, { before, after, change }, when) {
  const success = (judged) => judged.success?.find(({ kind }) => kind === "all");
  const all = success(before) && success(after);
  const head = ["", "Return", ...(all ? ["Success"] : [])];
  const rows = [
    ["as trained", number(before.return.mean), ...(all ? [share(success(before).successes / success(before).episodes)] : [])],
    ["changed", number(after.return.mean), ...(all ? [share(success(after).successes / success(after).episodes)] : [])],
    ["difference", interval(change.return), ...(all && change.success ? [`${(100 * change.success.mean).toFixed(1).replace("-", "−")} points`] : [])],
  ];
  element.replaceChildren(el("table", {},
    el("caption", {}, `On the same ${change.episodes} held-out episodes, by the controller ${when}; in brackets a 95 % interval.`),
    el("thead", {}, el("tr", {}, ...head.map((text) => (text ? el("th", { scope: "col" }, text) : el("td"))))),
    el("tbody", {}, ...rows.map(([name, ...values]) => el("tr", {}, el("th", { scope: "row" }, name), ...values.map((text) => el("td", {}, text))))),
  ));
}
