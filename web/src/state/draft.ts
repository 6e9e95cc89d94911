// The draft of a site: zones, lines, edges and rules as the site file has them, and how they change.

import type { Point, Site } from "./site.ts";
import { named } from "./words.ts";

export type PlaceKind = "zones" | "lines" | "edges" | "exclusions" | "portals";
export const PLACE_KINDS: readonly PlaceKind[] = ["zones", "lines", "edges", "exclusions", "portals"];
export type OneKind = "zone" | "line" | "edge" | "exclusion" | "portal";
export const ONE: Record<PlaceKind, OneKind> = {
  zones: "zone", lines: "line", edges: "edge", exclusions: "exclusion", portals: "portal",
};
/** Whether a place is an area with a height: a zone, or a volume in which lying is normal. */
export const isArea = (kind: PlaceKind): boolean => kind === "zones" || kind === "exclusions";
/** Whether a place is a line between two points, with a direction. */
export const isLine = (kind: PlaceKind): boolean => kind === "lines" || kind === "portals";

export type Table = Readonly<Record<string, unknown>>;
export interface Rule extends Table {
  readonly id: string;
  readonly kind: string;
}

/** What of a site file can be drafted; each table has all keys that the file has. */
export interface Parts {
  zones: Readonly<Record<string, Table>>;
  lines: Readonly<Record<string, Table>>;
  edges: Readonly<Record<string, Table>>;
  exclusions: Readonly<Record<string, Table>>;
  portals: Readonly<Record<string, Table>>;
  rules: readonly Rule[];
}

export const nothing: Parts = {
  zones: {}, lines: {}, edges: {}, exclusions: {}, portals: {}, rules: [],
};

export interface Key {
  name: string;
  about: string;
  type: "number" | "integer" | "choice" | "flag" | "text";
  default: unknown;
  required: boolean;
  choices?: string[];
  least?: number;
  most?: number;
  above?: number;
  below?: number;
}

export interface Kind {
  name: string;
  about: string;
  place: "zone" | "line" | "edge" | null;
  place_is_optional: boolean;
  keys: Key[];
  common: Key[];
}

/** Something wrong or doubtful, and the keys that lead to it. */
export interface Remark {
  at: (string | number)[];
  text: string;
}

const pointsKey = (kind: PlaceKind): string => (isArea(kind) ? "polygon_m" : "points_m");
export const least = (kind: PlaceKind): number => (isArea(kind) ? 3 : 2);
export const most = (kind: PlaceKind): number => (isLine(kind) ? 2 : 1000);

/** Return the corners of a place. */
export function corners(parts: Parts, kind: PlaceKind, name: string): Point[] {
  const value = parts[kind][name]?.[pointsKey(kind)];
  return Array.isArray(value) ? (value as Point[]) : [];
}

export function heights(table: Table | undefined): readonly [number, number] {
  const z = table?.z_m;
  return Array.isArray(z) ? [Number(z[0]), Number(z[1])] : [0, 2.5];
}

/** Return which kind of place has a name; the first that does. */
export const kindOf = (parts: Parts, name: string | null): PlaceKind | null =>
  name === null ? null : (PLACE_KINDS.find((kind) => name in parts[kind]) ?? null);

const rounded = (value: number): number => Math.round(value * 1000) / 1000;
const exact = (points: readonly Point[]): Point[] =>
  points.map(([x, y]): Point => [rounded(x), rounded(y)]);

const withTable = (parts: Parts, kind: PlaceKind, name: string, table: Table): Parts =>
  ({ ...parts, [kind]: { ...parts[kind], [name]: table } });

export function withCorners(
  parts: Parts, kind: PlaceKind, name: string, points: readonly Point[],
): Parts {
  return withTable(parts, kind, name, { ...parts[kind][name], [pointsKey(kind)]: exact(points) });
}

export const withHeights = (
  parts: Parts, kind: PlaceKind, name: string, z: readonly [number, number],
): Parts => withTable(parts, kind, name, { ...parts[kind][name], z_m: z });

/** Return a name that no place of this kind has. */
export function freeName(parts: Parts, kind: PlaceKind): string {
  let n = 1;
  while (`${ONE[kind]}-${n}` in parts[kind]) n++;
  return `${ONE[kind]}-${n}`;
}

