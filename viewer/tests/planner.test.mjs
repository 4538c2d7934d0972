// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The planner as a WebAssembly module, in node and in pages. Environment: as in page.mjs, and MNEME_DATA.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { launch, mneme, open, reasonToSkip, root, shoot } from "./page.mjs";
import { lacksModule, startPlanner } from "./planner.mjs";

const skip = lacksModule || await reasonToSkip();
if (skip) console.log(`SKIPPED: ${skip}`);
const panda = process.env.MNEME_DATA && join(process.env.MNEME_DATA, "mbm/panda");
const noPanda = skip || (panda && existsSync(panda) ? false : "MNEME_DATA is not set");

/** The path that the program finds on all machines. */
const portablePath = (where) => JSON.parse(mneme("plan", where, "--isa", "portable", "--json")).path;

describe("the module in node", { skip }, () => {
  for (const [robot, where] of [["planar8", "scenes/planar/scenario2.yaml"], ["planar8", "scenes/planar/threaded_b0.yaml"],
    ["fetch", "scenes/shelf/thin.yaml"]]) {
    test(`plans ${where} as the program does`, async () => {
      const planner = await startPlanner(robot);
      planner.addFile(`/${where}`, readFileSync(join(root, where), "utf8"));
      const opened = planner.open(`/${where}`);
      assert.equal(opened.status, 200, JSON.stringify(opened.json));
      assert.equal(opened.json.isa, "wasm");
      const { start, goals } = opened.json;
      const { json } = planner.call("/v1/plan", { start, goals });
      assert.equal(json.status, "solved", JSON.stringify(json));
      assert.deepEqual(json.path, portablePath(join(root, where)));
    });
  }

  test("refuses in words what the service refuses", async () => {
    const planner = await startPlanner("planar8");
    assert.equal(planner.call("/v1/plan", {}).status, 409);
    assert.match(planner.open("/none.yaml").json.error.message, /none\.yaml/);
  });

  test("plans problems of MotionBenchMaker as the program does", { skip: noPanda }, async () => {
    const planner = await startPlanner("panda");
    const times = [];
    for (const file of readdirSync(panda).map((name) => join(panda, name))) {
      planner.addFile("/problems.json", readFileSync(file, "utf8"));
      const { problems } = JSON.parse(readFileSync(file, "utf8"));
      for (const { index } of problems.slice(0, 5)) {
        const opened = planner.open(`/problems.json#${index}`);
        assert.equal(opened.status, 200, JSON.stringify(opened.json));
        const { start, goals } = opened.json;
        const { json } = planner.call("/v1/plan", { start, goals });
        assert.equal(json.status, "solved", `${file} ${index}: ${json.message}`);
        assert.deepEqual(json.path, portablePath(`${file}#${index}`), `${file} ${index}`);
        times.push(1e3 * json.planning_time_s);
      }
    }
    const median = times.sort((a, b) => a - b)[times.length >> 1];
    console.log(`${times.length} paths are those of the program; median ${median.toFixed(3)} ms`);
  });
});

/** Does something that asks for a plan, and waits until that is shown. */
async function planned(page, action) {
  const before = await page.evaluate(() => window.mneme.live.count);
  await action();
  await page.waitForFunction((count) => window.mneme.live.count > count, before, { timeout: 120000 });
}

describe("the page that plans by itself", { skip }, () => {
  let directory, browser;

  before(async () => {
    directory = mkdtempSync(join(tmpdir(), "mneme-planner-"));
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    if (directory) rmSync(directory, { recursive: true });
  });

  /** The page of `flags`, once its first plan is shown. */
  async function openPage(...flags) {
    const file = join(directory, "page.html");
    mneme("view", "--live", file, ...flags);
    assert.ok(statSync(file).size < 4 << 20, `${statSync(file).size} bytes`);
    const opened = await open(browser, file);
    await opened.page.waitForFunction(() => window.mneme.live.count > 0, null, { timeout: 120000 });
    const times = await opened.page.evaluate(() => [performance.getEntriesByName("first-picture")[0].startTime, performance.now()]);
    console.log(`${flags.join(" ")}: first picture after ${times[0].toFixed(0)} ms, first plan after ${times[1].toFixed(0)} ms`);
    return opened;
  }
  const note = (page) => page.locator("#note").textContent();

  test("plans without a network to where the goal is dragged, and around what is added", async () => {
    const { page, complaints, close } = await openPage("--problem", join(root, "scenes/planar/scenario3.yaml"));
    assert.match(await note(page), /^planned in/);
    const goal = await page.evaluate(() => window.mneme.live.goalPosition());
    const [from, to] = await page.evaluate((at) => [at, [at[0] + 0.4, at[1] + 0.5, 0]].map((each) => window.mneme.project(each)), goal);
    await planned(page, async () => {
      await page.mouse.move(from.x, from.y);
      await page.mouse.down();
      for (let i = 1; i <= 8; ++i) await page.mouse.move(from.x + (to.x - from.x) * i / 8, from.y + (to.y - from.y) * i / 8);
      await page.mouse.up();
    });
    assert.match(await note(page), /^planned in/);
    const [moved, reached] = await page.evaluate(() => [window.mneme.live.goalPosition(), window.mneme.live.reachedPosition()]);
    assert.ok(Math.hypot(...moved.map((value, i) => value - goal[i])) > 0.2);
    assert.ok(Math.hypot(...moved.map((value, i) => value - reached[i])) < 1e-3);
    await planned(page, () => page.locator("#add-ball").click());
    assert.deepEqual(complaints, []);
    await shoot(page, "own-planar");
    await close();
  });

  test("plans for Panda and for Fetch, whose scenes and joints are those of the problem", async () => {
    for (const flags of [["--robot", "panda"], ["--problem", join(root, "scenes/shelf/thick.yaml")]]) {
      const { page, complaints, close } = await openPage(...flags);
      await planned(page, () => page.locator("#seed").click());
      assert.match(await note(page), /^planned in/);
      assert.deepEqual(complaints, []);
      await shoot(page, `own-${flags[1].split("/").at(-1)}`);
      await close();
    }
  });
});
