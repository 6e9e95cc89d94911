// The floor plan: the site from above, the longer side across.

import type { Person, Snapshot } from "../state/people.ts";
import type { Point, Site } from "../state/site.ts";
import { boxesIn } from "../state/volumes.ts";
import { slotOf } from "../state/marks.ts";
import type { Severity } from "../state/messages.ts";
import { named } from "../state/words.ts";
import { ellipse, P90, showsForecast } from "./body.ts";
import { halves } from "./halves.ts";
import { drawGlyph, drawMark, drawUnsure, font, type Pen } from "./mark.ts";
import { alpha, type Palette } from "./palette.ts";

export interface PlanInput {
  site: Site;
  snapshot: Snapshot | null;
  slots: ReadonlyMap<number, number>;
  paths: ReadonlyMap<number, readonly Point[]>;
  selected: number | null;
  /** Severity per person in an alert that is open. */
  alarmed: ReadonlyMap<number, Severity>;
  /** Names of zones and edges with an open alert. */
  active: ReadonlyMap<string, Severity>;
  faulty: ReadonlySet<string>;
  layers: { paths: boolean; forecasts: boolean; zones: boolean; cameras: boolean };
  /** Mean number of people in cells of the floor; null where density is not shown. */
  heat: { cell: number; people: ReadonlyMap<string, number> } | null;
  /** Large plan: names of zones and cameras are written. */
  names: boolean;
  /** The zone, line or edge that is chosen. */
  chosen: string | null;
}

export interface PlanView {
  to(point: Point): Point;
  from(pixel: Point): Point;
  scale: number;
}

/** Return how the floor lies in a picture of this size, with a margin [px]. */
export function planView(site: Site, width: number, height: number, margin: number): PlanView {
  const { low, high } = site.floor;
  const [dx, dy] = [high[0] - low[0], high[1] - low[1]];
  const turned = dy > dx;
  const [long, short] = turned ? [dy, dx] : [dx, dy];
  const scale = Math.max(
    1, Math.min((width - 2 * margin) / long, (height - 2 * margin) / short),
  );
  const [left, bottom] = [(width - long * scale) / 2, (height + short * scale) / 2];
  return {
    scale,
    to: ([x, y]) => {
      const [u, v] = turned ? [y - low[1], high[0] - x] : [x - low[0], y - low[1]];
      return [left + u * scale, bottom - v * scale];
    },
    from: ([px, py]) => {
      const [u, v] = [(px - left) / scale, (bottom - py) / scale];
      return turned ? [high[0] - v, low[1] + u] : [low[0] + u, low[1] + v];
    },
  };
}

function trace(pen: Pen, view: PlanView, points: readonly Point[], closed: boolean): void {
  pen.beginPath();
  points.forEach((point, i) => {
    const [x, y] = view.to(point);
    if (i === 0) pen.moveTo(x, y);
    else pen.lineTo(x, y);
  });
  if (closed) pen.closePath();
}

const severityInk = (c: Palette, severity: Severity): string =>
  ({ critical: c.critical, alarm: c.bodyAlarm, warning: c.warnFill, info: c.info })[severity];

export function drawPlan(
  pen: Pen, c: Palette, width: number, height: number, margin: number, input: PlanInput,
): PlanView {
  const view = planView(input.site, width, height, margin);
  drawFloor(pen, c, view, input);
  if (input.heat) drawHeat(pen, c, view, input.heat);
  if (input.layers.zones) drawZones(pen, c, view, input);
  if (input.layers.cameras) drawCameras(pen, c, view, input);
  const people = input.snapshot?.people.filter((p) => Number.isFinite(p.floor[0])) ?? [];
  for (const person of people) drawTrace(pen, c, view, input, person);
  const last = (p: Person) => (input.alarmed.has(p.id) ? 2 : p.id === input.selected ? 1 : 0);
  for (const person of [...people].sort((a, b) => last(a) - last(b))) {
    drawPerson(pen, c, view, input, person);
  }
  return view;
}

function drawFloor(pen: Pen, c: Palette, view: PlanView, { site, names }: PlanInput): void {
  const { low, high } = site.floor;
  trace(pen, view, [low, [high[0], low[1]], high, [low[0], high[1]]], true);
  pen.fillStyle = c.floor;
  pen.fill();
  const { below } = halves(site);
  if (below) {
    trace(pen, view, below, true);
    pen.fillStyle = c.track;
    pen.fill();
  }
  pen.lineWidth = 1;
  const each = names ? 1 : 5;
  for (const axis of [0, 1] as const) {
    for (let at = Math.ceil(low[axis] / each) * each; at <= high[axis]; at += each) {
      const ends: Point[] = axis === 0
        ? [[at, low[1]], [at, high[1]]]
        : [[low[0], at], [high[0], at]];
      pen.strokeStyle = Math.abs(at / 5 - Math.round(at / 5)) < 1e-6 ? c.grid5 : c.grid1;
      trace(pen, view, ends, false);
      pen.stroke();
    }
  }
}

