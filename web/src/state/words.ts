// Numbers and times as the page writes them.

import type { Severity } from "./messages.ts";

export const SEVERITY: Record<Severity, string> = {
  critical: "Critical", alarm: "Alarm", warning: "Warning", info: "Info",
};

/** Times from here up are Unix times; others are those of a recording. */
export const UNIX_FROM_S = 1e9;

/** Return an age or length [s]: one decimal below 10 s, none above, minutes and hours in words. */
export function duration(seconds: number): string {
  const s = Math.max(0, seconds);
  if (s < 9.95) return `${s.toFixed(1)} s`;
  if (s < 99.5) return `${Math.round(s)} s`;
  const minutes = Math.round(s / 60);
  if (minutes < 100) return `${minutes} min`;
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** Return how long something has held, in whole seconds, for a sentence that changes each second. */
export const whole = (seconds: number): string =>
  seconds < 99.5 ? `${Math.max(0, Math.round(seconds))} s` : duration(seconds);

/** Return a probability in whole percent; never 0 or 100. */
export function percent(p: number): string {
  if (p > 0.99) return "over 99 %";
  if (p < 0.01) return "below 1 %";
  return `${Math.round(100 * p)} %`;
}

/** Return an uncertainty [m] in whole centimetres. */
export const plusMinus = (metres: number): string =>
  Number.isFinite(metres) ? `± ${Math.max(1, Math.round(100 * metres))} cm` : "Unknown";

const formats = new Map<string, Intl.DateTimeFormat>();

function format(timezone: string, options: Intl.DateTimeFormatOptions): Intl.DateTimeFormat {
  const key = timezone + JSON.stringify(options);
  let made = formats.get(key);
  if (!made) {
    made = new Intl.DateTimeFormat("en-GB", { timeZone: timezone, ...options });
    formats.set(key, made);
  }
  return made;
}

/** Return a moment as the site's clock shows it, or as the time within a recording. */
export function clock(t: number, timezone: string, digits = 0): string {
  if (!Number.isFinite(t)) return "--:--:--";
  const seconds = digits ? t.toFixed(digits).split(".")[1] : "";
  const tail = digits ? `.${seconds}` : "";
  if (t < UNIX_FROM_S) {
    const whole = Math.floor(digits ? Number(t.toFixed(digits)) : t);
    const two = (n: number) => String(Math.floor(n)).padStart(2, "0");
    return `${two(whole / 3600)}:${two((whole % 3600) / 60)}:${two(whole % 60)}${tail}`;
  }
  const options = { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" };
  return format(timezone, options as Intl.DateTimeFormatOptions).format(t * 1000) + tail;
}

/** Return hours and minutes. */
export const hourMinute = (t: number, timezone: string): string =>
  t < UNIX_FROM_S ? clock(t, timezone).slice(3) : clock(t, timezone).slice(0, 5);

/** Return the day: Mon 30 Nov; nothing for the times of a recording. */
export function day(t: number, timezone: string): string {
  if (!Number.isFinite(t)) return "";
  if (t < UNIX_FROM_S) return "Recording";
  return format(timezone, { weekday: "short", day: "2-digit", month: "short" })
    .format(t * 1000)
    .replace(",", "");
}

/** Return the name of a zone, camera or rule with a capital and without hyphens. */
export function named(name: string): string {
  const words = name.replaceAll(/[-_]+/g, " ").trim();
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** Return a number of things as one writes it. */
export const count = (n: number, one: string, many = `${one}s`): string =>
  `${n} ${n === 1 ? one : many}`;

/** Return names as a list: a, b and c. */
export const list = (names: readonly string[]): string =>
  names.length < 2
    ? (names[0] ?? "")
    : `${names.slice(0, -1).join(", ")} and ${names[names.length - 1] ?? ""}`;
