// Colours of scene, plan and tiles: the page's variables, read when the theme changes.

export interface Palette {
  sky: string; floor: string; track: string; ground: string; wall: string;
  grid1: string; grid5: string; edge: string; zone: string;
  solidTop: string; solidFront: string; solidSide: string; solidLine: string;
  body: string; bodyProvisional: string; bodyAlarm: string;
  text: string; text2: string; text3: string;
  panel: string; raised: string; line: string; line2: string; accent: string;
  warn: string; warnFill: string; alarm: string; alarmFill: string;
  critical: string; criticalFill: string; info: string;
  marks: string[];
  dark: boolean;
}

const NAMES: Record<Exclude<keyof Palette, "marks" | "dark">, string> = {
  sky: "sky", floor: "floor", track: "track", ground: "ground", wall: "wall",
  grid1: "grid1", grid5: "grid5", edge: "edge", zone: "zone",
  solidTop: "solid-top", solidFront: "solid-front", solidSide: "solid-side",
  solidLine: "solid-line",
  body: "body", bodyProvisional: "body-provisional", bodyAlarm: "body-alarm",
  text: "text", text2: "text2", text3: "text3",
  panel: "panel", raised: "raised", line: "line", line2: "line2", accent: "accent",
  warn: "warn", warnFill: "warn-fill", alarm: "alarm", alarmFill: "alarm-fill",
  critical: "critical", criticalFill: "critical-fill", info: "info",
};

let current: Palette | null = null;

export function palette(): Palette {
  current ??= read();
  return current;
}

/** Forget the colours: the theme has changed. */
export function forget(): void {
  current = null;
}

function read(): Palette {
  const style = getComputedStyle(document.documentElement);
  const of = (name: string): string => style.getPropertyValue(`--${name}`).trim() || "#888888";
  const colours = Object.fromEntries(Object.entries(NAMES).map(([key, name]) => [key, of(name)]));
  return {
    ...(colours as unknown as Palette),
    marks: Array.from({ length: 12 }, (_, i) => of(`mark-${i + 1}`)),
    dark: of("scheme") === "dark",
  };
}

export type Rgb = readonly [number, number, number];

/** Return the parts of #rrggbb or #rgb, 0 to 1. */
export function rgb(hex: string): Rgb {
  const digits = hex.slice(1);
  const n = parseInt(digits.length === 3 ? digits.replaceAll(/./g, "$&$&") : digits, 16);
  return [((n >> 16) & 255) / 255, ((n >> 8) & 255) / 255, (n & 255) / 255];
}

/** Return a colour with an alpha, for canvas. */
export function alpha(hex: string, a: number): string {
  const [r, g, b] = rgb(hex).map((x) => Math.round(x * 255));
  return `rgb(${r} ${g} ${b} / ${a})`;
}

/** Return a mixed with b, as #rrggbb. */
export function mix(a: string, b: string, share: number): string {
  const [x, y] = [rgb(a), rgb(b)];
  const part = (i: 0 | 1 | 2) =>
    Math.round(255 * (x[i] * (1 - share) + y[i] * share)).toString(16).padStart(2, "0");
  return `#${part(0)}${part(1)}${part(2)}`;
}
