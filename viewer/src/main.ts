// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Puts the page together. */
import { Box3, Group, Object3D, Vector3 } from "three";
import { Dock } from "./dock";
import { el, icon } from "./elements";
import { FlatRobot } from "./flat_robot";
import { type Frame, makeMemory } from "./memory_view";
import { shadow } from "./materials";
import { Motion } from "./motion";
import { type Layer, Panel } from "./panel";
import { SceneView } from "./scene_view";
import { makeComponents, makeSamples, makeTipTrace, makeTrees } from "./search_view";
import { poseMatrix, RobotShape, type RobotView, SolidRobot } from "./solid_robot";
import { Stage } from "./stage";
import { initTheme, originColor, palette, pathColor, toggleTheme } from "./theme";
import { type Link, type Pose, readTrace, type Trace } from "./trace";

const NARROW = 720;
const STILL_FRACTION = 0.45;

/** The robot's shapes at some poses. */
function expandByRobot(box: Box3, links: Link[], poses: Pose[]): void {
  links.forEach((link, i) => {
    const matrix = poseMatrix(poses[i]!);
    const add = (x: number, y: number, z: number, r: number) => {
      const p = new Vector3(x, y, z).applyMatrix4(matrix);
      box.expandByPoint(p.clone().addScalar(r)).expandByPoint(p.addScalar(-r));
    };
    for (const [x, y, z, r] of link.spheres) add(x!, y!, z!, r!);
    for (const c of link.capsules) {
      add(c[0]!, c[1]!, c[2]!, c[6]!);
      add(c[3]!, c[4]!, c[5]!, c[6]!);
    }
  });
}

/** Links that stand elsewhere at some point of the plan than at the start. */
function movingLinks(trace: Trace): boolean[] {
  const others = [...trace.goals, ...trace.waypoints.filter((_, i) => i % 10 === 0).map((w) => w.poses)];
  return trace.start.map((pose, i) => others.some((poses) => poses[i]!.some((v, k) => Math.abs(v - pose[k]!) > 1e-4)));
}

/** The box of all that the robot passes. */
function robotBox(trace: Trace): Box3 {
  const box = new Box3();
  const stops = trace.waypoints.filter((_, i) => i % 10 === 0).map((w) => w.poses);
  for (const { tip } of trace.waypoints) box.expandByPoint(new Vector3(tip[0], tip[1], tip[2]));
  for (const poses of [trace.start, ...trace.goals, ...stops]) expandByRobot(box, trace.links, poses);
  return box;
}

class Viewer {
  private readonly motion: Motion;
  private readonly shape: RobotShape;
  private readonly stage: Stage;
  private readonly scene: SceneView;
  private readonly panel: Panel;
  readonly dock: Dock;
  private readonly shown: Record<Layer, boolean>;
  private readonly layers: Partial<Record<Layer, Object3D>> = {};
  private robot!: RobotView;
  private frames: Frame[] = [];
  private chosen: number | null = null;
  private readonly floorHeight = { value: 0 };
  private readonly shadowOpacity = { value: 0.2 };
  private readonly shade = shadow(this.floorHeight, this.shadowOpacity);
  private readonly labels = document.getElementById("labels")!;

  constructor(private readonly trace: Trace) {
    const isPlanar = trace.is_planar;
    this.motion = new Motion(trace);
    this.shape = new RobotShape(isPlanar ? [] : trace.links, movingLinks(trace));
    // In the plane remembered arms and search at once would be too much, unless search is all there is.
    const isSearchShown = !isPlanar || this.motion.isEmpty;
    this.shown = {
      ends: true, tip: true, memory: true, components: isPlanar, samples: isSearchShown, trees: isSearchShown,
    };
    this.scene = new SceneView(trace.obstacles, isPlanar, this.shade);
    this.stage = this.makeStage();
    this.stage.scene.add(this.scene.object);
    this.writeHead();
    this.panel = new Panel(document.getElementById("panel")!, trace, this.shown, {
      layerChanged: (layer, isShown) => {
        this.shown[layer] = isShown;
        this.refresh();
      },
      primitiveChosen: (index) => {
        this.chosen = index;
        this.refresh();
      },
    });
    this.build();
    this.dock = new Dock(document.getElementById("dock")!, trace, this.motion, (fraction) => this.moveRobot(fraction));
    this.stage.onDraw(() => this.placeLabels());
    window.addEventListener("keydown", (event) => this.press(event));
    window.addEventListener("resize", () => this.layOut());
    if (window.innerWidth < NARROW) document.body.classList.add("closed");
    this.layOut();
  }

