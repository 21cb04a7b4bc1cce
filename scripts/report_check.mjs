// Opens reports in a headless Chromium and checks them: accessibility (axe-core), nothing loaded, nothing said in the
// console, nothing wider than the screen of a telephone, the film of a hand plays and stands still where it should.
//
//   node scripts/report_check.mjs REPORT.html… [--shots FOLDER]
//
// Needs a Chromium (CHROMIUM names it, where it is not found) and the packages axe-core and puppeteer-core, which
// `npm install --no-save axe-core puppeteer-core` fetches; NODE_PATH may say where they are. `--shots` keeps pictures:
// telephone, desk, the same by night, and the pages of a print.
import { createRequire } from "node:module";
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const load = createRequire(join(process.cwd(), "package.json"));
const puppeteer = load("puppeteer-core");
const axe = readFileSync(load.resolve("axe-core/axe.min.js"), "utf8");

const places = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const executablePath = places.find((place) => place && existsSync(place));
if (!executablePath) throw new Error("no Chromium is found; name one with CHROMIUM");
const words = process.argv.slice(2);
const flag = words.indexOf("--shots");
const shots = flag < 0 ? undefined : words.splice(flag, 2)[1];
if (words.length === 0) throw new Error("name the reports to check");
if (shots) mkdirSync(shots, { recursive: true });

const views = [
  { name: "telephone", width: 390, height: 844, deviceScaleFactor: 2, scheme: "light" },
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
      await film(page, told, media);
      await open(false);
      if (shots) {
        await media("reduce");
        await page.evaluate(() => scrollTo(0, 0));
        await page.screenshot({ path: join(shots, `${name}-${view.name}.png`), fullPage: true });
        if (view.name === "desk") await page.pdf({ path: join(shots, `${name}.pdf`), format: "A4" });
      }
      await page.close();
    }
  }
} finally {
  await browser.close();
}
for (const fault of faults) console.error(fault);
console.log(`${words.length} reports, ${views.length} views each: ${faults.length} faults`);
process.exitCode = faults.length > 0 ? 1 : 0;

// Plays the film, if there is one: it moves when asked to, and by itself only for those who like that.
async function film(page, told, media) {
  if (!(await page.$(".player"))) return;
  const drawn = () => page.$eval(".player svg", (svg) => svg.innerHTML);
  const wait = () => new Promise((done) => setTimeout(done, 400));
  const before = await drawn();
  await wait();
  if ((await drawn()) !== before) told("the film plays although motion is to be reduced");
  await page.click(".player .play");
  await wait();
  const moving = await drawn();
  if (moving === before) told("the film does not play");
  await page.click(".player .play");
  const stopped = await drawn();
  await wait();
  if ((await drawn()) !== stopped) told("the film does not stop");
  await page.focus(".player input");
  await page.keyboard.press("End");
  const clock = await page.$eval(".player .clock", (clock) => clock.textContent);
  if (!/^\d+\.\d\d s, \d+ mm/.test(clock)) told(`the clock says ${clock}`);
  await page.reload();
  await media("no-preference");
  await page.reload();
  await page.$eval(".player", (player) => player.scrollIntoView({ block: "center" }));
  await wait();
  const first = await drawn();
  await wait();
  if ((await drawn()) === first) told("the film does not begin by itself");
}
