// The browser of the checks beside this file. It needs a Chromium (CHROMIUM names it, where it is not found) and, in the folder where
// a check is called, the packages axe-core and puppeteer-core: `npm install --no-save axe-core puppeteer-core`.
import { createRequire } from "node:module";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";

const load = createRequire(join(process.cwd(), "package.json"));
export const puppeteer = load("puppeteer-core");
export const axe = readFileSync(load.resolve("axe-core/axe.min.js"), "utf8");

const places = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
export const executablePath = places.find((place) => place && existsSync(place));
if (!executablePath) throw new Error("no Chromium is found; name one with CHROMIUM");
