// The scene as one camera sees it, drawn: for tiles without pictures, and over pictures.

import type { Severity } from "../state/messages.ts";
import type { Person, Snapshot } from "../state/people.ts";
import type { Camera, Point, Point3, Site } from "../state/site.ts";
import { HEAD, HEAD_M, isDashed, joint, LIMBS, topOf, TORSO } from "./body.ts";
import { DROP_M, ground, halves, rim } from "./halves.ts";
import { toCamera, toPixel, type Lens } from "./lens.ts";
import { box, font, type Pen } from "./mark.ts";
import { alpha, type Palette } from "./palette.ts";

export interface TileInput {
  site: Site;
  camera: Camera;
  snapshot: Snapshot | null;
  alarmed: ReadonlyMap<number, Severity>;
  selected: number | null;
  /** A zone that is drawn with its height: to see whether it lies where it is meant. */
  prism?: { polygon: readonly Point[]; z: readonly [number, number] } | null;
  /** Whether a picture lies beneath: then only people are drawn. */
  picture: boolean;
}

const NEAR = 0.1;

/** Tell whether a picture is higher than wide: cut to the shape of a tile, people would lose heads. */
export const isUpright = ({ lens }: Camera): boolean => lens.height > lens.width;

/** Return the lens' picture scaled to fill a tile and cut to its shape, an upright one whole. */
function fill(lens: Lens, width: number, height: number): (p: Point3) => Point {
  const [wide, high] = [width / lens.width, height / lens.height];
  const scale = lens.height > lens.width ? Math.min(wide, high) : Math.max(wide, high);
  const [left, top] = [(width - lens.width * scale) / 2, (height - lens.height * scale) / 2];
  return (p) => {
    const [u, v] = toPixel(lens, p);
    return [left + (u + 0.5) * scale, top + (v + 0.5) * scale];
  };
}

/** Return a chain of points with those behind the camera cut off. */
function ahead(points: readonly Point3[], closed: boolean): Point3[] {
  const out: Point3[] = [];
  const n = points.length;
  for (let i = 0; i < (closed ? n : n - 1); i++) {
    const [a, b] = [points[i] as Point3, points[(i + 1) % n] as Point3];
    const cut = (): Point3 => {
      const s = (NEAR - a[2]) / (b[2] - a[2]);
      return [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), NEAR];
    };
    if (a[2] >= NEAR) out.push(a);
    if (a[2] >= NEAR !== b[2] >= NEAR) out.push(cut());
    if (!closed && i === n - 2 && b[2] >= NEAR) out.push(b);
  }
  return out;
}

/** Return points in steps of at most half a metre: straight lines bend in a distorted picture. */
function dense(points: readonly Point3[], closed: boolean): Point3[] {
  const out: Point3[] = [];
  const n = points.length;
  for (let i = 0; i < (closed ? n : n - 1); i++) {
    const [a, b] = [points[i] as Point3, points[(i + 1) % n] as Point3];
    const steps = Math.min(80, Math.max(1, Math.ceil(Math.hypot(b[0] - a[0], b[1] - a[1]) / 0.5)));
    for (let k = 0; k < steps; k++) {
      const s = k / steps;
      out.push([a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])]);
    }
  }
  if (!closed && n > 0) out.push(points[n - 1] as Point3);
  return out;
}

export function drawTile(
  pen: Pen, c: Palette, width: number, height: number, input: TileInput,
): void {
  const { lens } = input.camera;
  const put = fill(lens, width, height);
  const trace = (points: readonly Point3[], closed: boolean): void => {
    const seen = ahead(
      dense(points, closed).map((p) => toCamera(lens.T, p[0], p[1], p[2])), closed,
    );
    pen.beginPath();
    seen.forEach((p, i) => {
      const [x, y] = put(p);
      if (i === 0) pen.moveTo(x, y);
      else pen.lineTo(x, y);
    });
    if (closed) pen.closePath();
  };
  if (!input.picture) drawSite(pen, c, width, height, input.site, trace);
  if (input.prism) drawPrism(pen, c, input.prism, trace);
  drawPeople(pen, c, input, put, lens);
  if (!input.picture && isUpright(input.camera)) drawMargins(pen, c, width, height, lens);
}

