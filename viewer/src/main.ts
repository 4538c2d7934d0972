// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Starts the page. */
import { Vector3 } from "three";
import { el } from "./elements";
import { LivePage } from "./live";
import { initTheme } from "./theme";
import { readTrace } from "./trace";
import { Viewer } from "./viewer";

const STILL_FRACTION = 0.45;

/** What scripts and tests may do with the page. */
interface Handle {
  seek(fraction: number): void;
  fraction(): number;
  tip(): number[] | null;
  /** Pixels of a point in the scene. */
  project(point: number[]): { x: number; y: number } | null;
  /** Draws at once: what is on the canvas may be read until the next task. */
  redraw(): void;
  /** Of the page of a service. */
  live: LivePage | null;
}

function start(): void {
  let viewer: Viewer | null = null;
  initTheme(() => viewer?.build());
  const trace = readTrace();
  viewer = new Viewer(trace);
  const page = viewer;
  const live = trace.live ? new LivePage(page, trace, trace.live) : null;
  const handle: Handle = {
    seek: (fraction) => page.dock.seek(fraction),
    fraction: () => page.dock.fraction,
    tip: () => page.tip(),
    project: (point) => page.stage.project(new Vector3(...point)),
    redraw: () => page.stage.drawNow(),
    live,
  };
  Object.assign(window, { mneme: handle });
  // The second of these comes when the first picture has been drawn.
  requestAnimationFrame(() => requestAnimationFrame(() => {
    performance.mark("first-picture");
    document.body.classList.add("ready");
  }));
  // Without a graphics card, motion is not smooth: show a still picture of robot, start and goal.
  const isCalm = page.stage.isSlow || window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (live) return;
  if (isCalm) page.dock.seek(STILL_FRACTION);
  else page.dock.toggle();
}

try {
  start();
} catch (error) {
  document.body.append(el("p", { class: "failure" }, `Cannot show this page: ${(error as Error).message}`));
  throw error;
}
