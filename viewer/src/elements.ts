// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Elements by a few words. */

type Child = Node | string | null;

export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Record<string, string> = {}, ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  for (const child of children) if (child !== null) element.append(child);
  return element;
}

export function svg(tag: string, attributes: Record<string, string | number> = {}, ...children: Node[]): SVGElement {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

const PATHS = {
  play: "M7 4.5v15l12.5-7.5z",
  pause: "M6.5 4.5h4v15h-4zM13.5 4.5h4v15h-4z",
  reset: "M12 5V2L7.5 6 12 10V7a5 5 0 1 1-5 5H5a7 7 0 1 0 7-7z",
  theme: "M12 3a9 9 0 1 0 0 18zM12 3a9 9 0 0 1 0 18",
  panel: "M3 5h18v2H3zm0 6h18v2H3zm0 6h18v2H3z",
  loop: "M7 7h9V4l4.5 4L16 12V9H9v3H7zM17 17H8v3l-4.5-4L8 12v3h7v-3h2z",
};

export function icon(name: keyof typeof PATHS): SVGElement {
  const path = svg("path", { d: PATHS[name] });
  if (name === "theme") path.setAttribute("class", "half");
  return svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, path);
}

export function seconds(value: number): string {
  if (value >= 1) return `${value.toFixed(2)} s`;
  if (value >= 1e-3) return `${(1e3 * value).toPrecision(3)} ms`;
  return value > 0 ? `${Math.round(1e6 * value)} \u00b5s` : "0";
}

export function metres(value: number): string {
  const size = Math.abs(value);
  if (size < 0.01) return `${(1e3 * value).toFixed(1)} mm`;
  return size < 1 ? `${(1e2 * value).toFixed(1)} cm` : `${value.toFixed(2)} m`;
}

export function counted(value: number): string {
  return value.toLocaleString("en-US").replaceAll(",", "\u202f");
}
