// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { test } from "node:test";

const here = fileURLToPath(new URL("../", import.meta.url));
const skip = existsSync(`${here}node_modules/esbuild`) ? false : "no node_modules: run 'npm ci' in viewer/";
if (skip) console.log(`SKIPPED: ${skip}`);
const committed = readFileSync(`${here}dist/viewer.html`, "utf8");

test("the committed page is what its sources make", { skip }, async () => {
  const { page } = await import("../build.mjs");
  assert.ok((await page()) === committed, "dist/viewer.html is stale: run 'npm run build' in viewer/ and commit it");
});

test("the sources have no type errors", { skip }, () => {
  execFileSync(`${here}node_modules/.bin/tsc`, ["--noEmit"], { cwd: here, stdio: "pipe" });
});

test("the page is small and has one place for title and trace each", () => {
  assert.ok(committed.length < 700e3);
  for (const place of ["<!--mneme-title-->", "<!--mneme-trace-->"]) assert.equal(committed.split(place).length, 2);
  // What stands in the program's source as a raw string.
  assert.ok(!committed.includes(")mneme-page"));
});
