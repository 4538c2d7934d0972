// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Where the robot is at a fraction of the motion: between waypoints poses are interpolated. */
import { Quaternion, Vector3 } from "three";
import type { Pose, Trace, Waypoint } from "./trace";

export interface Moment {
  poses: Pose[];
  tip: Vector3;
  q: number[];
  velocity: number[] | null;
  acceleration: number[] | null;
  /** The nearest waypoint. */
  index: number;
  clearance: number | null;
}

const from = new Quaternion();
const to = new Quaternion();

function between(a: Pose, b: Pose, t: number): Pose {
  const pose = mix(a.slice(0, 3), b, t);
  from.set(a[3]!, a[4]!, a[5]!, a[6]!);
  to.set(b[3]!, b[4]!, b[5]!, b[6]!);
  from.slerp(to, t);
  return [...pose, from.x, from.y, from.z, from.w];
}

function mix(a: number[], b: number[], t: number): number[] {
  return a.map((value, i) => value + t * (b[i]! - value));
}

export class Motion {
  /** L2 joint distance of the whole path. */
  readonly length: number;
  /** Seconds, of a plan with a trajectory; otherwise null, and fractions are of the length. */
  readonly duration: number | null;

  constructor(private readonly trace: Trace) {
    this.length = trace.waypoints.at(-1)?.travelled ?? 0;
    this.duration = trace.duration_s ?? null;
  }

  get isEmpty(): boolean {
    return this.trace.waypoints.length === 0;
  }

  private stop(waypoint: Waypoint): number {
    const [at, whole] = this.duration ? [waypoint.time ?? 0, this.duration] : [waypoint.travelled, this.length];
    return whole > 0 ? at / whole : 0;
  }

  /** The fraction at which waypoint `index` stands. */
  fractionOf(index: number): number {
    return this.stop(this.trace.waypoints[index]!);
  }

  at(fraction: number): Moment | null {
    const waypoints = this.trace.waypoints;
    if (waypoints.length === 0) return null;
    let low = 0;
    let high = waypoints.length - 1;
    while (low + 1 < high) {
      const middle = (low + high) >> 1;
      if (this.fractionOf(middle) <= fraction) low = middle;
      else high = middle;
    }
    const a = waypoints[low]!;
    const b = waypoints[high]!;
    const span = this.stop(b) - this.stop(a);
    const t = span > 0 ? Math.min(1, Math.max(0, (fraction - this.stop(a)) / span)) : 0;
    const clearance = a.clearance !== null && b.clearance !== null ? a.clearance + t * (b.clearance - a.clearance) : null;
    return {
      poses: a.poses.map((pose, i) => between(pose, b.poses[i]!, t)),
      tip: new Vector3(...a.tip).lerp(new Vector3(...b.tip), t),
      q: mix(a.q, b.q, t),
      velocity: a.velocity ? mix(a.velocity, b.velocity!, t) : null,
      acceleration: a.acceleration ?? null,
      index: t < 0.5 ? low : high,
      clearance,
    };
  }
}
