// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Robots as they look, or as the spheres and capsules that are checked. */
import {
  BufferGeometry, CylinderGeometry, DoubleSide, Float32BufferAttribute, Group, Material, Matrix4, Mesh, Quaternion,
  SphereGeometry, Vector3,
} from "three";
import { clay, flat } from "./materials";
import { geometryOf, isSamePose, poseMatrix } from "./shapes";
import type { Link, Pose } from "./trace";

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

function coverGeometry(link: Link, units: Units): BufferGeometry {
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

/** What panes show of a robot, solid or flat. */
export interface RobotView {
  readonly object: Group;
  setPoses(poses: Pose[]): void;
  /** Hides links that stand where they do in one of `others`, which is shown, too: two at one place flicker. */
  hideWhere(...others: Pose[][]): void;
}

/** A piece of a link's surface, in the link's frame. */
export interface Piece {
  link: number;
  geometry: BufferGeometry;
  /** Of a piece that has one of its own. */
  color: string | null;
}

export type Skin = "looks" | "covers";

/** The links' geometry, which robots and ghosts share. */
export class RobotShape {
  readonly covers: { fine: Piece[]; coarse: Piece[]; shadow: Piece[] };
  private readonly looks: Piece[];
  /** True if there is more to see than what is checked. */
  readonly hasLooks: boolean;

  constructor(readonly links: Link[]) {
    const cover = (units: Units): Piece[] =>
      links.map((link, i) => ({ link: i, geometry: coverGeometry(link, units), color: null }));
    this.covers = { fine: cover(FINE), coarse: cover(COARSE), shadow: cover(SHADOW) };
    this.looks = links.flatMap((link, i) =>
      (link.visual ?? []).flatMap((shape) => {
        const geometry = geometryOf(shape);
        return geometry ? [{ link: i, geometry, color: shape.color ?? null }] : [];
      }));
    this.hasLooks = this.looks.length > 0;
  }

  /** Links without looks are seen as they are checked. */
  pieces(skin: Skin, detail: "fine" | "coarse" | "shadow"): Piece[] {
    const covers = this.covers[detail];
    if (skin === "covers" || !this.hasLooks) return covers;
    const seen = new Set(this.looks.map((piece) => piece.link));
    return [...this.looks, ...covers.filter((piece) => !seen.has(piece.link))];
  }

  isCarried(link: number): boolean {
    return this.links[link]!.carrier !== undefined;
  }
}

/** Where ghost and robot share a surface, the robot is seen. */
const BEHIND = { polygonOffset: true, polygonOffsetFactor: 4, polygonOffsetUnits: 16 };

export interface SolidStyle {
  color: string;
  /** Of attached objects. */
  carriedColor: string;
  /** Below one it is a ghost, of which only the nearest surface is seen. */
  opacity: number;
  skin: Skin;
  shade: Material | null;
}

export class SolidRobot implements RobotView {
  readonly object = new Group();
  private readonly meshes: Mesh[][] = [];
  private poses: Pose[] = [];

  /** Only links of `chosen` if that is given. */
  constructor(shape: RobotShape, style: SolidStyle, private readonly chosen?: Set<number>) {
    const { color, opacity, skin } = style;
    if (opacity < 1) {
      const mask = Object.assign(flat(color), { colorWrite: false, transparent: true, side: DoubleSide }, BEHIND);
      const clothes = Object.assign(clay(color, opacity), { side: DoubleSide }, BEHIND);
      // Ghosts come after all that is solid, and hide nothing of it.
      for (const piece of shape.pieces(skin, "coarse")) {
        this.add(piece, mask, 10);
        this.add(piece, clothes, 11);
      }
    } else {
      const materials = new Map<string, Material>();
      for (const piece of shape.pieces(skin, "fine")) {
        const own = skin === "looks" ? piece.color : null;
        const tone = shape.isCarried(piece.link) ? style.carriedColor : own ?? color;
        if (!materials.has(tone)) materials.set(tone, Object.assign(clay(tone), { side: DoubleSide }));
        this.add(piece, materials.get(tone)!, 0);
      }
    }
    if (style.shade) for (const piece of shape.pieces(skin, "shadow")) this.add(piece, style.shade, -1);
  }

  setPoses(poses: Pose[]): void {
    this.poses = poses;
    poses.forEach((pose, link) => {
      const matrix = poseMatrix(pose);
      for (const mesh of this.meshes[link] ?? []) {
        mesh.matrix.copy(matrix);
        mesh.matrixWorldNeedsUpdate = true;
      }
    });
  }

  hideWhere(...others: Pose[][]): void {
    this.poses.forEach((pose, link) => {
      const isHidden = others.some((poses) => isSamePose(pose, poses[link]!));
      for (const mesh of this.meshes[link] ?? []) mesh.visible = !isHidden;
    });
  }

  private add({ link, geometry }: Piece, material: Material, order: number): void {
    if (this.chosen && !this.chosen.has(link)) return;
    const mesh = new Mesh(geometry, material);
    mesh.matrixAutoUpdate = false;
    mesh.frustumCulled = false;
    mesh.renderOrder = order;
    mesh.userData.link = link;
    (this.meshes[link] ??= []).push(mesh);
    this.object.add(mesh);
  }
}
