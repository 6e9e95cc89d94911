// Marks of people and glyphs of severities, on canvas.

import { mark } from "../state/marks.ts";
import type { Severity } from "../state/messages.ts";
import type { Palette } from "./palette.ts";

export type Pen = CanvasRenderingContext2D;

const SHAPES: Record<string, string> = {
  // Boxes of 20 x 20, centre 10, 10.
  disc: "M10 1.5a8.5 8.5 0 1 0 0 17a8.5 8.5 0 1 0 0-17z",
  square: "M3.5 2.5h13a1 1 0 0 1 1 1v13a1 1 0 0 1-1 1h-13a1 1 0 0 1-1-1v-13a1 1 0 0 1 1-1z",
  pill: "M10 .5a5.2 5.2 0 0 1 5.2 5.2v8.6a5.2 5.2 0 0 1-10.4 0V5.7A5.2 5.2 0 0 1 10 .5z",
  plus: "M6.8 1.5h6.4v5.3h5.3v6.4h-5.3v5.3H6.8v-5.3H1.5V6.8h5.3z",
};

export const GLYPHS: Record<Severity, string> = {
  critical: "M6.2 1h7.6L19 6.2v7.6L13.8 19H6.2L1 13.8V6.2z",
  alarm: "M10 .6 19.4 10 10 19.4.6 10z",
  warning: "M10 1.5 19 17.5H1z",
  info: "M10 1.8a8.2 8.2 0 1 0 0 16.4a8.2 8.2 0 1 0 0-16.4z",
};

const cache = new Map<string, Path2D>();

function path(d: string): Path2D {
  let made = cache.get(d);
  if (!made) cache.set(d, (made = new Path2D(d)));
  return made;
}

/** Draw the mark of a slot with its centre at x, y and this radius [px]. */
export function drawMark(
  pen: Pen, colours: Palette, slot: number, x: number, y: number, radius: number, ink?: string,
): void {
  const { shape, fill } = mark(slot);
  const colour = ink ?? colours.marks[slot - 1] ?? colours.text;
  const shapePath = path(SHAPES[shape] as string);
  pen.save();
  pen.translate(x - radius, y - radius);
  pen.scale(radius / 10, radius / 10);
  pen.fillStyle = colour;
  pen.strokeStyle = colour;
  if (fill === "solid") pen.fill(shapePath);
  else {
    pen.save();
    pen.clip(shapePath);
    if (fill === "half") pen.fillRect(0, 10, 20, 10);
    pen.lineWidth = fill === "ring" ? 8 : 6;
    pen.stroke(shapePath);
    pen.restore();
  }
  pen.restore();
}

/** Draw a dashed ring, the mark of a person who is not confirmed yet. */
export function drawUnsure(pen: Pen, colour: string, x: number, y: number, radius: number): void {
  pen.save();
  pen.strokeStyle = colour;
  pen.lineWidth = Math.max(1.2, radius * 0.3);
  pen.setLineDash([radius * 0.55, radius * 0.5]);
  pen.beginPath();
  pen.arc(x, y, radius * 0.8, 0, 2 * Math.PI);
  pen.stroke();
  pen.restore();
}

/** Draw the glyph of a severity with its centre at x, y. */
export function drawGlyph(
  pen: Pen, severity: Severity, x: number, y: number, size: number, fill: string, sign: string,
): void {
  pen.save();
  pen.translate(x - size / 2, y - size / 2);
  pen.scale(size / 20, size / 20);
  pen.fillStyle = fill;
  pen.fill(path(GLYPHS[severity]));
  pen.fillStyle = sign;
  const top = severity === "warning" ? 7 : 5;
  pen.fillRect(9, top, 2, 6);
  pen.beginPath();
  pen.arc(10, top + 8.3, 1.15, 0, 2 * Math.PI);
  pen.fill();
  pen.restore();
}

/** Draw a box with round corners. */
export function box(
  pen: Pen, x: number, y: number, w: number, h: number, r: number,
): void {
  pen.beginPath();
  pen.roundRect(x, y, w, h, r);
}

export const FONT =
  '-apple-system, "Segoe UI Variable Text", "Segoe UI", Roboto, Inter, "Noto Sans", '
  + '"Liberation Sans", Arial, sans-serif';

export const font = (weight: number, px: number): string => `${weight} ${px}px ${FONT}`;

/** Make a canvas as many device pixels large as it shows; return its pen in CSS pixels. */
export function fit(canvas: HTMLCanvasElement): { pen: Pen; width: number; height: number } | null {
  const { clientWidth: width, clientHeight: height } = canvas;
  const pen = canvas.getContext("2d");
  if (!pen || width === 0 || height === 0) return null;
  const ratio = Math.min(window.devicePixelRatio || 1, 3);
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) {
    canvas.width = w;
    canvas.height = h;
  }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}