/** Where levels of service of walkways begin, by Fruin [people/m²]: E, F. */
const [LEVEL_E, LEVEL_F] = [1.08, 2.15];

/** Draw densities: grey up to level D, then in the colours of a warning and an alarm. */
function drawHeat(
  pen: Pen, c: Palette, view: PlanView, { cell, people }: NonNullable<PlanInput["heat"]>,
): void {
  const sums = new Map<string, number>();
  for (const [key, count] of people) {
    const [i = 0, j = 0] = key.split(" ").map(Number);
    for (const di of [-1, 0, 1]) {
      for (const dj of [-1, 0, 1]) {
        const near = `${i + di} ${j + dj}`;
        sums.set(near, (sums.get(near) ?? 0) + count);
      }
    }
  }
  const window = (3 * cell) ** 2;
  for (const [key, count] of sums) {
    const density = count / window;
    const [i = 0, j = 0] = key.split(" ").map(Number);
    const [a, b] = [view.to([i * cell, j * cell]), view.to([(i + 1) * cell, (j + 1) * cell])];
    const ink = density >= LEVEL_F ? c.alarmFill : density >= LEVEL_E ? c.warnFill : c.text;
    const strength = density >= LEVEL_E ? 0.5 : 0.34 * Math.min(1, density / LEVEL_E);
    if (strength < 0.01) continue;
    pen.fillStyle = alpha(ink, strength);
    pen.fillRect(
      Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.abs(b[0] - a[0]) + 0.5, Math.abs(b[1] - a[1]) + 0.5,
    );
  }
}

/** Draw what no rule is about: walls, beds and benches hatched, ways in and out, boxes that move. */
function drawOthers(pen: Pen, c: Palette, view: PlanView, input: PlanInput): void {
  for (const wall of input.site.walls) {
    trace(pen, view, wall.points, false);
    pen.strokeStyle = c.text3;
    pen.lineWidth = 4;
    pen.stroke();
  }
  for (const one of input.site.exclusions) {
    const chosen = one.name === input.chosen;
    const ink = chosen ? c.accent : c.text3;
    hatch(pen, view, one.polygon, alpha(ink, 0.5));
    trace(pen, view, one.polygon, true);
    pen.strokeStyle = ink;
    pen.lineWidth = chosen ? 2 : 1;
    pen.stroke();
    if (input.names) {
      const [x, y] = corner(view, one.polygon);
      write(pen, c, named(one.name), x + 8, y + 13, chosen ? c.accent : c.text3, 12);
    }
  }
  for (const portal of input.site.portals) {
    trace(pen, view, portal.points, false);
    pen.strokeStyle = portal.name === input.chosen ? c.accent : c.text2;
    pen.lineWidth = 3;
    pen.setLineDash([2, 4]);
    pen.stroke();
    pen.setLineDash([]);
    pen.lineWidth = 1.3;
    if (input.names) drawWayIn(pen, view, portal.points);
  }
  for (const volume of input.site.volumes) {
    trace(pen, view, volume.path, false);
    pen.strokeStyle = alpha(c.text3, 0.6);
    pen.lineWidth = 1;
    pen.setLineDash([1, 4]);
    pen.stroke();
    pen.setLineDash([]);
    for (const box of input.snapshot ? boxesIn(volume, input.snapshot) : []) {
      trace(pen, view, box, true);
      pen.fillStyle = alpha(c.text2, 0.25);
      pen.fill();
      pen.strokeStyle = c.text2;
      pen.lineWidth = 1.5;
      pen.stroke();
    }
  }
}

function hatch(pen: Pen, view: PlanView, polygon: readonly Point[], ink: string): void {
  const corners = polygon.map((p) => view.to(p));
  const [xs, ys] = [corners.map((p) => p[0]), corners.map((p) => p[1])];
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  pen.save();
  trace(pen, view, polygon, true);
  pen.clip();
  pen.beginPath();
  for (let x = left - (bottom - top); x < right; x += 8) {
    pen.moveTo(x, bottom);
    pen.lineTo(x + bottom - top, top);
  }
  pen.strokeStyle = ink;
  pen.lineWidth = 1;
  pen.stroke();
  pen.restore();
}

