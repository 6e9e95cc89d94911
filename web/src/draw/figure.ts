// The figure of one person from the front: how well each joint is known.

import { JOINTS, L_HIP, L_SHOULDER, R_HIP, R_SHOULDER, type Person } from "../state/people.ts";
import { HEAD, HEAD_M, isDashed, joint, LIMBS, TORSO } from "./body.ts";
import type { Pen } from "./mark.ts";
import { alpha, type Palette } from "./palette.ts";

const SHOWN_FROM_M = 0.03;
const RING_SIGMAS = 1.6;

export function drawFigure(
  pen: Pen, c: Palette, width: number, height: number, person: Person, ink: string,
): void {
  const put = frame(person, width, height);
  if (!put) return;
  const { at, scale } = put;
  pen.lineCap = "round";
  pen.strokeStyle = ink;
  pen.fillStyle = alpha(ink, 0.33);
  const corners = TORSO.map(at);
  if (corners.every((p) => Number.isFinite(p[0]))) {
    pen.beginPath();
    corners.forEach((p, i) => pen[i ? "lineTo" : "moveTo"](p[0], p[1]));
    pen.closePath();
    pen.fill();
  }
  for (const [a, b, radius] of LIMBS) {
    const [p, q] = [at(a), at(b)];
    if (!Number.isFinite(p[0] + q[0])) continue;
    pen.setLineDash(isDashed(person, a, b) ? [3, 5] : []);
    pen.lineWidth = Math.max(2, 2 * radius * scale);
    pen.beginPath();
    pen.moveTo(p[0], p[1]);
    pen.lineTo(q[0], q[1]);
    pen.stroke();
  }
  pen.setLineDash([]);
  pen.fillStyle = ink;
  const head = at(HEAD);
  pen.beginPath();
  pen.arc(head[0], head[1], HEAD_M * scale, 0, 2 * Math.PI);
  pen.fill();
  for (let j = 5; j < JOINTS; j++) drawJoint(pen, c, at(j), person, j, scale);
}

function drawJoint(
  pen: Pen, c: Palette, [x, y]: readonly [number, number], person: Person, j: number, scale: number,
): void {
  if (!Number.isFinite(x)) return;
  pen.fillStyle = c.panel;
  pen.beginPath();
  pen.arc(x, y, 2.2, 0, 2 * Math.PI);
  pen.fill();
  const sigma = person.sigma[j] ?? NaN;
  if (!(sigma > SHOWN_FROM_M)) return;
  pen.strokeStyle = c.text2;
  pen.lineWidth = 1;
  pen.setLineDash([2, 2]);
  pen.beginPath();
  pen.arc(x, y, RING_SIGMAS * sigma * scale, 0, 2 * Math.PI);
  pen.stroke();
  pen.setLineDash([]);
}

/** Return the person as seen from the front, scaled to the picture. */
function frame(person: Person, width: number, height: number): {
  at: (j: number) => readonly [number, number]; scale: number;
} | null {
  const across = (a: number, b: number): [number, number] => {
    const [p, q] = [joint(person, a), joint(person, b)];
    return [p[0] - q[0], p[1] - q[1]];
  };
  let [dx, dy] = across(L_SHOULDER, R_SHOULDER);
  if (!Number.isFinite(dx + dy)) [dx, dy] = across(L_HIP, R_HIP);
  if (!Number.isFinite(dx + dy)) [dx, dy] = [1, 0];
  const length = Math.hypot(dx, dy) || 1;
  const right: [number, number] = [dx / length, dy / length];
  const plane = (j: number): [number, number] => {
    const p = joint(person, j);
    return [p[0] * right[0] + p[1] * right[1], p[2]];
  };
  const all = [...Array(JOINTS).keys(), HEAD].map(plane).filter((p) => Number.isFinite(p[0]));
  if (all.length === 0) return null;
  const us = all.map((p) => p[0]);
  const vs = all.map((p) => p[1]);
  const top = Math.max(...vs) + HEAD_M;
  const tall = Math.max(1, top - Math.min(...vs));
  const scale = Math.min((height - 12) / tall, (width - 24) / Math.max(0.7, Math.max(...us) - Math.min(...us)));
  const middle = (Math.max(...us) + Math.min(...us)) / 2;
  return {
    scale,
    at: (j) => {
      const [u, v] = plane(j);
      return [width / 2 + (u - middle) * scale, 6 + (top - v) * scale];
    },
  };
}
