// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** The scene: one object per obstacle, which can be tinted. */
import {
  Box3, BoxGeometry, BufferGeometry, CapsuleGeometry, Color, CylinderGeometry, EdgesGeometry, Float32BufferAttribute,
  Group, LineLoop, LineSegments, Material, Mesh, Object3D, Quaternion, ShaderMaterial, SphereGeometry, Vector3,
} from "three";
import { clay, flat } from "./materials";
import { poseMatrix } from "./solid_robot";
import { palette } from "./theme";
import type { Obstacle, Shape } from "./trace";

const UP = new Vector3(0, 1, 0);
/** Opacity of solid obstacles: an arm in a box or a shelf must be seen. */
const SEE_THROUGH = 0.6;

function geometryOf(shape: Shape): BufferGeometry {
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
  }
}

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

export class SceneView {
  readonly object = new Group();
  private readonly skins: ShaderMaterial[] = [];
  private readonly edges: ShaderMaterial[] = [];
  private readonly groups: Group[] = [];

  constructor(obstacles: Obstacle[], private readonly isPlanar: boolean, private readonly shade: Material) {
    for (const obstacle of obstacles) {
      const skin = isPlanar ? flat("#000") : clay("#000", SEE_THROUGH);
      const edge = flat("#000");
      const group = new Group();
      for (const shape of obstacle.shapes) group.add(...this.solids(shape, skin, edge));
      this.skins.push(skin);
      this.edges.push(edge);
      this.groups.push(group);
      this.object.add(group);
    }
    this.tint(new Map());
  }

  /** The colours of some obstacles; the others are as always. */
  tint(colors: Map<number, string>): void {
    const { obstacle, obstacleEdge } = palette();
    this.skins.forEach((skin, i) => {
      const tint = colors.get(i);
      const color: Color = skin.uniforms.color!.value.set(obstacle);
      if (tint) color.lerp(new Color(tint), this.isPlanar ? 0.25 : 0.4);
      this.edges[i]!.uniforms.color!.value.set(tint ?? obstacleEdge);
    });
  }

  bounds(i: number): Box3 {
    return new Box3().setFromObject(this.groups[i]!);
  }

  private solids(shape: Shape, skin: Material, edge: Material): Object3D[] {
    const geometry = geometryOf(shape);
    const solid: Object3D[] = [new Mesh(geometry, skin)];
    const circle = this.isPlanar ? rim(shape) : null;
    if (circle) return [...solid, new LineLoop(circle, edge)];
    if (!this.isPlanar) {
      const shadow = new Mesh(geometry, this.shade);
      shadow.renderOrder = -1;
      shadow.frustumCulled = false;
      solid.push(shadow);
    }
    if (shape.type !== "box" && shape.type !== "cylinder") return solid;
    return [...solid, new LineSegments(new EdgesGeometry(geometry, 30), edge)];
  }
}