function drawZones(pen: Pen, c: Palette, view: PlanView, input: PlanInput): void {
  drawOthers(pen, c, view, input);
  for (const zone of input.site.zones) {
    const severity = input.active.get(zone.name);
    const chosen = zone.name === input.chosen;
    const ink = severity ? severityInk(c, severity) : chosen ? c.accent : c.zone;
    trace(pen, view, zone.polygon, true);
    pen.fillStyle = alpha(ink, severity || chosen ? 0.16 : 0.08);
    pen.fill();
    pen.strokeStyle = ink;
    pen.lineWidth = chosen ? 2 : 1.3;
    pen.stroke();
    if (input.names) {
      const [x, y] = corner(view, zone.polygon);
      write(pen, c, named(zone.name), x + 8, y + 13, chosen ? c.accent : c.text2, 12);
    }
  }
  for (const line of input.site.lines) {
    trace(pen, view, line.points, false);
    pen.strokeStyle = line.name === input.chosen ? c.accent : c.zone;
    pen.lineWidth = 1.3;
    pen.setLineDash([5, 3]);
    pen.stroke();
    pen.setLineDash([]);
    if (input.names) drawWayIn(pen, view, line.points);
  }
  for (const edge of input.site.edges) {
    const severity = input.active.get(edge.name);
    trace(pen, view, edge.points, false);
    const chosen = edge.name === input.chosen;
    pen.strokeStyle = severity ? severityInk(c, severity) : chosen ? c.accent : c.edge;
    pen.lineWidth = chosen ? 3 : 2;
    pen.stroke();
    drawTeeth(pen, view, edge.points);
  }
}

/** Draw an arrow across a line in the direction "in": from its right to its left. */
function drawWayIn(pen: Pen, view: PlanView, points: readonly Point[]): void {
  const [a, b] = [view.to(points[0] as Point), view.to(points[1] as Point)];
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  if (length < 12) return;
  const [ux, uy] = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
  const [x, y] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const [tx, ty] = [x + uy * 18, y - ux * 18]; // y runs down on the screen: left is this side
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(tx, ty);
  pen.moveTo(tx - uy * 6 - ux * 4, ty + ux * 6 - uy * 4);
  pen.lineTo(tx, ty);
  pen.lineTo(tx - uy * 6 + ux * 4, ty + ux * 6 + uy * 4);
  pen.stroke();
}

/** Return the corner of a polygon that lies uppermost left on the screen. */
function corner(view: PlanView, polygon: readonly Point[]): Point {
  return polygon.map(view.to).reduce((a, b) => (b[0] + b[1] < a[0] + a[1] ? b : a));
}

/** Draw short teeth to the left of the way along an edge: the side of the drop. */
function drawTeeth(pen: Pen, view: PlanView, points: readonly Point[]): void {
  pen.lineWidth = 1;
  pen.beginPath();
  for (let i = 0; i + 1 < points.length; i++) {
    const [a, b] = [view.to(points[i] as Point), view.to(points[i + 1] as Point)];
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (length < 1) continue;
    const [ux, uy] = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    for (let s = 4; s < length; s += 8) {
      const [x, y] = [a[0] + ux * s, a[1] + uy * s];
      pen.moveTo(x, y);
      pen.lineTo(x + uy * 4, y - ux * 4); // y runs down on the screen: left is this side
    }
  }
  pen.stroke();
}

function drawCameras(pen: Pen, c: Palette, view: PlanView, input: PlanInput): void {
  for (const camera of input.site.cameras) {
    const [x, y] = view.to([camera.at[0], camera.at[1]]);
    const ahead = view.to([camera.at[0] + camera.ahead[0], camera.at[1] + camera.ahead[1]]);
    const turn = Math.atan2(ahead[1] - y, ahead[0] - x);
    const half = Math.atan(camera.lens.width / 2 / camera.lens.fx);
    const faulty = input.faulty.has(camera.name);
    const ink = faulty ? c.warnFill : c.text3;
    const reach = Math.min(5, Math.max(1.5, 0.35 * shortSide(input.site))) * view.scale;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.arc(x, y, reach, turn - half, turn + half);
    pen.closePath();
    pen.fillStyle = alpha(ink, faulty ? 0.14 : 0.16);
    pen.fill();
    if (faulty) {
      pen.setLineDash([3, 2]);
      pen.strokeStyle = ink;
      pen.lineWidth = 1;
      pen.stroke();
      pen.setLineDash([]);
    }
    pen.save();
    pen.translate(x, y);
    pen.rotate(turn);
    pen.fillStyle = ink;
    pen.fillRect(-4.5, -3, 6, 6);
    pen.beginPath();
    pen.moveTo(1, 0);
    pen.lineTo(4.5, -3);
    pen.lineTo(4.5, 3);
    pen.fill();
    pen.restore();
    if (input.names) write(pen, c, named(camera.name), x, y - 12, c.text2, 11, "center");
  }
}

