// Alerts: episodes folded from events, and the faults of cameras.

import { faultLine, faultTitle, partOf, type Part } from "./faults.ts";
import type { CloudEvent, EventData, Reason, Severity } from "./messages.ts";
import { duration, named, percent, whole } from "./words.ts";

export interface Alert {
  /** The episode's id, the same in all its phases. */
  id: string;
  kind: string;
  rule: string;
  severity: Severity;
  raisedFrom: Severity | null;
  predicted: boolean;
  /** How long before the beginning the warning came [s], and when it came; null without one. */
  lead: number | null;
  warned: number | null;
  joints: string[];
  threshold: Record<string, number>;
  /** When the condition began to hold, or will [s]. */
  start: number;
  detected: number;
  end: number | null;
  ack: { by: string | null; t: number } | null;
  shelved: { until: number; by: string | null; note: string | null } | null;
  closed: { reason: Reason; by: string | null; note: string | null; t: number } | null;
  probability: number | null;
  people: number[];
  place: string | null;
  /** The part of the site that fails; null for an alert about people. */
  part: Part | null;
  camera: string | null;
  /** How the part is, and what is wrong with it, in the server's words. */
  state: string | null;
  fault: string | null;
  /** Whether the part works again although the alert has not ended. */
  back: boolean;
  count: number | null;
  measures: Record<string, number>;
  cameras: string[];
}

export type Alerts = ReadonlyMap<string, Alert>;

const RANK: Record<Severity, number> = { info: 0, warning: 1, alarm: 2, critical: 3 };
export const FLOOD = { alerts: 10, seconds: 600 };

const timeOf = (event: CloudEvent, now: number): number => {
  const t = event.time ? Date.parse(event.time) / 1000 : NaN;
  return Number.isFinite(t) ? t : now;
};

const numbers = (measures: Record<string, number | string | null> | undefined): Record<string, number> =>
  Object.fromEntries(
    Object.entries(measures ?? {}).filter((m): m is [string, number] => typeof m[1] === "number"),
  );

function cameraOf(data: EventData, kind: string): string | null {
  if (partOf(kind) !== "camera") return null;
  return data.camera ?? data.evidence?.cameras?.[0] ?? null;
}

function begun(event: CloudEvent, now: number): Alert {
  const { data } = event;
  const t = data.t_detect_s ?? data.t_start_s ?? timeOf(event, now);
  const kind = data.rule?.kind ?? event.type.replace(/^trecsim\.|\.v1$/g, "");
  return {
    id: data.event,
    kind,
    rule: data.rule?.id ?? "",
    severity: data.severity ?? "warning",
    raisedFrom: null,
    predicted: false,
    lead: null,
    warned: data.predicted ? t : null,
    joints: [],
    threshold: {},
    start: data.t_start_s ?? t,
    detected: t,
    end: null,
    ack: null, shelved: null, closed: null,
    probability: null,
    people: [],
    place: data.zone ?? data.edge ?? data.line ?? null,
    part: partOf(kind),
    camera: cameraOf(data, kind),
    state: null, fault: null, back: false,
    count: null,
    measures: {},
    cameras: [],
  };
}

/** Return the alerts after one event. An event that comes twice changes nothing. */
export function withEvent(alerts: Alerts, event: CloudEvent, now: number): Alerts {
  const { data } = event;
  if (!data?.event) return alerts;
  const before = alerts.get(data.event) ?? begun(event, now);
  const next = new Map(alerts);
  next.set(data.event, stepped(told(before, data), event, now));
  return next;
}

/** Take over what an event tells of the condition itself. */
function told(alert: Alert, data: EventData): Alert {
  const raised = data.severity && RANK[data.severity] > RANK[alert.severity] && !alert.predicted;
  return {
    ...alert,
    severity: data.severity ?? alert.severity,
    raisedFrom: raised ? alert.severity : alert.raisedFrom,
    predicted: data.predicted ?? alert.predicted,
    lead: data.lead_s ?? alert.lead,
    // What was expected has begun: it is detected now.
    detected: alert.predicted && data.predicted === false ? (data.t_detect_s ?? alert.detected) : alert.detected,
    joints: data.joints ?? alert.joints,
    threshold: data.threshold ? numbers(data.threshold) : alert.threshold,
    start: data.t_start_s ?? alert.start,
    end: data.t_end_s ?? alert.end,
    probability: data.probability ?? alert.probability,
    // Faults of the site list who was there; they are about nobody of them.
    people: alert.part ? [] : (data.people?.map((one) => one.person) ?? alert.people),
    count: data.count ?? alert.count,
    state: data.state ?? alert.state,
    fault: data.fault ?? alert.fault,
    measures: data.measures ? numbers(data.measures) : alert.measures,
    cameras: data.evidence?.cameras ?? alert.cameras,
  };
}