  /** All that depends on the theme, anew. */
  build(): void {
    const { trace } = this;
    const colors = palette();
    for (const part of [this.layers.ends, this.layers.tip, this.layers.trees, this.robot?.object]) part?.removeFromParent();
    const make = (color: string, opacity: number, order: number): RobotView =>
      trace.is_planar
        ? new FlatRobot(trace.links, color, colors.halo, order, opacity < 1 ? 4 : 5)
        : new SolidRobot(this.shape, color, opacity, opacity < 1 ? null : this.shade);
    this.shadowOpacity.value = colors.shadow;
    const ends = new Group();
    for (const [poses, fraction] of [[trace.start, 0], ...trace.goals.map((goal) => [goal, 1])] as [Pose[], number][]) {
      const ghost = make(`#${pathColor(fraction).getHexString()}`, 0.42, 10);
      ghost.setPoses(poses);
      ends.add(ghost.object);
    }
    this.robot = make(trace.is_planar ? colors.robotAccent : colors.robot, 1, 24);
    this.robot.setPoses(trace.start);
    this.robot.object.visible = !this.motion.isEmpty;
    this.layers.ends = ends;
    this.layers.tip = makeTipTrace(trace);
    this.layers.trees = makeTrees(trace);
    this.stage.scene.add(ends, this.layers.tip, this.layers.trees, this.robot.object);
    this.stage.applyTheme();
    this.panel.recolor();
    this.refresh();
    if (this.dock) this.moveRobot(Math.min(1, this.dock.fraction));
  }

  changeTheme(): void {
    toggleTheme(() => this.build());
  }

  redraw(): void {
    this.stage.drawNow();
  }

  get isSlow(): boolean {
    return this.stage.isSlow;
  }

  tip(): number[] | null {
    return this.motion.at(Math.min(1, this.dock.fraction))?.tip.toArray() ?? null;
  }

  private makeStage(): Stage {
    const { trace } = this;
    const box = robotBox(trace);
    const around = box.clone().expandByScalar(trace.is_planar ? 1 : 0.15);
    // Obstacles that the robot does not come near may lie outside the picture, and large ones in part.
    trace.obstacles.forEach((_, i) => {
      const bounds = this.scene.bounds(i);
      if (bounds.intersectsBox(around)) box.union(trace.is_planar ? bounds : bounds.intersect(around));
    });
    this.floorHeight.value = trace.obstacles.reduce((low, _, i) => Math.min(low, this.scene.bounds(i).min.z), box.min.z);
    const canvas = document.getElementById("canvas") as HTMLCanvasElement;
    return new Stage(canvas, trace.is_planar, box, this.floorHeight.value, this.viewDirection());
  }

  /** From the side and a little from behind, so that the arm is seen reaching into the scene. */
  private viewDirection(): Vector3 {
    if (this.trace.is_planar) return new Vector3(0, 0, 1);
    const tips = [this.trace.waypoints.at(-1)?.tip, this.trace.waypoints[0]?.tip].filter((tip) => tip !== undefined);
    const towards = tips.reduce((sum, tip) => sum.add(new Vector3(tip[0], tip[1], 0)), new Vector3());
    if (towards.length() < 1e-3) towards.set(1, 0, 0);
    towards.normalize();
    const side = new Vector3(towards.y, -towards.x, 0);
    return side.multiplyScalar(0.95).addScaledVector(towards, -0.28).add(new Vector3(0, 0, 0.42)).normalize();
  }

  private refresh(): void {
    const { trace } = this;
    for (const layer of ["components", "samples", "memory"] as const) this.layers[layer]?.removeFromParent();
    const memory = makeMemory(trace, this.scene, this.chosen);
    this.layers.components = makeComponents(trace, this.chosen);
    this.layers.samples = makeSamples(trace, this.chosen);
    this.layers.memory = memory.object;
    this.stage.scene.add(this.layers.components, this.layers.samples, memory.object);
    for (const [layer, object] of Object.entries(this.layers)) object.visible = this.shown[layer as Layer];
    this.frames = this.shown.memory ? memory.frames : [];
    this.scene.tint(this.shown.memory ? memory.tints : new Map());
    this.writeLabels();
    this.stage.invalidate();
  }

  private moveRobot(fraction: number): void {
    const moment = this.motion.at(fraction);
    if (moment === null) return;
    this.robot.setPoses(moment.poses);
    this.stage.invalidate();
  }

