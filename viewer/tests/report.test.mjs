// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { launch, mneme, open, reasonToSkip, root, shoot } from "./page.mjs";

const skip = await reasonToSkip();
if (skip) console.log(`SKIPPED: ${skip}`);

/** Solved runs of a planner and a sampler, by the columns of the CSV file. */
function countSolved(csv, planner, sampler) {
  const [head, ...lines] = csv.trim().split("\n").map((line) => line.split(","));
  const column = (line, name) => line[head.indexOf(name)];
  return lines.filter((line) => column(line, "planner") === planner && column(line, "sampler") === sampler &&
    column(line, "status") === "solved" && column(line, "is_valid") === "1").length;
}

describe("reports of benchmarks", { skip }, () => {
  let directory, browser, csv;

  before(async () => {
    directory = mkdtempSync(join(tmpdir(), "mneme-report-"));
    const problem = join(root, "scenes/planar/scenario1.yaml");
    const [db, rows] = [join(directory, "planar.db"), join(directory, "runs.csv")];
    mneme("learn", "--robot", "planar8", "--scenes", problem, "--db", db, "--starts-per-link", "1", "--paths-per-start",
      "1", "--jobs", "1");
    mneme("bench", "run", problem, "--planners", "rrt_connect,rrt,prm", "--samplers", "gl,uniform,halton", "--db", db,
      "--seeds", "20", "--max-iterations", "500", "--csv", rows);
    mneme("bench", "report", rows, "-o", join(directory, "report.html"));
    csv = readFileSync(rows, "utf8");
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    if (directory) rmSync(directory, { recursive: true });
  });

  test("3 planners, 3 samplers and 20 seeds are shown offline without complaints, with the counts of the CSV file",
    async () => {
      const { page, complaints, close } = await open(browser, join(directory, "report.html"), { ready: "footer" });
      assert.equal(await page.locator("figure svg, .figure svg").count(), 1);
      const lines = await page.locator("table.times tbody tr").evaluateAll((rows) =>
        rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
      assert.equal(lines.length, 9);
      for (const [planner, sampler, , solved] of lines) {
        assert.equal(solved, `${countSolved(csv, planner, sampler)}/20/20`, `${planner}, ${sampler}`);
      }
      await shoot(page, "report");
      assert.deepEqual(complaints, []);
      await close();
    });
});
