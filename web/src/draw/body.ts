// The limbs of a person, for scene, tiles and the figure of the selection.

import { JOINTS, L_HIP, L_SHOULDER, R_HIP, R_SHOULDER, type Person } from "../state/people.ts";

export const HEAD_M = 0.105;
export const HEAD = JOINTS; // index of the made-up joint in the middle of the head
export const NECK = JOINTS + 1; // between the shoulders

/** Ends and radius [m] of each limb; ends may be the made-up joints. */
export const LIMBS: readonly (readonly [number, number, number])[] = [
  [5, 7, 0.034], [7, 9, 0.027], [6, 8, 0.034], [8, 10, 0.027],
  [11, 13, 0.048], [13, 15, 0.036], [12, 14, 0.048], [14, 16, 0.036],
  [5, 6, 0.033], [11, 12, 0.033], [5, 11, 0.036], [6, 12, 0.036],
  [NECK, HEAD, 0.03],
];

export const TORSO = [L_SHOULDER, R_SHOULDER, R_HIP, L_HIP] as const;

/** Return a joint, or a made-up one: the middle of the head, or of the shoulders. */
export function joint(person: Person, j: number): [number, number, number] {
  if (j < JOINTS) {
    const { xyz } = person;
    return [xyz[3 * j] ?? NaN, xyz[3 * j + 1] ?? NaN, xyz[3 * j + 2] ?? NaN];
  }
  if (j === NECK) return middle(person, [L_SHOULDER, R_SHOULDER]);
  const ears = middle(person, [3, 4]);
  return Number.isFinite(ears[0]) ? ears : middle(person, [0, 1, 2]);
}

function middle(person: Person, joints: readonly number[]): [number, number, number] {
  const sum: [number, number, number] = [0, 0, 0];
  let n = 0;
  for (const j of joints) {
    const p = joint(person, j);
    if (!Number.isFinite(p[0])) continue;
    n++;
    for (const axis of [0, 1, 2] as const) sum[axis] += p[axis];
  }
  return [sum[0] / n, sum[1] / n, sum[2] / n];
}

/** Tell whether cameras see a joint now; the made-up ones are seen where theirs are. */
export function isSeen(person: Person, j: number): boolean {
  if (j < JOINTS) return (person.support[j] ?? 0) > 0;
  if (j === NECK) return isSeen(person, L_SHOULDER) || isSeen(person, R_SHOULDER);
  return [0, 1, 2, 3, 4].some((k) => isSeen(person, k));
}

/** Tell whether a limb is drawn dashed: nothing invented looks seen. */
export const isDashed = (person: Person, a: number, b: number): boolean =>
  person.state !== "confirmed" || !isSeen(person, a) || !isSeen(person, b);

/** Return the top of a person's head [m]. */
export function topOf(person: Person): [number, number, number] {
  const head = joint(person, HEAD);
  if (Number.isFinite(head[0])) return [head[0], head[1], head[2] + 0.2];
  let top = -Infinity;
  for (let j = 0; j < JOINTS; j++) top = Math.max(top, person.xyz[3 * j + 2] ?? -Infinity);
  return [person.floor[0], person.floor[1], Number.isFinite(top) ? top + 0.15 : 1.8];
}

/** Return the axes [m] and the turn [rad] of an ellipse of so many standard deviations. */
export function ellipse(
  cov: readonly [number, number, number], sigmas: number,
): { a: number; b: number; turn: number } {
  const [xx, xy, yy] = cov;
  const mean = (xx + yy) / 2;
  const spread = Math.hypot((xx - yy) / 2, xy);
  return {
    a: sigmas * Math.sqrt(Math.max(0, mean + spread)),
    b: sigmas * Math.sqrt(Math.max(0, mean - spread)),
    turn: 0.5 * Math.atan2(2 * xy, xx - yy),
  };
}

export const P50 = 1.177;
export const P90 = 2.146;

const SLOW_MPS = 0.2;

/** Tell whether a person's forecast is drawn: not before it is confirmed, nor while it stands. */
export function showsForecast(person: Person, selected: boolean): boolean {
  const last = person.forecast[person.forecast.length - 1];
  if (!last || person.state === "provisional") return false;
  const metres = Math.hypot(last.at[0] - person.floor[0], last.at[1] - person.floor[1]);
  return selected || metres / last.ahead >= SLOW_MPS;
}
