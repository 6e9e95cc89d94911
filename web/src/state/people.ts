// People of a snapshot, with what the page derives from their joints.

import type { PersonMessage, PersonState, SnapshotMessage } from "./messages.ts";
import type { Path, Point, Zone } from "./site.ts";

export const JOINTS = 17;
export const JOINT_NAMES = [
  "nose", "L eye", "R eye", "L ear", "R ear", "L shoulder", "R shoulder", "L elbow", "R elbow",
  "L wrist", "R wrist", "L hip", "R hip", "L knee", "R knee", "L ankle", "R ankle",
] as const;
export const [L_SHOULDER, R_SHOULDER, L_HIP, R_HIP, L_ANKLE, R_ANKLE] = [5, 6, 11, 12, 15, 16];

/** Forecasts are drawn up to here [s]: regions farther ahead fill the hall. */
const SHOWN_S = 4;

export interface Person {
  id: number;
  state: PersonState;
  /** For how long no camera has seen the person [s]; NaN where it is not told. */
  unseen: number;
  posture: string | null;
  /** Joints, x y z in turn [m]; NaN where missing. */
  xyz: Float32Array;
  /** One standard deviation per joint [m]. */
  sigma: Float32Array;
  /** Number of cameras that support each joint now. */
  support: Uint8Array;
  floor: Point;
  velocity: Point | null;
  forecast: { ahead: number; at: Point; cov: readonly [number, number, number] }[];
}

/** Where a vehicle is whose position comes from a feed. */
export interface Vehicle {
  volume: string;
  at: Point;
  /** From +x towards +y [rad]. */
  heading: number;
}

export interface Snapshot {
  t: number;
  sent: number;
  people: Person[];
  vehicles: Vehicle[];
}

/** Return how many people there are: a provisional track may be nobody, and does not count. */
export const counted = (snapshot: Snapshot): number =>
  snapshot.people.filter((person) => person.state !== "provisional").length;

/** Return the person's point on the floor: mean of the supported ankles, else of the hips. */
export function floorPoint(xyz: Float32Array, support: Uint8Array): Point {
  const mean = (joints: number[]): Point | null => {
    const kept = joints.filter((j) => Number.isFinite(xyz[3 * j]));
    if (kept.length === 0) return null;
    const sum = (axis: number) => kept.reduce((s, j) => s + (xyz[3 * j + axis] ?? NaN), 0);
    return [sum(0) / kept.length, sum(1) / kept.length];
  };
  const ankles = [L_ANKLE, R_ANKLE].filter((j) => (support[j] ?? 0) > 0);
  const every = [...Array(JOINTS).keys()];
  return mean(ankles) ?? mean([L_HIP, R_HIP]) ?? mean(every) ?? [NaN, NaN];
}

function readPerson(message: PersonMessage, t: number): Person {
  const xyz = new Float32Array(3 * JOINTS).fill(NaN);
  const sigma = new Float32Array(JOINTS).fill(NaN);
  const support = new Uint8Array(JOINTS);
  for (let j = 0; j < JOINTS; j++) {
    const point = message.xyz_m[j];
    for (let axis = 0; axis < 3; axis++) xyz[3 * j + axis] = point?.[axis] ?? NaN;
    sigma[j] = message.sigma_m[j] ?? NaN;
    support[j] = message.support[j] ?? 0;
  }
  const v = message.velocity_mps;
  return {
    id: message.person,
    state: message.state,
    unseen: message.seen_s ?? NaN,
    posture: message.posture ?? null,
    xyz, sigma, support,
    floor: floorPoint(xyz, support),
    velocity: v && v[0] !== null && v[1] !== null ? [v[0], v[1]] : null,
    forecast: (message.forecast ?? [])
      .map((f) => ({ ahead: f.t_s - t, at: f.xy_m, cov: f.cov_m2 }))
      .filter((f) => f.ahead < SHOWN_S + 0.05),
  };
}

