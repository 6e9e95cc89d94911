// The floor, cut along an edge that crosses the site: what lies below it is drawn lower.

import { inside } from "../state/people.ts";
import type { Point, Site, Zone } from "../state/site.ts";

export const DROP_M = 1.1; // how deep a drop is drawn: how deep it is, is not known

/** The parts of the floor. */
export interface Halves {
  floor: Point[];
  /** What lies below the edge; null without an edge from one side of the site to another. */
  below: Point[] | null;
}

const REACH = 0.15; // share of the edge's length that may be missing on either side

/** Return the part of a polygon on the left of the way from a to b, or on its right. */
function cut(polygon: readonly Point[], a: Point, b: Point, left: boolean): Point[] {
  const side = ([x, y]: Point): number =>
    ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) * (left ? 1 : -1);
  return polygon.flatMap((p, i) => {
    const q = polygon[(i + 1) % polygon.length] as Point;
    const [s, t] = [side(p), side(q)];
    const kept: Point[] = s >= 0 ? [p] : [];
    if (s > 0 !== t > 0 && s !== t) {
      const share = s / (s - t);
      kept.push([p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])]);
    }
    return kept;
  });
}

/** Return the floor of a site, and what lies below its first edge. */
export function halves(site: Site): Halves {
  const { low, high } = site.floor;
  const whole: Point[] = [low, [high[0], low[1]], high, [low[0], high[1]]];
  const points = site.edges[0]?.points;
  const [a, b] = [points?.[0], points?.[points.length - 1]];
  if (!points || points.length !== 2 || !a || !b) return { floor: whole, below: null };
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  const [ux, uy] = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
  const outside = ([x, y]: Point): boolean =>
    x <= low[0] || x >= high[0] || y <= low[1] || y >= high[1];
  const far = REACH * length;
  const crosses = outside([a[0] - ux * far, a[1] - uy * far])
    && outside([b[0] + ux * far, b[1] + uy * far]);
  if (!crosses) return { floor: whole, below: null };
  return { floor: cut(whole, a, b, false), below: cut(whole, a, b, true) };
}

/** Return where the edge's line meets the floor's border: the top of the wall of the drop. */
export function rim({ floor, below }: Halves): [Point, Point] | null {
  if (!below) return null;
  const same = (p: Point, q: Point) => Math.hypot(p[0] - q[0], p[1] - q[1]) < 1e-6;
  const shared = floor.filter((p) => below.some((q) => same(p, q)));
  return shared.length >= 2 ? [shared[0] as Point, shared[1] as Point] : null;
}

/** Return the height on which a zone is drawn: lower where all of it lies below the edge. */
export function ground({ below }: Halves, zone: Zone): number {
  if (!below) return 0;
  const centre: Point = [0, 1].map(
    (axis) => zone.polygon.reduce((sum, p) => sum + (p[axis] ?? 0), 0) / zone.polygon.length,
  ) as unknown as Point;
  return inside(below, centre) ? -DROP_M : 0;
}
