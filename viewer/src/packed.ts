// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Points, triangles and cubes out of the text that a trace holds of them. */
import { BufferGeometry, Float32BufferAttribute, Vector3 } from "three";
import type { Packed } from "./trace";

/** Corners between faces that meet at less than this are round. */
const CREASE = Math.cos((38 * Math.PI) / 180);

function bytesOf(text: string): ArrayBuffer {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes.buffer;
}

/** Numbers in groups of `size`: x, y, z, then lengths. */
export function unpack(packed: Packed, size: 3 | 4): Float32Array {
  const view = new DataView(bytesOf(packed.data));
  const values = new Float32Array(view.byteLength / 2);
  for (let i = 0; i < values.length; ++i) {
    const axis = i % size;
    values[i] = (axis < 3 ? packed.low[axis]! : 0) + packed.step * view.getUint16(2 * i, true);
  }
  return values;
}

function unpackIndices(text: string): Uint32Array {
  const view = new DataView(bytesOf(text));
  return Uint32Array.from({ length: view.byteLength / 4 }, (_, i) => view.getUint32(4 * i, true));
}

/** Per corner of each triangle the mean normal of the faces around it that lie smoothly to its own. */
function creasedNormals(points: Float32Array, indices: Uint32Array): Float32Array {
  const faceCount = indices.length / 3;
  const faces = new Float32Array(3 * faceCount);
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  const first = new Uint32Array(points.length / 3 + 1);
  for (let f = 0; f < faceCount; ++f) {
    const corners = [a, b, c].map((v, k) => v.fromArray(points, 3 * indices[3 * f + k]!));
    corners[1]!.sub(corners[0]!).cross(corners[2]!.sub(corners[0]!)).normalize().toArray(faces, 3 * f);
    for (let k = 0; k < 3; ++k) ++first[indices[3 * f + k]! + 1]!;
  }
  for (let i = 1; i < first.length; ++i) first[i]! += first[i - 1]!;
  const around = new Uint32Array(indices.length);
  const next = first.slice();
  for (let i = 0; i < indices.length; ++i) around[next[indices[i]!]!++] = Math.floor(i / 3);

  const normals = new Float32Array(3 * indices.length);
  for (let i = 0; i < indices.length; ++i) {
    const own = 3 * Math.floor(i / 3);
    let [x, y, z] = [0, 0, 0];
    for (let k = first[indices[i]!]!; k < first[indices[i]! + 1]!; ++k) {
      const other = 3 * around[k]!;
      const dot = faces[own]! * faces[other]! + faces[own + 1]! * faces[other + 1]! + faces[own + 2]! * faces[other + 2]!;
      if (dot < CREASE) continue;
      x += faces[other]!;
      y += faces[other + 1]!;
      z += faces[other + 2]!;
    }
    const length = Math.hypot(x, y, z) || 1;
    normals.set([x / length, y / length, z / length], 3 * i);
  }
  return normals;
}

/** Triangles with normals, sharp where the surface is. */
export function surfaceOf(packed: Packed): BufferGeometry {
  const points = unpack(packed, 3);
  const indices = unpackIndices(packed.indices ?? "");
  const positions = new Float32Array(3 * indices.length);
  for (let i = 0; i < indices.length; ++i) {
    for (let k = 0; k < 3; ++k) positions[3 * i + k] = points[3 * indices[i]! + k]!;
  }
  return new BufferGeometry()
    .setAttribute("position", new Float32BufferAttribute(positions, 3))
    .setAttribute("normal", new Float32BufferAttribute(creasedNormals(points, indices), 3));
}
