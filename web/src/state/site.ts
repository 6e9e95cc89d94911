// The site as the page draws it: a tolerant reading of /api/site.

import { invert, lens, type Lens, type Matrix34 } from "../draw/lens.ts";

export type Point = readonly [number, number];
export type Point3 = readonly [number, number, number];

export interface Camera {
  name: string;
  lens: Lens;
  at: Point3;
  ahead: Point3;
}

export interface Zone {
  name: string;
  polygon: Point[];
  z: readonly [number, number];
  restricted: boolean;
}

export interface Path {
  name: string;
  points: Point[];
}

/** A box that moves along a path, once or again and again, or that a feed tells; see docs/rules.md. */
export interface Volume {
  name: string;
  /** Whether snapshots say where it is; it then has no path. */
  fed: boolean;
  size: Point3;
  bottom: number;
  path: Point[];
  pathS: number[];
  startS: number;
  periodS: number | null;
  heading: number | null;
}

export interface Site {
  name: string;
  version: string;
  timezone: string;
  mode: string | null;
  /** Which rules are off in each mode. */
  modes: Record<string, { off: string[]; schedule: string[] | null }>;
  ruleIds: string[];
  cameras: Camera[];
  zones: Zone[];
  lines: Path[];
  edges: Path[];
  /** What nobody walks through. */
  walls: Path[];
  /** Where lying is normal: beds and benches. */
  exclusions: Zone[];
  /** Ways in and out. */
  portals: Path[];
  /** Boxes that move, by a timetable or a feed. */
  volumes: Volume[];
  floor: { low: Point; high: Point };
  armed: number;
  rules: number;
  pictures: boolean;
  recording: boolean;
}

type Json = Record<string, unknown>;

const isJson = (value: unknown): value is Json =>
  typeof value === "object" && value !== null && !Array.isArray(value);

const entries = (value: unknown): [string, Json][] =>
  isJson(value)
    ? Object.entries(value).filter((entry): entry is [string, Json] => isJson(entry[1]))
    : [];

const isPoint = (value: unknown): value is Point =>
  Array.isArray(value) && value.length >= 2 && value.every((x) => Number.isFinite(x));

const points = (value: unknown): Point[] => (Array.isArray(value) ? value.filter(isPoint) : []);

const texts = (value: unknown): string[] =>
  Array.isArray(value) ? value.filter((one): one is string => typeof one === "string") : [];

const number = (value: unknown, other: number): number =>
  typeof value === "number" && Number.isFinite(value) ? value : other;

/** Return the site as the page draws it; what is missing or malformed is left out. */
export function readSite(body: unknown): Site {
  const outer = isJson(body) ? body : {};
  const site = isJson(outer.site) ? outer.site : outer;
  const rules = isJson(site.rules) ? site.rules : {};
  const cameras = entries(site.cameras).flatMap(([name, value]) => readCamera(name, value));
  const zones = entries(site.zones).map(([name, value]) => readZone(name, value));
  const edges = entries(site.edges).map(([name, value]) => readPath(name, value));
  const lines = entries(site.lines).map(([name, value]) => readPath(name, value));
  const walls = entries(site.walls).map(([name, value]) => readPath(name, value));
  const exclusions = entries(site.exclusions).map(([name, value]) => readZone(name, value));
  const portals = entries(site.portals).map(([name, value]) => readPath(name, value));
  return {
    name: typeof site.name === "string" ? site.name : "site",
    version: typeof outer.version === "string" ? outer.version : "",
    timezone: readTimezone(site.timezone),
    mode: typeof site.mode === "string" ? site.mode : null,
    modes: Object.fromEntries(entries(site.modes).map(([name, value]) => [name, {
      off: texts(value.off), schedule: value.schedule ? texts(value.schedule) : null,
    }])),
    ruleIds: texts(site.rule_ids),
    cameras,
    zones: zones.filter((zone) => zone.polygon.length > 2),
    lines: lines.filter((line) => line.points.length > 1),
    edges: edges.filter((edge) => edge.points.length > 1),
    walls: walls.filter((wall) => wall.points.length > 1),
    exclusions: exclusions.filter((one) => one.polygon.length > 2),
    portals: portals.filter((one) => one.points.length > 1),
    volumes: entries(site.volumes).flatMap(([name, value]) => readVolume(name, value)),
    floor: readFloor(site.floor ?? site.floor_m, cameras, zones, edges),
    armed: number(rules.armed, 0),
    rules: number(rules.total, 0),
    pictures: site.pictures === true,
    recording: site.kind === "recording",
  };
}

function readTimezone(value: unknown): string {
  try {
    if (typeof value === "string") {
      new Intl.DateTimeFormat("en-GB", { timeZone: value });
      return value;
    }
  } catch {
    // a name that this browser does not know: UTC, and the clock says so
  }
  return "UTC";
}

function readCamera(name: string, value: Json): Camera[] {
  const made = lens(value);
  if (!made) return [];
  const T: Matrix34 = made.T;
  return [{ name, lens: made, at: invert(T, [0, 0, 0]), ahead: [T[2][0], T[2][1], T[2][2]] }];
}

function readZone(name: string, value: Json): Zone {
  const z = Array.isArray(value.z_m) ? value.z_m : [0, 2.5];
  return {
    name,
    polygon: points(value.polygon_m),
    z: [number(z[0], 0), number(z[1], 2.5)],
    restricted: value.restricted === true,
  };
}

function readVolume(name: string, value: Json): Volume[] {
  const [size, path] = [value.size_m, points(value.path_m)];
  const pathS = Array.isArray(value.path_s) ? value.path_s.filter(Number.isFinite) as number[] : [0];
  if (!Array.isArray(size) || size.length !== 3 || !size.every(Number.isFinite)) return [];
  const fed = typeof value.feed === "string";
  if (!fed && (path.length === 0 || path.length !== pathS.length)) return [];
  return [{
    name, fed, size: size as unknown as Point3, bottom: number(value.bottom_m, 0), path, pathS,
    startS: number(value.start_s, 0),
    periodS: typeof value.period_s === "number" && value.period_s > 0 ? value.period_s : null,
    heading: typeof value.heading_deg === "number" ? value.heading_deg * Math.PI / 180 : null,
  }];
}

const readPath = (name: string, value: Json): Path => ({ name, points: points(value.points_m) });

function readFloor(
  value: unknown, cameras: Camera[], zones: Zone[], edges: Path[],
): { low: Point; high: Point } {
  const given = isJson(value) ? [value.low_m, value.high_m] : value;
  if (Array.isArray(given) && given.length === 2 && given.every(isPoint)) {
    const [a, b] = given as [Point, Point];
    if (b[0] > a[0] && b[1] > a[1]) return { low: a, high: b };
  }
  if (Array.isArray(given) && given.length === 4 && given.every((x) => Number.isFinite(x))) {
    const [x0, y0, x1, y1] = given as [number, number, number, number];
    if (x1 > x0 && y1 > y0) return { low: [x0, y0], high: [x1, y1] };
  }
  const all: Point[] = [
    ...cameras.map((camera): Point => [camera.at[0], camera.at[1]]),
    ...zones.flatMap((zone) => zone.polygon),
    ...edges.flatMap((edge) => edge.points),
  ];
  if (all.length === 0) return { low: [-5, -5], high: [5, 5] };
  const low: Point = [Math.min(...all.map((p) => p[0])), Math.min(...all.map((p) => p[1]))];
  const high: Point = [Math.max(...all.map((p) => p[0])), Math.max(...all.map((p) => p[1]))];
  return { low: [low[0] - 1, low[1] - 1], high: [high[0] + 1, high[1] + 1] };
}
