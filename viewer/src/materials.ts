// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * A few short shaders instead of three.js' general ones: these compile in milliseconds even without a graphics card,
 * which is what the first picture waits for. Colours are sRGB throughout.
 */
import {
  Box3, BoxGeometry, BufferGeometry, Color, DoubleSide, Float32BufferAttribute, GLSL3, InstancedBufferAttribute,
  InstancedBufferGeometry, IUniform, LineSegments, Mesh, NotEqualStencilFunc, Object3D, Points, ReplaceStencilOp,
  ShaderMaterial, Vector2, Vector3,
} from "three";

/** Pixels of the canvas, and how many make one of the page. */
export const resolution = { value: new Vector2(1, 1) };
export const pixelRatio = { value: Math.min(2, window.devicePixelRatio) };

/** Towards the light. */
export const SUN = new Vector3(-0.35, -0.62, 1.1).normalize();

/** Matt solids: sky, sun and a light rim. `place` is where a corner is, in GLSL. */
export function clay(color: string, opacity = 1, place = "position", inputs = ""): ShaderMaterial {
  return new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { color: { value: new Color(color) }, opacity: { value: opacity }, sun: { value: SUN } },
    transparent: opacity < 1,
    depthWrite: opacity >= 1,
    vertexShader: /* glsl */ `
      ${inputs}
      out vec3 surface;
      out vec3 seen;
      void main() {
        surface = mat3(modelMatrix) * normal;
        vec4 at = modelMatrix * vec4(${place}, 1.0);
        seen = cameraPosition - at.xyz;
        gl_Position = projectionMatrix * viewMatrix * at;
      }`,
    fragmentShader: /* glsl */ `
      uniform vec3 color;
      uniform float opacity;
      uniform vec3 sun;
      in vec3 surface;
      in vec3 seen;
      out vec4 pixel;
      void main() {
        vec3 n = normalize(surface) * (gl_FrontFacing ? 1.0 : -1.0);
        float sky = 0.5 + 0.5 * n.z;
        float light = max(0.0, dot(n, sun));
        float edge = 1.0 - abs(dot(n, normalize(seen)));
        float rim = edge * edge * edge;
        vec3 lit = color * (0.50 + 0.20 * sky + 0.36 * light) + 0.07 * rim;
        pixel = vec4(min(lit, 1.0), min(1.0, opacity * (1.0 + 0.9 * rim)));
      }`,
  });
}

/** One colour, whatever the light. */
export function flat(color: string): ShaderMaterial {
  return new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { color: { value: new Color(color) } },
    // In the same order as in clay(), whose depths a mask must meet exactly.
    vertexShader: /* glsl */ `
      void main() {
        vec4 at = modelMatrix * vec4(position, 1.0);
        gl_Position = projectionMatrix * viewMatrix * at;
      }`,
    fragmentShader: /* glsl */ `
      uniform vec3 color;
      out vec4 pixel;
      void main() { pixel = vec4(color, 1.0); }`,
  });
}

/** The shadow of a solid on the floor, each spot of which is darkened once. */
export function shadow(floor: { value: number }, opacity: IUniform<number>): ShaderMaterial {
  return new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { floor: floor as IUniform<number>, opacity, sun: { value: SUN } },
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
    stencilWrite: true,
    stencilFunc: NotEqualStencilFunc,
    stencilRef: 1,
    stencilZPass: ReplaceStencilOp,
    vertexShader: /* glsl */ `
      uniform float floor;
      uniform vec3 sun;
      out float height;
      void main() {
        vec4 at = modelMatrix * vec4(position, 1.0);
        height = at.z - floor;
        at.xyz -= sun * (height / sun.z);
        at.z += 0.001;
        gl_Position = projectionMatrix * viewMatrix * at;
      }`,
    fragmentShader: /* glsl */ `
      uniform float opacity;
      in float height;
      out vec4 pixel;
      void main() { pixel = vec4(0.05, 0.08, 0.16, opacity * (1.0 - 0.35 * clamp(height, 0.0, 1.5))); }`,
  });
}

