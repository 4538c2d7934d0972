// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Play, scrub and the clearance along the path, which is what one scrubs on. */
import { el, icon, metres, svg } from "./elements";
import type { Motion } from "./motion";
import type { Trace } from "./trace";

const WIDTH = 1000;
const HEIGHT = 100;

/** Seconds that playing the whole motion takes: its own, or what is comfortable to watch. */
function duration(motion: Motion): number {
  return motion.duration ?? Math.min(14, Math.max(4, 0.9 * motion.length));
}

const SPEEDS = [1, 0.5, 0.25, 2];
/** Seconds that it stands still at the goal before it starts again. */
const REST = 0.8;

export class Dock {
  fraction = 0;
  isPlaying = false;
  isLooping = true;
  private readonly playButton = el("button", { class: "round", id: "play", title: "Play or pause (space)" });
  private readonly readout = el("output", { id: "readout" });
  private readonly cursor = svg("g", { class: "cursor" });
  private readonly chart = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", class: "chart" });
  private readonly slider = el("div", {
    id: "scrubber", role: "slider", tabindex: "0", "aria-label": "Position along the path", "aria-valuemin": "0",
    "aria-valuemax": "100",
  });
  private readonly speedButton = el("button", { class: "speed", id: "speed", title: "Speed" });
  private speed = 0;
  private last = 0;
  private isRemoved = false;

  constructor(private readonly root: HTMLElement, private readonly trace: Trace, private readonly motion: Motion,
              private readonly moved: (fraction: number) => void) {
    root.replaceChildren();
    if (motion.isEmpty) {
      root.append(el("p", { class: "nopath" }, trace.plan.message || "There is no path."));
      return;
    }
    this.playButton.addEventListener("click", () => this.toggle());
    this.drawChart();
    this.slider.append(this.chart, ...this.axis());
    this.slider.addEventListener("pointerdown", (event) => this.drag(event));
    this.speedButton.addEventListener("click", () => {
      this.speed = (this.speed + 1) % SPEEDS.length;
      this.show();
    });
    root.append(this.playButton, el("div", { class: "track" }, this.readout, this.slider));
    this.show();
    requestAnimationFrame((time) => this.tick(time));
  }

  toggle(): void {
    if (this.motion.isEmpty) return;
    this.isPlaying = !this.isPlaying;
    if (this.isPlaying && this.fraction >= 1) this.fraction = 0;
    this.show();
  }

  /** Another dock takes its place. */
  remove(): void {
    this.isRemoved = true;
    this.root.replaceChildren();
  }

  /** Goes to a fraction of the motion and stays there. */
  seek(fraction: number): void {
    if (this.motion.isEmpty) return;
    this.isPlaying = false;
    this.fraction = Math.min(1, Math.max(0, fraction));
    this.show();
  }

  /** Goes to the path's next configuration, or to the one before. */
  jump(direction: number): void {
    const stops = this.trace.vertices.map((i) => this.motion.fractionOf(i));
    const next = direction > 0
      ? stops.find((stop) => stop > this.fraction + 1e-6)
      : stops.reverse().find((stop) => stop < this.fraction - 1e-6);
    this.seek(next ?? (direction > 0 ? 1 : 0));
  }

