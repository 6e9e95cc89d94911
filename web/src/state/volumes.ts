// Where boxes that move are: by a timetable, as the server's `Volume` has it, or as a snapshot says.

import type { Snapshot } from "./people.ts";
import type { Point, Volume } from "./site.ts";

const MOST = 100;

/** Yield for how long each box has been on its way [s]. */
function underWay(volume: Volume, now: number): number[] {
  const [since, took] = [now - volume.startS, volume.pathS.at(-1) ?? 0];
  if (volume.path.length === 1) return [0];
  if (volume.periodS === null) return since >= 0 && since <= took ? [since] : [];
  if (since < 0) return [];
  const newest = since % volume.periodS;
  const count = Math.min(Math.floor((Math.min(since, took) - newest) / volume.periodS) + 1, MOST);
  return Array.from({ length: Math.max(count, 0) }, (_, n) => newest + n * (volume.periodS as number));
}

/** Return the corners of the boxes that are there in a snapshot. */
export function boxesIn(volume: Volume, snapshot: Snapshot): Point[][] {
  if (!volume.fed) return boxesAt(volume, snapshot.t);
  return snapshot.vehicles
    .filter((one) => one.volume === volume.name)
    .map((one) => box(volume, one.at, one.heading));
}

/** Return the corners of the boxes that a timetable puts there at a time. */
export function boxesAt(volume: Volume, now: number): Point[][] {
  return underWay(volume, now).map((since) => box(volume, ...placed(volume, since)));
}

function box(volume: Volume, at: Point, heading: number): Point[] {
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  const [l, w] = [volume.size[0] / 2, volume.size[1] / 2];
  return ([[-l, -w], [l, -w], [l, w], [-l, w]] as Point[]).map(([x, y]): Point =>
    [at[0] + c * x - s * y, at[1] + s * x + c * y]);
}

/** Return the middle of a box that has been on its way for so long, and its heading [rad]. */
function placed({ path, pathS, heading }: Volume, since: number): [Point, number] {
  if (path.length === 1) return [path[0] as Point, heading ?? 0];
  let after = pathS.findIndex((at) => at >= since);
  if (after < 0) after = path.length - 1;
  after = Math.max(after, 1);
  const [a, b] = [path[after - 1] as Point, path[after] as Point];
  const [from, to] = [pathS[after - 1] as number, pathS[after] as number];
  const share = Math.min(Math.max((since - from) / Math.max(to - from, 1e-9), 0), 1);
  const at: Point = [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
  return [at, heading ?? Math.atan2(b[1] - a[1], b[0] - a[0])];
}
