// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Colours that mean something: the same as in mneme's SVG pictures. */
import { Color, ColorManagement } from "three";

ColorManagement.enabled = false;

const START = new Color(0x1f5fd0);
const MIDDLE = new Color(0x964aaa);
const GOAL = new Color(0xd9303a);

/** From the blue of the start to the red of the goal. */
export function pathColor(fraction: number): Color {
  const t = Math.min(1, Math.max(0, fraction));
  const color = t < 0.5 ? START.clone().lerp(MIDDLE, 2 * t) : MIDDLE.clone().lerp(GOAL, 2 * t - 1);
  return isDark() ? color.lerp(new Color(0xffffff), 0.22) : color;
}

const PRIMITIVES_LIGHT = [
  "#c76a00", "#0b8a6a", "#8250df", "#bf2c86", "#0a7ea4", "#5f8416", "#8f5a2c", "#a8323e", "#4a5bb5", "#7a6a00",
];
const PRIMITIVES_DARK = [
  "#f0a04b", "#4cc3a1", "#b79bff", "#f07fc0", "#58c4e8", "#a9cf5a", "#d3a06c", "#ff8f98", "#98a8ff", "#d8c64a",
];

/** Of samples from a primitive's experience; of uniform ones if `origin` is negative. */
export function originColor(origin: number): string {
  if (origin < 0) return isDark() ? "#8b98ab" : "#6b7687";
  const colors = isDark() ? PRIMITIVES_DARK : PRIMITIVES_LIGHT;
  return colors[origin % colors.length]!;
}

/** Of what touches. */
export function touchColor(): string {
  return isDark() ? "#ff5a4d" : "#e01e10";
}

export interface Palette {
  background: string;
  grid: string;
  obstacle: string;
  obstacleEdge: string;
  robot: string;
  robotAccent: string;
  trees: [string, string];
  halo: string;
  shadow: number;
}

const LIGHT: Palette = {
  background: "#eef2f8", grid: "#ccd5e3", obstacle: "#b7c5d9", obstacleEdge: "#8696ad",
  robot: "#f3eee6", robotAccent: "#f2a33c", trees: ["#1f5fd0", "#d9303a"], halo: "#ffffff", shadow: 0.16,
};
const DARK: Palette = {
  background: "#10151d", grid: "#2a3443", obstacle: "#50617a", obstacleEdge: "#7c8da8",
  robot: "#ccd1da", robotAccent: "#f2a33c", trees: ["#6ea0ff", "#ff7a80"], halo: "#10151d", shadow: 0.5,
};

export type Theme = "light" | "dark";

export function isDark(): boolean {
  return document.documentElement.dataset.theme === "dark";
}

export function palette(): Palette {
  return isDark() ? DARK : LIGHT;
}

/** Takes the system's theme, or that of `?theme=`; calls `changed` whenever it changes. */
export function initTheme(changed: () => void): void {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const asked = new URLSearchParams(location.search).get("theme");
  const set = (theme: Theme) => {
    document.documentElement.dataset.theme = theme;
    changed();
  };
  set(asked === "dark" || asked === "light" ? asked : system.matches ? "dark" : "light");
  system.addEventListener("change", () => set(system.matches ? "dark" : "light"));
}

export function toggleTheme(changed: () => void): void {
  document.documentElement.dataset.theme = isDark() ? "light" : "dark";
  changed();
}
