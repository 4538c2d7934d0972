// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Shapes of traces as geometry. */
import {
  BoxGeometry, BufferGeometry, CapsuleGeometry, CylinderGeometry, Matrix4, Quaternion, SphereGeometry, Vector3,
} from "three";
import { surfaceOf } from "./packed";
import type { Pose, Shape } from "./trace";

export function poseMatrix(pose: Pose): Matrix4 {
  const position = new Vector3(pose[0], pose[1], pose[2]);
  const turn = new Quaternion(pose[3], pose[4], pose[5], pose[6]);
  return new Matrix4().compose(position, turn, new Vector3(1, 1, 1));
}

export function poseOf(matrix: Matrix4): Pose {
  const [position, turn, scale] = [new Vector3(), new Quaternion(), new Vector3()];
  matrix.decompose(position, turn, scale);
  return [...position.toArray(), ...turn.toArray()];
}

/** True if two poses differ by less than what is seen: a fifth of a millimetre, or of a milliradian. */
export function isSamePose(a: Pose, b: Pose): boolean {
  const sign = a[3]! * b[3]! + a[4]! * b[4]! + a[5]! * b[5]! + a[6]! * b[6]! < 0 ? -1 : 1;
  return a.every((value, i) => Math.abs(value - (i < 3 ? 1 : sign) * b[i]!) < 2e-4);
}

const UP = new Vector3(0, 1, 0);

/** The surface of a solid or a mesh; null for points and cubes. */
export function geometryOf(shape: Shape): BufferGeometry | null {
  switch (shape.type) {
    case "sphere": {
      const [x, y, z, r] = shape.sphere as [number, number, number, number];
      return new SphereGeometry(r, 32, 20).translate(x, y, z);
    }
    case "capsule": {
      const c = shape.capsule;
      const a = new Vector3(c[0], c[1], c[2]);
      const b = new Vector3(c[3], c[4], c[5]);
      const along = b.clone().sub(a);
      const turn = new Quaternion().setFromUnitVectors(UP, along.clone().normalize());
      const middle = a.add(b).multiplyScalar(0.5);
      return new CapsuleGeometry(c[6], along.length(), 12, 32).applyQuaternion(turn).translate(...middle.toArray());
    }
    case "box":
      return new BoxGeometry(...(shape.size as [number, number, number])).applyMatrix4(poseMatrix(shape.pose));
    case "cylinder":
      return new CylinderGeometry(shape.radius, shape.radius, shape.length, 48)
        .rotateX(Math.PI / 2).applyMatrix4(poseMatrix(shape.pose));
    case "mesh":
      return surfaceOf(shape.triangles).applyMatrix4(poseMatrix(shape.pose));
    default:
      return null;
  }
}
