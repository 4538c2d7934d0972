// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** The scene: one object per obstacle, which can be tinted and moved. */
import {
  Box3, BufferGeometry, Color, DoubleSide, EdgesGeometry, Float32BufferAttribute, Group, LineLoop, LineSegments, Material, Mesh,
  Object3D, ShaderMaterial,
} from "three";
import { cloud, clay, cubes, flat } from "./materials";
import { unpack } from "./packed";
import { geometryOf, poseMatrix } from "./shapes";
import { palette } from "./theme";
import type { Obstacle, Shape } from "./trace";

/** Opacity of solid obstacles: an arm in a box or a shelf must be seen. */
const SEE_THROUGH = 0.6;

/** The circle of a sphere in the plane. */
function rim(shape: Shape): BufferGeometry | null {
  if (shape.type !== "sphere") return null;
  const [x, y, , r] = shape.sphere as [number, number, number, number];
  const points: number[] = [];
  for (let i = 0; i < 96; ++i) {
    const angle = (i / 96) * 2 * Math.PI;
    points.push(x + r * Math.cos(angle), y + r * Math.sin(angle), 0);
  }
  return new BufferGeometry().setAttribute("position", new Float32BufferAttribute(points, 3));
}

/** The materials of one obstacle. */
interface Skin {
  solid: ShaderMaterial;
  edge: ShaderMaterial;
  color: { value: Color };
}

export class SceneView {
  readonly object = new Group();
  private readonly skins: Skin[] = [];
  readonly groups: Group[] = [];

  constructor(readonly obstacles: Obstacle[], private readonly isPlanar: boolean, private readonly shade: Material) {
    for (const obstacle of obstacles) {
      const solid = isPlanar ? flat("#000") : clay("#000", SEE_THROUGH);
      if (obstacle.shapes.some((shape) => shape.type === "mesh")) solid.side = DoubleSide;
      const skin = { solid, edge: flat("#000"), color: solid.uniforms.color as { value: Color } };
      const group = new Group();
      for (const shape of obstacle.shapes) group.add(...this.parts(shape, skin));
      this.skins.push(skin);
      this.groups.push(group);
      this.object.add(group);
    }
    this.tint(new Map());
  }

  /** The colours of some obstacles; the others are as always. */
  tint(colors: Map<number, string>, strength = 0.4): void {
    const { obstacle, obstacleEdge } = palette();
    this.skins.forEach((skin, i) => {
      const tint = colors.get(i);
      skin.color.value.set(obstacle);
      if (tint) skin.color.value.lerp(new Color(tint), this.isPlanar ? 0.25 : strength);
      (skin.edge.uniforms.color!.value as Color).set(tint ?? obstacleEdge);
    });
  }

  bounds(i: number): Box3 {
    this.groups[i]!.updateMatrixWorld(true);
    return new Box3().setFromObject(this.groups[i]!);
  }

  private parts(shape: Shape, skin: Skin): Object3D[] {
    if (shape.type === "points") {
      return [this.placed(cloud(unpack(shape.points, 3), shape.radius, skin.color), shape)];
    }
    if (shape.type === "octree") {
      return [this.placed(cubes(unpack(shape.cubes, 4), shape.radius, skin.color), shape)];
    }
    return this.solids(geometryOf(shape)!, shape, skin);
  }

  private placed(object: Object3D, shape: Shape & { pose: number[] }): Object3D {
    object.applyMatrix4(poseMatrix(shape.pose));
    return object;
  }

  private solids(geometry: BufferGeometry, shape: Shape, skin: Skin): Object3D[] {
    const solid: Object3D[] = [new Mesh(geometry, skin.solid)];
    const circle = this.isPlanar ? rim(shape) : null;
    if (circle) return [...solid, new LineLoop(circle, skin.edge)];
    if (shape.type === "mesh") {
      // Of a folded surface only what is nearest is seen.
      const mask = Object.assign(flat("#000"), { colorWrite: false, transparent: true, side: skin.solid.side });
      const first = new Mesh(geometry, mask);
      first.renderOrder = 1;
      solid[0]!.renderOrder = 2;
      solid.push(first);
    }
    if (!this.isPlanar) {
      const shadow = new Mesh(geometry, this.shade);
      shadow.renderOrder = -1;
      shadow.frustumCulled = false;
      solid.push(shadow);
    }
    if (shape.type !== "box" && shape.type !== "cylinder") return solid;
    return [...solid, new LineSegments(new EdgesGeometry(geometry, 30), skin.edge)];
  }
}