/** Cover what lies beside an upright picture: the camera does not see it. */
function drawMargins(pen: Pen, c: Palette, width: number, height: number, lens: Lens): void {
  const margin = (width - (lens.width * height) / lens.height) / 2;
  pen.fillStyle = c.panel;
  pen.fillRect(0, 0, margin, height);
  pen.fillRect(width - margin, 0, margin, height);
}

type Trace = (points: readonly Point3[], closed: boolean) => void;

const flat = (points: readonly Point[], z = 0): Point3[] => points.map((p) => [p[0], p[1], z]);

function drawPrism(
  pen: Pen, c: Palette, { polygon, z }: NonNullable<TileInput["prism"]>, trace: Trace,
): void {
  pen.strokeStyle = c.accent;
  trace(flat(polygon, z[0]), true);
  pen.fillStyle = alpha(c.accent, 0.25);
  pen.fill();
  pen.lineWidth = 1.6;
  pen.stroke();
  pen.lineWidth = 1.2;
  pen.setLineDash([4, 3]);
  trace(flat(polygon, z[1]), true);
  pen.stroke();
  pen.setLineDash([]);
  for (const [x, y] of polygon) {
    trace([[x, y, z[0]], [x, y, z[1]]], false);
    pen.stroke();
  }
}

function drawSite(
  pen: Pen, c: Palette, width: number, height: number, site: Site, trace: Trace,
): void {
  pen.fillStyle = c.sky;
  pen.fillRect(0, 0, width, height);
  const { low, high } = site.floor;
  const parts = halves(site);
  if (parts.below) {
    trace(flat(parts.below, -DROP_M), true);
    pen.fillStyle = c.track;
    pen.fill();
    const top = rim(parts);
    if (top) {
      trace([...flat(top), ...flat([top[1], top[0]], -DROP_M)], true);
      pen.fillStyle = c.wall;
      pen.fill();
    }
  }
  trace(flat(parts.floor), true);
  pen.fillStyle = c.floor;
  pen.fill();
  pen.save();
  pen.clip();
  pen.lineWidth = 1;
  const long = Math.max(high[0] - low[0], high[1] - low[1]);
  const each = long > 40 ? 5 : 1;
  for (const axis of [0, 1] as const) {
    for (let at = Math.ceil(low[axis] / each) * each; at <= high[axis]; at += each) {
      pen.strokeStyle = at % 5 === 0 ? c.grid5 : c.grid1;
      trace(flat(axis === 0 ? [[at, low[1]], [at, high[1]]] : [[low[0], at], [high[0], at]]), false);
      pen.stroke();
    }
  }
  pen.restore();
  for (const zone of site.zones) {
    trace(flat(zone.polygon, ground(parts, zone)), true);
    pen.fillStyle = alpha(c.zone, 0.1);
    pen.fill();
    pen.strokeStyle = c.zone;
    pen.stroke();
  }
  for (const edge of site.edges) {
    trace(flat(edge.points), false);
    pen.strokeStyle = c.edge;
    pen.lineWidth = 1.6;
    pen.stroke();
  }
}

function drawPeople(
  pen: Pen, c: Palette, input: TileInput, put: (p: Point3) => Point, lens: Lens,
): void {
  const far = (person: Person): number => {
    const [x, y] = person.floor;
    return toCamera(lens.T, x, y, 1)[2];
  };
  const people = (input.snapshot?.people ?? [])
    .map((person) => ({ person, depth: far(person) }))
    .filter((one) => one.depth > 0.3)
    .sort((a, b) => b.depth - a.depth);
  for (const { person } of people) drawBody(pen, c, input, person, put, lens);
  const taken: [number, number, number, number][] = [];
  for (const { person } of people.reverse()) drawNumber(pen, c, input, person, put, lens, taken);
}

const isAlarm = (severity: Severity | undefined): boolean =>
  severity === "alarm" || severity === "critical";

