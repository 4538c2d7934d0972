// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Bundles src/ and three.js into one page without a trace, dist/viewer.html, which is committed.
// node build.mjs [FILE]
import { readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));

async function bundle(entry, options = {}) {
  const result = await build({
    entryPoints: [join(here, "src", entry)],
    absWorkingDir: here,
    bundle: true,
    minify: true,
    write: false,
    charset: "ascii",
    legalComments: "none",
    ...options,
  });
  return result.outputFiles[0].text.trim();
}

/** The text of the page; the same sources give the same bytes. */
export async function page() {
  const script = await bundle("main.ts", { format: "iife", target: "es2022" });
  const style = await bundle("style.css");
  const { version } = JSON.parse(await readFile(join(here, "node_modules/three/package.json"), "utf8"));
  const parts = {
    "/*mneme-style*/": style,
    "/*mneme-script*/": script.replaceAll("</script", "<\\/script"),
    "@three-version@": version,
  };
  let text = await readFile(join(here, "src/page.html"), "utf8");
  for (const [place, part] of Object.entries(parts)) text = text.replace(place, () => part);
  return text;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const file = process.argv[2] ?? join(here, "dist/viewer.html");
  const text = await page();
  await writeFile(file, text);
  console.log(`${file}: ${Math.round(text.length / 1024)} KiB`);
}
