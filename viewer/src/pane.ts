// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** One plan in its scene: robot, start and goals, obstacles, memory, search and what touches. */
import { Box3, Group, Object3D, Scene, Vector3 } from "three";
import { el } from "./elements";
import { FlatRobot } from "./flat_robot";
import { type Frame, makeMemory } from "./memory_view";
import { shadow } from "./materials";
import { Motion } from "./motion";
import type { Layer } from "./panel";
import { SceneView } from "./scene_view";
import { makeComponents, makeSamples, makeTipTrace, makeTrees } from "./search_view";
import { poseMatrix } from "./shapes";
import { RobotShape, type RobotView, type Skin, SolidRobot } from "./solid_robot";
import type { Stage, View } from "./stage";
import { originColor, palette, pathColor, touchColor } from "./theme";
import { type Link, type Pose, type Touch, touchName, type Trace } from "./trace";

/** The robot's shapes at some poses. */
function expandByRobot(box: Box3, links: Link[], poses: Pose[], only?: Set<number>): void {
  links.forEach((link, i) => {
    if (only && !only.has(i)) return;
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

/** The box of all that the robot passes. */
function robotBox(trace: Trace): Box3 {
  const box = new Box3();
  const stops = trace.waypoints.filter((_, i) => i % 10 === 0).map((w) => w.poses);
  for (const { tip } of trace.waypoints) box.expandByPoint(new Vector3(tip[0], tip[1], tip[2]));
  for (const poses of [trace.start, ...trace.goals, ...stops]) expandByRobot(box, trace.links, poses);
  return box;
}

/** The start, and the goal that was reached or all that were given: a pose may have many configurations. */
function endsOf({ start, goals, plan, waypoints }: Trace): Pose[][] {
  return [start, ...(plan.solved && waypoints.length > 0 ? [waypoints.at(-1)!.poses] : goals)];
}

export class Pane {
  readonly motion: Motion;
  readonly scene: SceneView;
  /** What stands in the stage's scene of this pane. */
  private readonly object = new Group();
  private readonly layers: Partial<Record<Layer, Object3D>> = {};
  private robot: RobotView | null = null;
  private readonly ends: Pose[][];
  private ghosts: RobotView[] = [];
  private touchMarks = new Group();
  private frames: Frame[] = [];
  private readonly floorHeight = { value: 0 };
  private readonly shadowOpacity = { value: 0.2 };
  private readonly shade = shadow(this.floorHeight, this.shadowOpacity);
  private readonly labels = el("div", { class: "labels" });
  private readonly box: Box3;
  private fraction = 0;

  /** `shape` is that of the trace's links. */
  constructor(readonly trace: Trace, readonly shape: RobotShape, stageScene: Scene, private readonly picture: number) {
    this.motion = new Motion(trace);
    this.scene = new SceneView(trace.obstacles, trace.is_planar, this.shade);
    this.ends = endsOf(trace);
    this.box = robotBox(trace);
    this.object.add(this.scene.object);
    stageScene.add(this.object);
    document.getElementById("labels")!.append(this.labels);
    this.floorHeight.value = trace.obstacles.reduce((low, _, i) => Math.min(low, this.scene.bounds(i).min.z), this.box.min.z);
  }

  remove(): void {
    this.object.removeFromParent();
    this.labels.remove();
    this.object.traverse((part) => {
      const { geometry, userData } = part as Object3D & { geometry?: { dispose(): void } };
      // The robot's geometry is shared with panes to come.
      if (geometry && userData.link === undefined) geometry.dispose();
    });
  }

  get view(): View {
    const { trace } = this;
    const box = this.box.clone();
    const around = box.clone().expandByScalar(trace.is_planar ? 1 : 0.15);
    // Obstacles that the robot does not come near may lie outside the picture, and large ones in part.
    trace.obstacles.forEach((_, i) => {
      const bounds = this.scene.bounds(i);
      if (bounds.intersectsBox(around)) box.union(trace.is_planar ? bounds : bounds.intersect(around));
    });
    return { box, floorHeight: this.floorHeight.value, direction: this.viewDirection() };
  }

  /** All that depends on the theme and on what the robot is seen as, anew. */
  build(skin: Skin): void {
    const { trace } = this;
    const colors = palette();
    const { ends, tip, trees } = this.layers;
    for (const part of [ends, tip, trees, this.robot?.object, this.touchMarks]) part?.removeFromParent();
    const make = (color: string, opacity: number): RobotView =>
      trace.is_planar
        ? new FlatRobot(trace.links, color, colors.halo, opacity < 1 ? 10 : 24, opacity < 1 ? 4 : 5)
        : new SolidRobot(this.shape, {
          color, opacity, skin, carriedColor: colors.robotAccent, shade: opacity < 1 ? null : this.shade,
        });
    this.shadowOpacity.value = colors.shadow;
    const newEnds = new Group();
    this.ghosts = this.ends.map((poses, i) => {
      const ghost = make(`#${pathColor(i === 0 ? 0 : 1).getHexString()}`, 0.42);
      ghost.setPoses(poses);
      newEnds.add(ghost.object);
      return ghost;
    });
    this.robot = make(trace.is_planar ? colors.robotAccent : colors.robot, 1);
    this.layers.ends = newEnds;
    this.layers.tip = makeTipTrace(trace);
    this.layers.trees = makeTrees(trace);
    this.touchMarks = this.makeTouches();
    this.object.add(newEnds, this.layers.tip, this.layers.trees, this.robot.object, this.touchMarks);
    this.move(this.fraction);
  }

  /** Shows layers, and one primitive alone if it is chosen. */
  refresh(shown: Record<Layer, boolean>, chosen: number | null): void {
    const { trace } = this;
    for (const layer of ["components", "samples", "memory"] as const) this.layers[layer]?.removeFromParent();
    const memory = makeMemory(trace, this.scene, chosen);
    this.layers.components = makeComponents(trace, chosen);
    this.layers.samples = makeSamples(trace, chosen);
    this.layers.memory = memory.object;
    this.object.add(this.layers.components, this.layers.samples, memory.object);
    for (const [layer, object] of Object.entries(this.layers)) object.visible = shown[layer as Layer];
    this.frames = shown.memory ? memory.frames : [];
    const tints = shown.memory ? memory.tints : new Map<number, string>();
    for (const touch of trace.touches ?? []) if (!touch.is_self) tints.set(touch.other, touchColor());
    this.scene.tint(tints);
    this.writeLabels();
  }

  /** Where the robot is at a fraction of the motion; it stands at the start if there is none. */
  move(fraction: number): void {
    this.fraction = fraction;
    if (!this.robot) return;
    const poses = this.motion.at(fraction)?.poses ?? this.trace.start;
    this.robot.setPoses(poses);
    // What stands still, or in the same place at the start and at goals, is drawn once.
    this.ghosts.forEach((ghost, i) => ghost.hideWhere(poses, ...this.ends.slice(0, i)));
  }

  /** What touches, and its surroundings. */
  touchBox(touch: Touch): Box3 {
    const box = new Box3().setFromCenterAndSize(new Vector3(...touch.place), new Vector3().setScalar(this.trace.is_planar ? 1.2 : 0.16));
    expandByRobot(box, this.trace.links, this.posesOf(touch), new Set([touch.link]));
    return box;
  }

  private posesOf(touch: Touch): Pose[] {
    return touch.goal < 0 ? this.trace.start : this.trace.goals[touch.goal] ?? this.trace.start;
  }

  /** The links that touch in red, as they are checked. */
  private makeTouches(): Group {
    const group = new Group();
    const byEnd = new Map<number, Set<number>>();
    for (const touch of this.trace.touches ?? []) {
      const links = byEnd.get(touch.goal) ?? new Set<number>();
      links.add(touch.link);
      if (touch.is_self) links.add(touch.other);
      byEnd.set(touch.goal, links);
    }
    for (const [goal, links] of byEnd) {
      const poses = goal < 0 ? this.trace.start : this.trace.goals[goal]!;
      const color = touchColor();
      const chosen = this.trace.links.filter((_, i) => links.has(i));
      const marks: RobotView = this.trace.is_planar
        ? new FlatRobot(chosen, color, palette().halo, 30, 6)
        : new SolidRobot(this.shape, { color, carriedColor: color, opacity: 0.8, skin: "covers", shade: null }, links);
      marks.setPoses(this.trace.is_planar ? poses.filter((_, i) => links.has(i)) : poses);
      marks.object.traverse((part) => (part.renderOrder += 20));
      group.add(marks.object);
    }
    return group;
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

  private writeLabels(): void {
    const frames = this.frames.map((frame) => {
      const label = el("span", {}, frame.label);
      label.style.setProperty("--color", originColor(frame.index));
      return label;
    });
    const touches = (this.trace.touches ?? []).slice(0, 4).map((touch) =>
      el("span", { class: "touch" }, touchName(this.trace, touch)));
    this.labels.replaceChildren(...frames, ...touches);
  }

  /** Called while the stage's camera is that of this pane. */
  placeLabels(stage: Stage): void {
    const anchors = [...this.frames.map((frame) => frame.anchor),
      ...(this.trace.touches ?? []).slice(0, 4).map((touch) => new Vector3(...touch.place))];
    const taken: { x: number; y: number }[] = [];
    const covered = ["head", "tools"].map((id) => document.getElementById(id)!.getBoundingClientRect());
    anchors.forEach((anchor, i) => {
      const label = this.labels.children[i] as HTMLElement;
      const at = stage.project(anchor, this.picture);
      if (at) while (taken.some((other) => Math.abs(other.x - at.x) < 64 && Math.abs(other.y - at.y) < 22)) at.y += 23;
      const isCovered = covered.some((box) => at && at.x > box.left - 36 && at.x < box.right + 36 && at.y - 28 < box.bottom);
      label.style.visibility = at && !isCovered ? "visible" : "hidden";
      if (!at) return;
      taken.push(at);
      label.style.transform = `translate(-50%,-120%) translate(${at.x.toFixed(1)}px,${at.y.toFixed(1)}px)`;
    });
  }
}
