// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Facts beside the picture: plan, times, memory and layers. */
import { counted, el, metres, seconds } from "./elements";
import { nearestDistance } from "./memory_view";
import { originColor } from "./theme";
import { distanceUnit, primitiveName, sourceName, type Touch, touchName, type Trace } from "./trace";

export type Layer = "ends" | "tip" | "covers" | "beside" | "memory" | "components" | "samples" | "trees";

export interface PanelEvents {
  layerChanged(layer: Layer, isShown: boolean): void;
  primitiveChosen(index: number | null): void;
  touchChosen(touch: Touch): void;
}

interface Part {
  name: string;
  value: number;
  kind: string;
}

/** Splits the total time; the rest of planning is the search. */
export function timeParts(times: Record<string, number>): Part[] {
  const value = (name: string) => times[name] ?? 0;
  const memory = value("retrieval_time_s");
  const learning = value("learning_time_s");
  const parts = [
    { name: "loading", value: value("load_time_s"), kind: "load" },
    { name: "memory", value: memory, kind: "memory" },
    { name: "learning", value: learning, kind: "learning" },
    { name: "search", value: Math.max(0, value("planning_time_s") - memory - learning), kind: "search" },
    { name: "simplification", value: value("simplification_time_s"), kind: "simplify" },
    { name: "verification", value: value("verification_time_s"), kind: "verify" },
  ];
  return parts.filter((part) => part.value > 0);
}

function section(title: string, ...children: (Node | string)[]): HTMLElement {
  return el("section", {}, el("h2", {}, title), ...children);
}

function fact(name: string, value: string): Node[] {
  return [el("dt", {}, name), el("dd", {}, value)];
}

/** Easy problems are solved before memory is queried. */
function notUsed(): HTMLElement {
  return section("Memory", el("p", { class: "soft" }, "Not used: solved before --retrieve-after."));
}

export class Panel {
  private readonly rows = new Map<number, HTMLElement>();
  private readonly switches = new Map<Layer, HTMLInputElement>();
  private chosen: number | null = null;

  /** `joints` are the plots of the motion, if there is one. */
  constructor(root: HTMLElement, private readonly trace: Trace, shown: Record<Layer, boolean>,
              joints: HTMLElement | null, private readonly events: PanelEvents) {
    root.replaceChildren();
    if (trace.touches?.length) root.append(this.touches(trace.touches));
    if (trace.beside) root.append(this.comparison(trace.beside));
    if (trace.plan.planner) root.append(this.plan());
    root.append(this.layers(shown));
    if (joints) root.append(section("Joints", joints));
    if (timeParts(trace.times).length > 0) root.append(this.times());
    if (trace.primitives.length > 0) root.append(this.memory());
    else if (trace.plan.solved && sourceName(trace) === "memory" && !trace.times.retrieval_time_s) root.append(notUsed());
    if (trace.samples.shown.length > 0) root.append(this.origins());
    root.append(this.keys());
  }

  /** Shows or hides a layer as if it had been clicked. */
  toggleLayer(layer: Layer): void {
    this.switches.get(layer)?.click();
  }

  choose(index: number | null): void {
    this.chosen = index === this.chosen ? null : index;
    for (const [i, row] of this.rows) row.setAttribute("aria-pressed", String(i === this.chosen));
    this.events.primitiveChosen(this.chosen);
  }

  /** Colours follow the theme. */
  recolor(): void {
    for (const swatch of document.querySelectorAll<HTMLElement>("[data-origin]"))
      swatch.style.setProperty("--color", originColor(Number(swatch.dataset.origin)));
  }

