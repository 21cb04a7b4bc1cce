// Follows the runs: asks for what is new once a second, and shows it.
import { Chart } from "./chart.js";
import { Design, Runs, Tiles, result } from "./panels.js";
import { Robot } from "./robot.js";
import { ask } from "./server.js";
import { el, mark, spoken, tell, title } from "./words.js";

const PACE = 1000, PACE_HIDDEN = 10_000, PACE_SILENT = 2000; // ms between two looks
const MOST_SHOWN = 12; // runs of an experiment in the chart unless somebody asks for more
const KINDS = { return: "Return", reward: "Terms of the reward", design: "Design", learner: "Learner" };
const $ = (id) => document.getElementById(id);

// What somebody has chosen stays over a reload.
const memory = {
  get(key) { try { return JSON.parse(sessionStorage.getItem(`hwasp.${key}`)); } catch { return null; } },
  set(key, value) { try { sessionStorage.setItem(`hwasp.${key}`, JSON.stringify(value)); } catch { /* then it does not */ } },
};

const state = {
  server: null, runs: [], details: new Map(), design: new Map(),
  chosen: null, shown: new Set(), boxes: memory.get("boxes") ?? {}, column: memory.get("column") ?? "return/return", axis: memory.get("axis") ?? "env_steps",
};
const tag = {};

const chart = new Chart($("chart"));
const runs = new Runs($("run-list"), { pick, toggle });
const terms = new Tiles($("terms"), $("term-tiles"), "reward", setColumn);
const learner = new Tiles($("learner"), $("learner-tiles"), "learner", setColumn);
const robot = new Robot({ stages: $("stages"), note: $("robot-note"), costs: $("cost"), follow: $("follow") }, (values) => {
  state.design.set(state.chosen, values);
  render();
});
const design = new Design($("design-rows"), $("design-note"), (wanted) => {
  $("back").hidden = wanted.size === 0;
  robot.want(wanted);
  if (wanted.size === 0) render();
});

$("back").addEventListener("click", () => design.reset());
$("column").addEventListener("change", () => setColumn($("column").value));
$("axis").addEventListener("change", () => {
  memory.set("axis", (state.axis = $("axis").value));
  render();
});
document.addEventListener("visibilitychange", () => document.hidden || look());
addEventListener("hashchange", () => look());

function setColumn(column) {
  memory.set("column", (state.column = column));
  render();
}

function pick(index) {
  memory.set("chosen", state.runs[index].label);
  if (state.chosen !== index) design.reset();
  state.chosen = index;
  delete state.boxes[state.runs[index].label];
  look();
}

function toggle(index, on) {
  state.boxes[state.runs[index].label] = on;
  look();
}

let timer, looking = false, again = false;

// Looks once, and again after a while.
async function look() {
  if (looking) return void (again = true);
  looking = true;
  clearTimeout(timer);
  let pace = document.hidden ? PACE_HIDDEN : PACE;
  try {
    do {
      again = false;
      await fetchNew();
    } while (again);
    link("live", "live");
    trouble("");
  } catch (error) {
    pace = PACE_SILENT;
    link("lost", error.status === 0 ? "no answer" : "refused");
    trouble(error.status === 0
      ? "The program does not answer. It may have ended, or the connection is cut. What you see is the last that it told; this page goes on by itself as soon as it answers again."
      : error.status === undefined ? `This page has a fault: ${error.message}` : `The program refuses: ${error.message}.`);
  } finally {
    looking = false;
    timer = setTimeout(look, pace);
  }
}

function link(kind, text) {
  $("link").className = kind;
  tell($("link"), text);
}

function trouble(text) {
  $("trouble").hidden = text === "";
  tell($("trouble"), text);
}

async function fetchNew() {
  const list = await ask("/api/runs", { tag });
  if (list) {
    if (list.server !== state.server) {
      // Another server may have other runs.
      state.details.clear();
      state.design.clear();
      [state.server, state.chosen] = [list.server, null];
    }
    state.runs = list.runs;
    note(list);
    choose();
  }
  share();
  for (const run of state.runs) {
    if (run.index !== state.chosen && !state.shown.has(run.index)) continue;
    const known = state.details.get(run.index);
    if (known?.version === run.version) continue;
    const since = known ? `?since=${known.curve.epoch}.${known.curve.width}.${known.curve.env_steps.length}` : "";
    merge(known, await ask(`/api/runs/${run.index}${since}`));
  }
  render();
}

function note({ waiting, full, runs: { length } }) {
  const parts = [];
  if (waiting.length > 0) parts.push(`Not there yet: ${waiting.join(", ")}. ${waiting.length > 1 ? "They appear" : "It appears"} here as soon as training begins.`);
  if (full) parts.push(`Only the first ${length} runs are shown; name fewer folders to see others.`);
  $("runs-note").hidden = parts.length === 0;
  tell($("runs-note"), parts.join(" "));
}

// Takes a run to look at, where that is open.
function choose() {
  if (state.runs[state.chosen]) return;
  const last = state.runs.find((run) => run.label === memory.get("chosen"));
  const training = state.runs.find((run) => run.state === "training");
  state.chosen = (last ?? training ?? state.runs[0])?.index ?? null;
}

