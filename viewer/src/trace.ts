// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** The trace that stands in the page, as docs/schema/trace.schema.json describes it. Metres, radians, seconds. */

/** x, y, z, then a quaternion x, y, z, w. */
export type Pose = number[];

export type Shape =
  | { type: "sphere"; sphere: number[] }
  | { type: "capsule"; capsule: number[] }
  | { type: "box"; pose: Pose; size: number[] }
  | { type: "cylinder"; pose: Pose; radius: number; length: number };

export interface Link {
  name: string;
  spheres: number[][];
  capsules: number[][];
}

export interface Obstacle {
  name: string;
  shapes: Shape[];
}

export interface Waypoint {
  q: number[];
  travelled: number;
  clearance: number | null;
  nearest: [number, number];
  tip: number[];
  poses: Pose[];
}

export interface Primitive {
  obstacles: number[];
  gap: number | null;
  similarity_errors: number[];
  is_learned: boolean;
  components: number;
  draws: number;
}

/** A configuration as points x, y, z of its joints and its tip. */
export interface Arm {
  origin: number;
  points: number[];
}

export interface Trace {
  problem: string;
  robot: string;
  generator?: string;
  is_planar: boolean;
  joints: string[];
  plan: {
    status: string;
    solved: boolean;
    message: string;
    planner: string;
    sampler: string;
    seed: number;
    isa: string;
    path_length: number;
    iterations: number;
    states_checked: number;
    motions_checked: number;
    nodes: number;
  };
  times: Record<string, number>;
  links: Link[];
  obstacles: Obstacle[];
  start: Pose[];
  goals: Pose[][];
  waypoints: Waypoint[];
  vertices: number[];
  primitives: Primitive[];
  components: { count: number; shown: Arm[] };
  samples: { uniform_draws: number; shown: Arm[] };
  edges: { count: number; shown: { graph: number; tips: number[] }[] };
}

/** What the distance of a primitive's keys is measured in. */
export function distanceUnit(primitive: Primitive): string {
  return primitive.obstacles.length === 0 ? "rad" : "m";
}

/** Reads the trace of the page; throws if there is none. */
export function readTrace(): Trace {
  const text = document.getElementById("trace")?.textContent ?? "";
  const trace = JSON.parse(text) as Trace;
  if (!Array.isArray(trace.waypoints)) throw new Error("the page holds no trace");
  return trace;
}

/** Names of a primitive's obstacles; a memory of whole paths has start and goal as its only primitives. */
export function primitiveName(trace: Trace, primitive: Primitive): string {
  if (primitive.obstacles.length === 0) return "start and goal";
  return primitive.obstacles.map((i) => trace.obstacles[i]?.name ?? "?").join(" \u2013 ");
}