  private plan(): HTMLElement {
    const { plan } = this.trace;
    const facts = [
      fact("planner", plan.planner), fact("sampler", plan.sampler),
      fact("planning", seconds(this.trace.times.planning_time_s ?? 0)),
      ...(plan.solved ? [fact("path", `${this.trace.vertices.length} configurations, ${plan.path_length.toFixed(2)} rad`)] : []),
      ...(this.trace.duration_s ? [fact("motion", `${this.trace.duration_s.toFixed(2)} s`)] : []),
      fact("samples", counted(plan.iterations)), fact("nodes", counted(plan.nodes)),
      fact("states checked", counted(plan.states_checked)), fact("motions checked", counted(plan.motions_checked)),
      fact("seed", `${plan.seed}, ${plan.isa}`),
    ];
    return section("Plan", el("dl", {}, ...facts.flat()));
  }

  private touches(touches: Touch[]): HTMLElement {
    const list = el("div", { class: "touches" });
    for (const touch of touches) {
      const end = touch.goal < 0 ? "start" : this.trace.goals.length > 1 ? `goal ${touch.goal}` : "goal";
      const row = el("button", { class: "touching" },
        el("span", {}, touchName(this.trace, touch), el("small", {}, `at the ${end}`)),
        el("b", {}, touch.distance < 0 ? `${metres(-touch.distance)} deep` : "touching"));
      row.addEventListener("click", () => this.events.touchChosen(touch));
      list.append(row);
    }
    return section("In contact", list);
  }

  /** Compares two plans; shorter bars are better. */
  private comparison(beside: Trace): HTMLElement {
    const sides: [Trace, string][] = [[this.trace, "mine"], [beside, "other"]];
    const rows: [string, (trace: Trace) => number, (value: number) => string][] = [
      ["planning", (trace) => trace.times.planning_time_s ?? 0, seconds],
      ["samples", (trace) => trace.plan.iterations, counted],
      ["states checked", (trace) => trace.plan.states_checked, counted],
      ["path, rad", (trace) => trace.plan.path_length, (value) => (value > 0 ? value.toFixed(2) : "none")],
    ];
    const list = el("div", { class: "versus" });
    for (const [name, of, text] of rows) {
      const most = Math.max(...sides.map(([trace]) => of(trace))) || 1;
      list.append(el("span", {}, name));
      const bars = el("div", {});
      for (const [trace, side] of sides) {
        const share = Math.max(1, (100 * of(trace)) / most);
        bars.append(el("div", {}, el("i", { class: side, style: `width:${share.toFixed(1)}%` }), el("b", {}, text(of(trace)))));
      }
      list.append(bars);
    }
    const names = sides.map(([trace, side]) => {
      const status = trace.plan.solved ? "" : `: ${trace.plan.status.replaceAll("_", " ")}`;
      return el("span", { class: side }, `${sourceName(trace)}${status}`);
    });
    return section("Comparison", el("p", { class: "legend" }, ...names), list);
  }

  private times(): HTMLElement {
    const parts = timeParts(this.trace.times);
    const total = parts.reduce((sum, part) => sum + part.value, 0) || 1;
    const bar = el("div", { class: "bar" });
    const list = el("ul", { class: "times" });
    for (const part of parts) {
      bar.append(el("i", { class: part.kind, style: `flex-grow:${part.value / total}`, title: `${part.name} ${seconds(part.value)}` }));
      list.append(el("li", { class: part.kind }, el("span", {}, part.name), el("b", {}, seconds(part.value))));
    }
    return section("Time", bar, list);
  }

