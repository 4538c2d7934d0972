// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** The trace that stands in the page, as docs/schema/trace.schema.json describes it. Metres, radians, seconds. */

/** x, y, z, then a quaternion x, y, z, w. */
export type Pose = number[];

export type Shape =
  | { type: "sphere"; sphere: number[] }
  | { type: "capsule"; capsule: number[] }
  | { type: "box"; pose: Pose; size: number[] }
  | { type: "cylinder"; pose: Pose; radius: number; length: number }
  | { type: "points"; pose: Pose; radius: number; points: Packed }
  | { type: "mesh"; pose: Pose; radius: number; triangles: Packed }
  | { type: "octree"; pose: Pose; radius: number; cubes: Packed };

/** Coordinates in 16 bits, as base64; `count` is how many there are in all. */
export interface Packed {
  count: number;
  low: number[];
  step: number;
  data: string;
  indices?: string;
}

export interface Link {
  name: string;
  spheres: number[][];
  capsules: number[][];
  /** Visual shapes; without them a smooth surface of the checked ones is shown. */
  visual?: (Shape & { color?: string })[];
  /** The link that carries it, of an attached object. */
  carrier?: string;
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
  time?: number;
  velocity?: number[];
  acceleration?: number[];
}

/** Of each joint; null where it has none. */
export interface Limits {
  lower: (number | null)[];
  upper: (number | null)[];
  velocity: (number | null)[];
  acceleration: (number | null)[];
}

/** What touches at the start (`goal` is -1) or at a goal. */
export interface Touch {
  goal: number;
  link: number;
  other: number;
  is_self: boolean;
  distance: number;
  place: number[];
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
  limits?: Limits;
  duration_s?: number;
  links: Link[];
  obstacles: Obstacle[];
  touches?: Touch[];
  start: Pose[];
  goals: Pose[][];
  waypoints: Waypoint[];
  vertices: number[];
  primitives: Primitive[];
  components: { count: number; shown: Arm[] };
  samples: { uniform_draws: number; shown: Arm[] };
  edges: { count: number; shown: { graph: number; tips: number[] }[] };
  /** Another plan of the same problem. */
  beside?: Trace;
  live?: Live;
}

export type Allowed = [string, string] | { pair: [string, string]; at_ends: number };

/** What the page of a service starts with. */
export interface Live {
  start: number[];
  has_memory: boolean;
  /** The scene of the service that holds what requests cannot: points, triangles, cubes; they come last among the obstacles. */
  scene: string | null;
  /** What may touch: a link and an obstacle, or what may at the ends of a path. */
  allow: Allowed[];
  /** What links keep along the whole path, as requests spell it. */
  constraints: object[];
  /** Empty at rest. */
  start_velocity: number[];
  /** Links that goals are for, with those that move with each, in its frame. */
  tips: { link: string; pose: Pose; carries: { link: number; pose: Pose }[] }[];
  /** Links that are only seen, in the frame of the one that carries them; traces of plans lack them. */
  welds: { link: number; to: number; pose: Pose }[];
  /** In a page that plans by itself: the files that its module opens, and the problem's address among them. */
  planner?: { files: { path: string; text: string }[]; problem: string };
}

/** What the distance of a primitive's keys is measured in. */
export function distanceUnit(primitive: Primitive): string {
  return primitive.obstacles.length === 0 ? "rad" : "m";
}

/** Reads the trace of the page; throws if there is none. */
export function readTrace(): Trace {
  const text = document.getElementById("trace")?.textContent ?? "";
  const trace = JSON.parse(text) as Trace;
  if (!Array.isArray(trace.waypoints)) throw new Error("the page contains no trace");
  const { beside } = trace;
  if (beside?.links.length === 0) beside.links = trace.links;
  if (beside?.obstacles.length === 0) beside.obstacles = trace.obstacles;
  return trace;
}

/** "memory" or the sampler's name. */
export function sourceName(trace: Trace): string {
  return trace.plan.sampler === "gl" ? "memory" : trace.plan.sampler;
}

/** Names of a primitive's obstacles; a memory of whole paths has start and goal as its only primitives. */
export function primitiveName(trace: Trace, primitive: Primitive): string {
  if (primitive.obstacles.length === 0) return "start and goal";
  return primitive.obstacles.map((i) => trace.obstacles[i]?.name ?? "?").join(" \u2013 ");
}

/** "forearm_link \u2194 shelf". */
export function touchName(trace: Trace, touch: Touch): string {
  const other = touch.is_self ? trace.links[touch.other]?.name : trace.obstacles[touch.other]?.name;
  return `${trace.links[touch.link]?.name ?? "?"} \u2194 ${other ?? "?"}`;
}