/** Take over what the phase of an event changes. */
function stepped(alert: Alert, event: CloudEvent, now: number): Alert {
  const { data } = event;
  const by = data.by ?? null;
  const t = timeOf(event, data.t_detect_s ?? now);
  switch (data.phase) {
    case "new":
      return alert;
    case "update":
      // Rising severity notifies again: neither an acknowledgement nor shelving holds.
      return alert.raisedFrom && data.severity && RANK[data.severity] > RANK[alert.raisedFrom]
        ? { ...alert, ack: null, shelved: null }
        : alert;
    case "end":
      return { ...alert, end: alert.end ?? t };
    case "ack":
      return { ...alert, ack: { by, t } };
    case "shelve":
      return { ...alert, shelved: { until: data.until_s ?? t, by, note: data.note ?? null } };
    case "unshelve":
      return { ...alert, shelved: null };
    case "close":
      return {
        ...alert,
        closed: { reason: data.reason ?? "true", by, note: data.note ?? null, t },
      };
    case "reopen":
      return { ...alert, closed: null };
  }
}

export type Handling = "new" | "acknowledged" | "ended" | "shelved" | "closed";

/** Return how an alert stands now. */
export function handling(alert: Alert, now: number): Handling {
  if (alert.closed) return "closed";
  if (alert.shelved && alert.shelved.until > now) return "shelved";
  if (alert.ack) return alert.end === null ? "acknowledged" : "closed";
  return alert.end === null ? "new" : "ended";
}

/** Whether the condition holds now. */
export const isActive = (alert: Alert): boolean => alert.end === null && alert.closed === null;

/** A happening of one moment is shown for so long [s]. */
const MOMENT_S = 2;

/** Whether the condition of an alert held at a time. */
export const holds = (alert: Alert, t: number): boolean =>
  t >= alert.start && t <= Math.max(alert.end ?? Infinity, alert.start + MOMENT_S);

/** Order alerts by severity, then the newest first. */
export const urgent = (a: Alert, b: Alert): number =>
  RANK[b.severity] - RANK[a.severity] || b.start - a.start || a.id.localeCompare(b.id);

/** Return the alerts that are listed as cards: not closed, the most urgent first. */
export function openAlerts(alerts: Alerts, now: number): Alert[] {
  const order: Record<Handling, number> = {
    new: 0, ended: 0, acknowledged: 1, shelved: 2, closed: 3,
  };
  return [...alerts.values()]
    .filter((alert) => handling(alert, now) !== "closed")
    .sort(
      (a, b) =>
        order[handling(a, now)] - order[handling(b, now)] || urgent(a, b),
    );
}

/** Return the alerts that are over and dealt with, newest first. */
export const closedAlerts = (alerts: Alerts, now: number): Alert[] =>
  [...alerts.values()]
    .filter((alert) => handling(alert, now) === "closed")
    .sort((a, b) => b.start - a.start);

/** Return cards: an alert each, or many of one rule and place as one while there is a flood. */
export function cards(open: readonly Alert[], now: number): Alert[][] {
  const recent = open.filter((alert) => now - alert.start <= FLOOD.seconds);
  if (recent.length < FLOOD.alerts) return open.map((alert) => [alert]);
  const groups = new Map<string, Alert[]>();
  for (const alert of open) {
    const key = `${alert.rule}/${alert.place ?? ""}/${alert.camera ?? ""}/${handling(alert, now)}`;
    groups.set(key, [...(groups.get(key) ?? []), alert]);
  }
  return [...groups.values()];
}

/** Return when cameras were silent, as the server tells it. */
export const outages = (alerts: Alerts): { camera: string; from: number; to: number }[] =>
  [...alerts.values()].flatMap((one) =>
    one.camera === null ? [] : [{ camera: one.camera, from: one.start, to: one.end ?? Infinity }]);

export const isFault = (state: string): boolean => state === "stale" || state === "down";

const TITLES: Record<string, (alert: Alert, who: string, where: string) => string> = {
  "edge.platform": (_, who) => `${who} beyond platform edge`,
  "zone.restricted": (_, who, where) => `${who} in ${where}`,
  "zone.enter": (_, _who, where) => `${where} entered`,
  "zone.exit": (_, _who, where) => `${where} left`,
  "zone.dwell": (a, _who, where) => `${where}, stayed ${long(a) || "too long"}`,
  "line.cross": (_, _who, where) => `${where} crossed`,
  "occupancy.limit": (a) => `${a.count ?? "Too many"} or more waiting`,
  "density.level": (_, _who, where) => `${where} is crowded`,
  "speed.running": (_, who) => `${who} runs`,
  "body.fall": (_, who) => `${who} fell`,
  "body.down": (a, who) => `${who} down${long(a) && `, ${long(a)}`}`,
  "flow.wrong_way": (_, who) => `${who} goes the wrong way`,
  "zone.confined": (_, who, where) => `${who} has left ${where}`,
  "density.critical": (_, _who, where) => `${where} is dangerously crowded`,
  "crowd.pressure": (_, _who, where) => `Crowd turbulence in ${where}`,
  "flow.bottleneck": (_, _who, where) => `Flow through ${where} breaks down`,
  "crowd.panic": () => "Several people run",
  "body.climb": (_, who) => `${who} climbs`,
  "body.reach": (_, who, where) => `${who} reaches into ${where}`,
  "body.distress": (_, who) => `${who} calls for help`,
  "group.split": (_, who) => `${who} is left alone`,
};

