// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Draws scenes without WebGL: triangles, lines and dots on a canvas, the farthest first. */
import {
  type BufferAttribute, type BufferGeometry, type Camera, Color, InstancedBufferGeometry, Line, LineLoop, LineSegments, Material, Matrix4, Mesh,
  Object3D, OrthographicCamera, Points, type Scene, type ShaderMaterial, Vector3,
} from "three";
import { SUN } from "./materials";

/** Of surfaces that are seen through: the same surface of the robot hides them. */
const BEHIND = 0.001;

interface Mark {
  /** Larger ones are drawn over smaller ones, whatever their depth. */
  order: number;
  /** 1 is farthest. */
  depth: number;
  draw(): void;
}

type Corner = Vector3;

function attribute(geometry: BufferGeometry, name: string): BufferAttribute {
  return geometry.getAttribute(name) as BufferAttribute;
}

/** Those of a shader, or the same of a material of three.js, as handles have. */
function uniformsOf(material: Material): ShaderMaterial["uniforms"] {
  const { uniforms, color, opacity } = material as ShaderMaterial & { color?: Color };
  return uniforms ?? { ...(color ? { color: { value: color } } : {}), opacity: { value: opacity } };
}

/** Has the members of a WebGLRenderer that a Stage needs. */
export class Painter {
  private ratio = 1;
  private part = { left: 0, width: 1, height: 1 };
  private marks: Mark[] = [];
  private toScreen = new Matrix4();
  private eye = new Vector3();
  private isFlat = false;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly context: CanvasRenderingContext2D) {}

  getPixelRatio(): number {
    return this.ratio;
  }
  setPixelRatio(ratio: number): void {
    this.ratio = ratio;
  }
  setSize(width: number, height: number): void {
    this.canvas.width = Math.round(width * this.ratio);
    this.canvas.height = Math.round(height * this.ratio);
  }
  setViewport(left: number, _bottom: number, width: number, height: number): void {
    this.part = { left, width, height };
  }
  setAnimationLoop(draw: (time: number) => void): void {
    const tick = (time: number): void => {
      // First, so that a picture that fails is not the last one.
      requestAnimationFrame(tick);
      draw(time);
    };
    requestAnimationFrame(tick);
  }

  render(scene: Scene, camera: Camera): void {
    const { context, part } = this;
    scene.updateMatrixWorld();
    this.toScreen.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    this.eye.setFromMatrixPosition(camera.matrixWorld);
    this.isFlat = camera instanceof OrthographicCamera;
    this.marks = [];
    scene.traverseVisible((object) => {
      if (object instanceof Mesh) this.addMesh(object);
      else if (object instanceof Line) this.addLine(object);
      else if (object instanceof Points) this.addPoints(object);
    });
    this.marks.sort((a, b) => (a.order === b.order ? b.depth - a.depth : a.order - b.order));
    context.save();
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.beginPath();
    context.rect(part.left, 0, part.width, part.height);
    context.clip();
    context.fillStyle = `#${(scene.background as Color).getHexString()}`;
    context.fill();
    context.lineCap = context.lineJoin = "round";
    for (const mark of this.marks) mark.draw();
    context.restore();
  }

  private addMesh(mesh: Mesh): void {
    const material = mesh.material as ShaderMaterial;
    const uniforms = uniformsOf(material);
    if (uniforms.thickness) return this.addStrokes(mesh, material);
    // Shadows and the grid of the floor are left to WebGL.
    if (!material.visible || !material.colorWrite || !uniforms.color || uniforms.cell) return;
    if (mesh.geometry instanceof InstancedBufferGeometry) return this.addCubes(mesh, material);
    const opacity = (uniforms.opacity?.value as number | undefined) ?? 1;
    const world = this.toWorld(mesh.geometry, mesh.matrixWorld);
    const screen = world.map((corner) => this.project(corner.clone()));
    const index = mesh.geometry.getIndex();
    const count = index ? index.count : world.length;
    const order = this.orderOf(mesh, material);
    const [edge, other, sight] = [new Vector3(), new Vector3(), new Vector3()];
    for (let i = 0; i + 2 < count; i += 3) {
      const [a, b, c] = index ? [index.getX(i), index.getX(i + 1), index.getX(i + 2)] : [i, i + 1, i + 2];
      const normal = edge.subVectors(world[b]!, world[a]!).cross(other.subVectors(world[c]!, world[a]!)).normalize();
      const isFront = normal.dot(sight.subVectors(this.eye, world[a]!)) > 0;
      // Of closed surfaces only what faces the camera is seen.
      if (!isFront && (opacity < 1 || mesh.userData.link !== undefined)) continue;
      const light = uniforms.sun ? this.light(isFront ? normal : normal.negate()) : 1;
      this.addPolygon([screen[a]!, screen[b]!, screen[c]!], uniforms.color.value as Color, light, opacity, order);
    }
  }

  /** In the plane layers lie over each other; in space depth decides, except for what is drawn over everything. */
  private orderOf(object: Object3D, material: Material): number {
    return this.isFlat || !material.depthTest ? object.renderOrder : -Infinity;
  }

  private toWorld(geometry: BufferGeometry, matrix: Matrix4): Vector3[] {
    const position = attribute(geometry, "position");
    return Array.from({ length: position.count }, (_, i) => new Vector3().fromBufferAttribute(position, i).applyMatrix4(matrix));
  }

  /** As in clay(), without its rim. */
  private light(normal: Vector3): number {
    return 0.5 + 0.2 * (0.5 + 0.5 * normal.z) + 0.36 * Math.max(0, normal.dot(SUN));
  }

  private addStrokes(mesh: Mesh, material: ShaderMaterial): void {
    const [from, to, tone] = ["a", "b", "tone"].map((name) => mesh.geometry.getAttribute(name) as BufferAttribute | undefined);
    const order = this.orderOf(mesh, material);
    for (let i = 0; from && to && tone && i < from.count; i += 4) {
      const ends = [from, to].map((list) => this.project(new Vector3().fromBufferAttribute(list, i).applyMatrix4(mesh.matrixWorld)));
      const color = new Color().fromBufferAttribute(tone, i);
      this.addStroke(ends[0]!, ends[1]!, color, material.uniforms.thickness!.value, material.uniforms.opacity!.value, order);
    }
  }

  private addLine(line: Line): void {
    const material = line.material as Material;
    const uniforms = uniformsOf(material);
    const tone = line.geometry.getAttribute("tone") as BufferAttribute | undefined;
    const opacity = (uniforms.opacity?.value as number | undefined) ?? 1;
    const screen = this.toWorld(line.geometry, line.matrixWorld).map((point) => this.project(point));
    const isPairs = line instanceof LineSegments;
    const count = line instanceof LineLoop ? screen.length : screen.length - 1;
    for (let i = 0; i < count; i += isPairs ? 2 : 1) {
      const color = tone ? new Color().fromBufferAttribute(tone, i) : (uniforms.color!.value as Color);
      this.addStroke(screen[i]!, screen[(i + 1) % screen.length]!, color, 1, opacity, this.orderOf(line, material));
    }
  }

  private addPoints(points: Points): void {
    const material = points.material as ShaderMaterial;
    const { uniforms } = material;
    const order = this.orderOf(points, material);
    const tone = points.geometry.getAttribute("tone") as BufferAttribute | undefined;
    for (const [i, point] of this.toWorld(points.geometry, points.matrixWorld).entries()) {
      const at = this.project(point);
      const color = tone ? new Color().fromBufferAttribute(tone, i) : (uniforms.color!.value as Color);
      this.addDot(at, color, (uniforms.size?.value as number | undefined) ?? 2, (uniforms.opacity?.value as number | undefined) ?? 1, order);
    }
  }

  private addCubes(mesh: Mesh, { uniforms }: ShaderMaterial): void {
    const cubes = attribute(mesh.geometry, "cube");
    for (let i = 0; i < cubes.count; ++i) {
      const middle = new Vector3().fromBufferAttribute(cubes, i).applyMatrix4(mesh.matrixWorld);
      const [at, rim] = [this.project(middle), this.project(middle.clone().add(new Vector3(0, 0, cubes.getW(i))))];
      this.addDot(at, uniforms.color!.value as Color, Math.max(1, 2 * Math.hypot(rim.x - at.x, rim.y - at.y)), 1, -Infinity);
    }
  }

  private addPolygon(corners: [Corner, Corner, Corner], color: Color, light: number, opacity: number, order: number): void {
    const [a, b, c] = corners;
    if (a.z > 1 || b.z > 1 || c.z > 1) return;
    this.mark(order, (a.z + b.z + c.z) / 3 + (opacity < 1 ? BEHIND : 0), color.clone().multiplyScalar(light), opacity, (context) => {
      context.beginPath();
      for (const { x, y } of corners) context.lineTo(x, y);
      context.closePath();
      context.fill();
      // Neighbours leave no gap.
      if (opacity === 1) context.stroke();
    }, 0.7);
  }

  private addStroke(a: Corner, b: Corner, color: Color, width: number, opacity: number, order: number): void {
    if (a.z > 1 || b.z > 1) return;
    this.mark(order, (a.z + b.z) / 2, color, opacity, (context) => {
      context.beginPath();
      context.moveTo(a.x, a.y);
      context.lineTo(b.x, b.y);
      context.stroke();
    }, width);
  }

  private addDot(at: Corner, color: Color, size: number, opacity: number, order: number): void {
    if (at.z > 1) return;
    this.mark(order, at.z, color, opacity, (context) => {
      context.beginPath();
      context.arc(at.x, at.y, size / 2, 0, 2 * Math.PI);
      context.fill();
    }, 0);
  }

  private mark(order: number, depth: number, color: Color, opacity: number, paint: (context: CanvasRenderingContext2D) => void,
               width: number): void {
    const style = `#${color.getHexString()}`;
    this.marks.push({
      order, depth, draw: () => {
        const { context } = this;
        context.globalAlpha = opacity;
        context.fillStyle = context.strokeStyle = style;
        context.lineWidth = width;
        paint(context);
      },
    });
  }

  /** Pixels of the page, and the depth; beyond 1 it is behind the camera. */
  private project(point: Vector3): Corner {
    const { left, width, height } = this.part;
    const p = point.applyMatrix4(this.toScreen);
    return new Vector3(left + (0.5 + p.x / 2) * width, (0.5 - p.y / 2) * height, p.z);
  }
}
