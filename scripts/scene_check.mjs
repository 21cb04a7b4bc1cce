// Opens pages of scenes (`hwasp play RUN --html`) in a headless Chromium that draws with its processor, and checks them: nothing is
// loaded or said in the console, axe-core finds no fault, nothing is wider than the screen; something is to be seen, it moves when
// played, keys and pointer turn it. It says how long a picture of 800 × 500 pixels takes; with `--timed`, for a machine that does
// nothing else, more than 60 ms is a fault.
//
//   node scripts/scene_check.mjs scene.html… [--timed] [--shots FOLDER]
//
// Needs a Chromium (CHROMIUM names it, where it is not found) and the packages axe-core and puppeteer-core, which
// `npm install --no-save axe-core puppeteer-core` fetches. `--shots` keeps pictures.
import { mkdirSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { axe, executablePath, puppeteer } from "./browser.mjs";

const MOST_MS = 60;

const words = process.argv.slice(2);
const timed = words.includes("--timed") && words.splice(words.indexOf("--timed"), 1).length > 0;
const flag = words.indexOf("--shots");
const shots = flag < 0 ? undefined : words.splice(flag, 2)[1];
if (words.length === 0) throw new Error("name the pages to check");
if (shots) mkdirSync(shots, { recursive: true });

const views = [
  { name: "telephone", width: 360, height: 740, scheme: "light" },
  { name: "desk", width: 1280, height: 800, scheme: "light" },
  { name: "wide", width: 1600, height: 900, scheme: "dark" },
];
const faults = [];
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const drawing = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
let browser = await puppeteer.launch({ executablePath, args: drawing });

// A page, with whatever it should not do told of.
async function opened(word, told, { width, height, scheme, motion = "reduce" }) {
  const page = await browser.newPage();
  page.on("console", (message) => told(`console: ${message.text()}`));
  page.on("pageerror", (error) => told(`script: ${error.message}`));
  page.on("request", (request) => {
    if (!request.url().startsWith("file:") || !request.isNavigationRequest()) told(`it asks for ${request.url()}`);
  });
  await page.emulateMediaFeatures([
    { name: "prefers-color-scheme", value: scheme },
    { name: "prefers-reduced-motion", value: motion },
  ]);
  await page.setViewport({ width, height });
  await page.goto(pathToFileURL(resolve(word)).href);
  await wait(600);
  return page;
}

// What the picture shows now, as bytes of a PNG.
const picture = async (page) => (await (await page.$("canvas")).screenshot()).toString("base64");

// How many colours a picture has: a background alone has few.
const colours = (page, png) =>
  page.evaluate(async (png) => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(png), (letter) => letter.charCodeAt(0))]));
    const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
    canvas.drawImage(image, 0, 0);
    const { data } = canvas.getImageData(0, 0, image.width, image.height);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4) seen.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return seen.size;
  }, png);

async function accessible(page, told) {
  // The page's own policy lets no script in but its own; the debugger may.
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => globalThis.axe.run({ resultTypes: ["violations"] }));
  for (const { id, help, nodes } of violations) {
    told(`${id}: ${help}: ${nodes.slice(0, 3).map((node) => node.target.join(" ")).join("; ")} (${nodes.length})`);
  }
  const [needed, there] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  if (needed > there) told(`it is ${needed} px wide on a screen of ${there}`);
}

async function works(page, told) {
  const clock = () => page.$eval(".hw-clock", (clock) => clock.textContent);
  const changes = async (what, act) => {
    const before = await picture(page);
    await act();
    await wait(400);
    if ((await picture(page)) === before) told(`the picture stays as it is after ${what}`);
  };
  const [before, began] = [await picture(page), await clock()];
  if ((await colours(page, before)) < 200) told("the picture is nearly empty");
  await wait(400);
  if ((await picture(page)) !== before) told("it plays although motion is to be reduced");
  await page.click(".hw-play");
  await wait(900);
  if ((await clock()) === began || (await picture(page)) === before) told("it does not play");
  await page.focus("canvas");
  await page.keyboard.press("Space");
  const stopped = await clock();
  await wait(400);
  if ((await clock()) !== stopped) told("space does not stop it");
  await changes("the left arrow", () => page.keyboard.press("ArrowLeft"));
  await changes("plus", () => page.keyboard.press("+"));
  const box = await (await page.$("canvas")).boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  await changes("a drag", async () => {
    await page.mouse.move(...middle);
    await page.mouse.down();
    await page.mouse.move(middle[0] + 60, middle[1] + 30, { steps: 4 });
    await page.mouse.up();
  });
  await changes("the wheel", () => page.mouse.wheel({ deltaY: -300 }));
  await changes("the right button", async () => {
    await page.mouse.down({ button: "right" });
    await page.mouse.move(middle[0] - 40, middle[1], { steps: 4 });
    await page.mouse.up({ button: "right" });
  });
  await changes("Home", () => page.keyboard.press("Home"));
  await page.focus(".hw input");
  await page.keyboard.press("End");
  await wait(100);
  const end = await page.$eval(".hw input", (slider) => Number(slider.max));
  if (!(Math.abs(parseFloat(await clock()) - end) < 0.011)) told(`at the end the clock says ${await clock()}`);
  const takes = await page.$$(".hw [aria-pressed]:not([hidden])");
  if (takes.length > 1) await changes("choosing another episode", () => takes[1].click());
  // The card may be lost at any time.
  const same = await picture(page);
  await page.evaluate(() => {
    const lose = document.querySelector("canvas").getContext("webgl2").getExtension("WEBGL_lose_context");
    lose.loseContext();
    setTimeout(() => lose.restoreContext(), 100);
  });
  await wait(800);
  if ((await colours(page, await picture(page))) < 0.5 * (await colours(page, same))) told("a lost context does not come back");
}

