// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Where the robot is at a fraction of the path: between waypoints poses are interpolated. */
import { Quaternion, Vector3 } from "three";
import type { Pose, Trace } from "./trace";

export interface Moment {
  poses: Pose[];
  tip: Vector3;
  /** The nearest waypoint. */
  index: number;
  clearance: number | null;
}

const from = new Quaternion();
const to = new Quaternion();

function between(a: Pose, b: Pose, t: number): Pose {
  const pose = [0, 1, 2].map((i) => a[i]! + t * (b[i]! - a[i]!));
  from.set(a[3]!, a[4]!, a[5]!, a[6]!);
  to.set(b[3]!, b[4]!, b[5]!, b[6]!);
  from.slerp(to, t);
  return [...pose, from.x, from.y, from.z, from.w];
}

export class Motion {
  /** L2 joint distance of the whole path. */
  readonly length: number;

  constructor(private readonly trace: Trace) {
    this.length = trace.waypoints.at(-1)?.travelled ?? 0;
  }

  get isEmpty(): boolean {
    return this.trace.waypoints.length === 0;
  }

  /** The fraction at which waypoint `index` stands. */
  fractionOf(index: number): number {
    return this.length > 0 ? this.trace.waypoints[index]!.travelled / this.length : 0;
  }

  at(fraction: number): Moment | null {
    const waypoints = this.trace.waypoints;
    if (waypoints.length === 0) return null;
    const travelled = fraction * this.length;
    let low = 0;
    let high = waypoints.length - 1;
    while (low + 1 < high) {
      const middle = (low + high) >> 1;
      if (waypoints[middle]!.travelled <= travelled) low = middle;
      else high = middle;
    }
    const a = waypoints[low]!;
    const b = waypoints[high]!;
    const span = b.travelled - a.travelled;
    const t = span > 0 ? Math.min(1, Math.max(0, (travelled - a.travelled) / span)) : 0;
    const clearance =
      a.clearance === null || b.clearance === null ? null : a.clearance + t * (b.clearance - a.clearance);
    return {
      poses: a.poses.map((pose, i) => between(pose, b.poses[i]!, t)),
      tip: new Vector3(...(a.tip as [number, number, number])).lerp(
        new Vector3(...(b.tip as [number, number, number])), t),
      index: t < 0.5 ? low : high,
      clearance,
    };
  }
}
