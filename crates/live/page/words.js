// Numbers and elements.

// A number with four figures, as people read it.
export function number(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) return value.toExponential(2).replace("e+", "e").replace("-", "−");
  const decimals = Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(size))));
  const text = size >= 1000 ? Math.round(value).toLocaleString("en") : value.toFixed(decimals);
  return text.replace("-", "−");
}

export const count = (value) => Math.round(value).toLocaleString("en");

// A count in few characters: 4.2 M.
export function short(value) {
  const [unit, size] = Math.abs(value) >= 1e9 ? ["G", 1e9] : Math.abs(value) >= 1e6 ? ["M", 1e6] : Math.abs(value) >= 1e3 ? ["k", 1e3] : ["", 1];
  const text = Number((value / size).toPrecision(3)).toString();
  return (unit ? `${text} ${unit}` : text).replace("-", "−");
}

// A time in seconds: 42 s, 3 min 5 s, 2 h 10 min.
export function duration(seconds) {
  const s = Math.ceil(seconds);
  if (s < 60) return `${s} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min ${s % 60} s`;
  return `${Math.floor(s / 3600)} h ${Math.floor((s % 3600) / 60)} min`;
}

export const withUnit = (text, unit) => (unit ? `${text} ${unit}` : text);

// What a name says to people: thumb_distal_radius is "thumb distal radius".
export const spoken = (name) => name.replaceAll("_", " ");

// What a run is called: the last two folders of its path tell it from others.
export const title = (label) => label.split("/").filter(Boolean).slice(-2).join("/");

// An element with properties; what begins with aria- or data- is an attribute.
export function el(tag, props = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(props)) {
    if (value === undefined || value === null) continue;
    if (name.includes("-") || name === "role" || name === "for") element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

// Writes a text where it is another one: who reads along with a screen reader is not disturbed by what stays.
export function tell(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// Colours that people with any kind of colour vision tell apart, after Okabe and Ito; then the same with dashes.
const COLOURS = 6;
export const mark = (index) => ({ className: `c${index % COLOURS}`, dash: ["", "7 4", "2 3", "9 3 2 3"][Math.floor(index / COLOURS) % 4] });