/** Grid lines, fading towards the rim of their plane; every fourth is stronger. */
export function gridMaterial(color: string, cell: number, radius: number): ShaderMaterial {
  return new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { color: { value: new Color(color) }, cell: { value: cell }, radius: { value: radius } },
    transparent: true,
    depthWrite: false,
    vertexShader: /* glsl */ `
      out vec2 at;
      void main() {
        at = position.xy;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: /* glsl */ `
      uniform vec3 color;
      uniform float cell, radius;
      in vec2 at;
      out vec4 pixel;
      float lines(float size) {
        vec2 p = at / size;
        vec2 line = abs(fract(p - 0.5) - 0.5) / fwidth(p);
        return 1.0 - min(1.0, min(line.x, line.y));
      }
      void main() {
        float strength = max(0.45 * lines(cell), lines(4.0 * cell));
        pixel = vec4(color, strength * smoothstep(1.0, 0.15, length(at) / radius));
      }`,
  });
}

function attribute(values: number[], size = 3): Float32BufferAttribute {
  return new Float32BufferAttribute(values, size);
}

/** Hair lines between pairs of points; `colors` has three numbers per point. */
export function hairLines(positions: number[], colors: number[], opacity: number, order: number): LineSegments {
  const geometry = new BufferGeometry().setAttribute("position", attribute(positions)).setAttribute("tone", attribute(colors));
  const material = new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { opacity: { value: opacity } },
    transparent: true,
    depthWrite: false,
    vertexShader: /* glsl */ `
      in vec3 tone;
      out vec3 color;
      void main() {
        color = tone;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: /* glsl */ `
      uniform float opacity;
      in vec3 color;
      out vec4 pixel;
      void main() { pixel = vec4(color, opacity); }`,
  });
  const lines = new LineSegments(geometry, material);
  lines.renderOrder = order;
  return lines;
}

