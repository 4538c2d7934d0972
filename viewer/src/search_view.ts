// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Samples and trees of the planner, components of memory, and the end-effector path. */
import { Color, Group, Object3D } from "three";
import { dots, hairLines, repeated, Strokes } from "./materials";
import { originColor, palette, pathColor } from "./theme";
import type { Arm, Trace } from "./trace";

function pointPairs(points: number[]): number[] {
  const pairs: number[] = [];
  for (let i = 0; i + 5 < points.length; i += 3) pairs.push(...points.slice(i, i + 6));
  return pairs;
}

/** The edges of trees or roadmap, in the colour of the end that they grew from. */
export function makeTrees(trace: Trace): Object3D {
  const positions: number[] = [];
  const colors: number[] = [];
  const sides = palette().trees;
  for (const edge of trace.edges.shown) {
    const pairs = pointPairs(edge.tips);
    positions.push(...pairs);
    colors.push(...repeated(sides[edge.graph] ?? sides[0], pairs.length / 3));
  }
  return hairLines(positions, colors, trace.is_planar ? 0.28 : 0.4, 4);
}

/** True if `arm` is of the chosen primitive, or if none is chosen. */
function isChosen(arm: Arm, chosen: number | null): boolean {
  return chosen === null || arm.origin === chosen;
}

/** The retrieved means as faint arms. */
export function makeComponents(trace: Trace, chosen: number | null): Object3D {
  const positions: number[] = [];
  const colors: number[] = [];
  for (const arm of trace.components.shown) {
    if (!isChosen(arm, chosen)) continue;
    const pairs = pointPairs(arm.points);
    positions.push(...pairs);
    colors.push(...repeated(originColor(arm.origin), pairs.length / 3));
  }
  return hairLines(positions, colors, chosen === null ? 0.32 : 0.6, 5);
}

/** The end effector at the samples. */
export function makeSamples(trace: Trace, chosen: number | null): Object3D {
  const positions: number[] = [];
  const colors: number[] = [];
  for (const sample of trace.samples.shown) {
    if (!isChosen(sample, chosen)) continue;
    positions.push(...sample.points.slice(-3));
    colors.push(...new Color(originColor(sample.origin)).toArray());
  }
  return dots(positions, colors, 5, 0.6, 6);
}

/** The end-effector path, from blue to red. */
export function makeTipTrace(trace: Trace): Object3D {
  const group = new Group();
  if (trace.waypoints.length < 2) return group;
  const points = trace.waypoints.flatMap(({ tip }) => [tip[0]!, tip[1]!, trace.is_planar ? 0 : tip[2]!]);
  const count = trace.waypoints.length - 1;
  const colors = Array.from({ length: count }, (_, i) => pathColor(i / count).toArray()).flat();
  const strokes = new Strokes(3.2, trace.is_planar ? 20 : 7, { depthTest: !trace.is_planar });
  strokes.set(pointPairs(points), colors);
  group.add(strokes.object);
  return group;
}
