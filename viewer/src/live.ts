// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** The page of a service, or one that plans by itself: the goal of the hand and obstacles can be dragged, and each release is planned. */
import {
  Group, Matrix4, Mesh, MeshBasicMaterial, Object3D, Plane, Raycaster, SphereGeometry, Vector2, Vector3,
} from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import { el, seconds } from "./elements";
import { OwnPlanner, type Reply } from "./own_planner";
import { geometryOf, poseMatrix, poseOf } from "./shapes";
import { SolidRobot } from "./solid_robot";
import { pathColor } from "./theme";
import type { Live, Obstacle, Pose, Shape, Trace } from "./trace";
import type { Viewer } from "./viewer";

/** Pixels around the goal that take hold of it. */
const GRIP = 16;
const TIMEOUT = 10;

interface Answer {
  id: string;
  status: string;
  path: number[][];
}

/** An obstacle of the page; its shapes stay as they came, `moved` says where they have gone. */
interface Body {
  name: string;
  shapes: Shape[];
  moved: Matrix4;
  scale: number;
}

type Selected = "goal" | Body;

/** What a click makes. */
const MAKERS: [string, (size: number) => Shape][] = [
  ["Box", (size) => ({ type: "box", pose: [0, 0, 0, 0, 0, 0, 1], size: [size, size, size] })],
  ["Ball", (size) => ({ type: "sphere", sphere: [0, 0, 0, size / 2] })],
  ["Cylinder", (size) => ({ type: "cylinder", pose: [0, 0, 0, 0, 0, 0, 1], radius: size / 3, length: 1.5 * size })],
];

/** What a request holds; the rest stays where it is. */
function isMovable({ type }: Shape): boolean {
  return type === "sphere" || type === "capsule" || type === "box" || type === "cylinder";
}

function movedShape(shape: Shape, matrix: Matrix4, scale: number): Shape {
  const point = (list: number[], at: number) => new Vector3().fromArray(list, at).multiplyScalar(scale).applyMatrix4(matrix).toArray();
  const pose = (old: Pose): Pose => {
    const scaled = poseMatrix([...old.slice(0, 3).map((value) => scale * value), ...old.slice(3)]);
    return poseOf(matrix.clone().multiply(scaled));
  };
  switch (shape.type) {
    case "sphere": return { type: "sphere", sphere: [...point(shape.sphere, 0), scale * shape.sphere[3]!] };
    case "capsule":
      return { type: "capsule", capsule: [...point(shape.capsule, 0), ...point(shape.capsule, 3), scale * shape.capsule[6]!] };
    case "box": return { ...shape, pose: pose(shape.pose), size: shape.size.map((value) => scale * value) };
    case "cylinder":
      return { ...shape, pose: pose(shape.pose), radius: scale * shape.radius, length: scale * shape.length };
    default: return shape;
  }
}

/** As compact files spell it. */
function requested(name: string, shape: Shape): object {
  const placed = (pose: Pose) => ({ p: pose.slice(0, 3), q: [pose[6], pose[3], pose[4], pose[5]] });
  const common = { name, type: shape.type };
  switch (shape.type) {
    case "sphere": return { ...common, p: shape.sphere.slice(0, 3), radius: shape.sphere[3] };
    case "capsule":
      return { ...common, a: shape.capsule.slice(0, 3), b: shape.capsule.slice(3, 6), radius: shape.capsule[6] };
    case "box": return { ...common, ...placed(shape.pose), size: shape.size };
    case "cylinder": return { ...common, ...placed(shape.pose), radius: shape.radius, length: shape.length };
    default: throw new Error(`${name}: ${shape.type} cannot be sent`);
  }
}

/** As fetch(), whose own words for a service that has gone tell nobody what to do. */
async function reachService(path: string, body: string | null, signal: AbortSignal): Promise<Reply> {
  const options = body === null ? {} : { method: "POST", headers: { "Content-Type": "application/json" }, body };
  try {
    const response = await fetch(path, { ...options, signal });
    return { status: response.status, json: await response.json() };
  } catch (error) {
    if (signal.aborted) throw error;
    throw new Error("the service does not answer: restart it, then reload the page");
  }
}

