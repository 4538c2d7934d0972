// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** A smooth surface close to a union of spheres and capsules, for robots without visual meshes. */
import { Box3, BufferGeometry, Float32BufferAttribute, Vector3 } from "three";

/** All points within `radius` of the segment from `a` to `b`; a sphere if both are the same. */
export interface Solid {
  a: Vector3;
  b: Vector3;
  radius: number;
}

/** Voxels along the longest side of a link. */
const VOXELS = 28;
const SMALLEST_VOXEL = 0.002;
/** Voxels by which the field is known beyond the surface, on either side. */
const BAND = 4;
/** Passes of a blur over three voxels: they fill the valleys between spheres. */
const PASSES = 2;
const MARGIN = BAND + 1;

/** Distances to a surface, negative inside, at the corners of cubic cells. */
class Field {
  readonly counts: [number, number, number];
  readonly voxel: number;
  private readonly origin: Vector3;
  private values: Float32Array;

  constructor(solids: Solid[]) {
    const box = new Box3();
    for (const { a, b, radius } of solids) {
      for (const end of [a, b]) box.expandByPoint(end.clone().addScalar(radius)).expandByPoint(end.clone().subScalar(radius));
    }
    const size = box.getSize(new Vector3());
    this.voxel = Math.max(SMALLEST_VOXEL, Math.max(size.x, size.y, size.z) / VOXELS);
    this.origin = box.min.clone().subScalar(MARGIN * this.voxel);
    this.counts = size.toArray().map((extent) => Math.ceil(extent / this.voxel) + 2 * MARGIN + 1) as [number, number, number];
    this.values = new Float32Array(this.counts[0] * this.counts[1] * this.counts[2]).fill(BAND * this.voxel);
    for (const solid of solids) this.add(solid);
    for (let pass = 0; pass < PASSES; ++pass) for (const step of this.steps) this.blur(step);
  }

  /** Distances in the list between neighbours along x, y and z. */
  get steps(): [number, number, number] {
    return [1, this.counts[0], this.counts[0] * this.counts[1]];
  }
  at(index: number): number {
    return this.values[index]!;
  }
  point(x: number, y: number, z: number): Vector3 {
    return new Vector3(x, y, z).multiplyScalar(this.voxel).add(this.origin);
  }

  private add({ a, b, radius }: Solid): void {
    const band = BAND * this.voxel;
    const reach = radius + band;
    const low = a.clone().min(b).subScalar(reach).sub(this.origin).divideScalar(this.voxel).ceil();
    const high = a.clone().max(b).addScalar(reach).sub(this.origin).divideScalar(this.voxel).floor();
    const along = b.clone().sub(a);
    const span = along.lengthSq();
    const [, row, layer] = this.steps;
    for (let z = low.z; z <= high.z; ++z) {
      for (let y = low.y; y <= high.y; ++y) {
        for (let x = low.x; x <= high.x; ++x) {
          const from = this.point(x, y, z).sub(a);
          const t = span > 0 ? Math.min(1, Math.max(0, from.dot(along) / span)) : 0;
          const distance = Math.max(-band, from.addScaledVector(along, -t).length() - radius);
          const index = x + y * row + z * layer;
          if (distance < this.values[index]!) this.values[index] = distance;
        }
      }
    }
  }

  private blur(step: number): void {
    const { values } = this;
    const blurred = values.slice();
    for (let i = step; i < values.length - step; ++i) blurred[i] = (values[i - step]! + values[i]! + values[i + step]!) / 3;
    this.values = blurred;
  }
}

/** The zero level of a field by surface nets: a vertex in each cell that it passes, joined across edges (Gibson 1998). */
export function smoothGeometry(solids: Solid[]): BufferGeometry {
  const field = new Field(solids);
  const [nx, ny, nz] = field.counts;
  const [stepX, stepY, stepZ] = field.steps;
  const corners = Array.from({ length: 8 }, (_, c) => ({
    x: c & 1, y: (c >> 1) & 1, z: c >> 2, offset: (c & 1) * stepX + ((c >> 1) & 1) * stepY + (c >> 2) * stepZ,
  }));
  const edges = corners.flatMap((_, c) => [1, 2, 4].filter((bit) => !(c & bit)).map((bit) => [c, c | bit] as const));
  const vertices = new Map<number, number>();
  const positions: number[] = [];
  const indices: number[] = [];

  const addVertex = (x: number, y: number, z: number, index: number): void => {
    const sum = new Vector3();
    let count = 0;
    for (const [from, to] of edges) {
      const [p, q] = [corners[from]!, corners[to]!];
      const [u, v] = [field.at(index + p.offset), field.at(index + q.offset)];
      if (u < 0 === v < 0) continue;
      const t = u / (u - v);
      sum.add(new Vector3(p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.z + t * (q.z - p.z)));
      ++count;
    }
    if (count === 0) return;
    vertices.set(index, positions.length / 3);
    positions.push(...field.point(x, y, z).addScaledVector(sum, field.voxel / count).toArray());
  };
  for (let z = 0; z < nz - 1; ++z) {
    for (let y = 0; y < ny - 1; ++y) {
      for (let x = 0; x < nx - 1; ++x) addVertex(x, y, z, x + y * stepY + z * stepZ);
    }
  }
  for (const [index] of vertices) {
    for (const [step, u, v] of [[stepX, stepY, stepZ], [stepY, stepZ, stepX], [stepZ, stepX, stepY]] as const) {
      const isInside = field.at(index) < 0;
      if (isInside === field.at(index + step) < 0) continue;
      const quad = [index, index - u, index - u - v, index - v].map((cell) => vertices.get(cell)!);
      const [a, b, c, d] = (isInside ? quad : quad.reverse()) as [number, number, number, number];
      indices.push(a, b, c, a, c, d);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
  geometry.setIndex(indices);
  geometry.computeVertexNormals();
  return geometry;
}
