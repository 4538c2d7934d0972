// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Puts the page together: panes on the stage, panel, dock, keys. */
import { Dock } from "./dock";
import { el, icon, seconds } from "./elements";
import { JointPlots } from "./joints";
import { Pane } from "./pane";
import { type Layer, Panel } from "./panel";
import { RobotShape } from "./solid_robot";
import { Stage } from "./stage";
import { toggleTheme } from "./theme";
import { sourceName, type Touch, type Trace } from "./trace";

const NARROW = 720;

export class Viewer {
  readonly stage: Stage;
  panes: Pane[] = [];
  dock!: Dock;
  private panel!: Panel;
  private joints: JointPlots | null = null;
  private readonly shown: Record<Layer, boolean>;
  private chosen: number | null = null;
  private readonly shape: RobotShape;
  /** Called after panes have been built anew. */
  onBuild: () => void = () => {};

  constructor(private trace: Trace) {
    const isPlanar = trace.is_planar;
    // In the plane remembered arms and search at once would be too much, unless search is all there is; in space
    // samples and trees hide the arm.
    const isSearchShown = isPlanar && trace.waypoints.length === 0 && !trace.live;
    this.shown = {
      ends: true, tip: true, covers: false, beside: true, memory: true, components: isPlanar, samples: isSearchShown,
      trees: isSearchShown,
    };
    this.shape = new RobotShape(isPlanar ? [] : trace.links);
    this.stage = new Stage(document.getElementById("canvas") as HTMLCanvasElement, isPlanar);
    this.writeTools();
    this.show(trace);
    this.stage.resetView();
    this.stage.onDraw((picture) => this.panes[picture]?.placeLabels(this.stage));
    window.addEventListener("keydown", (event) => this.press(event));
    window.addEventListener("resize", () => this.layOut());
    if (window.innerWidth < NARROW) document.body.classList.add("closed");
    this.layOut();
    const [touch] = trace.touches ?? [];
    if (touch) this.lookAt(touch);
  }

  /** Shows another trace of the same robot from where the camera is, until the view is reset. */
  show(trace: Trace): void {
    this.trace = trace;
    this.chosen = null;
    const wasPlaying = this.dock?.isPlaying ?? false;
    this.dock?.remove();
    for (const pane of this.panes) pane.remove();
    const traces = trace.beside ? [trace, trace.beside] : [trace];
    this.panes = traces.map((each, i) => new Pane(each, this.shape, this.stage.scenes[i]!, i));
    const { motion } = this.panes[0]!;
    this.joints = motion.isEmpty ? null : new JointPlots(trace, motion, (fraction) => this.dock.seek(fraction));
    this.writeHead();
    this.panel = new Panel(document.getElementById("panel")!, trace, this.shown,
      this.joints?.object ?? null, {
        layerChanged: (layer, isShown) => this.changeLayer(layer, isShown),
        primitiveChosen: (index) => {
          this.chosen = index;
          this.refresh();
        },
        touchChosen: (touch) => this.lookAt(touch),
      });
    this.stage.setView(this.panes[0]!.view);
    this.dock = new Dock(document.getElementById("dock")!, trace, motion, (fraction) => this.move(fraction));
    this.build();
    this.layOut();
    if (wasPlaying) this.dock.toggle();
  }

  /** All that depends on the theme, anew. */
  build(): void {
    for (const pane of this.panes) pane.build(this.shown.covers ? "covers" : "looks");
    this.stage.applyTheme();
    this.panel.recolor();
    this.refresh();
    this.move(Math.min(1, this.dock.fraction));
    this.onBuild();
  }

  lookAt(touch: Touch): void {
    this.stage.focus(this.panes[0]!.touchBox(touch));
  }

  tip(): number[] | null {
    return this.panes[0]!.motion.at(Math.min(1, this.dock.fraction))?.tip.toArray() ?? null;
  }

  private changeLayer(layer: Layer, isShown: boolean): void {
    this.shown[layer] = isShown;
    if (layer === "covers") this.build();
    else this.refresh();
    if (layer === "beside") this.layOut();
  }

  private refresh(): void {
    for (const [i, pane] of this.panes.entries()) pane.refresh(this.shown, i === 0 ? this.chosen : null);
    const count = this.panes.length > 1 && this.shown.beside && window.innerWidth >= NARROW ? 2 : 1;
    document.body.classList.toggle("split", count > 1);
    this.stage.setCount(count);
    this.stage.invalidate();
  }

  private move(fraction: number): void {
    const own = this.panes[0]!.motion.duration;
    for (const pane of this.panes) {
      const other = pane.motion.duration;
      pane.move(own !== null && other !== null ? Math.min(1, (fraction * own) / other) : fraction);
    }
    this.joints?.show(fraction);
    this.stage.invalidate();
  }

  private writeHead(): void {
    const { trace } = this;
    const { plan } = trace;
    const status = el("span", { class: plan.solved ? "status solved" : "status failed" }, plan.status.replaceAll("_", " "));
    document.getElementById("head")!.replaceChildren(
      el("h1", {}, trace.problem || "plan", ...(plan.status ? [status] : [])),
      el("p", {}, [trace.robot, plan.planner, plan.sampler].filter((name) => name).join(" \u00b7 ")),
      ...(this.stage.hasGraphics ? [] : [el("p", { id: "simplified" }, "Simplified picture: this browser has no WebGL 2.")]));
    const names = trace.beside ? [trace, trace.beside] : [];
    document.getElementById("sides")!.replaceChildren(...names.map((side) => el("p", { class: "side" },
      el("b", {}, sourceName(side)),
      el("span", {}, `${seconds(side.times.planning_time_s ?? 0)}, ${side.plan.iterations} samples`))));
  }

  private writeTools(): void {
    const buttons: [Parameters<typeof icon>[0], string, () => void][] = [
      ["reset", "Reset the view (r)", () => this.stage.resetView()],
      ["theme", "Light or dark (t)", () => toggleTheme(() => this.build())],
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
    const edit = document.getElementById("edit")?.offsetHeight ?? -8;
    const dock = document.getElementById("dock")!.offsetHeight + edit + 8;
    const head = document.getElementById("head")!.offsetHeight;
    const right = !isNarrow && isOpen ? panel.offsetWidth + 16 : 0;
    document.getElementById("sides")!.style.right = `${right}px`;
    this.stage.setInsets({
      top: head, left: 0, right, bottom: dock + 16 + (isNarrow && isOpen ? panel.offsetHeight : 0),
    });
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const isButton = event.target instanceof HTMLElement && event.target.matches("button, input, select");
    const step = event.shiftKey ? null : 0.01;
    const actions: Record<string, () => void> = {
      ArrowRight: () => (step ? this.dock.seek(this.dock.fraction + step) : this.dock.jump(1)),
      ArrowLeft: () => (step ? this.dock.seek(Math.min(1, this.dock.fraction) - step) : this.dock.jump(-1)),
      Home: () => this.dock.seek(0),
      End: () => this.dock.seek(1),
      r: () => this.stage.resetView(),
      t: () => toggleTheme(() => this.build()),
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