export class LivePage {
  private readonly bodies: Body[];
  private start: number[];
  private tip = 0;
  private goal: Matrix4;
  private seed = 1;
  private selected: Selected = "goal";
  private hasBeside: boolean;
  private isUsedAtOnce = false;
  private readonly hand = new Group();
  private readonly handle = new Object3D();
  private readonly gizmo: TransformControls;
  private readonly raycaster = new Raycaster();
  private readonly note = el("output", { id: "note" });
  private readonly bar = el("div", { id: "edit" });
  private running: AbortController | null = null;
  private reached: number[] | null = null;
  private readonly reach: typeof reachService;
  /** Plans that have been shown. */
  count = 0;

  constructor(private readonly viewer: Viewer, private readonly first: Trace, private readonly live: Live) {
    this.start = live.start;
    const { planner } = live;
    if (planner) {
      const own = new OwnPlanner(planner);
      this.reach = (path, body, signal) => own.reach(path, body, signal);
    } else {
      this.reach = reachService;
    }
    this.hasBeside = live.has_memory;
    this.goal = poseMatrix(live.tips[0]?.pose ?? [0, 0, 0, 0, 0, 0, 1]);
    this.bodies = first.obstacles.filter(({ shapes }) => shapes.every(isMovable))
      .map(({ name, shapes }) => ({ name, shapes, moved: new Matrix4(), scale: 1 }));
    const { stage } = viewer;
    this.gizmo = new TransformControls(stage.camera, stage.canvas);
    this.gizmo.setSize(0.72);
    if (stage.isPlanar) Object.assign(this.gizmo, { showZ: false });
    this.connectGizmo();
    stage.scenes[0]!.add(this.hand, this.handle, this.gizmo.getHelper());
    stage.canvas.parentElement!.addEventListener("pointerdown", (event) => this.grab(event), { capture: true });
    window.addEventListener("keydown", (event) => this.press(event));
    viewer.onBuild = () => this.drawHand();
    document.body.classList.add("live");
    this.writeBar();
    document.getElementById("stage")!.after(this.bar);
    window.dispatchEvent(new Event("resize"));
    this.drawHand();
    this.select("goal");
    void this.plan();
  }

  /** Where the goal is, as the service is told. */
  goalPosition(): number[] {
    return new Vector3().setFromMatrixPosition(this.goal).toArray();
  }

  obstaclePosition(name: string): number[] | null {
    const body = this.bodies.find((each) => each.name === name);
    return body ? this.middle(body).toArray() : null;
  }

  /** Where the link that the goal is for ends up; null without a plan. */
  reachedPosition(): number[] | null {
    const end = this.viewer.panes[0]!.trace.waypoints.at(-1);
    const [carried] = this.live.tips[this.tip]!.carries;
    if (!end || !carried) return null;
    const pose = poseMatrix(end.poses[carried.link]!).multiply(poseMatrix(carried.pose).invert());
    return new Vector3().setFromMatrixPosition(pose).toArray();
  }

  private obstacles(): Obstacle[] {
    return this.bodies.map(({ name, shapes, moved, scale }) =>
      ({ name, shapes: shapes.map((shape) => movedShape(shape, moved, scale)) }));
  }

  // ------------------------------------------------------------------------------------------------ asking

  private request(sampler: string | null): object {
    const pose = poseOf(this.goal);
    const goal: Record<string, unknown> = { link: this.live.tips[this.tip]!.link, position: pose.slice(0, 3) };
    if (!this.first.is_planar) goal.quat_xyzw = pose.slice(3);
    const settings = {
      seed: this.seed, timeout: TIMEOUT, ...(sampler ? { sampler } : {}), ...(this.isUsedAtOnce && !sampler ? { "retrieve-after": 0 } : {}),
    };
    const obstacles = this.obstacles().flatMap(({ name, shapes }) => shapes.map((shape, i) =>
      (shapes.length > 1 ? { body: name, ...requested(`${name} ${i + 1}`, shape) } : requested(name, shape))));
    const { scene, constraints } = this.live;
    // Where a plan has ended the robot is at rest.
    const velocity = this.start === this.live.start && this.live.start_velocity.length > 0 ? { start_velocity: this.live.start_velocity } : {};
    const isGone = (name: string): boolean => this.first.obstacles.some((body) => body.name === name && body.shapes.every(isMovable))
      && !this.bodies.some((body) => body.name === name);
    const allow = this.live.allow.filter((one) => !(Array.isArray(one) ? one : one.pair).some(isGone));
    return {
      name: this.first.problem, start: this.start, goal, obstacles, settings, trace: true, ...(scene ? { scene } : {}), allow,
      constraints, ...velocity, ...(sampler ? { remember: false } : {}),
    };
  }