/** Return a snapshot as the page keeps it. Forecasts come less often; the last one is carried. */
export function readSnapshot(message: SnapshotMessage, before: Snapshot | null): Snapshot {
  const people = message.people.map((person) => readPerson(person, message.t_s));
  const passed = before ? message.t_s - before.t : Infinity;
  if (before && passed >= 0 && passed < 1) {
    const old = new Map(before.people.map((person) => [person.id, person]));
    for (const person of people) {
      const last = old.get(person.id);
      if (person.forecast.length > 0 || !last) continue;
      person.forecast = last.forecast
        .map((f) => ({ ...f, ahead: f.ahead - passed }))
        .filter((f) => f.ahead > 0.05);
    }
  }
  const vehicles = (message.volumes ?? []).map((one): Vehicle => ({
    volume: one.volume, at: one.xy_m, heading: one.heading_deg * Math.PI / 180,
  }));
  return { t: message.t_s, sent: message.sent_s, people, vehicles };
}

/** Return the most cameras that support any joint of a person. */
export const seenBy = (person: Person): number => Math.max(0, ...person.support);

/** Return the person's uncertainty [m]: the median over the joints. */
export function positionSigma(person: Person): number {
  const known = [...person.sigma].filter(Number.isFinite).sort((a, b) => a - b);
  return known[Math.floor(known.length / 2)] ?? NaN;
}

/** Return the joint that is known least well, and its uncertainty [m]. */
export function leastSure(person: Person): { joint: string; sigma: number } | null {
  let worst = -1;
  person.sigma.forEach((s, j) => {
    if (Number.isFinite(s) && (worst < 0 || s > (person.sigma[worst] ?? 0))) worst = j;
  });
  return worst < 0
    ? null
    : { joint: JOINT_NAMES[worst] ?? "", sigma: person.sigma[worst] ?? NaN };
}

/** Tell whether a point lies in a polygon. */
export function inside(polygon: readonly Point[], [x, y]: Point): boolean {
  let within = false;
  polygon.forEach((a, i) => {
    const b = polygon[(i + 1) % polygon.length] as Point;
    if (a[1] > y !== b[1] > y && x < ((b[0] - a[0]) * (y - a[1])) / (b[1] - a[1]) + a[0]) {
      within = !within;
    }
  });
  return within;
}

function toSegment(a: Point, b: Point, p: Point): number {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const length2 = dx * dx + dy * dy;
  const along = length2 > 0 ? ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length2 : 0;
  const s = Math.min(1, Math.max(0, along));
  return Math.hypot(p[0] - a[0] - s * dx, p[1] - a[1] - s * dy);
}

/** Return the distance of a point from a chain of segments [m]. */
export function toPath(points: readonly Point[], p: Point, closed = false): number {
  let least = Infinity;
  const ends = closed ? points.length : points.length - 1;
  for (let i = 0; i < ends; i++) {
    const distance = toSegment(points[i] as Point, points[(i + 1) % points.length] as Point, p);
    least = Math.min(least, distance);
  }
  return least;
}

/** Return the nearest edge, else the nearest zone that the person is not in, with its distance. */
export function nearest(
  person: Person, edges: readonly Path[], zones: readonly Zone[],
): { name: string; kind: "edge" | "zone"; metres: number } | null {
  const found = [
    ...edges.map((edge) => ({
      name: edge.name, kind: "edge" as const, metres: toPath(edge.points, person.floor),
    })),
    ...(edges.length > 0 ? [] : zones)
      .filter((zone) => !inside(zone.polygon, person.floor))
      .map((zone) => ({
        name: zone.name, kind: "zone" as const, metres: toPath(zone.polygon, person.floor, true),
      })),
  ].filter((one) => Number.isFinite(one.metres));
  return found.sort((a, b) => a.metres - b.metres)[0] ?? null;
}

/** Return the name of the zone that a point lies in. */
export const zoneAt = (zones: readonly Zone[], point: Point): string | null =>
  zones.find((zone) => inside(zone.polygon, point))?.name ?? null;
