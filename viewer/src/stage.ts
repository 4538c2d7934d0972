// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Camera, light and floor of one picture, or of two beside each other; draws when something has changed. */
import {
  Box3, Color, LinearSRGBColorSpace, Mesh, MOUSE, OrthographicCamera, PerspectiveCamera, PlaneGeometry,
  Scene, TOUCH, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { gridMaterial, pixelRatio, resolution } from "./materials";
import { Painter } from "./painter";
import { palette } from "./theme";

const FIELD_OF_VIEW = 32;
/** Of the free part of the canvas that what matters may take. */
const FILLED = 0.94;
export interface Insets {
  top: number;
  right: number;
  bottom: number;
  left: number;
}

interface Drawing {
  renderer: WebGLRenderer | Painter;
  /** Null without WebGL 2. */
  context: WebGL2RenderingContext | null;
  /** Too slow for smooth edges in motion. */
  isSoftware: boolean;
}

/** Draws on a graphics card, in software, or on a plain canvas in browsers without WebGL 2. */
function makeDrawing(canvas: HTMLCanvasElement): Drawing {
  const isSoftware = isDrawnInSoftware();
  const context = canvas.getContext("webgl2", {
    stencil: true, powerPreference: "high-performance", alpha: false, antialias: !isSoftware,
  });
  if (context) {
    const renderer = new WebGLRenderer({ canvas, context });
    renderer.debug.checkShaderErrors = false;
    renderer.outputColorSpace = LinearSRGBColorSpace;
    renderer.setScissorTest(true);
    return { renderer, context, isSoftware };
  }
  const plain = canvas.getContext("2d");
  if (!plain) throw new Error("this browser draws neither with WebGL 2 nor on a canvas");
  return { renderer: new Painter(canvas, plain), context: null, isSoftware: true };
}

/** Asks a context of its own, because smooth edges must be decided on before there is one. */
function isDrawnInSoftware(): boolean {
  const probe = document.createElement("canvas").getContext("webgl2");
  const names = probe?.getExtension("WEBGL_debug_renderer_info");
  const name = probe && names ? String(probe.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
  probe?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

/** Milliseconds without a change before a picture in software is drawn again with smooth edges. */
const STILL = 160;

/** What is to be seen, and from where. */
export interface View {
  /** Holds what matters. */
  box: Box3;
  floorHeight: number;
  /** The camera looks against it. */
  direction: Vector3;
}

export class Stage {
  /** One for each picture; the camera is the same. */
  readonly scenes = [new Scene(), new Scene()];
  /** True without a graphics card. */
  readonly isSlow: boolean;
  private readonly renderer: WebGLRenderer | Painter;
  private readonly ratio = Math.min(2, window.devicePixelRatio);
  private changed = 0;
  private isUntouched = true;
  readonly camera: PerspectiveCamera | OrthographicCamera;
  readonly controls: OrbitControls;
  private readonly floors: Mesh[] = [];
  private count = 1;
  private view: View = { box: new Box3(new Vector3(), new Vector3(1, 1, 1)), floorHeight: 0, direction: new Vector3(0, 0, 1) };
  private nextView = this.view;
  private isStale = true;
  /** Behind the picture that is being drawn. */
  private fence: WebGLSync | null = null;
  private insets: Insets = { top: 0, right: 0, bottom: 0, left: 0 };
  private readonly afterDraw: ((picture: number) => void)[] = [];

  private readonly context: WebGL2RenderingContext | null;

  constructor(readonly canvas: HTMLCanvasElement, readonly isPlanar: boolean) {
    const { renderer, context, isSoftware } = makeDrawing(canvas);
    this.context = context;
    this.isSlow = isSoftware;
    this.renderer = renderer;
    this.renderer.setPixelRatio(this.ratio);
    this.camera = isPlanar
      ? new OrthographicCamera(-1, 1, 1, -1, 0.1, 1000)
      : new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.05, 200);
    this.camera.up.set(0, isPlanar ? 1 : 0, isPlanar ? 0 : 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener("change", () => this.invalidate());
    this.controls.addEventListener("start", () => (this.isUntouched = false));
    this.controls.maxPolarAngle = Math.PI * 0.54;
    if (isPlanar) this.lockToPlane();
    new ResizeObserver(() => this.setInsets(this.insets)).observe(canvas.parentElement!);
    this.renderer.setAnimationLoop((time) => this.draw(time));
  }

  /** False without WebGL 2: pictures have no shadows and no grid. */
  get hasGraphics(): boolean {
    return this.context !== null;
  }

  /** What resetView() will show: until then nothing moves under the hands of who drags it. */
  setView(view: View): void {
    this.nextView = view;
  }

  /** One picture, or two. */
  setCount(count: number): void {
    this.count = count;
    this.setInsets(this.insets);
  }

  /** Calls `callback` after each picture, while the camera is that of the picture. */
  onDraw(callback: (picture: number) => void): void {
    this.afterDraw.push(callback);
  }

  invalidate(): void {
    this.isStale = true;
  }

  /** Pixels at the rim that panels cover: the middle of the view moves accordingly. */
  setInsets(insets: Insets): void {
    this.insets = insets;
    if (this.isUntouched) this.fitView();
    else this.resize();
  }

  /** Where `point` is on the canvas, in pixels of the page; null behind the camera. */
  project(point: Vector3, picture = 0): { x: number; y: number } | null {
    this.aim(picture);
    const p = point.clone().project(this.camera);
    if (p.z > 1) return null;
    const part = this.part(picture);
    return { x: part.left + (0.5 + p.x / 2) * part.width, y: (0.5 - p.y / 2) * part.height };
  }

  /** The picture at these pixels, and where in it: -1 to 1, upwards. */
  locate(x: number, y: number): { picture: number; at: Vector2 } {
    const picture = this.count > 1 && x >= this.part(1).left ? 1 : 0;
    const part = this.part(picture);
    this.aim(picture);
    return { picture, at: new Vector2((2 * (x - part.left)) / part.width - 1, 1 - (2 * y) / part.height) };
  }

  /** Looks at a small place from where the camera is. */
  focus(box: Box3): void {
    const center = box.getCenter(new Vector3());
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    this.isUntouched = false;
    this.controls.target.copy(center);
    const size = Math.max(0.05, box.getSize(new Vector3()).length());
    if (this.camera instanceof PerspectiveCamera) {
      this.camera.position.copy(center).addScaledVector(direction, (1.1 * size) / Math.tan((FIELD_OF_VIEW * Math.PI) / 360));
    } else {
      this.camera.position.copy(center).addScaledVector(direction, 50);
      this.camera.zoom = this.view.box.getSize(new Vector3()).length() / (3 * size);
    }
    this.resize();
    this.controls.update();
  }

  applyTheme(): void {
    const colors = palette();
    this.scenes.forEach((scene, i) => {
      scene.background = new Color(colors.background);
      this.floors[i]?.removeFromParent();
      this.floors[i] = this.makeFloor();
      scene.add(this.floors[i]!);
    });
    this.invalidate();
  }

  resetView(): void {
    this.view = this.nextView;
    this.applyTheme();
    this.fitView();
  }

  private fitView(): void {
    const center = this.view.box.getCenter(new Vector3());
    this.controls.target.copy(center);
    this.camera.zoom = 1;
    this.camera.position.copy(center).addScaledVector(this.view.direction, this.isPlanar ? 50 : this.fittingDistance(center));
    this.camera.lookAt(center);
    this.resize();
    this.controls.update();
    this.isUntouched = true;
  }

  /** The part of the canvas that a picture takes, in pixels; the last one goes on below panels at the right. */
  private part(picture: number): { left: number; width: number; height: number; right: number } {
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    const share = Math.max(80, clientWidth - this.insets.left - this.insets.right) / this.count;
    const left = picture === 0 ? 0 : this.insets.left + picture * share;
    const isLast = picture === this.count - 1;
    const end = isLast ? clientWidth : this.insets.left + (picture + 1) * share;
    return { left, width: end - left, height: clientHeight, right: isLast ? this.insets.right : 0 };
  }

  /** The free part of each picture, in pixels. */
  private freePart(): { width: number; height: number } {
    const { top, right, bottom, left } = this.insets;
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    return {
      width: Math.max(80, (clientWidth - left - right) / this.count), height: Math.max(80, clientHeight - top - bottom),
    };
  }

  /** So far away that all corners of the box are seen in the free part. */
  private fittingDistance(center: Vector3): number {
    const free = this.freePart();
    const up = Math.tan((FIELD_OF_VIEW / 2) * (Math.PI / 180)) * FILLED * (free.height / this.canvas.parentElement!.clientHeight);
    const across = up * (free.width / free.height);
    const right = this.camera.up.clone().cross(this.view.direction).normalize();
    const above = this.view.direction.clone().cross(right);
    let distance = 0;
    for (let i = 0; i < 8; ++i) {
      const { min, max } = this.view.box;
      const corner = new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z).sub(center);
      const needed = Math.max(Math.abs(corner.dot(right)) / across, Math.abs(corner.dot(above)) / up);
      distance = Math.max(distance, needed + corner.dot(this.view.direction));
    }
    return distance;
  }

  private lockToPlane(): void {
    this.controls.enableRotate = false;
    this.controls.screenSpacePanning = true;
    this.controls.mouseButtons = { LEFT: MOUSE.PAN, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
    this.controls.touches = { ONE: TOUCH.PAN, TWO: TOUCH.DOLLY_PAN };
  }

  private makeFloor(): Mesh {
    const radius = this.isPlanar ? 30 : 3.5;
    const cell = this.isPlanar ? 1 : 0.25;
    const floor = new Mesh(new PlaneGeometry(2 * radius, 2 * radius), gridMaterial(palette().grid, cell, radius));
    const snap = (value: number) => Math.round(value / cell / 4) * cell * 4;
    const center = this.view.box.getCenter(new Vector3());
    const z = this.isPlanar ? -10 : this.view.floorHeight - 0.002;
    floor.position.set(snap(center.x), snap(center.y), z);
    floor.renderOrder = -2;
    return floor;
  }

  private resize(): void {
    const width = this.canvas.parentElement!.clientWidth;
    const height = this.canvas.parentElement!.clientHeight;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.aim(0);
    this.invalidate();
  }

  /** Makes the camera that of a picture. */
  aim(picture: number): void {
    const { width, height, right } = this.part(picture);
    if (width === 0 || height === 0) return;
    const { top, bottom } = this.insets;
    const left = picture === 0 ? this.insets.left : 0;
    if (this.camera instanceof PerspectiveCamera) {
      this.camera.fov = FIELD_OF_VIEW;
      this.camera.aspect = width / height;
    } else {
      const free = this.freePart();
      const size = this.view.box.getSize(new Vector3());
      const scale = Math.max(size.x / free.width, size.y / free.height) / FILLED;
      this.camera.left = (-width / 2) * scale;
      this.camera.right = (width / 2) * scale;
      this.camera.top = (height / 2) * scale;
      this.camera.bottom = (-height / 2) * scale;
    }
    this.camera.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  drawNow(): void {
    this.isStale = false;
    this.setRatio(this.ratio);
    this.renderAll();
    for (let picture = 0; picture < this.count; ++picture) {
      this.aim(picture);
      for (const callback of this.afterDraw) callback(picture);
    }
    this.aim(0);
  }

  private renderAll(): void {
    for (let picture = 0; picture < this.count; ++picture) {
      const { left, width, height } = this.part(picture);
      this.aim(picture);
      this.renderer.setViewport(left, 0, width, height);
      if (this.renderer instanceof WebGLRenderer) this.renderer.setScissor(left, 0, width, height);
      resolution.value.set(width, height).multiplyScalar(this.renderer.getPixelRatio());
      this.renderer.render(this.scenes[picture]!, this.camera);
    }
    if (!this.context) return;
    this.context.deleteSync(this.fence);
    this.fence = this.context.fenceSync(this.context.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.context.flush();
  }

  /** One picture at a time: a page that draws faster than it is shown waits for all it has drawn. */
  private draw(time: number): void {
    if (this.isBusy()) return;
    if (this.isStale) {
      this.drawNow();
      this.changed = time;
    } else if (this.context && this.isSlow && this.changed > 0 && time - this.changed > STILL) {
      this.changed = 0;
      this.setRatio(2 * this.ratio);
      this.renderAll();
      this.aim(0);
    }
  }

  private isBusy(): boolean {
    const { context, fence } = this;
    if (!context) return false;
    if (fence && context.clientWaitSync(fence, 0, 0) === context.TIMEOUT_EXPIRED) return true;
    context.deleteSync(fence);
    this.fence = null;
    return false;
  }

  private setRatio(ratio: number): void {
    if (this.renderer.getPixelRatio() === ratio) return;
    this.renderer.setPixelRatio(ratio);
    pixelRatio.value = ratio;
  }
}

