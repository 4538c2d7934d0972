// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The page of a service, with real drags.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { launch, looks, mneme, open, reasonToSkip, root, shoot } from "./page.mjs";

const skip = await reasonToSkip() || hasNoService();
if (skip) console.log(`SKIPPED: ${skip}`);

function hasNoService() {
  try {
    mneme("serve", "--help");
    return false;
  } catch {
    return "mneme is built without its service";
  }
}

/** The address of a service that runs until `stop` is called. */
async function serve(...flags) {
  const child = spawn(process.env.MNEME_PROGRAM, ["serve", "--listen", "127.0.0.1:0", ...flags],
    { stdio: ["ignore", "pipe", "inherit"] });
  const address = await new Promise((resolve, reject) => {
    child.stdout.on("data", (text) => resolve(String(text).match(/http:\S+/)[0]));
    child.on("exit", (code) => reject(new Error(`mneme serve ended with ${code}`)));
  });
  return { address, stop: () => new Promise((resolve) => child.on("exit", resolve) && child.kill("SIGTERM")) };
}

const shown = (page) => page.evaluate(() => window.mneme.live.count);

/** Does something that asks for a plan, and waits until that is shown. */
async function planned(page, action) {
  const before = await shown(page);
  await action();
  await page.waitForFunction((count) => window.mneme.live.count > count, before, { timeout: 120000 });
}

/** A drag in small steps, as people do it. */
async function drag(page, from, by) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 1; i <= 8; ++i) await page.mouse.move(from.x + (by.x * i) / 8, from.y + (by.y * i) / 8);
  await page.mouse.up();
}

const place = (page, name) => page.evaluate((each) =>
  (each === "goal" ? window.mneme.live.goalPosition() : window.mneme.live.obstaclePosition(each)), name);
const pixels = (page, point) => page.evaluate((each) => window.mneme.project(each), point);
/** A drag from a place of the scene to another one. */
async function carry(page, from, to) {
  const [a, b] = [await pixels(page, from), await pixels(page, to)];
  await drag(page, a, { x: b.x - a.x, y: b.y - a.y });
}
const distance = (a, b) => Math.hypot(...a.map((value, i) => value - b[i]));

async function openLive(browser, service) {
  const opened = await open(browser, service.address);
  await opened.page.waitForFunction(() => window.mneme.live.count > 0, null, { timeout: 120000 });
  return opened;
}

