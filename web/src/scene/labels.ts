// Names, numbers and callouts over the scene, on a flat canvas.

import type { Palette } from "../draw/palette.ts";
import { box, drawGlyph, drawMark, drawUnsure, font, type Pen } from "../draw/mark.ts";
import type { PersonState, Severity } from "../state/messages.ts";
import { severityInk } from "./ground.ts";

export interface Chip {
  person: number;
  slot: number;
  state: PersonState;
  unseen: number;
  x: number;
  y: number;
  /** Height of the body on the screen [px], and distance [m]. */
  tall: number;
  far: number;
  selected: boolean;
  severity: Severity | null;
}

const MOST = 25;
const H = 20;

/** Draw the chips of people, nearest last; return where each lies. */
export function drawChips(
  pen: Pen, c: Palette, chips: Chip[],
): { person: number; box: [number, number, number, number] }[] {
  const placed: { person: number; box: [number, number, number, number] }[] = [];
  const near = [...chips].sort((a, b) => weight(b) - weight(a) || a.far - b.far);
  const shown = near.slice(0, MOST).reverse();
  const taken: [number, number, number, number][] = [];
  for (const chip of [...shown].reverse()) {
    const size = chip.tall < 24 && !chip.selected && !chip.severity;
    const w = size ? 14 : width(pen, chip);
    let y = chip.y - H;
    for (let tries = 0; tries < 3; tries++) {
      const hit = taken.find((o) => overlaps(o, [chip.x - w / 2, y, chip.x + w / 2, y + H]));
      if (!hit) break;
      y = hit[1] - H - 2;
    }
    const place: [number, number, number, number] = [chip.x - w / 2, y, chip.x + w / 2, y + H];
    taken.push(place);
    placed.push({ person: chip.person, box: place });
    if (size) drawMark(pen, c, chip.slot, chip.x, y + H / 2, 5);
    else drawChip(pen, c, chip, place[0], y, w);
  }
  if (near.length > MOST) note(pen, c, `+${near.length - MOST} more people`);
  return placed;
}

const weight = (chip: Chip): number => (chip.severity ? 2 : 0) + (chip.selected ? 1 : 0);

const overlaps = (a: readonly number[], b: readonly number[]): boolean =>
  (a[0] ?? 0) < (b[2] ?? 0) && (b[0] ?? 0) < (a[2] ?? 0)
  && (a[1] ?? 0) < (b[3] ?? 0) && (b[1] ?? 0) < (a[3] ?? 0);

const unseenText = (chip: Chip): string =>
  chip.state === "coasting" && chip.unseen >= 0.1 ? ` ${chip.unseen.toFixed(1)} s` : "";

function width(pen: Pen, chip: Chip): number {
  pen.font = font(600, 12);
  return 29 + pen.measureText(`${chip.person}${unseenText(chip)}`).width;
}

function drawChip(pen: Pen, c: Palette, chip: Chip, x: number, y: number, w: number): void {
  pen.save();
  box(pen, x, y, w, H, 4);
  pen.fillStyle = c.raised;
  pen.globalAlpha = 0.94;
  pen.fill();
  pen.globalAlpha = 1;
  pen.strokeStyle = chip.severity ? severityInk(c, chip.severity)
    : chip.selected ? c.accent : chip.state === "confirmed" ? c.line : c.line2;
  pen.lineWidth = chip.severity || chip.selected ? 2 : 1;
  if (chip.state === "provisional") pen.setLineDash([3, 2]);
  if (chip.state === "coasting") pen.setLineDash([1.5, 2]);
  pen.stroke();
  pen.setLineDash([]);
  const [mx, my] = [x + 12, y + H / 2];
  if (chip.severity) {
    const sign = chip.severity === "warning" ? "#1d1500" : "#ffffff";
    drawGlyph(pen, chip.severity, mx, my, 13, severityInk(c, chip.severity), sign);
  } else if (chip.state === "provisional") drawUnsure(pen, c.text3, mx, my, 5);
  else {
    pen.globalAlpha = chip.state === "coasting" ? 0.55 : 1;
    drawMark(pen, c, chip.slot, mx, my, 5.5);
    pen.globalAlpha = 1;
  }
  pen.font = font(600, 12);
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  pen.fillStyle = chip.state === "confirmed" ? c.text : c.text2;
  pen.fillText(String(chip.person), x + 21, my + 0.5);
  const tail = unseenText(chip);
  if (tail) {
    const after = pen.measureText(String(chip.person)).width;
    pen.font = font(400, 12);
    pen.fillStyle = c.text2;
    pen.fillText(tail, x + 21 + after, my + 0.5);
  }
  pen.restore();
}

/** Draw the name of a camera. */
export function drawName(
  pen: Pen, c: Palette, name: string, x: number, y: number, faulty: boolean,
): void {
  pen.font = font(500, 11);
  const w = pen.measureText(name).width + 14;
  box(pen, x - w / 2, y - 24, w, 18, 4);
  pen.fillStyle = c.raised;
  pen.globalAlpha = 0.9;
  pen.fill();
  pen.globalAlpha = 1;
  pen.strokeStyle = faulty ? c.warnFill : c.line;
  pen.lineWidth = 1;
  pen.stroke();
  pen.fillStyle = faulty ? c.warn : c.text2;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillText(name, x, y - 14.5);
}

/** Draw a mark of distance along the site. */
export function drawMetres(pen: Pen, c: Palette, text: string, x: number, y: number): void {
  pen.font = font(500, 11);
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.lineWidth = 3;
  pen.strokeStyle = c.sky;
  pen.strokeText(text, x, y);
  pen.fillStyle = c.text2;
  pen.fillText(text, x, y);
}

/** Draw what an alarm says, above the head of the person. */
export function drawCallout(
  pen: Pen, c: Palette, severity: Severity, title: string, line: string, x: number, y: number,
): void {
  pen.font = font(600, 15);
  const wide = pen.measureText(title).width;
  pen.font = font(500, 13);
  const w = Math.max(wide, pen.measureText(line).width) + 62;
  const [left, top] = [x - w / 2, y - 62];
  pen.fillStyle = severity === "critical" ? c.criticalFill : c.alarmFill;
  box(pen, left, top, w, 50, 6);
  pen.fill();
  pen.beginPath();
  pen.moveTo(x - 7, top + 49);
  pen.lineTo(x + 7, top + 49);
  pen.lineTo(x, top + 58);
  pen.fill();
  drawGlyph(pen, severity, left + 25, top + 25, 26, "#ffffff", pen.fillStyle as string);
  pen.fillStyle = "#ffffff";
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  pen.font = font(600, 15);
  pen.fillText(title, left + 48, top + 17);
  pen.font = font(500, 13);
  pen.fillText(line, left + 48, top + 35);
}

function note(pen: Pen, c: Palette, text: string): void {
  pen.font = font(500, 12);
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  pen.fillStyle = c.text2;
  pen.fillText(text, 16, 76);
}