  private async ask(sampler: string | null, signal: AbortSignal): Promise<{ answer: Answer; trace: Trace }> {
    const { status, json: answer } = await this.reach("/v1/plan", JSON.stringify(this.request(sampler)), signal);
    if (status !== 200) throw new Error(answer.error?.message ?? `the service answers ${status}`);
    const traced = await this.reach(`/v1/plans/${answer.id}/trace`, null, signal);
    if (traced.status !== 200) throw new Error("the service has no trace of the plan");
    return { answer, trace: this.adopted(traced.json) };
  }

  /** A trace of a plan with the links of the first one, which may have more: those that are only seen. */
  private adopted(trace: Trace): Trace {
    const { links } = this.first;
    const place = new Map(trace.links.map((link, i) => [link.name, i]));
    const back = trace.links.map((link) => links.findIndex(({ name }) => name === link.name));
    const poses = (given: Pose[]): Pose[] => {
      const all = links.map((link, i) => {
        const at = place.get(link.name);
        return at === undefined ? this.first.start[i]! : given[at]!;
      });
      for (const { link, to, pose } of this.live.welds) {
        all[link] = poseOf(poseMatrix(all[to]!).multiply(poseMatrix(pose)));
      }
      return all;
    };
    trace.start = poses(trace.start);
    trace.goals = trace.goals.map(poses);
    for (const waypoint of trace.waypoints) {
      waypoint.poses = poses(waypoint.poses);
      waypoint.nearest[0] = back[waypoint.nearest[0]] ?? -1;
    }
    for (const touch of trace.touches ?? []) {
      touch.link = back[touch.link] ?? 0;
      if (touch.is_self) touch.other = back[touch.other] ?? 0;
    }
    trace.links = links;
    return trace;
  }

  /** Plans from memory, and uniformly beside it; a plan that is under way is given up. */
  async plan(): Promise<void> {
    this.running?.abort();
    const controller = new AbortController();
    this.running = controller;
    this.say("planning\u2026");
    try {
      const { answer, trace } = await this.ask(null, controller.signal);
      if (this.live.has_memory && this.hasBeside) {
        trace.beside = (await this.ask("uniform", controller.signal)).trace;
      }
      this.reached = answer.path.at(-1) ?? null;
      this.viewer.show(trace);
      this.setView();
      this.placeHandle();
      const own = trace.plan.solved ? `planned in ${seconds(trace.times.planning_time_s ?? 0)}` : trace.plan.message;
      this.say(own, !trace.plan.solved);
      if (trace.plan.solved && !this.viewer.stage.isSlow) {
        this.viewer.dock.seek(0);
        this.viewer.dock.toggle();
      } else {
        this.viewer.dock.seek(0.45);
      }
      ++this.count;
    } catch (error) {
      if (controller.signal.aborted) return;
      this.say((error as Error).message, true);
    }
  }

  private setView(): void {
    const { stage, panes } = this.viewer;
    const { view } = panes[0]!;
    // What can be dragged is to be seen.
    view.box.expandByPoint(new Vector3().setFromMatrixPosition(this.goal));
    for (const body of this.bodies) view.box.expandByPoint(this.middle(body));
    stage.setView(view);
    if (this.count === 0) stage.resetView();
  }

  private say(text: string, isBad = false): void {
    this.note.textContent = text;
    this.note.title = text;
    this.note.className = isBad ? "bad" : "";
  }

