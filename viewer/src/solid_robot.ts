// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Robots with their visual shapes, or with the spheres and capsules that are checked. */
import {
  BufferGeometry, CylinderGeometry, DoubleSide, Float32BufferAttribute, Group, Material, Matrix4, Mesh, Quaternion,
  SphereGeometry, Vector3,
} from "three";
import { clay, flat } from "./materials";
import { geometryOf, isSamePose, poseMatrix } from "./shapes";
import { smoothGeometry, type Solid } from "./smooth";
import type { Link, Pose } from "./trace";

const UP = new Vector3(0, 1, 0);

/** Units that are scaled: a ball of radius one, and a tube about y that is one metre long. */
interface Units {
  ball: BufferGeometry;
  tube: BufferGeometry;
  /** The radius of a ball within the flat faces of both. */
  inner: number;
}
function makeUnits(around: number, along: number): Units {
  return {
    ball: new SphereGeometry(1, around, along), tube: new CylinderGeometry(1, 1, 1, around, 1, true),
    inner: Math.cos(Math.PI / around) * Math.cos(Math.PI / (2 * along)),
  };
}
const FINE = makeUnits(16, 10);
/** Ghosts are seen through, and drawn twice. */
const COARSE = makeUnits(11, 7);
const SHADOW = makeUnits(8, 5);

function solidsOf(link: Link): Solid[] {
  const balls = link.spheres.map((s) => ({ a: new Vector3().fromArray(s), b: new Vector3().fromArray(s), radius: s[3]! }));
  const capsules = link.capsules.map((c) =>
    ({ a: new Vector3().fromArray(c), b: new Vector3().fromArray(c, 3), radius: c[6]! }));
  return [...balls, ...capsules];
}

function contains({ a, b, radius }: Solid, point: Vector3): boolean {
  const [x, y, z] = [b.x - a.x, b.y - a.y, b.z - a.z];
  const [u, v, w] = [point.x - a.x, point.y - a.y, point.z - a.z];
  const span = x * x + y * y + z * z;
  const t = span > 0 ? Math.min(1, Math.max(0, (u * x + v * y + w * z) / span)) : 0;
  return (u - t * x) ** 2 + (v - t * y) ** 2 + (w - t * z) ** 2 < radius * radius;
}

/** Collects solids into one geometry: a drawing call for each would take far longer than all triangles. */
class Merger {
  private readonly positions: number[] = [];
  private readonly normals: number[] = [];
  private readonly indices: number[] = [];

  /** Adds `unit`, which `matrix` scales, turns and moves, without the triangles that lie within one of `hiding`. */
  add(unit: BufferGeometry, matrix: Matrix4, hiding: Solid[]): void {
    const part = unit.clone().applyMatrix4(matrix);
    const [position, normal] = [part.getAttribute("position"), part.getAttribute("normal")];
    const hidden = Array.from({ length: position.count }, (_, i) => {
      const corner = new Vector3().fromBufferAttribute(position, i);
      return new Set(hiding.filter((solid) => contains(solid, corner)));
    });
    const places = new Map<number, number>();
    const place = (corner: number): number => {
      if (!places.has(corner)) {
        places.set(corner, this.positions.length / 3);
        this.positions.push(position.getX(corner), position.getY(corner), position.getZ(corner));
        this.normals.push(normal.getX(corner), normal.getY(corner), normal.getZ(corner));
      }
      return places.get(corner)!;
    };
    const { array } = part.getIndex()!;
    for (let i = 0; i < array.length; i += 3) {
      const [a, b, c] = [array[i]!, array[i + 1]!, array[i + 2]!];
      // Solids are convex: one that holds the corners holds what is between them.
      if ([...hidden[a]!].some((solid) => hidden[b]!.has(solid) && hidden[c]!.has(solid))) continue;
      this.indices.push(place(a), place(b), place(c));
    }
  }

  geometry(): BufferGeometry {
    const merged = new BufferGeometry();
    merged.setAttribute("position", new Float32BufferAttribute(this.positions, 3));
    merged.setAttribute("normal", new Float32BufferAttribute(this.normals, 3));
    merged.setIndex(this.indices);
    return merged;
  }
}

/** The surface of all solids together: most of what each has lies within others. */
function coverGeometry(link: Link, units: Units): BufferGeometry {
  const merger = new Merger();
  const solids = solidsOf(link);
  const hiders = solids.map((solid) => ({ ...solid, radius: units.inner * solid.radius }));
  solids.forEach(({ a, b, radius }, i) => {
    const middle = a.clone().lerp(b, 0.5);
    const reach = radius + a.distanceTo(b) / 2;
    const hiding = hiders.filter((other, k) => k !== i && contains({ ...other, radius: other.radius + reach }, middle));
    const along = b.clone().sub(a);
    const length = along.length();
    const ends = length < 1e-6 ? [a] : [a, b];
    for (const end of ends) merger.add(units.ball, new Matrix4().makeScale(radius, radius, radius).setPosition(end), hiding);
    if (ends.length < 2) return;
    const turn = new Quaternion().setFromUnitVectors(UP, along.normalize());
    merger.add(units.tube, new Matrix4().compose(middle, turn, new Vector3(radius, length, radius)), hiding);
  });
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

type Detail = "fine" | "coarse" | "shadow";
const UNITS: Record<Detail, Units> = { fine: FINE, coarse: COARSE, shadow: SHADOW };

/** More spheres and capsules than this without a visual mesh are shown as one smooth surface. */
const MOST_PLAIN = 2;

/** The visual shapes of a link; a smooth surface in the place of many spheres. */
function looksOf(link: Link, index: number): Piece[] {
  const visual = link.visual ?? [];
  const isPlain = visual.every(({ type }) => type === "sphere" || type === "capsule");
  const solids = solidsOf(link);
  if (isPlain && solids.length > MOST_PLAIN) return [{ link: index, geometry: smoothGeometry(solids), color: visual[0]?.color ?? null }];
  const shapes: NonNullable<Link["visual"]> = visual.length > 0 ? visual : [
    ...link.spheres.map((sphere) => ({ type: "sphere" as const, sphere })),
    ...link.capsules.map((capsule) => ({ type: "capsule" as const, capsule })),
  ];
  return shapes.flatMap((shape) => {
    const geometry = geometryOf(shape);
    return geometry ? [{ link: index, geometry, color: shape.color ?? null }] : [];
  });
}

/** The links' geometry, which robots and ghosts share. */
export class RobotShape {
  private readonly looks: Piece[];
  private readonly covers: Partial<Record<Detail, Piece[]>> = {};

  constructor(readonly links: Link[]) {
    this.looks = links.flatMap(looksOf);
  }

  pieces(skin: Skin, detail: Detail): Piece[] {
    if (skin === "looks") return this.looks;
    return (this.covers[detail] ??= this.links.map((link, i) =>
      ({ link: i, geometry: coverGeometry(link, UNITS[detail]), color: null })));
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
