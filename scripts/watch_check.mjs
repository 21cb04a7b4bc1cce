// Opens the page of `hwasp watch` in a headless Chromium and checks it as somebody would use it: a training is started and its
// curve grows, its robot moves, a slider changes the design and both robots are shown, other runs are chosen, a reload changes nothing, the program
// dies and the page says so and comes back with it. Besides: accessibility (axe-core), nothing in the console, nothing wider than
// the screen, the bytes of the page, the time of a frame.
//
//   node scripts/watch_check.mjs PROGRAM [--hand RUN] [--timed] [--shots FOLDER]
//
// PROGRAM is the built `hwasp`; `--hand` names the run of a hand, whose frames are timed (with `--timed`, for a machine that does nothing else, more than 60 ms is a fault); `--shots` keeps pictures. It needs a
// Chromium (CHROMIUM names it, where it is not found) and the packages axe-core and puppeteer-core, as report_check.mjs does.
import { spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

import { axe, executablePath, puppeteer } from "./browser.mjs";

const MOST_BYTES = 1.5 * 2 ** 20;
const MOST_FRAME_MS = 60;
const PATIENCE = 60_000;

const words = process.argv.slice(2);
const timed = words.includes("--timed") && words.splice(words.indexOf("--timed"), 1).length > 0;
const option = (name) => {
  const at = words.indexOf(name);
  return at < 0 ? undefined : resolve(words.splice(at, 2)[1]);
};
const [shots, hand] = [option("--shots"), option("--hand")];
if (words.length !== 1) throw new Error("name the program to check");
const program = resolve(words[0]);
if (shots) mkdirSync(shots, { recursive: true });

const folder = mkdtempSync(join(tmpdir(), "hwasp-watch-"));
const faults = [];
const fault = (text) => faults.push(text);
const children = [];
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

// Starts the program, and gives its address as soon as it says one.
function start(...args) {
  const child = spawn(program, args, { cwd: folder });
  children.push(child);
  return new Promise((done, failed) => {
    let told = "";
    const hear = (bytes) => {
      told += bytes;
      const url = told.match(/http:\/\/\S+\//)?.[0];
      if (url) done({ child, url });
    };
    child.stdout.on("data", hear);
    child.stderr.on("data", hear);
    child.on("exit", (code) => failed(new Error(`${args.join(" ")} ended with ${code}: ${told}`)));
  });
}

// Trains to the end.
function train(experiment, steps) {
  const child = spawn(program, ["train", experiment, "--env-steps", steps, "--out", join("runs", experiment)], { cwd: folder, stdio: "ignore" });
  children.push(child);
  return new Promise((done, failed) => child.on("exit", (code) => (code === 0 ? done() : failed(new Error(`train ${experiment} ended with ${code}`)))));
}

function end(child, signal) {
  return new Promise((done) => {
    child.on("exit", done);
    child.kill(signal);
  });
}

const browser = await puppeteer.launch({ executablePath, args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
try {
  await check();
} catch (error) {
  fault(error.message);
} finally {
  await browser.close();
  children.forEach((child) => child.kill("SIGKILL"));
  rmSync(folder, { recursive: true, force: true });
}
faults.forEach((text) => console.error(text));
console.log(`the page of hwasp watch: ${faults.length} faults`);
process.exitCode = faults.length > 0 ? 1 : 0;

async function check() {
  const training = await start("train", "mass-spring", "--env-steps", "1e9", "--checkpoint-every", "3", "--out", "run", "--watch=127.0.0.1:0");
  const port = Number(new URL(training.url).port);
  const page = await browser.newPage();
  let quiet = true, bytes = 0;
  page.on("console", (message) => quiet && fault(`console: ${message.text()}`));
  page.on("pageerror", (error) => fault(`script: ${error.message}`));
  page.on("request", (request) => request.url().startsWith(training.url) || request.url().startsWith("data:") || fault(`it asks for ${request.url()}`));
  const network = await page.createCDPSession();
  await network.send("Network.enable");
  network.on("Network.loadingFinished", ({ encodedDataLength }) => { bytes += encodedDataLength; });
  const wait = (what, test, ...args) => page.waitForFunction(test, { timeout: PATIENCE, polling: 100 }, ...args).catch(() => { throw new Error(`${what}: not within ${PATIENCE / 1000} s`); });
  const text = (selector) => page.$eval(selector, (element) => element.textContent);
  const media = (scheme, motion) => page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }, { name: "prefers-reduced-motion", value: motion }]);
  const shoot = async (name) => shots && page.screenshot({ path: join(shots, `${name}.png`), fullPage: true });
  const points = () => page.$eval("#chart .line", (line) => line.getAttribute("d").split("L").length);

  await media("light", "no-preference");
  await page.setViewport({ width: 1600, height: 1000 });
  await page.goto(training.url);
  await wait("the page is live", () => document.querySelector("#link.live"));
  await wait("a curve", () => document.querySelector("#chart .line")?.getAttribute("d").includes("L"));
  const before = [await points(), await text("#run-list .facts")];
  await wait("the curve grows", ([points, facts]) => {
    const now = document.querySelector("#chart .line").getAttribute("d").split("L").length;
    return now !== points && document.querySelector("#run-list .facts").textContent !== facts;
  }, before);

  // The episode of the first checkpoints.
  await wait("an episode", () => document.querySelector("#stages canvas"));
  if (bytes > MOST_BYTES) fault(`the page takes ${bytes} bytes until its first episode`);
  console.log(`${(bytes / 1024).toFixed(0)} KiB until the first episode`);
  const clock = () => text("#stages .hw-clock");
  const plays = async (what) => wait(what, (first) => document.querySelector("#stages .hw-clock").textContent !== first, await clock());
  await plays("the episode plays");
  await wait("the newest checkpoint", () => /after .* steps of training/.test(document.querySelector("#robot-note").textContent));

  // Another design, by keyboard.
  await page.focus("#design-rows input[type=range]:enabled");
  const value = () => page.$eval("#design-rows .param:has(input:enabled) output", (output) => output.textContent);
  const trained = await value();
  for (let i = 0; i < 8; i++) await page.keyboard.press("ArrowRight");
  if ((await value()) === trained || !(await value()).includes("→")) fault(`the slider changes nothing: ${await value()}`);
  await wait("two episodes", () => document.querySelectorAll("#stages.two canvas").length === 2);
  await wait("what it costs", () => /difference/.test(document.querySelector("#cost table")?.textContent));
  if (!/ of training; in brackets|before training; in brackets/.test(await text("#cost caption"))) fault(`the cost tells of no checkpoint: ${await text("#cost caption")}`);
  const total = await text("#design-rows .group > .param output");
  if (!total.includes("→")) fault(`the total stays: ${total}`);
  const sizes = new Set(await page.$$eval("#stages canvas", (all) => all.map((one) => `${one.clientWidth} x ${one.clientHeight}`)));
  if (sizes.size !== 1) fault(`the two pictures have other sizes: ${[...sizes].join(", ")}`);
  await plays("the two episodes play");
  // What is looked at stands still meanwhile.
  await page.click("#follow");
  await shoot("what-if");
  await views(page, { media, shoot, name: "what-if" });
  await page.click("#follow");
  await page.click("#back");
  await wait("one episode again", () => document.querySelectorAll("#stages canvas").length === 1);

  // What was chosen stays over a reload.
  await page.select("#axis", "wall_s");
  await page.reload();
  await wait("the page comes back", () => document.querySelector("#link.live") && document.querySelector("#chart .line"));
  if ((await page.$eval("#axis", (axis) => axis.value)) !== "wall_s") fault("a reload forgets the axis");
  await media("light", "reduce");
  await page.reload();
  await wait("an episode at rest", () => document.querySelector("#stages canvas"));
  const still = await clock();
  await sleep(800);
  if ((await clock()) !== still) fault("the episode plays although motion is to be reduced");
  await media("light", "no-preference");

  // The program dies, and comes back with more runs.
  quiet = false;
  await end(training.child, "SIGKILL");
  await wait("the page says that nobody answers", () => document.querySelector("#link.lost") && !document.querySelector("#trouble").hidden);
  if (!/does not answer/.test(await text("#trouble"))) fault(`the page says: ${await text("#trouble")}`);
  await shoot("lost");
  for (const [experiment, steps] of [["balanced-arm", "2000"], ["mass-spring", "20000"]]) await train(experiment, steps);
  const again = await start("watch", "run", "runs", ...(hand ? [hand] : []), "--port", String(port));
  await wait("the page comes back by itself", () => document.querySelector("#link.live") && document.querySelector("#trouble").hidden);
  quiet = true;
  await wait("the run counts as interrupted", () => document.querySelector("#run-list .state.interrupted"));
  await others(page, { wait, text });
  if (hand) await frames(page, { wait, media, shoot });
  quiet = false; // the page asks once more before the browser closes
  if ((await end(again.child, "SIGINT")) !== 0) fault("Ctrl-C is no good end");
}

// The page in several sizes, by day and by night.
async function views(page, { media, shoot, name }) {
  for (const [width, height, scheme] of [[360, 740, "light"], [360, 740, "dark"], [800, 1000, "light"], [1600, 1000, "dark"], [1600, 1000, "light"]]) {
    await media(scheme, "reduce");
    await page.setViewport({ width, height });
    await sleep(300);
    const [needed, there] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    if (needed > there) fault(`${name}: it is ${needed} px wide on a screen of ${there}`);
    await page.evaluate(axe);
    const { violations } = await page.evaluate(() => globalThis.axe.run({ resultTypes: ["violations"] }));
    for (const { id, help, nodes } of violations) {
      fault(`${name}, ${width} px, ${scheme}: ${id}: ${help}: ${nodes.slice(0, 3).map((node) => node.target.join(" ")).join("; ")} (${nodes.length})`);
    }
    await shoot(`${name}-${width}-${scheme}`);
  }
  await media("light", "no-preference");
}

// Runs whose designs have a group of one name: each shows its own parameters and limits, and a slider of one is none of the other.
async function others(page, { wait, text }) {
  const names = await page.$$eval("#run-list .name", (all) => all.map((one) => one.textContent));
  const design = () => page.$eval("#design-rows", (rows) => rows.textContent);
  for (const [name, parameters] of [["runs/balanced-arm", 1], ["runs/mass-spring", 10], ["runs/balanced-arm", 1]]) {
    const index = names.indexOf(name), before = await design();
    if (index < 0) throw new Error(`the list has no ${name}: ${names.join(", ")}`);
    await page.evaluate((index) => document.querySelectorAll("#run-list .pick")[index].click(), index);
    await wait(`the design of ${name}`, ([parameters, before]) => document.querySelectorAll("#design-rows input[type=range]:enabled").length === parameters && document.querySelector("#design-rows").textContent !== before, [parameters, before]);
    const shown = await page.$$eval("#run-list .in-chart input", (all) => all.flatMap((box, i) => (box.checked ? [i] : [])));
    const alike = names.flatMap((other, i) => ((other === "runs/balanced-arm") === (parameters === 1) && !/hand|grasp/.test(other) ? [i] : []));
    if (String(shown) !== String(alike)) fault(`${name} shares its chart with ${shown}, not with ${alike}`);
    if (!(await text(`#run-list li:nth-child(${index + 1}) .what`)).startsWith(name.split("/")[1])) fault(`${name} is not told by its experiment`);
    await page.focus("#design-rows input[type=range]:enabled");
    for (let i = 0; i < 8; i++) await page.keyboard.press("ArrowRight");
    await wait(`what a change of ${name} costs`, () => /as trained/.test(document.querySelector("#cost caption")?.textContent) && !document.querySelector("#cost.old"));
  }
  if (!(await page.$eval("#trouble", (element) => element.hidden))) fault(`the page says: ${await text("#trouble")}`);
}

// The time between the frames of a hand that moves.
async function frames(page, { wait, media, shoot }) {
  await page.evaluate(() => [...document.querySelectorAll("#run-list .pick")].at(-1).click());
  await wait("the hand", () => /as trained/.test(document.querySelector("#robot-note").textContent) && document.querySelector("#stages canvas"));
  await sleep(500);
  const times = await page.evaluate(() => new Promise((done) => {
    const times = [];
    let last;
    requestAnimationFrame(function frame(now) {
      if (last !== undefined) times.push(now - last);
      last = now;
      if (times.length < 60) requestAnimationFrame(frame);
      else done(times.sort((a, b) => a - b));
    });
  }));
  console.log(`a frame of the hand: ${times[30].toFixed(0)} ms, the slowest ${times[59].toFixed(0)} ms`);
  if (timed && times[30] > MOST_FRAME_MS) fault(`a frame of the hand takes ${times[30].toFixed(0)} ms`);
  await shoot("hand");
  await views(page, { media, shoot, name: "hand" });
}