const shortSide = ({ floor: { low, high } }: Site): number =>
  Math.min(high[0] - low[0], high[1] - low[1]);

function inkOf(c: Palette, input: PlanInput, person: Person): string {
  const severity = input.alarmed.get(person.id);
  if (severity) return severityInk(c, severity);
  if (person.state === "provisional") return c.text3;
  return c.marks[slotOf(input.slots, person.id) - 1] ?? c.text2;
}

function drawTrace(pen: Pen, c: Palette, view: PlanView, input: PlanInput, person: Person): void {
  const ink = inkOf(c, input, person);
  const path = input.layers.paths ? (input.paths.get(person.id) ?? []) : [];
  const n = path.length;
  pen.strokeStyle = ink;
  pen.lineCap = "round";
  for (let i = 1; i < n; i++) {
    const share = i / n;
    const [a, b] = [view.to(path[i - 1] as Point), view.to(path[i] as Point)];
    pen.globalAlpha = 0.04 + 0.76 * share ** 1.5;
    pen.lineWidth = 0.8 + 1.2 * share;
    pen.beginPath();
    pen.moveTo(a[0], a[1]);
    pen.lineTo(b[0], b[1]);
    pen.stroke();
  }
  pen.globalAlpha = 1;
  if (!input.layers.forecasts || !showsForecast(person, person.id === input.selected)) return;
  for (const f of person.forecast.filter((_, i) => i % 2 === 1)) {
    const { a, b, turn } = ellipse(f.cov, P90);
    const [x, y] = view.to(f.at);
    const [ex, ey] = view.to([f.at[0] + Math.cos(turn), f.at[1] + Math.sin(turn)]);
    pen.beginPath();
    pen.ellipse(x, y, a * view.scale, b * view.scale, Math.atan2(ey - y, ex - x), 0, 2 * Math.PI);
    pen.fillStyle = alpha(ink, 0.06);
    pen.fill();
  }
  trace(pen, view, [person.floor, ...person.forecast.map((f) => f.at)], false);
  pen.setLineDash([3, 3]);
  pen.lineWidth = 1.2;
  pen.stroke();
  pen.setLineDash([]);
}

function drawPerson(pen: Pen, c: Palette, view: PlanView, input: PlanInput, person: Person): void {
  const [x, y] = view.to(person.floor);
  const severity = input.alarmed.get(person.id);
  const ink = inkOf(c, input, person);
  if (severity) {
    pen.beginPath();
    pen.arc(x, y, 11, 0, 2 * Math.PI);
    pen.strokeStyle = ink;
    pen.lineWidth = 2;
    pen.stroke();
    drawGlyph(pen, severity, x, y, 13, ink, c.floor);
  } else {
    pen.beginPath();
    const radius = input.names ? 6.5 : 4.6;
    pen.arc(x, y, radius + 2, 0, 2 * Math.PI);
    pen.fillStyle = c.floor;
    pen.fill();
    if (person.state === "provisional") drawUnsure(pen, ink, x, y, radius);
    else {
      pen.globalAlpha = person.state === "coasting" ? 0.55 : 1;
      drawMark(pen, c, slotOf(input.slots, person.id), x, y, radius);
      pen.globalAlpha = 1;
    }
    if (person.id === input.selected) {
      pen.beginPath();
      pen.arc(x, y, input.names ? 12 : 9, 0, 2 * Math.PI);
      pen.strokeStyle = c.accent;
      pen.lineWidth = 2;
      pen.stroke();
    }
  }
  const right = severity ? 15 : input.names ? 11 : 8;
  const px = input.names ? 13 : 11;
  const tone = severity === "warning" ? c.warn : severity ? ink : c.text;
  write(pen, c, String(person.id), x + right, y - (severity ? 0 : 6), tone, px);
}

function write(
  pen: Pen, c: Palette, text: string, x: number, y: number, ink: string, px: number,
  align: CanvasTextAlign = "left",
): void {
  pen.font = font(600, px);
  pen.textAlign = align;
  pen.textBaseline = "middle";
  pen.lineWidth = 3;
  pen.lineJoin = "round";
  pen.strokeStyle = c.floor;
  pen.strokeText(text, x, y);
  pen.fillStyle = ink;
  pen.fillText(text, x, y);
}