/** Return the parts with a place of another name; rules that are about it follow. */
export function renamed(parts: Parts, kind: PlaceKind, from: string, to: string): Parts {
  if (to === from || !/^[A-Za-z0-9_-]{1,64}$/.test(to) || to in parts[kind]) return parts;
  const tables = Object.fromEntries(
    Object.entries(parts[kind]).map(([name, table]) => [name === from ? to : name, table]),
  );
  const key = ONE[kind];
  const rules = parts.rules.map((rule) => (rule[key] === from ? { ...rule, [key]: to } : rule));
  return { ...parts, [kind]: tables, rules };
}

/** Return the parts without a place, and without the rules that are about it. */
export function without(parts: Parts, kind: PlaceKind, name: string): Parts {
  const { [name]: _gone, ...tables } = parts[kind];
  const rules = parts.rules.filter((rule) => rule[ONE[kind]] !== name);
  return { ...parts, [kind]: tables, rules };
}

/** Return the rules about a place, with their numbers in the file. */
export const rulesOf = (parts: Parts, kind: PlaceKind, name: string): [number, Rule][] =>
  numbered(parts).filter(([, rule]) => rule[ONE[kind]] === name);

/** Return the rules that are about no place. */
export const everywhere = (parts: Parts): [number, Rule][] =>
  numbered(parts).filter(([, rule]) =>
    PLACE_KINDS.every((kind) => typeof rule[ONE[kind]] !== "string"));

const numbered = (parts: Parts): [number, Rule][] =>
  parts.rules.map((rule, n): [number, Rule] => [n, rule]);

/** Return the parts with a key of a rule set; undefined takes the key away. */
export function withKey(parts: Parts, n: number, key: string, value: unknown): Parts {
  const rules = parts.rules.map((rule, i) => {
    if (i !== n) return rule;
    const { [key]: _old, ...rest } = rule;
    return (value === undefined ? rest : { ...rule, [key]: value }) as Rule;
  });
  return { ...parts, rules };
}

/** Return the parts with one rule more, with what its kind needs. */
export function withRule(parts: Parts, kind: Kind, place: string | null): Parts {
  const base = [place, kind.name.split(".").pop()].filter(Boolean).join("-").slice(0, 56);
  const taken = new Set(parts.rules.map((rule) => rule.id));
  let id = base;
  for (let n = 2; taken.has(id); n++) id = `${base}-${n}`;
  const needed = kind.keys.filter((key) => key.required);
  const values = Object.fromEntries(needed.map((key) => [key.name, first(key)]));
  const where = kind.place && place ? { [kind.place]: place } : {};
  return { ...parts, rules: [...parts.rules, { id, kind: kind.name, ...where, ...values }] };
}

/** Return a value for a key that has no default. */
function first(key: Key): unknown {
  if (key.type === "choice") return key.choices?.[0];
  if (key.type === "number" || key.type === "integer") {
    return Math.max(key.least ?? (key.above === undefined ? 0 : key.above + 1), 0);
  }
  return key.type === "flag" ? false : "";
}

export const withoutRule = (parts: Parts, n: number): Parts =>
  ({ ...parts, rules: parts.rules.filter((_, i) => i !== n) });

/** Return the parts with a rule of another kind: keys that the new kind has not are dropped. */
export function withKind(parts: Parts, n: number, kind: Kind): Parts {
  const old = parts.rules[n];
  if (!old) return parts;
  const names = new Set([
    "id", "severity", "schedule", kind.place ?? "",
    ...kind.common.map((key) => key.name), ...kind.keys.map((key) => key.name),
  ]);
  const kept = Object.fromEntries(Object.entries(old).filter(([key]) => names.has(key)));
  const needed = kind.keys.filter((key) => key.required && !(key.name in kept));
  const values = Object.fromEntries(needed.map((key) => [key.name, first(key)]));
  const rule: Rule = { ...kept, id: old.id, kind: kind.name, ...values };
  return { ...parts, rules: parts.rules.map((one, i) => (i === n ? rule : one)) };
}

// Geometry

export const area = (polygon: readonly Point[]): number =>
  Math.abs(polygon.reduce((sum, a, i) => {
    const b = polygon[(i + 1) % polygon.length] as Point;
    return sum + a[0] * b[1] - b[0] * a[1];
  }, 0)) / 2;