  // ----------------------------------------------------------------------------------------------- showing

  /** The goal as the hand there, or as a dot in the plane. */
  private drawHand(): void {
    this.hand.clear();
    const color = `#${pathColor(1).getHexString()}`;
    const carries = this.live.tips[this.tip]?.carries ?? [];
    if (this.first.is_planar || carries.length === 0) {
      const radius = this.first.is_planar ? 0.16 : 0.03;
      const ball = new Mesh(new SphereGeometry(radius, 24, 16), new MeshBasicMaterial({ color, depthTest: false, transparent: true }));
      ball.renderOrder = 40;
      ball.applyMatrix4(this.goal);
      this.hand.add(ball);
    } else {
      const robot = new SolidRobot(this.viewer.panes[0]!.shape,
        { color, carriedColor: color, opacity: 0.75, skin: "looks", shade: null }, new Set(carries.map(({ link }) => link)));
      const poses = this.first.start.slice();
      for (const { link, pose } of carries) poses[link] = poseOf(this.goal.clone().multiply(poseMatrix(pose)));
      robot.setPoses(poses);
      this.hand.add(robot.object);
    }
    this.viewer.stage.invalidate();
  }

  private middle(body: Body): Vector3 {
    const box = body.shapes.map((shape) => geometryOf(movedShape(shape, body.moved, body.scale))!);
    const center = new Vector3();
    for (const geometry of box) {
      geometry.computeBoundingSphere();
      center.add(geometry.boundingSphere!.center);
      geometry.dispose();
    }
    return center.divideScalar(Math.max(1, box.length));
  }

  private select(selected: Selected): void {
    this.selected = selected;
    this.placeHandle();
    this.gizmo.attach(this.handle);
    for (const button of this.bar.querySelectorAll<HTMLButtonElement>("[data-of=obstacle]")) button.disabled = selected === "goal";
    this.viewer.stage.invalidate();
  }

  private placeHandle(): void {
    const pose = this.selected === "goal" ? this.goal : new Matrix4().copyPosition(
      new Matrix4().setPosition(this.middle(this.selected)));
    pose.decompose(this.handle.position, this.handle.quaternion, this.handle.scale);
    this.handle.updateMatrixWorld(true);
    this.gizmo.setSpace(this.selected === "goal" ? "local" : "world");
  }

  /** What shows an obstacle; nothing where no plan with it has been shown. */
  private groupsOf({ name }: Body, panes = this.viewer.panes): Group[] {
    return panes.flatMap(({ scene }) => scene.groups.filter((_, i) => scene.obstacles[i]!.name === name));
  }

  /** Moves what is selected by `by`, a motion in the world. */
  private carry(by: Matrix4): void {
    if (this.selected === "goal") {
      this.goal.premultiply(by);
      this.drawHand();
    } else {
      this.selected.moved.premultiply(by);
      for (const group of this.groupsOf(this.selected)) group.applyMatrix4(by);
    }
    this.viewer.stage.invalidate();
  }

  // ---------------------------------------------------------------------------------------------- dragging

  private connectGizmo(): void {
    const { stage } = this.viewer;
    const before = new Matrix4();
    this.gizmo.addEventListener("dragging-changed", (event) => {
      stage.controls.enabled = !event.value;
      this.handle.updateMatrix();
      before.copy(this.handle.matrix);
      if (!event.value) void this.plan();
    });
    this.gizmo.addEventListener("objectChange", () => {
      this.handle.updateMatrix();
      this.carry(this.handle.matrix.clone().multiply(before.clone().invert()));
      before.copy(this.handle.matrix);
    });
    this.gizmo.addEventListener("change", () => stage.invalidate());
    // The gizmo stands in the first picture, which may be a part of the canvas.
    Object.assign(this.gizmo, {
      _getPointer: (event: PointerEvent) => {
        const box = stage.canvas.getBoundingClientRect();
        const { at } = stage.locate(event.clientX - box.left, event.clientY - box.top);
        stage.aim(0);
        return { x: at.x, y: at.y, button: event.button };
      },
    });
  }