/** Return how long it had lasted when it was detected, or in all; nothing below a second. */
function long(alert: Alert): string {
  const s = lasted(alert, alert.end ?? alert.detected);
  return s < 0.95 ? "" : whole(s);
}

export const lasted = (alert: Alert, now: number): number =>
  Math.max(0, (alert.end ?? now) - alert.start);

/** Return whether it is of one moment, as crossing a line is. */
export const isMomentary = (alert: Alert): boolean => alert.end !== null && alert.end <= alert.start;

/** Return who or what, and what: the title of an alert's card. */
export function title(alert: Alert, withNumber = false): string {
  if (alert.part) return faultTitle(alert);
  const number = alert.people[0];
  const who = withNumber && number !== undefined ? `Person ${number}` : "Person";
  const where = alert.place ? named(alert.place) : "the site";
  if (alert.predicted) return `${who} heads for ${where.toLowerCase()}`;
  return TITLES[alert.kind]?.(alert, who, where) ?? `${named(alert.rule || alert.kind)}`;
}

/** Return the title without who it is about: for a callout above that person. */
export function what(alert: Alert): string {
  const text = title(alert).replace(/^Person /, "");
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** Return where it is and whether it goes on: the second line of a card. */
export function where(alert: Alert, now: number): string {
  if (alert.part) return faultLine(alert, now);
  const place = alert.place ? `${named(alert.place)}. ` : "";
  if (isMomentary(alert)) return place.trim();
  if (alert.end !== null) return `${place}Over after ${duration(lasted(alert, now))}.`;
  if (alert.predicted) {
    return `${place}${alert.probability === null ? "" : `Chance ${percent(alert.probability)}.`}`;
  }
  return `${place}Still there.`;
}

export interface Figure {
  value: string;
  words: string;
}

/** Return the three figures of "is it real?", those that are known. */
export function figures(alert: Alert, cameras: number): Figure[] {
  const found: Figure[] = [];
  if (alert.part) return found;
  if (alert.cameras.length > 0) {
    found.push({ value: `${alert.cameras.length} of ${cameras}`, words: "cameras see it" });
  }
  if (alert.probability !== null) {
    found.push({ value: percent(alert.probability), words: "certain" });
  }
  const measure = Object.entries(alert.measures)[0];
  if (measure) found.push(measured(measure[0], measure[1]));
  return found;
}

const UNITS: [RegExp, string, number][] = [
  [/_mps$/, "m/s", 1], [/_per_m2$/, "/m²", 1], [/_deg$/, "°", 0], [/_m$/, "m", 1], [/_s$/, "s", 1],
];

/** Return a measure of a rule as a number with its unit, and in words. */
export function measured(name: string, value: number): Figure {
  const ahead = /^probability_([\d.]+)s$/.exec(name);
  if (ahead) return { value: percent(value), words: `within ${ahead[1]} s` };
  const unit = UNITS.find(([pattern]) => pattern.test(name));
  const words = name.replace(unit?.[0] ?? /$^/, "").replaceAll("_", " ");
  return {
    value: unit ? `${value.toFixed(unit[2])} ${unit[1]}` : `${Number(value.toPrecision(3))}`,
    words,
  };
}

/** Return who did something, in words; nothing for whoever sits at a machine without users. */
export const actor = (by: string | null | undefined): string =>
  !by || by === "local" ? "" : by === "token" ? "a program" : by;

export const REASONS: Record<Reason, string> = {
  true: "True", false: "False alarm", test: "Test", expected: "Expected",
};

/** Return what was done about an alert, in a few words. */
export function handled(alert: Alert, now: number, clock: (t: number) => string): string {
  switch (handling(alert, now)) {
    case "acknowledged":
      return "acknowledged";
    case "ended":
      return "ended";
    case "shelved":
      return `shelved to ${clock(alert.shelved?.until ?? now).slice(0, 5)}`;
    case "closed":
      return alert.closed ? `closed, ${REASONS[alert.closed.reason].toLowerCase()}` : "over";
    case "new":
      if (alert.predicted) return `early, in ${duration(alert.start - now)}`;
      return alert.raisedFrom ? `raised from ${named(alert.raisedFrom)}` : "";
  }
}