  private writeHead(): void {
    const { trace } = this;
    const { plan } = trace;
    const status = el("span", { class: plan.solved ? "status solved" : "status failed" }, plan.status.replaceAll("_", " "));
    document.getElementById("head")!.append(
      el("h1", {}, trace.problem || "plan", status), el("p", {}, `${trace.robot} \u00b7 ${plan.planner} \u00b7 ${plan.sampler}`));
    const buttons: [Parameters<typeof icon>[0], string, () => void][] = [
      ["reset", "Reset the view (r)", () => this.stage.resetView()],
      ["theme", "Light or dark (t)", () => this.changeTheme()],
      ["panel", "Panel (p)", () => this.togglePanel()],
    ];
    for (const [name, title, action] of buttons) {
      const button = el("button", { class: "round small", title, "aria-label": title, id: `tool-${name}` }, icon(name));
      button.addEventListener("click", action);
      document.getElementById("tools")!.append(button);
    }
  }

  private togglePanel(): void {
    document.body.classList.toggle("closed");
    this.layOut();
  }

  private layOut(): void {
    const isNarrow = window.innerWidth < NARROW;
    const panel = document.getElementById("panel")!;
    const isOpen = !document.body.classList.contains("closed");
    const dock = document.getElementById("dock")!.offsetHeight;
    const head = document.getElementById("head")!.offsetHeight;
    this.stage.setInsets({
      top: head, left: 0, right: !isNarrow && isOpen ? panel.offsetWidth + 16 : 0,
      bottom: dock + 16 + (isNarrow && isOpen ? panel.offsetHeight : 0),
    });
  }

  private writeLabels(): void {
    this.labels.replaceChildren(...this.frames.map((frame) => {
      const label = el("span", {}, frame.label);
      label.style.setProperty("--color", originColor(frame.index));
      return label;
    }));
  }

  private placeLabels(): void {
    const taken: { x: number; y: number }[] = [];
    const covered = ["head", "tools"].map((id) => document.getElementById(id)!.getBoundingClientRect());
    this.frames.forEach((frame, i) => {
      const label = this.labels.children[i] as HTMLElement;
      const at = this.stage.project(frame.anchor);
      if (at) while (taken.some((other) => Math.abs(other.x - at.x) < 64 && Math.abs(other.y - at.y) < 22)) at.y += 23;
      const isCovered = covered.some((box) => at && at.x > box.left - 36 && at.x < box.right + 36 && at.y - 28 < box.bottom);
      label.style.visibility = at && !isCovered ? "visible" : "hidden";
      if (!at) return;
      taken.push(at);
      label.style.transform = `translate(-50%,-120%) translate(${at.x.toFixed(1)}px,${at.y.toFixed(1)}px)`;
    });
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const isButton = event.target instanceof HTMLElement && event.target.matches("button, input");
    const step = event.shiftKey ? null : 0.01;
    const actions: Record<string, () => void> = {
      ArrowRight: () => (step ? this.dock.seek(this.dock.fraction + step) : this.dock.jump(1)),
      ArrowLeft: () => (step ? this.dock.seek(Math.min(1, this.dock.fraction) - step) : this.dock.jump(-1)),
      Home: () => this.dock.seek(0),
      End: () => this.dock.seek(1),
      r: () => this.stage.resetView(),
      t: () => this.changeTheme(),
      p: () => this.togglePanel(),
      Escape: () => this.chosen !== null && this.panel.choose(null),
    };
    if (!isButton) actions[" "] = () => this.dock.toggle();
    this.panel.layerOrder.forEach((layer, i) => (actions[String(i + 1)] = () => this.panel.toggleLayer(layer)));
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}

/** What scripts and tests may do with the page. */
interface Handle {
  seek(fraction: number): void;
  fraction(): number;
  tip(): number[] | null;
  /** Draws at once: what is on the canvas may be read until the next task. */
  redraw(): void;
}

function start(): void {
  let viewer: Viewer | null = null;
  initTheme(() => viewer?.build());
  viewer = new Viewer(readTrace());
  const { dock } = viewer;
  const handle: Handle = {
    seek: (fraction) => dock.seek(fraction),
    fraction: () => dock.fraction,
    tip: () => viewer!.tip(),
    redraw: () => viewer!.redraw(),
  };
  Object.assign(window, { mneme: handle });
  // The second of these comes when the first picture has been drawn.
  requestAnimationFrame(() => requestAnimationFrame(() => {
    performance.mark("first-picture");
    document.body.classList.add("ready");
  }));
  // What moves by itself must move smoothly: otherwise a still picture of robot, start and goal.
  const isCalm = viewer.isSlow || window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (isCalm) dock.seek(STILL_FRACTION);
  else dock.toggle();
}

try {
  start();
} catch (error) {
  document.body.append(el("p", { class: "failure" }, `This page cannot be shown: ${(error as Error).message}`));
  throw error;
}