  /** What stands at these pixels, and where it is hit. */
  private pick(x: number, y: number): { what: Selected; at: Vector3; picture: number; isGrip: boolean } | null {
    const { stage, panes } = this.viewer;
    const goal = stage.project(new Vector3().setFromMatrixPosition(this.goal));
    const { picture, at } = stage.locate(x, y);
    if (goal && picture === 0 && Math.hypot(goal.x - x, goal.y - y) < GRIP) {
      return { what: "goal", at: new Vector3().setFromMatrixPosition(this.goal), picture, isGrip: true };
    }
    this.aimRay(at, picture);
    const owners = new Map<Object3D, Selected>(picture === 0 ? [[this.hand, "goal"]] : []);
    for (const body of this.bodies) for (const group of this.groupsOf(body, panes.slice(picture, picture + 1))) owners.set(group, body);
    const [hit] = this.raycaster.intersectObjects([...owners.keys()], true).filter(({ object }) => object instanceof Mesh && object.renderOrder !== -1);
    if (!hit) return null;
    let part: Object3D | null = hit.object;
    while (part && !owners.has(part)) part = part.parent;
    return part && { what: owners.get(part)!, at: hit.point, picture, isGrip: false };
  }

  private aimRay(at: Vector2, picture: number): void {
    this.viewer.stage.aim(picture);
    this.raycaster.setFromCamera(at, this.viewer.stage.camera);
  }

  /** Takes hold of what is under the pointer, unless that is the gizmo. */
  private grab(event: PointerEvent): void {
    const { stage } = this.viewer;
    if (event.button !== 0 || event.target !== stage.canvas) return;
    const box = stage.canvas.getBoundingClientRect();
    const found = this.pick(event.clientX - box.left, event.clientY - box.top);
    // At its own place the goal goes before the handles around it.
    if (!found || (this.gizmo.axis !== null && !found.isGrip)) return;
    event.stopPropagation();
    event.preventDefault();
    this.select(found.what);
    // Obstacles slide over their floor, the goal in the plane of the picture; with shift both go up and down.
    const towards = stage.camera.getWorldDirection(new Vector3());
    const normal = stage.isPlanar || (found.what !== "goal" && !event.shiftKey) ? new Vector3(0, 0, 1)
      : event.shiftKey ? towards.setZ(0).normalize() : towards;
    const plane = new Plane().setFromNormalAndCoplanarPoint(normal, found.at);
    let last: Vector3 | null = null;
    let isMoved = false;
    const where = (at: PointerEvent): Vector3 | null => {
      const located = stage.locate(at.clientX - box.left, at.clientY - box.top);
      this.aimRay(located.at, found.picture);
      return located.picture === found.picture ? this.raycaster.ray.intersectPlane(plane, new Vector3()) : null;
    };
    const move = (at: PointerEvent) => {
      const here = where(at);
      if (here && last) {
        const step = here.clone().sub(last);
        if (event.shiftKey) step.set(0, 0, step.z);
        if (stage.isPlanar) step.setZ(0);
        isMoved = isMoved || step.length() > 0;
        this.carry(new Matrix4().makeTranslation(step));
        this.placeHandle();
      }
      last = here ?? last;
    };
    const release = () => {
      window.removeEventListener("pointermove", move);
      window.removeEventListener("pointerup", release);
      window.removeEventListener("pointercancel", release);
      if (isMoved) void this.plan();
    };
    move(event);
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", release);
    window.addEventListener("pointercancel", release);
  }

  private press(event: KeyboardEvent): void {
    if (event.target instanceof HTMLElement && event.target.matches("input, select")) return;
    if (event.key === "Delete" || event.key === "Backspace") this.removeSelected();
    if (event.key === "g") this.toggleMode();
  }

  // ----------------------------------------------------------------------------------------------- the bar

