// Opens reports in a headless Chromium and checks them: accessibility (axe-core), nothing loaded, nothing said in the
// console, nothing wider than the screen at 360, 390, 800, 1280 and 1600 pixels, what is folded is open on paper, the film of a
// hand plays and stands still where it should.
//
//   node scripts/report_check.mjs REPORT.html… [--shots FOLDER]
//
// Needs a Chromium (CHROMIUM names it, where it is not found) and the packages axe-core and puppeteer-core, which
// `npm install --no-save axe-core puppeteer-core` fetches; NODE_PATH may say where they are. `--shots` keeps pictures
// of each view, and the pages of a print.
import { mkdirSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { axe, executablePath, puppeteer } from "./browser.mjs";

const words = process.argv.slice(2);
const flag = words.indexOf("--shots");
const shots = flag < 0 ? undefined : words.splice(flag, 2)[1];
if (words.length === 0) throw new Error("name the reports to check");
if (shots) mkdirSync(shots, { recursive: true });

const views = [
  { name: "narrow", width: 360, height: 740, deviceScaleFactor: 1, scheme: "light" },
  { name: "telephone", width: 390, height: 844, deviceScaleFactor: 2, scheme: "light" },
  { name: "tablet", width: 800, height: 1100, deviceScaleFactor: 1, scheme: "light" },
  { name: "wide", width: 1600, height: 1000, deviceScaleFactor: 1, scheme: "light" },
  { name: "desk", width: 1280, height: 900, deviceScaleFactor: 1, scheme: "light" },
  { name: "night", width: 1280, height: 900, deviceScaleFactor: 1, scheme: "dark" },
];
const faults = [];
const browser = await puppeteer.launch({ executablePath, args: ["--no-sandbox", "--disable-gpu"] });
try {
  for (const word of words) {
    const name = basename(word).replace(/\.html?$/, "");
    for (const view of views) {
      const told = (text) => faults.push(`${word}, ${view.name}: ${text}`);
      const page = await browser.newPage();
      page.on("console", (message) => told(`console: ${message.text()}`));
      page.on("pageerror", (error) => told(`script: ${error.message}`));
      page.on("request", (request) => {
        if (!request.url().startsWith("file:")) told(`it asks for ${request.url()}`);
      });
      // Films stand still, so that what is checked is what stays.
      const media = (motion) =>
        page.emulateMediaFeatures([
          { name: "prefers-color-scheme", value: view.scheme },
          { name: "prefers-reduced-motion", value: motion },
        ]);
      await media("reduce");
      await page.setViewport(view);
      await page.goto(pathToFileURL(resolve(word)).href);
      // Everything that can be opened is checked too.
      const open = (on) =>
        page.evaluate((on) => {
          for (const details of document.querySelectorAll("details")) {
            details.dataset.open ??= String(details.open);
            details.open = on || details.dataset.open === "true";
          }
        }, on);
      await open(true);
      // The page's own policy lets no script in but its own; the debugger may.
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => globalThis.axe.run({ resultTypes: ["violations"] }));
      for (const { id, help, nodes } of violations) {
        told(`${id}: ${help}: ${nodes.slice(0, 3).map((node) => node.target.join(" ")).join("; ")} (${nodes.length})`);
      }
      const [needed, there] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
      if (needed > there) told(`it is ${needed} px wide on a screen of ${there}`);
      for (const cut of await page.evaluate(overflowing)) told(`wider than its place: ${cut}`);
      await film(page, told, media);
      await open(false);
      if (shots) {
        await media("reduce");
        await page.evaluate(() => scrollTo(0, 0));
        await page.screenshot({ path: join(shots, `${name}-${view.name}.png`), fullPage: true });
      }
      if (view.name === "desk") await print(page, told, shots && join(shots, `${name}.pdf`));
      await page.close();
    }
  }
} finally {
  await browser.close();
}
for (const fault of faults) console.error(fault);
console.log(`${words.length} reports, ${views.length} views each: ${faults.length} faults`);
process.exitCode = faults.length > 0 ? 1 : 0;

// What is wider than its place and cannot be scrolled there.
function overflowing() {
  const boxes = [...document.querySelectorAll("main *, header *")];
  const scrolls = (element) => element.closest(".scroll, .sketch, .hidden, .cards thead, .player input");
  return boxes
    .filter((box) => !scrolls(box) && box.getClientRects().length > 0)
    .filter((box) => {
      const { left, right } = box.getBoundingClientRect();
      return right > innerWidth + 1 || left < -1;
    })
    .slice(0, 3)
    .map((box) => `${box.tagName.toLowerCase()}.${box.getAttribute("class") ?? ""} ${box.textContent.slice(0, 40)}`);
}

// Prints: what is folded is open on paper, and folded again afterwards.
async function print(page, told, path) {
  const closed = () => page.$$eval("details:not([open])", (all) => all.length);
  const before = await closed();
  await page.evaluate(() => addEventListener("beforeprint", () => {
    globalThis.foldedOnPaper = document.querySelectorAll("details:not([open])").length;
  }));
  await page.pdf({ path, format: "A4" });
  const left = await page.evaluate(() => globalThis.foldedOnPaper);
  if (left !== 0) told(`${left} parts are folded on paper`);
  if ((await closed()) !== before) told("what was folded is not folded again after printing");
}

// Plays the film, if there is one: it moves when asked to, and by itself only for those who like that.
async function film(page, told, media) {
  if (!(await page.$(".player"))) return;
  // What rests in a film still goes on in time.
  const drawn = () => page.$eval(".player", (player) => player.querySelector("svg").innerHTML + player.querySelector(".clock").textContent);
  const wait = () => new Promise((done) => setTimeout(done, 400));
  const before = await drawn();
  await wait();
  if ((await drawn()) !== before) told("the film plays although motion is to be reduced");
  await page.click(".player .play");
  // Slowly, where the machine has much to do.
  let moving = before;
  for (let i = 0; i < 10 && moving === before; i += 1) {
    await wait();
    moving = await drawn();
  }
  if (moving === before) told("the film does not play");
  await page.click(".player .play");
  const stopped = await drawn();
  await wait();
  if ((await drawn()) !== stopped) told("the film does not stop");
  await page.focus(".player input");
  await page.keyboard.press("End");
  const clock = await page.$eval(".player .clock", (clock) => clock.textContent);
  if (!/^\d+\.\d\d s, (\d+ mm|return )/.test(clock)) told(`the clock says ${clock}`);
  await page.reload();
  await media("no-preference");
  await page.reload();
  await page.$eval(".player", (player) => player.scrollIntoView({ block: "center" }));
  await wait();
  const first = await drawn();
  await wait();
  if ((await drawn()) === first) told("the film does not begin by itself");
}