export const distance = (a: Point, b: Point): number => Math.hypot(b[0] - a[0], b[1] - a[1]);

export const length = (points: readonly Point[]): number =>
  points.slice(1).reduce((sum, b, i) => sum + distance(points[i] as Point, b), 0);

export const middle = (points: readonly Point[]): Point => {
  const n = Math.max(1, points.length);
  return [
    points.reduce((sum, p) => sum + p[0], 0) / n, points.reduce((sum, p) => sum + p[1], 0) / n,
  ];
};

const turn = (a: Point, b: Point, c: Point): number =>
  (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

/** Whether two sides of a polygon cross or touch beside their common corner. */
export function crosses(polygon: readonly Point[]): boolean {
  const n = polygon.length;
  const at = (i: number): Point => polygon[i % n] as Point;
  const between = (a: Point, b: Point, p: Point): boolean =>
    turn(a, b, p) === 0 && [0, 1].every((k) =>
      Math.min(a[k as 0], b[k as 0]) <= p[k as 0] && p[k as 0] <= Math.max(a[k as 0], b[k as 0]));
  for (let i = 0; i < n; i++) {
    if (distance(at(i), at(i + 1)) === 0) return true;
    for (let j = i + 2; j < n; j++) {
      if (i === 0 && j === n - 1) continue;
      const [a, b, c, d] = [at(i), at(i + 1), at(j), at(j + 1)];
      if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) return true;
      if (between(a, b, c) || between(a, b, d) || between(c, d, a) || between(c, d, b)) return true;
    }
  }
  return false;
}

export const SNAP_M = 0.1;
const snapped = (value: number): number => Math.round(value / SNAP_M) * SNAP_M;

/** Return a place of the floor on the grid, or in line with another corner. */
export function snap(point: Point, free: boolean, straight: Point | null): Point {
  const [x, y] = free ? point : [snapped(point[0]), snapped(point[1])];
  if (!straight) return [rounded(x), rounded(y)];
  const level = Math.abs(point[0] - straight[0]) > Math.abs(point[1] - straight[1]);
  return level ? [rounded(x), straight[1]] : [straight[0], rounded(y)];
}

/** Return the site with the places of a draft in place of its own. */
export function drafted(site: Site, parts: Parts): Site {
  const path = (kind: "lines" | "edges" | "portals") =>
    Object.keys(parts[kind]).map((name) => ({ name, points: corners(parts, kind, name) }));
  const areas = (kind: "zones" | "exclusions") =>
    Object.entries(parts[kind]).map(([name, table]) => ({
      name, polygon: corners(parts, kind, name), z: heights(table), restricted: false,
    }));
  return {
    ...site,
    zones: areas("zones"),
    exclusions: areas("exclusions"),
    lines: path("lines"),
    edges: path("edges"),
    portals: path("portals"),
  };
}

// What has changed

const text = (value: unknown): string => JSON.stringify(value, (_, inner: unknown) =>
  typeof inner === "object" && inner !== null && !Array.isArray(inner)
    ? Object.fromEntries(Object.entries(inner).sort(([a], [b]) => a.localeCompare(b)))
    : inner);

export const same = (a: Parts, b: Parts): boolean => text(a) === text(b);

/** Return in words what a draft changes. */
export function changes(before: Parts, after: Parts): string[] {
  const told: string[] = [];
  for (const kind of PLACE_KINDS) {
    const names = new Set([...Object.keys(before[kind]), ...Object.keys(after[kind])]);
    for (const name of names) {
      const [old, now] = [before[kind][name], after[kind][name]];
      if (!old) told.push(`${named(name)} added`);
      else if (!now) told.push(`${named(name)} removed`);
      else if (text(old) !== text(now)) told.push(`${named(name)} changed`);
    }
  }
  const olds = new Map(before.rules.map((rule) => [rule.id, rule]));
  const ids = new Set(after.rules.map((rule) => rule.id));
  for (const rule of after.rules) {
    const old = olds.get(rule.id);
    if (!old) told.push(`rule ${rule.id} added`);
    else if (text(old) !== text(rule)) told.push(`rule ${rule.id} changed`);
  }
  for (const rule of before.rules) if (!ids.has(rule.id)) told.push(`rule ${rule.id} removed`);
  return told;
}
