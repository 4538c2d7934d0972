// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** Arms in the plane: lines that keep a width on the screen, however thin the links are. */
import { Float32BufferAttribute, Group, Points, Vector3 } from "three";
import { dots, repeated, Strokes } from "./materials";
import { poseMatrix } from "./shapes";
import type { RobotView } from "./solid_robot";
import type { Link, Pose } from "./trace";

export class FlatRobot implements RobotView {
  readonly object = new Group();
  private readonly strokes: Strokes[];
  private readonly joints: Points[];

  /** `order` says what is drawn over what. */
  constructor(private readonly links: Link[], private readonly color: string, private readonly halo: string, order: number,
              width: number) {
    this.strokes = [new Strokes(width + 3.5, order, { opacity: 0.9 }), new Strokes(width, order + 1)];
    this.joints = [dots([], [], 2 * width + 3, 1, order + 2), dots([], [], width + 1.5, 1, order + 3)];
    for (const part of this.joints) Object.assign(part.material, { depthTest: false });
    this.object.add(...this.strokes.map((stroke) => stroke.object), ...this.joints);
  }

  setPoses(poses: Pose[]): void {
    const segments: number[] = [];
    const points: number[] = [];
    this.links.forEach((link, i) => {
      const pose = poseMatrix(poses[i]!);
      for (const c of link.capsules) {
        const a = new Vector3(c[0], c[1], c[2]).applyMatrix4(pose);
        const b = new Vector3(c[3], c[4], c[5]).applyMatrix4(pose);
        segments.push(a.x, a.y, 0, b.x, b.y, 0);
        points.push(a.x, a.y, 0, b.x, b.y, 0);
      }
      for (const s of link.spheres) {
        const p = new Vector3(s[0], s[1], s[2]).applyMatrix4(pose);
        points.push(p.x, p.y, 0);
      }
    });
    [this.halo, this.color].forEach((color, i) => this.strokes[i]!.set(segments, repeated(color, segments.length / 6)));
    [this.color, this.halo].forEach((color, i) => {
      const geometry = this.joints[i]!.geometry;
      geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
      geometry.setAttribute("tone", new Float32BufferAttribute(repeated(color, points.length / 3), 3));
    });
  }

  /** Lines over each other do not flicker. */
  hideWhere(): void {}
}
