// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Pages in headless Chromium. Environment: MNEME_PROGRAM (the program), MNEME_DATA (optional), MNEME_SHOTS (optional:
// a directory for screenshots), CHROMIUM (optional: the browser's file).
import { execFileSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

export const root = fileURLToPath(new URL("../../", import.meta.url));

const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const browserFile = [process.env.CHROMIUM, ...BROWSERS].find((file) => file && existsSync(file));

/** Why pages cannot be tested here, or false. */
export async function reasonToSkip() {
  if (!process.env.MNEME_PROGRAM) return "MNEME_PROGRAM does not name the program";
  if (!browserFile) return "there is no chromium";
  const found = await import("playwright-core").then(() => true, () => false);
  return found ? false : "there is no playwright-core: run 'npm ci' in viewer/";
}

export async function launch(graphics = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]) {
  const { chromium } = await import("playwright-core");
  return chromium.launch({ executablePath: browserFile, args: ["--no-sandbox", ...graphics] });
}

export function mneme(...args) {
  try {
    return execFileSync(process.env.MNEME_PROGRAM, args, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
  } catch (error) {
    // No path within the limit is an answer too.
    if (error.status === 3) return error.stdout;
    throw new Error(`mneme ${args.join(" ")}: ${error.stderr}`);
  }
}

/**
 * A page once `ready` is in it, of a file without a network or of a service; `complaints` collects console errors,
 * exceptions and requests to others.
 */
export async function open(browser, file, { width = 960, height = 600, theme = "light", ready = "body.ready" } = {}) {
  const isServed = file.startsWith("http:");
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: theme, offline: !isServed });
  const page = await context.newPage();
  const complaints = [];
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(error.message));
  const address = isServed ? file : pathToFileURL(file).href;
  page.on("request", (request) => {
    const url = request.url();
    const isOwn = isServed ? new URL(url).origin === new URL(address).origin : url === address;
    if (!isOwn && !/^(data|blob):/.test(url)) complaints.push(url);
  });
  await page.goto(address, { timeout: 120000 });
  await page.waitForSelector(ready, { timeout: 120000 });
  return { page, complaints, close: () => context.close() };
}

/** A screenshot, where they are wanted. */
export async function shoot(page, name) {
  if (!process.env.MNEME_SHOTS) return;
  // The last picture of a still scene has smooth edges.
  await page.waitForTimeout(400);
  await page.screenshot({ path: join(process.env.MNEME_SHOTS, `${name}.png`), timeout: 120000 });
}

/** Pixels of the canvas, and how many of them differ from the most frequent colour. */
export function looks(page) {
  return page.evaluate(() => new Promise((resolve) => {
    requestAnimationFrame(() => {
      const canvas = document.getElementById("canvas");
      const copy = document.createElement("canvas");
      copy.width = 320;
      copy.height = Math.round((320 * canvas.height) / canvas.width);
      const context = copy.getContext("2d");
      window.mneme.redraw();
      context.drawImage(canvas, 0, 0, copy.width, copy.height);
      const { data } = context.getImageData(0, 0, copy.width, copy.height);
      const colors = [];
      for (let i = 0; i < data.length; i += 4) colors.push((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
      const counts = new Map();
      for (const color of colors) counts.set(color, (counts.get(color) ?? 0) + 1);
      const background = Math.max(...counts.values());
      resolve({ colors, share: 1 - background / colors.length, kinds: counts.size });
    });
  }));
}

/** How many pixels two looks differ in. */
export function difference(a, b) {
  return a.colors.filter((color, i) => color !== b.colors[i]).length;
}
