// When a rule is armed: ranges of a week as the site file writes them, and as hours of a week.

export const DAYS = ["Mo", "Tu", "We", "Th", "Fr", "Sa", "Su"] as const;

/** Seven days of 24 hours, Monday first: whether the rule is armed. */
export type Week = boolean[][];

const FORM = /^(?:([A-Za-z,-]+)\s+)?(\d\d):(\d\d)-(\d\d):(\d\d)$/;

const dayAt = (name: string): number => DAYS.findIndex((day) => day === name);

function days(words: string): number[] | null {
  const found: number[] = [];
  for (const part of words.split(",")) {
    const [first = "", last = first] = part.split("-");
    const [from, to] = [dayAt(first), dayAt(last)];
    if (from < 0 || to < 0) return null;
    for (let step = 0; step <= (to - from + 7) % 7; step++) found.push((from + step) % 7);
  }
  return found;
}

export const always = (): Week => DAYS.map(() => Array<boolean>(24).fill(true));

/** Read ranges; null where one is not of whole hours. */
export function readWeek(ranges: readonly string[]): Week | null {
  const week: Week = DAYS.map(() => Array<boolean>(24).fill(false));
  for (const range of ranges) {
    const found = FORM.exec(range.trim());
    const on = found && days(found[1] ?? "Mo-Su");
    if (!found || !on || found[3] !== "00" || found[5] !== "00") return null;
    const [from, to] = [Number(found[2]), Number(found[4])];
    const end = to > from ? to : to + 24;
    for (const day of on) {
      for (let hour = from; hour < end; hour++) {
        const at = (day + Math.floor(hour / 24)) % 7;
        (week[at] as boolean[])[hour % 24] = true;
      }
    }
  }
  return week;
}

const two = (n: number): string => String(n).padStart(2, "0");

/** Return the spans of a day, as [from, to] in hours. */
function spans(day: readonly boolean[]): [number, number][] {
  const found: [number, number][] = [];
  day.forEach((on, hour) => {
    const last = found.at(-1);
    if (on && last?.[1] === hour) last[1] = hour + 1;
    else if (on) found.push([hour, hour + 1]);
  });
  return found;
}

/** Return the names of days, those in a row as a range: Mo-Fr. */
function dayWords(on: readonly number[]): string {
  if (on.length === 7) return "Mo-Su";
  const parts: [number, number][] = [];
  for (const day of on) {
    const last = parts.at(-1);
    if (last && last[1] === day - 1) last[1] = day;
    else parts.push([day, day]);
  }
  return parts.map(([a, b]) => (a === b ? DAYS[a] : `${DAYS[a]}-${DAYS[b]}`)).join(",");
}

/** Write hours as ranges; undefined for always. */
export function writeWeek(week: Week): string[] | undefined {
  if (week.every((day) => day.every(Boolean))) return undefined;
  const byspan = new Map<string, number[]>();
  week.forEach((day, n) => {
    for (const [from, to] of spans(day)) {
      const key = `${two(from)}:00-${two(to)}:00`;
      byspan.set(key, [...(byspan.get(key) ?? []), n]);
    }
  });
  const ranges = [...byspan].map(([span, on]) => ({ span, on }));
  const merged = ranges.map(({ span, on }) => overnight(span, on, byspan)).filter((one) => one !== null);
  return merged.map(({ span, on }) => `${dayWords(on)} ${span}`);
}

/** Join an evening to the morning after it where both are on the same days, one later. */
function overnight(
  span: string, on: number[], all: ReadonlyMap<string, number[]>,
): { span: string; on: number[] } | null {
  const next = (days_: readonly number[]) => days_.map((day) => (day + 1) % 7).sort((a, b) => a - b);
  const same = (a: readonly number[], b: readonly number[]) => a.join() === b.join();
  if (span.endsWith("-24:00") && !span.startsWith("00:00")) {
    for (const [other, theirs] of all) {
      if (other.startsWith("00:00-") && other !== "00:00-24:00" && same(next(on), theirs)) {
        return { span: `${span.slice(0, 5)}-${other.slice(6)}`, on };
      }
    }
  }
  if (span.startsWith("00:00-") && span !== "00:00-24:00") {
    for (const [other, theirs] of all) {
      if (other.endsWith("-24:00") && other !== "00:00-24:00" && same(next(theirs), on)) return null;
    }
  }
  return { span, on };
}
