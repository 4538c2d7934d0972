// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import {
  difference, launch, looks, mneme, open, reasonToSkip, root, shoot, timeToFirstPicture,
} from "./page.mjs";

const skip = await reasonToSkip();
if (skip) console.log(`SKIPPED: ${skip}`);
const fetchProblems = process.env.MNEME_DATA && join(process.env.MNEME_DATA, "mbm/fetch/bookshelf_small.json");
const noFetch = skip || (fetchProblems && existsSync(fetchProblems) ? false : "MNEME_DATA is not set");

describe("pages", { skip }, () => {
  let directory, browser, planar;

  before(async () => {
    directory = mkdtempSync(join(tmpdir(), "mneme-view-"));
    const problem = join(root, "scenes/planar/scenario3.yaml");
    const db = join(directory, "planar.db");
    mneme("learn", "--robot", "planar8", "--scenes", problem, "--db", db, "--starts-per-link", "1", "--paths-per-start",
      "1", "--jobs", "1");
    planar = join(directory, "planar.html");
    mneme("plan", problem, "--db", db, "--view", planar);
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    if (directory) rmSync(directory, { recursive: true });
  });

  test("a planar plan is shown without errors and without a network, and scrubbing moves the robot", async () => {
    const { page, complaints, close } = await open(browser, planar);
    await page.evaluate(() => window.mneme.seek(0.2));
    const early = { looks: await looks(page), tip: await page.evaluate(() => window.mneme.tip()) };
    assert.ok(early.looks.share > 0.05, `only ${early.looks.share} of the picture is drawn on`);
    assert.ok(early.looks.kinds > 30);

    const box = await page.locator("#scrubber").boundingBox();
    await page.mouse.click(box.x + 0.8 * box.width, box.y + box.height / 2);
    const fraction = await page.evaluate(() => window.mneme.fraction());
    assert.ok(Math.abs(fraction - 0.8) < 0.02, `at ${fraction}`);
    const late = { looks: await looks(page), tip: await page.evaluate(() => window.mneme.tip()) };
    assert.ok(difference(early.looks, late.looks) > 50);
    assert.ok(Math.hypot(...late.tip.map((v, i) => v - early.tip[i])) > 0.2);
    await shoot(page, "planar-light");
    assert.deepEqual(complaints, []);
    await close();
  });

  test("keys play, step, hide layers and change the theme", async () => {
    const { page, complaints, close } = await open(browser, planar);
    const fraction = () => page.evaluate(() => window.mneme.fraction());
    await page.keyboard.press("Home");
    assert.equal(await fraction(), 0);
    await page.keyboard.press("ArrowRight");
    assert.ok(Math.abs((await fraction()) - 0.01) < 1e-9);
    await page.keyboard.press("Shift+ArrowRight");
    assert.ok((await fraction()) > 0.01);
    await page.keyboard.press("End");
    assert.equal(await fraction(), 1);
    await page.keyboard.press("Home");
    await page.keyboard.press(" ");
    await page.waitForFunction(() => window.mneme.fraction() > 0.02, null, { timeout: 60000 });
    await page.keyboard.press(" ");

    await page.keyboard.press("Home");
    const whole = await looks(page);
    await page.keyboard.press("1");
    const withoutGhosts = await looks(page);
    assert.ok(difference(whole, withoutGhosts) > 20);
    await page.keyboard.press("t");
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark");
    assert.ok(difference(withoutGhosts, await looks(page)) > 10000);
    assert.deepEqual(complaints, []);
    await close();
  });

  test("a primitive that is clicked is shown alone", async () => {
    const { page, complaints, close } = await open(browser, planar);
    const labels = page.locator("#labels span");
    assert.ok((await labels.count()) > 1);
    assert.match(await labels.first().textContent(), /\d\.\d\d m/);
    await page.locator(".primitive").first().click();
    assert.equal(await labels.count(), 1);
    await page.keyboard.press("Escape");
    assert.ok((await labels.count()) > 1);
    assert.deepEqual(complaints, []);
    await close();
  });

  test("the page fits a phone, in the dark", async () => {
    const { page, complaints, close } = await open(browser, planar, { width: 390, height: 780, theme: "dark" });
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark");
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
    for (const part of ["#head", "#dock", "#tools", "#play", "#scrubber"]) {
      const box = await page.locator(part).boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= 390 && box.y >= 0 && box.y + box.height <= 780, part);
    }
    assert.ok(!(await page.locator("#panel").isVisible()));
    assert.ok((await looks(page)).share > 0.03);
    await shoot(page, "planar-phone-dark");
    await page.locator("#tool-panel").click();
    assert.ok(await page.locator("#panel").isVisible());
    await shoot(page, "planar-phone-panel");
    assert.deepEqual(complaints, []);
    await close();
  });

  test("a plan that failed shows start, goal and search, and says why", async () => {
    const file = join(directory, "failed.html");
    mneme("plan", join(root, "scenes/planar/scenario3.yaml"), "--max-iterations", "200", "--view", file);
    const { page, complaints, close } = await open(browser, file);
    assert.match(await page.locator("#dock").textContent(), /no path within 200 iterations/);
    assert.ok((await looks(page)).share > 0.05);
    assert.deepEqual(complaints, []);
    await close();
  });

  // Within 2 s where a graphics card or an idle processor draws it; that is for people to look at, because a test must
  // pass on slow machines too.
  test("a plan of Fetch is below 2 MB, and its first picture comes soon", async () => {
    const file = join(directory, "shelf.html");
    mneme("plan", join(root, "scenes/shelf/thin.yaml"), "--max-iterations", "200000", "--view", file);
    assert.ok(statSync(file).size < 2e6);
    const first = await timeToFirstPicture(browser, file);
    console.log(`first picture of Fetch after ${first.toFixed(0)} ms`);
    assert.ok(first < 30000, `${first} ms`);
  });

  test("the robot of a plan of Fetch moves, in the light and in the dark", { skip: noFetch }, async () => {
    const file = join(directory, "fetch.html");
    mneme("plan", `${fetchProblems}#3`, "--view", file);
    assert.ok(readFileSync(file, "utf8").includes('"solved":true'));
    const { page, complaints, close } = await open(browser, file);
    await page.evaluate(() => window.mneme.seek(0.1));
    const early = await looks(page);
    assert.ok(early.share > 0.1);
    await page.evaluate(() => window.mneme.seek(0.9));
    assert.ok(difference(early, await looks(page)) > 100);
    await shoot(page, "fetch-light");
    await page.keyboard.press("t");
    await shoot(page, "fetch-dark");
    assert.deepEqual(complaints, []);
    await close();
  });
});