  private layers(shown: Record<Layer, boolean>): HTMLElement {
    const { trace } = this;
    const entries: [Layer, string, number | null][] = [
      ["ends", "Start and goal", null],
      ["tip", "End-effector path", trace.waypoints.length > 1 ? null : 0],
      ["covers", "Checked spheres", trace.is_planar ? 0 : null],
      ["beside", `Second plan: ${trace.beside ? sourceName(trace.beside) : ""}`, trace.beside ? null : 0],
      ["memory", "Primitives", trace.primitives.length],
      ["components", "Remembered arms", trace.components.count],
      ["samples", "Samples", trace.plan.iterations && trace.samples.shown.length ? trace.plan.iterations : 0],
      ["trees", trace.plan.planner.includes("prm") ? "Roadmap" : "Trees", trace.edges.count],
    ];
    const list = el("div", { class: "layers" });
    entries.filter(([, , count]) => count !== 0).forEach(([layer, name, count], i) => {
      const input = el("input", { type: "checkbox", "data-layer": layer });
      input.checked = shown[layer];
      input.addEventListener("change", () => this.events.layerChanged(layer, input.checked));
      this.switches.set(layer, input);
      list.append(el("label", {}, input, el("span", {}, name),
        el("small", {}, count === null ? "" : counted(count)), el("kbd", {}, String(i + 1))));
    });
    return section("Show", list);
  }

  /** Layers in the order of their keys. */
  get layerOrder(): Layer[] {
    return [...this.switches.keys()];
  }

  private memory(): HTMLElement {
    const list = el("div", { class: "primitives" });
    const order = this.trace.primitives.map((_, i) => i).sort((a, b) => this.rank(a) - this.rank(b));
    for (const index of order) list.append(this.primitiveRow(index));
    const retrieved = this.trace.primitives.filter((p) => p.similarity_errors.length > 0).length;
    const note = `${retrieved} of ${this.trace.primitives.length} primitives have a match. ` +
      "The number is the distance to the nearest key. Click a primitive to show it alone.";
    return section("Memory", el("p", { class: "soft" }, note), list);
  }

  private rank(index: number): number {
    return nearestDistance(this.trace.primitives[index]!) ?? Infinity;
  }

  private primitiveRow(index: number): HTMLElement {
    const primitive = this.trace.primitives[index]!;
    const distance = nearestDistance(primitive);
    const count = primitive.similarity_errors.length;
    const detail = distance === null
      ? "no match"
      : `${count} match${count === 1 ? "" : "es"}, ${counted(primitive.components)} arms` +
        (primitive.is_learned ? ", learned now" : "");
    const row = el("button", { class: distance === null ? "primitive none" : "primitive", "aria-pressed": "false" },
      el("i", { "data-origin": String(index) }),
      el("span", { class: "name" }, primitiveName(this.trace, primitive), el("small", {}, detail)),
      el("b", {}, distance === null ? "" : `${distance.toFixed(3)} ${distanceUnit(primitive)}`));
    row.addEventListener("click", () => this.choose(index));
    this.rows.set(index, row);
    return row;
  }

  private origins(): HTMLElement {
    const sources: [number, string, number][] = [[-1, "uniform", this.trace.samples.uniform_draws]];
    this.trace.primitives.forEach((p, i) => {
      if (p.draws > 0) sources.push([i, primitiveName(this.trace, p), p.draws]);
    });
    const most = Math.max(...sources.map(([, , draws]) => draws));
    const list = el("ul", { class: "origins" });
    for (const [origin, name, draws] of sources.sort((a, b) => b[2] - a[2]).slice(0, 12)) {
      const bar = el("i", { "data-origin": String(origin), style: `width:${Math.max(1.5, (100 * draws) / most)}%` });
      list.append(el("li", {}, el("span", {}, name), el("b", {}, counted(draws)), el("div", { class: "draws" }, bar)));
    }
    return section("Samples by source", list);
  }

  private keys(): HTMLElement {
    const rows: [string, string][] = [
      ["space", "play, pause"], ["\u2190 \u2192", "step (with shift: next waypoint of the path)"],
      ["home end", "start, goal"], ["1 \u2026 8", "layers"], ["r", "reset the view"], ["t", "light, dark"], ["p", "panel"],
    ];
    return section("Keys", el("dl", { class: "keys" }, ...rows.flatMap(([key, what]) =>
      [el("dt", {}, ...key.split(" ").map((k) => (k === "\u2026" ? k : el("kbd", {}, k)))), el("dd", {}, what)])));
  }
}