  private writeBar(): void {
    const button = (text: string, title: string, id: string, action: () => void, of = "") => {
      const made = el("button", { title, id, ...(of ? { "data-of": of } : {}) }, text);
      made.addEventListener("click", () => {
        action();
        made.blur();
      });
      return made;
    };
    if (this.live.tips.length > 1) {
      const choice = el("select", { id: "tip", title: "The link that must reach the goal" },
        ...this.live.tips.map(({ link }, i) => el("option", { value: String(i) }, link)));
      choice.addEventListener("change", () => this.chooseTip(Number(choice.value)));
      this.bar.append(choice);
    }
    for (const [name, make] of MAKERS) {
      if (this.first.is_planar && name !== "Ball") continue;
      this.bar.append(button(`+ ${name}`, `Add a ${name.toLowerCase()} to the scene`, `add-${name.toLowerCase()}`, () => this.add(name, make)));
    }
    this.bar.append(
      button("\u2212", "Make the obstacle smaller", "smaller", () => this.resize(1 / 1.15), "obstacle"),
      button("\u002b", "Make the obstacle larger", "larger", () => this.resize(1.15), "obstacle"),
      button("Remove", "Remove the obstacle (delete)", "remove", () => this.removeSelected(), "obstacle"),
      button("Turn", "Move or turn with the handles (g)", "turn", () => this.toggleMode()),
      button("Start here", "Start from the reached goal", "restart", () => this.restart()),
      button("New seed", "Plan again with another seed", "seed", () => {
        ++this.seed;
        void this.plan();
      }));
    if (this.live.has_memory) {
      this.addSwitch("with-uniform", "compare with uniform", this.hasBeside, (isOn) => (this.hasBeside = isOn));
      this.addSwitch("at-once", "memory at once", this.isUsedAtOnce, (isOn) => (this.isUsedAtOnce = isOn));
    }
    this.bar.append(this.note);
  }

  private addSwitch(id: string, text: string, isOn: boolean, change: (isOn: boolean) => void): void {
    const input = el("input", { type: "checkbox", id });
    input.checked = isOn;
    input.addEventListener("change", () => {
      change(input.checked);
      void this.plan();
    });
    this.bar.append(el("label", {}, input, text));
  }

  private chooseTip(tip: number): void {
    this.tip = tip;
    this.goal = poseMatrix(this.live.tips[tip]!.pose);
    this.drawHand();
    this.select("goal");
    void this.plan();
  }

  private toggleMode(): void {
    const isMoving = this.gizmo.mode === "translate";
    this.gizmo.setMode(isMoving ? "rotate" : "translate");
    if (this.viewer.stage.isPlanar) Object.assign(this.gizmo, { showX: !isMoving, showY: !isMoving, showZ: isMoving });
    document.getElementById("turn")!.textContent = isMoving ? "Move" : "Turn";
    this.viewer.stage.invalidate();
  }

  private add(kind: string, make: (size: number) => Shape): void {
    const names = new Set([...this.bodies, ...this.first.obstacles].map(({ name }) => name));
    let number = 1;
    while (names.has(`${kind.toLowerCase()} ${number}`)) ++number;
    const view = this.viewer.panes[0]!.view.box;
    const size = this.first.is_planar ? 1 : 0.16;
    const at = view.getCenter(new Vector3());
    // Beside the goal, on the side of the start: in the way.
    at.lerp(new Vector3().setFromMatrixPosition(this.goal), 0.6);
    if (this.first.is_planar) at.setZ(0);
    const added = { name: `${kind.toLowerCase()} ${number}`, shapes: [make(size)], moved: new Matrix4().setPosition(at), scale: 1 };
    this.bodies.push(added);
    this.selected = added;
    void this.plan().then(() => this.bodies.includes(added) && this.select(added));
  }

  private resize(by: number): void {
    if (this.selected === "goal") return;
    const body = this.selected;
    const middle = this.middle(body);
    body.scale *= by;
    body.moved.premultiply(new Matrix4().makeTranslation(middle.sub(this.middle(body))));
    void this.plan();
  }

  private removeSelected(): void {
    if (this.selected === "goal") return;
    // Also if nothing can be planned and shown then.
    for (const group of this.groupsOf(this.selected)) group.visible = false;
    this.bodies.splice(this.bodies.indexOf(this.selected), 1);
    this.select("goal");
    void this.plan();
  }

  private restart(): void {
    if (!this.reached) return;
    this.start = this.reached;
    void this.plan();
  }
}