// Two viewers beside each other have one time, one episode and one camera; they come and go.
async function beside(page, told) {
  const found = await page.evaluate(async () => {
    const data = JSON.parse(document.getElementById("scene").textContent);
    const wait = (ms) => new Promise((done) => setTimeout(done, ms));
    const places = [0, 1].map(() => document.body.appendChild(document.createElement("div")));
    places.forEach((place) => (place.style.cssText = "display: flex; width: 300px; height: 300px"));
    const a = globalThis.hwaspViewer(places[0], data, { controls: false, autoplay: false });
    const b = globalThis.hwaspViewer(places[1], data, { controls: false, sync: a });
    places[1].scrollIntoView();
    const shown = [];
    a.onframe = () => (shown[0] = places[0].querySelector("canvas").toDataURL());
    b.onframe = () => (shown[1] = places[1].querySelector("canvas").toDataURL());
    b.seek(1);
    await wait(600);
    const same = shown[0] === shown[1] && shown[0] !== undefined;
    b.play();
    await wait(600);
    const plays = a.state.time > 1;
    b.setScene({ ...data, takes: data.takes.slice(0, 1) });
    a.stop();
    b.destroy();
    a.setScene({ ...data, takes: [] });
    a.destroy();
    places.forEach((place) => place.remove());
    return { same, plays, gone: document.querySelectorAll(".hw").length === 1 };
  });
  if (!found.same) told("two viewers beside each other show different pictures");
  if (!found.plays) told("a viewer does not play with the one beside it");
  if (!found.gone) told("a viewer does not go away");
}

// Time from picture to picture while it plays, in the middle of many, ms; each is read back, so that it is drawn to its end.
async function pace(page) {
  await page.$eval(".hw-stage", (stage) => {
    stage.style.cssText = "flex: none; width: 800px; height: 500px";
  });
  await wait(300);
  return page.evaluate(async () => {
    const [canvas, pixel, taken] = [document.querySelector("canvas"), new Uint8Array(4), []];
    const gl = canvas.getContext("webgl2");
    const play = document.querySelector(".hw-play");
    if (play.textContent === "Play") play.click();
    for (let i = 0; i < 60; i++) {
      const from = await new Promise(requestAnimationFrame);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      await new Promise((done) => setTimeout(done));
      taken.push(performance.now() - from);
    }
    return taken.sort((a, b) => a - b)[30];
  });
}

try {
  for (const word of words) {
    const name = `${basename(dirname(resolve(word)))}-${basename(word).replace(/\.html?$/, "")}`;
    for (const view of views) {
      const told = (text) => faults.push(`${word}, ${view.name}: ${text}`);
      const page = await opened(word, told, view);
      await accessible(page, told);
      if (shots) await page.screenshot({ path: join(shots, `${name}-${view.name}.png`) });
      if (view.name === "desk") {
        await works(page, told);
        await beside(page, told);
        // Whatever else this machine does makes it longer.
        let ms = Infinity;
        for (let i = 0; i < 3 && ms > MOST_MS; i++) ms = Math.min(ms, await pace(page));
        console.log(`${word}: ${ms.toFixed(1)} ms a picture of 800 × 500`);
        if (timed && ms > MOST_MS) told(`a picture takes ${ms.toFixed(1)} ms, more than ${MOST_MS}`);
      }
      await page.close();
    }
    const told = (text) => faults.push(`${word}: ${text}`);
    const moving = await opened(word, told, { ...views[1], motion: "no-preference" });
    const clock = await moving.$eval(".hw-clock", (clock) => clock.textContent);
    if (clock.startsWith("0.00")) told("it does not begin by itself");
    await moving.close();
  }
  await browser.close();
  browser = await puppeteer.launch({ executablePath, args: ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"] });
  const told = (text) => faults.push(`${words[0]}, without WebGL: ${text}`);
  const page = await opened(words[0], told, views[1]);
  const sentence = await page.$eval(".hw-stage", (stage) => stage.textContent);
  if (!sentence.includes("WebGL 2 is missing")) told(`it says "${sentence}"`);
  await accessible(page, told);
} finally {
  await browser.close();
}
for (const fault of faults) console.error(fault);
console.log(`${words.length} scenes, ${views.length} views each: ${faults.length} faults`);
process.exitCode = faults.length > 0 ? 1 : 0;