describe("the page of a service", { skip }, () => {
  let directory, browser, planar, fetch;

  before(async () => {
    directory = mkdtempSync(join(tmpdir(), "mneme-live-"));
    const problem = join(root, "scenes/planar/scenario3.yaml");
    const db = join(directory, "planar.db");
    mneme("learn", "--robot", "planar8", "--scenes", problem, "--db", db, "--starts-per-link", "1", "--paths-per-start",
      "1", "--jobs", "1");
    planar = await serve("--robot", "planar8", "--db", db, "--problem", problem);
    fetch = await serve("--robot", "fetch", "--problem", join(root, "scenes/shelf/thick.yaml"));
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    await planar?.stop();
    await fetch?.stop();
    if (directory) rmSync(directory, { recursive: true });
  });

  test("dragging the goal plans to where it is left, from memory and uniformly beside it", async () => {
    const { page, complaints, close } = await openLive(browser, planar);
    assert.deepEqual(await page.locator("#sides .side b").allTextContents(), ["memory", "uniform"]);
    await planned(page, () => page.locator("#at-once").click());
    assert.ok((await page.locator(".primitive").count()) > 0, "what memory contributed");
    const goal = await place(page, "goal");
    await planned(page, () => carry(page, goal, [goal[0] + 0.4, goal[1] + 0.5, 0]));
    const moved = await place(page, "goal");
    assert.ok(distance(goal, moved) > 0.2, `moved by ${distance(goal, moved)}`);
    assert.match(await page.locator("#note").textContent(), /^planned in/);
    const reached = await page.evaluate(() => window.mneme.live.reachedPosition());
    assert.ok(distance(reached, moved) < 1e-3, `the arm ends at ${reached}, the goal is at ${moved}`);
    await shoot(page, "live-planar");
    assert.deepEqual(complaints, []);
    await close();
  });

  test("an obstacle is dragged, made, made larger and removed, and each time it is planned", async () => {
    const { page, complaints, close } = await openLive(browser, planar);
    const circle = await place(page, "circle_1");
    await planned(page, () => carry(page, circle, [circle[0] - 0.3, circle[1] + 0.2, 0]));
    assert.ok(distance(circle, await place(page, "circle_1")) > 0.1);
    await planned(page, () => page.locator("#add-ball").click());
    assert.ok(await place(page, "ball 1"));
    await planned(page, () => page.locator("#larger").click());
    await planned(page, () => page.keyboard.press("Delete"));
    assert.equal(await place(page, "ball 1"), null);
    assert.deepEqual(complaints, []);
    await close();
  });

  test("after an obstacle was removed and a plan refused, a drag moves the obstacle under the pointer", async () => {
    const { page, close } = await openLive(browser, planar);
    const circle = await pixels(page, await place(page, "circle_1"));
    await page.mouse.click(circle.x, circle.y);
    await page.route("**/v1/plan", (route) => route.fulfill({ status: 503, json: { error: { message: "busy" } } }));
    await page.keyboard.press("Delete");
    await page.waitForFunction(() => document.getElementById("note").textContent === "busy");
    assert.equal(await place(page, "circle_1"), null);
    const [second, third] = [await place(page, "circle_2"), await place(page, "circle_3")];
    await carry(page, second, [second[0] + 0.4, second[1] + 0.2, 0]);
    assert.ok(distance(second, await place(page, "circle_2")) > 0.1);
    assert.deepEqual(await place(page, "circle_3"), third);
    await close();
  });

  test("without WebGL a page plans, and draws the goal's handles", async () => {
    const plain = await launch(["--disable-3d-apis"]);
    for (const service of [planar, fetch]) {
      const { page, complaints, close } = await openLive(plain, service);
      assert.match(await page.locator("#simplified").textContent(), /no WebGL 2/);
      const { colors, share } = await looks(page);
      assert.ok(share > 0.05, `only ${share} of the picture is drawn on`);
      // The arrow of x is red, that of y green; both are slightly transparent.
      const [red, green] = [[16, 8], [8, 16]].map(([strong, weak]) =>
        colors.filter((color) => ((color >> strong) & 255) > 180 && ((color >> weak) & 255) < 90 && (color & 255) < 90).length);
      assert.ok(red > 3 && green > 3, `${red} red and ${green} green pixels`);
      const goal = await place(page, "goal");
      await planned(page, () => carry(page, goal, goal.map((value) => value - 0.02)));
      assert.ok(distance(goal, await place(page, "goal")) > 0.005);
      await shoot(page, "live-plain");
      assert.deepEqual(complaints, []);
      await close();
    }
    await plain.close();
  });

  test("plans keep the constraints of the problem, and the first start its velocity", async () => {
    const problem = join(directory, "upright.yaml");
    const constraint = { link: "link_8", axis: [1, 0, 0], up: [1, 0, 0], angle: 0.5 };
    const velocity = [0, 0, 0, 0, 0, 0, 0, 0.1];
    writeFileSync(problem, ["name: upright", "robot: planar8", `constraints: [${JSON.stringify(constraint)}]`,
      "scene: {circles: [[0, 12, 1]]}", "start: [0.6, 0.6, 0, 0, 0, 0, -0.6, -0.6]", `start_velocity: ${JSON.stringify(velocity)}`,
      "goal: [-0.6, -0.6, 0, 0, 0, 0, 0.6, 0.6]", ""].join("\n"));
    const service = await serve("--robot", "planar8", "--problem", problem);
    const { page, complaints, close } = await openLive(browser, service);
    const sent = [];
    page.on("request", (request) => request.url().endsWith("/v1/plan") && sent.push(request.postDataJSON()));
    for (const id of ["#seed", "#restart"]) {
      await planned(page, () => page.locator(id).click());
      assert.match(await page.locator("#note").textContent(), /^planned in/);
    }
    assert.deepEqual(sent.map(({ constraints }) => constraints), [[constraint], [constraint]]);
    assert.deepEqual(sent.map(({ start_velocity }) => start_velocity), [velocity, undefined]);
    assert.deepEqual(complaints, []);
    await close();
    await service.stop();
  });

  test("a goal that nothing reaches is refused in words, and the page goes on", async () => {
    const { page, complaints, close } = await openLive(browser, planar);
    const goal = await place(page, "goal");
    // Eight links of one metre each do not reach it.
    const far = [-7.5, 7, 0];
    await planned(page, () => carry(page, goal, far));
    assert.match(await page.locator("#note").textContent(), /^goal pose: the pose is out of reach of link/);
    assert.match(await page.locator("#dock").textContent(), /out of reach/);
    await planned(page, () => carry(page, far, goal));
    assert.match(await page.locator("#note").textContent(), /^planned in/);
    assert.deepEqual(complaints, []);
    await close();
  });

  test("the hand of Fetch is dragged in space, and the way to it scrubbed", async () => {
    const { page, complaints, close } = await openLive(browser, fetch);
    const goal = await place(page, "goal");
    // The gizmo stands at the goal itself; the arrow that points up takes hold of its height.
    const above = await pixels(page, [goal[0], goal[1], goal[2] + 0.12]);
    await planned(page, () => drag(page, above, { x: 0, y: -5 }));
    const moved = await place(page, "goal");
    assert.ok(distance(goal, moved) > 0.005, `moved by ${distance(goal, moved)}`);
    assert.match(await page.locator("#note").textContent(), /^planned in/);
    const reached = await page.evaluate(() => window.mneme.live.reachedPosition());
    assert.ok(distance(reached, moved) < 1e-3, `the hand ends at ${reached}, the goal is at ${moved}`);
    const box = await page.locator("#scrubber").boundingBox();
    await page.mouse.click(box.x + 0.3 * box.width, box.y + box.height / 2);
    assert.ok(Math.abs((await page.evaluate(() => window.mneme.fraction())) - 0.3) < 0.02);
    await shoot(page, "live-fetch");
    assert.deepEqual(complaints, []);
    await close();
  });

  test("clouds of the problem stay where they are, and count", async () => {
    writeFileSync(join(directory, "scan.ply"), "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n" +
      "property float z\nend_header\n7.9 0 0\n");
    const problem = join(directory, "scan.yaml");
    writeFileSync(problem, ["name: scan", "robot: planar8", "scene:", "  obstacles:",
      "    - {name: scan, type: points, file: scan.ply, radius: 0.2}", "    - {name: ball, type: sphere, position: [-3, -3, 0], radius: 0.5}",
      "  allow: [[link_1, ball], {pair: [link_8, ball], at_ends: 0.01}]",
      "start: [1.5, 0, 0, 0, 0, 0, 0, 0]", "goal: {link: link_8, position: [7.99, 0, 0]}", ""].join("\n"));
    const service = await serve("--robot", "planar8", "--problem", problem);
    const { page, complaints, close } = await openLive(browser, service);
    assert.match(await page.locator("#note").textContent(), /scan/);
    const goal = await place(page, "goal");
    await planned(page, () => carry(page, goal, [5, 3, 0]));
    assert.match(await page.locator("#note").textContent(), /^planned in/);
    assert.equal(await place(page, "scan"), null);
    assert.ok(await place(page, "ball"));
    assert.deepEqual(complaints, []);
    await close();
    await service.stop();
  });

  test("a service that has gone is said", async () => {
    const service = await serve("--robot", "planar8");
    const { page, close } = await openLive(browser, service);
    await service.stop();
    await page.locator("#seed").click();
    await page.waitForFunction(() => /does not answer/.test(document.getElementById("note").textContent), null, { timeout: 120000 });
    await close();
  });
});
