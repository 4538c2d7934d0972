// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Robots as the solids that are checked: spheres and capsules. */
import {
  BufferGeometry, CylinderGeometry, Float32BufferAttribute, Group, Material, Matrix4, Mesh, Quaternion, SphereGeometry,
  Vector3,
} from "three";
import { clay, flat } from "./materials";
import type { Link, Pose } from "./trace";

export function poseMatrix(pose: Pose): Matrix4 {
  const position = new Vector3(pose[0], pose[1], pose[2]);
  const turn = new Quaternion(pose[3], pose[4], pose[5], pose[6]);
  return new Matrix4().compose(position, turn, new Vector3(1, 1, 1));
}

const UP = new Vector3(0, 1, 0);

/** Units that are scaled: a ball of radius one, and a tube about y that is one metre long. */
interface Units {
  ball: BufferGeometry;
  tube: BufferGeometry;
}
function makeUnits(around: number, along: number): Units {
  return { ball: new SphereGeometry(1, around, along), tube: new CylinderGeometry(1, 1, 1, around, 1, true) };
}
const FINE = makeUnits(16, 10);
/** Ghosts are seen through, and drawn twice. */
const COARSE = makeUnits(11, 7);
const SHADOW = makeUnits(8, 5);

/** Collects solids into one geometry: a drawing call for each would take far longer than all triangles. */
class Merger {
  private readonly positions: number[] = [];
  private readonly normals: number[] = [];
  private readonly indices: number[] = [];

  /** Adds `unit`, which `matrix` scales, turns and moves. */
  add(unit: BufferGeometry, matrix: Matrix4): void {
    const first = this.positions.length / 3;
    const part = unit.clone().applyMatrix4(matrix);
    for (const value of part.getAttribute("position").array) this.positions.push(value);
    for (const value of part.getAttribute("normal").array) this.normals.push(value);
    for (const index of part.getIndex()!.array) this.indices.push(first + index);
  }

  geometry(): BufferGeometry {
    const merged = new BufferGeometry();
    merged.setAttribute("position", new Float32BufferAttribute(this.positions, 3));
    merged.setAttribute("normal", new Float32BufferAttribute(this.normals, 3));
    merged.setIndex(this.indices);
    return merged;
  }
}

function linkGeometry(link: Link, units: Units): BufferGeometry {
  const merger = new Merger();
  const addBall = (x: number, y: number, z: number, radius: number) =>
    merger.add(units.ball, new Matrix4().makeScale(radius, radius, radius).setPosition(x, y, z));
  for (const [x, y, z, r] of link.spheres) addBall(x!, y!, z!, r!);
  for (const c of link.capsules) {
    const a = new Vector3(c[0], c[1], c[2]);
    const b = new Vector3(c[3], c[4], c[5]);
    const radius = c[6]!;
    for (const end of [a, b]) addBall(end.x, end.y, end.z, radius);
    const along = b.clone().sub(a);
    if (along.length() < 1e-6) continue;
    const turn = new Quaternion().setFromUnitVectors(UP, along.clone().normalize());
    merger.add(units.tube,
      new Matrix4().compose(a.add(b).multiplyScalar(0.5), turn, new Vector3(radius, along.length(), radius)));
  }
  return merger.geometry();
}

/** What stages show of a robot, solid or flat. */
export interface RobotView {
  readonly object: Group;
  setPoses(poses: Pose[]): void;
}

/** The links' geometry, which robot and ghosts share. */
export class RobotShape {
  readonly fine: BufferGeometry[];
  readonly coarse: BufferGeometry[];
  readonly shadow: BufferGeometry[];

  /** Ghosts have only links that are `moving`: the others are where the robot has them. */
  constructor(links: Link[], readonly moving: boolean[]) {
    this.fine = links.map((link) => linkGeometry(link, FINE));
    this.coarse = links.map((link) => linkGeometry(link, COARSE));
    this.shadow = links.map((link) => linkGeometry(link, SHADOW));
  }
}

/** Where ghost and robot share a surface, the robot is seen: a lift that moved shows no stripes. */
const BEHIND = { polygonOffset: true, polygonOffsetFactor: 4, polygonOffsetUnits: 16 };

export class SolidRobot implements RobotView {
  readonly object = new Group();
  private readonly meshes: Mesh[][] = [];

  /** With an `opacity` below one it is a ghost, of which only the nearest surface is seen. */
  constructor(shape: RobotShape, color: string, opacity = 1, shade: Material | null = null) {
    // Ghosts come after all that is solid, and hide nothing of it.
    if (opacity < 1) {
      const mask = flat(color);
      Object.assign(mask, { colorWrite: false, transparent: true }, BEHIND);
      this.add(shape.coarse, mask, 10, shape.moving);
      this.add(shape.coarse, Object.assign(clay(color, opacity), BEHIND), 11, shape.moving);
    } else {
      this.add(shape.fine, clay(color), 0);
    }
    if (shade) this.add(shape.shadow, shade, -1);
  }

  setPoses(poses: Pose[]): void {
    poses.forEach((pose, link) => {
      const matrix = poseMatrix(pose);
      for (const mesh of this.meshes[link] ?? []) {
        mesh.matrix.copy(matrix);
        mesh.matrixWorldNeedsUpdate = true;
      }
    });
  }

  private add(geometries: BufferGeometry[], material: Material, order: number, isShown?: boolean[]): void {
    geometries.forEach((geometry, link) => {
      if (isShown && !isShown[link]) return;
      const mesh = new Mesh(geometry, material);
      mesh.matrixAutoUpdate = false;
      mesh.frustumCulled = false;
      mesh.renderOrder = order;
      (this.meshes[link] ??= []).push(mesh);
      this.object.add(mesh);
    });
  }
}