const experiment = (run) => run.experiment ?? run.problem;

// Takes the runs in the chart: those of the same experiment, for returns of others have another scale, and what the boxes say.
function share() {
  memory.set("boxes", state.boxes);
  const chosen = state.runs[state.chosen];
  if (!chosen) return;
  const alike = state.runs.filter((run) => experiment(run) === experiment(chosen)).slice(0, MOST_SHOWN);
  state.shown = new Set(state.runs.filter((run) => state.boxes[run.label] ?? (run === chosen || alike.includes(run))).map((run) => run.index));
}

// Puts new points behind those that are there.
function merge(known, detail) {
  const { curve } = detail;
  if (curve.from > 0) {
    const joined = (old, fresh) => old.slice(0, curve.from).concat(fresh);
    curve.env_steps = joined(known.curve.env_steps, curve.env_steps);
    curve.wall_s = joined(known.curve.wall_s, curve.wall_s);
    curve.columns.forEach((column, i) => { column.values = joined(known.curve.columns[i].values, column.values); });
  }
  if (known && known.curve.epoch !== curve.epoch) state.design.delete(detail.index);
  state.details.set(detail.index, detail);
}

function render() {
  const detail = state.details.get(state.chosen);
  runs.show(state.runs, state.chosen, state.shown);
  for (const id of ["curves", "robot", "design"]) $(id).hidden = !detail;
  document.title = detail ? `${percent(detail)}${title(detail.label)} · hwasp watch` : "hwasp watch";
  if (!detail) return;
  columns(detail);
  const [kind, name] = state.column.split("/");
  terms.show(detail, name);
  learner.show(detail, name);
  drawChart(kind, name);
  robot.show(detail);
  const values = state.design.get(detail.index);
  const parameters = detail.design.flatMap((group) => group.parameters);
  design.show(detail, values && new Map(parameters.map((parameter, i) => [parameter, values[i]])));
  $("back").hidden = design.wanted.size === 0;
  $("result").hidden = !detail.summary;
  if (detail.summary) result($("result-rows"), detail.summary);
  $("log").hidden = detail.log.length === 0;
  log(detail.log.map(line).join("\n"));
}

const percent = ({ state: at, budget, env_steps: steps }) => (at === "training" && budget ? `${Math.floor((100 * steps) / budget)} % ` : "");

// The choice of columns, those of the run that is looked at.
function columns(detail) {
  const select = $("column"), all = detail.curve.columns;
  const names = all.map((column) => `${column.kind}/${column.name}`);
  if (names.length > 0 && !names.includes(state.column)) state.column = names[0];
  if (select.dataset.names !== names.join()) {
    select.dataset.names = names.join();
    select.replaceChildren(...Object.entries(KINDS).flatMap(([kind, label]) => {
      const own = all.filter((column) => column.kind === kind);
      return own.length === 0 ? [] : [el("optgroup", { label }, ...own.map(({ name }) => el("option", { value: `${kind}/${name}` }, spoken(name))))];
    }));
  }
  select.value = state.column;
  $("axis").value = state.axis;
}

function drawChart(kind, name) {
  const lines = [], notes = [];
  let unit = "";
  for (const run of state.runs) {
    const detail = state.details.get(run.index);
    const column = state.shown.has(run.index) && detail?.curve.columns.find((one) => one.kind === kind && one.name === name);
    if (!column) continue;
    unit = column.unit;
    const ys = column.values.map((value) => (value === null ? null : value / column.to_si));
    lines.push({ name: title(run.label), mark: mark(run.index), xs: detail.curve[state.axis], ys });
    if (run.index === state.chosen && detail.curve.width > 1) notes.push(`Each point is the mean of ${detail.curve.width} iterations.`);
    if (run.index === state.chosen && column.meaning) notes.push(`${column.meaning[0].toUpperCase()}${column.meaning.slice(1).replace(/\.?$/, ".")}`);
  }
  const detail = state.details.get(state.chosen);
  notes.push(...detail.faults.map((fault) => `Note: ${fault}.`));
  if (state.runs.some((run) => !state.shown.has(run.index) && experiment(run) !== experiment(detail))) notes.push("Runs of other experiments are left out; their boxes add them.");
  if (detail.curve.env_steps.length === 0) notes.push("No iteration is done yet.");
  tell($("chart-note"), notes.join(" "));
  const label = `${spoken(name)}${unit ? ` in ${unit}` : ""} of ${lines.length === 1 ? lines[0].name : `${lines.length} runs`}`;
  chart.show(lines, { label, unit, time: state.axis === "wall_s" });
}

// A line of a log with the time of day alone.
const line = (text) => text.replace(/^(\d{4}-\d\d-\d\dT[\d:.]+Z)\s+(?:INFO )?/, (_, time) => `${new Date(time).toLocaleTimeString("en-GB")}  `);

// The log stays at its end unless somebody reads further up.
function log(text) {
  const lines = $("log-lines");
  if (lines.textContent === text) return;
  const end = lines.scrollTop + lines.clientHeight >= lines.scrollHeight - 40;
  lines.textContent = text;
  if (end) lines.scrollTop = lines.scrollHeight;
}

look();
