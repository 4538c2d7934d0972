// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Positions, velocities and accelerations along the motion, a plot for each joint, with limits. */
import { el, svg } from "./elements";
import type { Motion } from "./motion";
import type { Trace, Waypoint } from "./trace";

const WIDTH = 280;
const HEIGHT = 34;
/** Of the limit, from which on a value is drawn as tight. */
const TIGHT = 0.98;

type Kind = "position" | "velocity" | "acceleration";
const VALUES: Record<Kind, (waypoint: Waypoint) => number[] | undefined> = {
  position: (waypoint) => waypoint.q,
  velocity: (waypoint) => waypoint.velocity,
  acceleration: (waypoint) => waypoint.acceleration,
};

interface Row {
  cursor: SVGElement;
  value: HTMLElement;
}

interface Range {
  /** Where limits are; null without one. */
  lower: number | null;
  upper: number | null;
  /** Of the plot. */
  low: number;
  high: number;
}

export class JointPlots {
  readonly object = el("div", { class: "joints" });
  private readonly list = el("div", {});
  private readonly tabs = el("div", { class: "tabs", role: "tablist" });
  private kind: Kind = "position";
  private rows: Row[] = [];
  private fraction = 0;

  constructor(private readonly trace: Trace, private readonly motion: Motion, private readonly seek: (fraction: number) => void) {
    const kinds: Kind[] = motion.duration === null ? ["position"] : ["position", "velocity", "acceleration"];
    for (const kind of kinds) {
      const tab = el("button", { role: "tab", "data-kind": kind }, kind);
      tab.addEventListener("click", () => this.choose(kind));
      this.tabs.append(tab);
    }
    if (kinds.length > 1) this.object.append(this.tabs);
    this.object.append(this.list);
    this.choose("position");
  }

  show(fraction: number): void {
    this.fraction = fraction;
    const moment = this.motion.at(fraction);
    if (!moment) return;
    const values = { position: moment.q, velocity: moment.velocity, acceleration: moment.acceleration }[this.kind] ?? [];
    this.rows.forEach((row, joint) => {
      row.cursor.setAttribute("transform", `translate(${fraction * WIDTH} 0)`);
      const { lower, upper } = this.range(joint);
      const value = values[joint] ?? 0;
      const limit = value < 0 ? lower : upper;
      row.value.textContent = `${value.toFixed(2)}${limit === null ? "" : ` of ${limit.toFixed(2)}`}`;
      row.value.className = limit !== null && value / limit > TIGHT ? "tight" : "";
    });
  }

  private choose(kind: Kind): void {
    this.kind = kind;
    for (const tab of this.tabs.children) tab.setAttribute("aria-selected", String((tab as HTMLElement).dataset.kind === kind));
    this.rows = [];
    this.list.replaceChildren(...this.trace.joints.map((name, joint) => this.row(name, joint)));
    this.show(this.fraction);
  }

  private values(joint: number): number[] {
    return this.trace.waypoints.map((waypoint) => VALUES[this.kind](waypoint)?.[joint] ?? 0);
  }

  private limits(joint: number): [number | null, number | null] {
    const { limits } = this.trace;
    if (!limits) return [null, null];
    if (this.kind === "position") return [limits.lower[joint] ?? null, limits.upper[joint] ?? null];
    const limit = limits[this.kind][joint] ?? null;
    return [limit === null ? null : -limit, limit];
  }

  private range(joint: number): Range {
    const [lower, upper] = this.limits(joint);
    const values = this.values(joint);
    const low = Math.min(...values, lower ?? Infinity);
    const high = Math.max(...values, upper ?? -Infinity);
    const pad = Math.max(0.05, 0.06 * (high - low));
    return { lower, upper, low: low - pad, high: high + pad };
  }

  private row(name: string, joint: number): HTMLElement {
    const { lower, upper, low, high } = this.range(joint);
    const y = (value: number) => HEIGHT * (1 - (value - low) / (high - low));
    const chart = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none" });
    if (lower !== null && upper !== null) {
      chart.append(svg("rect", { x: 0, width: WIDTH, y: y(upper), height: y(lower) - y(upper), class: "allowed" }));
    }
    for (const limit of [lower, upper]) {
      if (limit !== null) chart.append(svg("line", { x1: 0, x2: WIDTH, y1: y(limit), y2: y(limit), class: "limit" }));
    }
    if (low < 0 && high > 0) chart.append(svg("line", { x1: 0, x2: WIDTH, y1: y(0), y2: y(0), class: "zero" }));
    const points = this.values(joint).map((value, i) => `${(this.motion.fractionOf(i) * WIDTH).toFixed(1)},${y(value).toFixed(2)}`);
    const cursor = svg("g", { class: "cursor" }, svg("line", { x1: 0, x2: 0, y1: 0, y2: HEIGHT }));
    chart.append(svg("polyline", { points: points.join(" "), class: "line" }), cursor);
    chart.addEventListener("pointerdown", (event) => {
      const box = chart.getBoundingClientRect();
      this.seek(((event as PointerEvent).clientX - box.left) / box.width);
    });
    const value = el("b", {});
    this.rows[joint] = { cursor, value };
    const figure = el("div", { class: "joint", "data-joint": name }, el("span", {}, name), value);
    figure.append(chart);
    return figure;
  }
}
