// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Frames around the primitives that memory was asked about, and where their labels go. */
import { Box3, Group, Object3D, Vector3 } from "three";
import { repeated, Strokes } from "./materials";
import type { SceneView } from "./scene_view";
import { originColor } from "./theme";
import { distanceUnit, type Primitive, type Trace } from "./trace";

export interface Frame {
  index: number;
  label: string;
  anchor: Vector3;
}

/** Metres between keys, the root of the similarity error. */
export function nearestDistance(primitive: Primitive): number | null {
  const error = primitive.similarity_errors[0];
  return error === undefined ? null : Math.sqrt(error);
}

/** Circles of a planar primitive as x, y, radius; null if it is not made of two spheres. */
function circlesOf(trace: Trace, primitive: Primitive): number[][] | null {
  const circles = primitive.obstacles.map((i) => {
    const shape = trace.obstacles[i]?.shapes[0];
    return shape?.type === "sphere" ? [shape.sphere[0]!, shape.sphere[1]!, shape.sphere[3]!] : null;
  });
  return circles.length === 2 && circles.every((c) => c !== null) ? (circles as number[][]) : null;
}

/** The rectangle around two circles, along the line of their centres. */
function rectangle(circles: number[][], margin: number): Vector3[] {
  const [[ax, ay, ar], [bx, by, br]] = circles as [[number, number, number], [number, number, number]];
  const length = Math.hypot(bx - ax, by - ay) || 1;
  const u = new Vector3((bx - ax) / length, (by - ay) / length, 0);
  const v = new Vector3(-u.y, u.x, 0);
  const half = Math.max(ar, br) + margin;
  const first = new Vector3(ax, ay, 0).addScaledVector(u, -ar - margin);
  const last = new Vector3(bx, by, 0).addScaledVector(u, br + margin);
  return [
    first.clone().addScaledVector(v, -half), last.clone().addScaledVector(v, -half),
    last.clone().addScaledVector(v, half), first.clone().addScaledVector(v, half),
  ];
}

function dashes(points: number[], color: string): Object3D {
  const strokes = new Strokes(1.7, 8, { dash: 6 });
  strokes.set(points, repeated(color, points.length / 6));
  return strokes.object;
}

function loop(corners: Vector3[]): number[] {
  return corners.flatMap((corner, i) => [...corner.toArray(), ...corners[(i + 1) % corners.length]!.toArray()]);
}

function boxEdges(box: Box3): number[] {
  const { min, max } = box;
  const corner = (i: number) => [i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z];
  const points: number[] = [];
  for (let i = 0; i < 8; ++i)
    for (const bit of [1, 2, 4]) if (!(i & bit)) points.push(...corner(i), ...corner(i | bit));
  return points;
}

export interface MemoryView {
  object: Group;
  frames: Frame[];
  /** Colours of the obstacles in the frames shown. */
  tints: Map<number, string>;
}

/** In space at most this many frames are shown at once: more hide the scene. */
const MOST_FRAMES_IN_SPACE = 3;

/** All primitives in the plane; in space the most similar ones; only the chosen one if there is one. */
function shownPrimitives(trace: Trace, chosen: number | null): number[] {
  const all = trace.primitives.map((_, i) => i);
  if (chosen !== null) return [chosen];
  if (trace.is_planar) return all;
  return all
    .filter((i) => trace.primitives[i]!.similarity_errors.length > 0)
    .sort((a, b) => nearestDistance(trace.primitives[a]!)! - nearestDistance(trace.primitives[b]!)!)
    .slice(0, MOST_FRAMES_IN_SPACE);
}

function labelOf(primitive: Primitive): string {
  const distance = nearestDistance(primitive);
  if (distance === null) return "no match";
  return primitive.is_learned ? "learned now" : `${distance.toFixed(2)} ${distanceUnit(primitive)}`;
}

export function makeMemory(trace: Trace, scene: SceneView, chosen: number | null): MemoryView {
  const view: MemoryView = { object: new Group(), frames: [], tints: new Map() };
  for (const index of shownPrimitives(trace, chosen)) {
    const primitive = trace.primitives[index]!;
    if (primitive.obstacles.length === 0) continue;
    const color = originColor(index);
    const circles = trace.is_planar ? circlesOf(trace, primitive) : null;
    if (circles) {
      const corners = rectangle(circles, 0.12);
      view.object.add(dashes(loop(corners), color));
      const top = corners.reduce((a, b) => (b.y > a.y ? b : a));
      view.frames.push({ index, label: labelOf(primitive), anchor: top });
    } else {
      const box = new Box3();
      for (const i of primitive.obstacles) box.union(scene.bounds(i));
      view.object.add(dashes(boxEdges(box.expandByScalar(0.015)), color));
      view.frames.push({ index, label: labelOf(primitive), anchor: box.getCenter(new Vector3()).setZ(box.max.z) });
    }
    const isTinted = !trace.is_planar || chosen !== null;
    for (const i of primitive.obstacles) if (isTinted && !view.tints.has(i)) view.tints.set(i, color);
  }
  return view;
}