/** Round dots of `size` pixels. */
export function dots(positions: number[], colors: number[], size: number, opacity: number, order: number): Points {
  const geometry = new BufferGeometry().setAttribute("position", attribute(positions)).setAttribute("tone", attribute(colors));
  const material = new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { opacity: { value: opacity }, size: { value: size }, ratio: pixelRatio },
    transparent: true,
    depthWrite: false,
    vertexShader: /* glsl */ `
      uniform float size, ratio;
      in vec3 tone;
      out vec3 color;
      void main() {
        color = tone;
        gl_PointSize = size * ratio;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: /* glsl */ `
      uniform float opacity;
      in vec3 color;
      out vec4 pixel;
      void main() {
        float r = length(gl_PointCoord - 0.5);
        if (r > 0.5) discard;
        pixel = vec4(color, opacity * smoothstep(0.5, 0.4, r));
      }`,
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  points.renderOrder = order;
  return points;
}

/** Points of `radius` metres, as small balls. */
export function cloud(positions: Float32Array, radius: number, color: IUniform<Color>): Object3D {
  const geometry = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(positions, 3));
  const material = new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { color, radius: { value: radius }, resolution, ratio: pixelRatio },
    vertexShader: /* glsl */ `
      uniform vec2 resolution;
      uniform float radius, ratio;
      void main() {
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        gl_PointSize = max(1.6 * ratio, radius * projectionMatrix[1][1] * resolution.y / gl_Position.w);
      }`,
    fragmentShader: /* glsl */ `
      uniform vec3 color;
      out vec4 pixel;
      void main() {
        vec2 at = 2.0 * gl_PointCoord - 1.0;
        float r = dot(at, at);
        if (r > 1.0) discard;
        vec3 n = vec3(at.x, -at.y, sqrt(1.0 - r));
        pixel = vec4(color * (0.58 + 0.42 * max(0.0, dot(n, normalize(vec3(-0.3, 0.7, 0.6))))), 1.0);
      }`,
  });
  return new Points(geometry, material);
}

/** Cubes as x, y, z and half the edge, each larger by `radius`. */
export function cubes(values: Float32Array, radius: number, color: IUniform<Color>): Object3D {
  const box = new BoxGeometry(2, 2, 2);
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute("position", box.getAttribute("position"));
  geometry.setAttribute("normal", box.getAttribute("normal"));
  geometry.setIndex(box.getIndex());
  geometry.setAttribute("cube", new InstancedBufferAttribute(values, 4));
  geometry.boundingBox = new Box3();
  const half = new Vector3();
  for (let i = 0; i < values.length; i += 4) {
    const middle = new Vector3(values[i], values[i + 1], values[i + 2]);
    half.setScalar(values[i + 3]! + radius);
    geometry.boundingBox.expandByPoint(middle.clone().add(half)).expandByPoint(middle.sub(half));
  }
  const material = clay("#000", 1, `position * (cube.w + ${radius.toFixed(6)}) + cube.xyz`, "in vec4 cube;");
  material.uniforms.color = color;
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  return mesh;
}

/** The corners of a stroke: along it, and across. */
const CORNERS = [[-1, -1], [1, -1], [1, 1], [-1, 1]] as const;

/** Lines of a width in pixels with round ends; in dashes of some pixels if asked for. */
export class Strokes {
  readonly object: Mesh<BufferGeometry, ShaderMaterial>;

  constructor(width: number, order: number, options: { opacity?: number; depthTest?: boolean; dash?: number } = {}) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      uniforms: {
        thickness: { value: width }, resolution, ratio: pixelRatio, opacity: { value: options.opacity ?? 1 },
        dash: { value: options.dash ?? 0 },
      },
      transparent: true,
      depthWrite: false,
      depthTest: options.depthTest ?? false,
      vertexShader: /* glsl */ `
        uniform vec2 resolution;
        uniform float thickness, ratio;
        in vec3 a, b, tone;
        out vec2 at;
        out vec3 color;
        flat out float span;
        void main() {
          vec4 p = projectionMatrix * modelViewMatrix * vec4(a, 1.0);
          vec4 q = projectionMatrix * modelViewMatrix * vec4(b, 1.0);
          vec2 along = (q.xy / q.w - p.xy / p.w) * 0.5 * resolution;
          span = length(along);
          vec2 u = span > 1e-4 ? along / span : vec2(1.0, 0.0);
          float r = 0.5 * thickness * ratio + 1.0;
          at = vec2(position.x < 0.0 ? -r : span + r, position.y * r);
          vec2 shift = u * position.x * r + vec2(-u.y, u.x) * position.y * r;
          gl_Position = position.x < 0.0 ? p : q;
          gl_Position.xy += shift / (0.5 * resolution) * gl_Position.w;
          color = tone;
        }`,
      fragmentShader: /* glsl */ `
        uniform float thickness, ratio, opacity, dash;
        in vec2 at;
        in vec3 color;
        flat in float span;
        out vec4 pixel;
        void main() {
          float away = length(vec2(at.x - clamp(at.x, 0.0, span), at.y)) - 0.5 * thickness * ratio;
          float cover = clamp(0.5 - away, 0.0, 1.0);
          if (cover <= 0.0 || (dash > 0.0 && fract(at.x / (1.7 * dash * ratio)) > 0.59)) discard;
          pixel = vec4(color, opacity * cover);
        }`,
    });
    this.object = new Mesh(new BufferGeometry(), material);
    this.object.frustumCulled = false;
    this.object.renderOrder = order;
  }

  /** Pairs of points, and one colour per pair. */
  set(pairs: number[], colors: number[]): void {
    const values: Record<"position" | "a" | "b" | "tone", number[]> = { position: [], a: [], b: [], tone: [] };
    const indices: number[] = [];
    for (let i = 0; i < pairs.length / 6; ++i) {
      for (const [along, across] of CORNERS) {
        values.position.push(along, across, 0);
        values.a.push(...pairs.slice(6 * i, 6 * i + 3));
        values.b.push(...pairs.slice(6 * i + 3, 6 * i + 6));
        values.tone.push(...colors.slice(3 * i, 3 * i + 3));
      }
      indices.push(...[0, 1, 2, 0, 2, 3].map((corner) => 4 * i + corner));
    }
    const geometry = new BufferGeometry();
    for (const [name, list] of Object.entries(values)) geometry.setAttribute(name, attribute(list));
    geometry.setIndex(indices);
    this.object.geometry.dispose();
    this.object.geometry = geometry;
  }
}

/** `color` for each of `count` entries. */
export function repeated(color: string | Color, count: number): number[] {
  const rgb = new Color(color).toArray();
  return Array.from({ length: count }, () => rgb).flat();
}