  private tick(time: number): void {
    const elapsed = Math.min(0.1, (time - this.last) / 1000);
    this.last = time;
    if (this.isRemoved) return;
    if (this.isPlaying) {
      const whole = duration(this.motion);
      this.fraction += (elapsed * SPEEDS[this.speed]!) / whole;
      const isOver = this.fraction >= 1 + REST / whole;
      if (isOver) this.fraction = this.isLooping ? 0 : 1;
      this.isPlaying = this.isLooping || !isOver;
      this.show();
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  private drag(event: PointerEvent): void {
    event.preventDefault();
    const go = (at: PointerEvent) => {
      const box = this.slider.getBoundingClientRect();
      this.seek((at.clientX - box.left) / box.width);
    };
    const stop = () => {
      this.slider.removeEventListener("pointermove", go);
      this.slider.removeEventListener("pointerup", stop);
      this.slider.removeEventListener("pointercancel", stop);
    };
    this.slider.setPointerCapture(event.pointerId);
    this.slider.addEventListener("pointermove", go);
    this.slider.addEventListener("pointerup", stop);
    this.slider.addEventListener("pointercancel", stop);
    go(event);
  }

  private show(): void {
    const fraction = Math.min(1, this.fraction);
    this.cursor.setAttribute("transform", `translate(${fraction * WIDTH} 0)`);
    this.slider.setAttribute("aria-valuenow", (100 * fraction).toFixed(0));
    this.playButton.replaceChildren(icon(this.isPlaying ? "pause" : "play"));
    this.playButton.setAttribute("aria-label", this.isPlaying ? "Pause" : "Play");
    this.readout.replaceChildren(...this.reading(fraction));
    this.moved(fraction);
  }

  private reading(fraction: number): Node[] {
    const moment = this.motion.at(fraction)!;
    const waypoint = this.trace.waypoints[moment.index]!;
    const nodes: Node[] = [];
    if (moment.clearance !== null) {
      const link = this.trace.links[waypoint.nearest[0]]?.name ?? "";
      const obstacle = this.trace.obstacles[waypoint.nearest[1]]?.name ?? "";
      const value = el("b", { class: moment.clearance < 0.01 ? "tight" : "" }, metres(moment.clearance));
      nodes.push(el("span", {}, "clearance ", value),
        el("span", { class: "soft" }, `${link} \u2194 ${obstacle}`));
    }
    const [whole, unit] = this.motion.duration === null ? [this.motion.length, "rad"] : [this.motion.duration, "s"];
    nodes.push(el("span", { class: "soft end" }, `${(fraction * whole).toFixed(2)} of ${whole.toFixed(2)} ${unit}`));
    this.speedButton.textContent = `${SPEEDS[this.speed]}\u00d7`;
    nodes.push(this.speedButton);
    return nodes;
  }

  /** The square root lets small clearances, which matter, take more room. */
  private height(clearance: number): number {
    const most = Math.max(0.02, ...this.trace.waypoints.map((w) => w.clearance ?? 0));
    return HEIGHT - 6 - (HEIGHT - 36) * Math.sqrt(Math.max(0, clearance) / most);
  }

  private drawChart(): void {
    const points = this.trace.waypoints
      .map((w, i) => ({ x: this.motion.fractionOf(i) * WIDTH, clearance: w.clearance }))
      .filter((p) => p.clearance !== null)
      .map((p) => `${p.x.toFixed(1)},${this.height(p.clearance!).toFixed(1)}`);
    const gradient = svg("linearGradient", { id: "way", x1: 0, x2: 1, y1: 0, y2: 0 },
      svg("stop", { offset: 0, "stop-color": "var(--start)" }), svg("stop", { offset: 0.5, "stop-color": "var(--middle)" }),
      svg("stop", { offset: 1, "stop-color": "var(--goal)" }));
    this.chart.append(svg("defs", {}, gradient));
    if (points.length > 1) {
      this.chart.append(
        svg("polygon", { points: `0,${HEIGHT} ${points.join(" ")} ${WIDTH},${HEIGHT}`, class: "area" }),
        svg("polyline", { points: points.join(" "), class: "line" }),
      );
    }
    for (const i of this.trace.vertices) {
      const x = this.motion.fractionOf(i) * WIDTH;
      this.chart.append(svg("line", { x1: x, x2: x, y1: HEIGHT - 7, y2: HEIGHT, class: "vertex" }));
    }
    this.cursor.append(svg("line", { x1: 0, x2: 0, y1: 0, y2: HEIGHT }));
    this.chart.append(this.cursor);
  }

  private axis(): Node[] {
    const values = this.trace.waypoints.map((w) => w.clearance).filter((c): c is number => c !== null);
    if (values.length === 0) return [];
    const most = Math.max(...values);
    const least = Math.min(...values);
    return [el("span", { class: "scale top" }, metres(most)), el("span", { class: "scale bottom" }, `least ${metres(least)}`)];
  }
}