function ink(c: Palette, input: TileInput, person: Person): string {
  if (isAlarm(input.alarmed.get(person.id))) return c.bodyAlarm;
  if (person.id === input.selected) return c.accent;
  if (input.picture) return "#ffffff";
  return person.state === "provisional" ? c.bodyProvisional : c.body;
}

function drawBody(
  pen: Pen, c: Palette, input: TileInput, person: Person, put: (p: Point3) => Point, lens: Lens,
): void {
  const at = (j: number): { p: Point; z: number } | null => {
    const [x, y, z] = joint(person, j);
    const q = toCamera(lens.T, x, y, z);
    return q[2] > NEAR ? { p: put(q), z: q[2] } : null;
  };
  const colour = ink(c, input, person);
  pen.lineCap = "round";
  const torso = TORSO.map(at);
  if (torso.every((corner) => corner !== null)) {
    pen.beginPath();
    torso.forEach((corner, i) => pen[i ? "lineTo" : "moveTo"](corner.p[0], corner.p[1]));
    pen.closePath();
    pen.fillStyle = alpha(colour, 0.33);
    pen.fill();
  }
  for (const rim of [true, false]) {
    for (const [a, b] of LIMBS) {
      const [from, to] = [at(a), at(b)];
      if (!from || !to) continue;
      pen.beginPath();
      pen.moveTo(from.p[0], from.p[1]);
      pen.lineTo(to.p[0], to.p[1]);
      pen.setLineDash(!rim && isDashed(person, a, b) ? [2.5, 2.5] : []);
      pen.strokeStyle = rim ? alpha(input.picture ? "#000000" : c.floor, 0.55) : colour;
      pen.lineWidth = rim ? 3.2 : 1.6;
      pen.stroke();
    }
  }
  pen.setLineDash([]);
  const head = at(HEAD);
  if (!head) return;
  const radius = Math.max(1.5, (HEAD_M * lens.fx * scaleOf(put, lens)) / head.z);
  pen.beginPath();
  pen.arc(head.p[0], head.p[1], radius, 0, 2 * Math.PI);
  pen.lineWidth = 1.6;
  pen.strokeStyle = colour;
  pen.fillStyle = colour;
  if (person.state === "confirmed") pen.fill();
  else pen.stroke();
}

/** Return tile pixels per pixel of the picture. */
function scaleOf(put: (p: Point3) => Point, lens: Lens): number {
  const [a, b] = [put([0, 0, 1]), put([0.01, 0, 1])];
  return Math.abs(b[0] - a[0]) / (0.01 * lens.fx);
}

function drawNumber(
  pen: Pen, c: Palette, input: TileInput, person: Person, put: (p: Point3) => Point, lens: Lens,
  taken: [number, number, number, number][],
): void {
  const [x, y, z] = topOf(person);
  const q = toCamera(lens.T, x, y, z);
  if (q[2] <= NEAR) return;
  const [u, v] = put(q);
  pen.font = font(600, 11);
  const text = String(person.id);
  const w = pen.measureText(text).width + 6;
  const place: [number, number, number, number] = [u - w / 2, v - 14, u + w / 2, v];
  const collides = taken.some(
    (o) => place[0] < o[2] && o[0] < place[2] && place[1] < o[3] && o[1] < place[3],
  );
  if (collides) return; // the nearer one has the room
  taken.push(place);
  const severity = input.alarmed.get(person.id);
  box(pen, place[0], place[1], w, 14, 3);
  const plain = input.picture ? "rgb(0 0 0 / .7)" : alpha(c.raised, 0.88);
  const fills = { critical: c.criticalFill, alarm: c.alarmFill, warning: c.warnFill, info: plain };
  pen.fillStyle = severity ? fills[severity] : plain;
  pen.fill();
  const dark = severity === "warning" ? "#1d1500" : c.text;
  pen.fillStyle = isAlarm(severity) || (input.picture && !severity) ? "#ffffff" : dark;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillText(text, u, v - 6.5);
}
