// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The WebAssembly module of the planner in node.
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { gunzipSync } from "node:zlib";
import { root } from "./page.mjs";

const file = (name) => join(root, "wasm", `planner.${name}.gz`);

/** Why the module cannot be tested here, or false. */
export const lacksModule = existsSync(file("wasm")) ? false : "there is no wasm/planner.wasm.gz: script/wasm --setup builds it";

/** A planner with the files of a robot that comes with mneme. */
export async function startPlanner(robot) {
  const directory = mkdtempSync(join(tmpdir(), "mneme-planner-"));
  const script = join(directory, "planner.cjs");
  writeFileSync(script, gunzipSync(readFileSync(file("js"))));
  const module = await createRequire(import.meta.url)(script)({ wasmBinary: gunzipSync(readFileSync(file("wasm"))) });
  rmSync(directory, { recursive: true });
  const functions = {
    addFile: module.cwrap("mneme_add_file", "number", ["string", "string"]),
    open: module.cwrap("mneme_open", "number", ["string"]),
    call: module.cwrap("mneme_call", "number", ["string", "string"]),
    answer: module.cwrap("mneme_answer", "string", []),
  };
  const answered = (status) => ({ status, json: JSON.parse(functions.answer()) });
  const planner = {
    addFile: (path, text) => answered(functions.addFile(path, text)),
    open: (where) => answered(functions.open(where)),
    call: (path, request) => answered(functions.call(path, JSON.stringify(request))),
  };
  for (const suffix of ["urdf", "srdf"]) {
    const path = `robots/${robot}.${suffix}`;
    if (existsSync(join(root, path))) planner.addFile(`/${path}`, readFileSync(join(root, path), "utf8"));
  }
  return planner;
}
