// The sentence that says whether all is well: the first case that holds.

import { actor, handling, isActive, isFault, title, where, type Alert } from "./alerts.ts";
import type { Health, Severity } from "./messages.ts";
import { clock, count, list, named, whole } from "./words.ts";

export type Look = "lost" | "filled" | "outlined" | "plain" | "dashed" | "clear" | "connecting";

export interface Status {
  row: 0 | 1 | 2 | 3 | 4 | 5 | 6 | 7;
  look: Look;
  severity: Severity | null;
  icon: "lost" | "clear" | "unarmed" | "severity" | "connecting";
  title: string;
  line: string;
}

export interface Situation {
  link: "connecting" | "open" | "lost";
  /** The server's time of its last message; NaN before the first. */
  lastTime: number;
  /** Seconds until the next try; NaN while one is under way. */
  waitFor: number;
  connectingFor: number;
  now: number;
  health: Health | null;
  /** Age of the newest people message [s]; NaN before the first, and of a recording. */
  age: number;
  hasPeople: boolean;
  /** Alerts that are not closed, the most urgent first. */
  open: readonly Alert[];
  armed: number;
  rules: number;
  next: string | null;
  timezone: string;
}

/** Without a people message for longer, nobody is watched, whatever the health says [s]. */
export const STALLED_S = 3;

const base = { severity: null, icon: "severity" } as const;

/** Return the status of the site. "All clear" only where everything is known to be well. */
export function status(s: Situation): Status {
  return (
    disconnected(s) ?? stopped(s) ?? alarmed(s) ?? acknowledged(s) ?? warned(s) ?? unarmed(s)
    ?? clear(s)
  );
}

function disconnected(s: Situation): Status | null {
  const waits = !s.health || (!s.hasPeople && s.health.fusion.state === "running");
  if (s.link === "connecting" || (s.link === "open" && waits)) {
    return {
      ...base, row: 0, look: "connecting", icon: "connecting", title: "Connecting…",
      line: s.connectingFor > 3 ? "Waiting for the first people message." : "",
    };
  }
  if (s.link === "open") return null;
  const since = Number.isFinite(s.lastTime) ? ` since ${clock(s.lastTime, s.timezone)}` : "";
  const next = Number.isFinite(s.waitFor)
    ? `Trying again in ${Math.max(1, Math.ceil(s.waitFor))} s.`
    : "Trying again now.";
  return {
    ...base, row: 1, look: "lost", icon: "lost", title: "No connection",
    line: `State of the site unknown${since}. ${next}`,
  };
}

function stopped(s: Situation): Status | null {
  const fusion = s.health?.fusion;
  if (fusion?.state === "starting") {
    return {
      ...base, row: 2, look: "plain", severity: "warning", title: "Watching has not begun",
      line: "3D people: no result yet. The first start on a machine takes minutes.",
    };
  }
  if (fusion?.state === "ended") {
    return {
      ...base, row: 2, look: "dashed", icon: "unarmed", title: "The recording has ended",
      line: "Nothing is watched now.",
    };
  }
  const late = s.age > STALLED_S;
  if (fusion?.state !== "stalled" && !late) return null;
  const age = late ? s.age : (fusion?.age_s ?? NaN);
  const how = Number.isFinite(age) ? `no result for ${whole(age)}` : "no result";
  return {
    ...base, row: 2, look: "filled", severity: "alarm", title: "Watching has stopped",
    line: `3D people: ${how}.`,
  };
}

const isAlarm = (alert: Alert): boolean =>
  (alert.severity === "alarm" || alert.severity === "critical") && !alert.predicted;

function alarmed(s: Situation): Status | null {
  const alarms = s.open.filter((a) => isAlarm(a) && ["new", "ended"].includes(handling(a, s.now)));
  const first = alarms[0];
  if (!first) return null;
  const look = { ...base, row: 3, look: "filled", severity: first.severity } as const;
  if (alarms.length === 1) return { ...look, title: title(first), line: sentence(first, s.now) };
  const kind = alarms.every((a) => a.severity === "critical") ? "critical alarms" : "alarms";
  return { ...look, title: `${alarms.length} ${kind}`, line: `First: ${lower(title(first))}.` };
}

function acknowledged(s: Situation): Status | null {
  const alarms = s.open.filter(
    (a) => isAlarm(a) && isActive(a) && ["acknowledged", "shelved"].includes(handling(a, s.now)),
  );
  const first = alarms[0];
  if (!first) return null;
  const shelved = alarms.every((a) => handling(a, s.now) === "shelved");
  return {
    ...base, row: 4, look: "outlined", severity: first.severity,
    title: `${count(alarms.length, "alarm")}, ${shelved ? "shelved" : "acknowledged"}`,
    line: first.part ? `${title(first)}.` : `${title(first)}, still there.`,
  };
}

function warned(s: Situation): Status | null {
  const look = { ...base, row: 5, look: "plain", severity: "warning" } as const;
  const warnings = s.open.filter((a) => isActive(a) && !a.part && a.severity !== "info");
  const people = warnings.filter((a) => handling(a, s.now) !== "shelved")[0];
  if (people) {
    const more = warnings.length - 1;
    return {
      ...look, title: title(people),
      line: more ? `And ${count(more, "other warning")}.` : where(people, s.now),
    };
  }
  const said = faultWords(s);
  return said && { ...look, ...said };
}

type Words = Pick<Status, "title" | "line">;

/** Return what fails now, or worked again a moment ago and is not acknowledged. */
function faultWords(s: Situation): Words | null {
  const rules = s.health?.rules?.fault;
  if (rules) return { title: "Rules fail", line: `Alerts for people may be missing: ${rules}.` };
  const cameras = faulty(s.health);
  const store = s.health?.store;
  if (cameras.length > 0) return cameraWords(s, cameras, store?.state === "failing");
  if (store?.state === "failing") {
    const reason = store.fault ? `: ${store.fault}` : "";
    const line = `People are tracked. Storage fails${reason}.`;
    return { title: "Nothing is recorded", line: line + handledBy(s, (a) => a.part === "store") };
  }
  const back = s.open.find((a) => a.back && handling(a, s.now) === "new");
  return back ? { title: title(back), line: where(back, s.now) } : doubtful(s.health);
}

/** Return which camera sends pictures and has a fault all the same, as one that is frozen. */
function doubtful(health: Health | null): Words | null {
  const [first, ...others] = Object.entries(health?.cameras ?? {})
    .filter(([, camera]) => camera.state === "live" && camera.fault);
  if (!first) return null;
  const more = others.length ? ` And ${count(others.length, "other camera")}.` : "";
  return { title: `Camera ${named(first[0])} is in doubt`, line: sentenceOf(first[1].fault ?? "") + more };
}

function faulty(health: Health | null): [string, string][] {
  return Object.entries(health?.cameras ?? {})
    .filter(([, camera]) => isFault(camera.state))
    .map(([name, camera]) => [name, camera.state]);
}

function cameraWords(s: Situation, faults: [string, string][], unstored: boolean): Words {
  const tail = unstored ? " Nothing is recorded." : "";
  const names = faults.map(([name]) => named(name));
  const [name, state] = faults[0] as [string, string];
  if (faults.length === 1) {
    const done = handledBy(s, (alert) => alert.camera === name);
    return {
      title: `Camera ${names[0]} is ${state}`,
      line: `No alert for people. What it sees is less well covered.${tail}${done}`,
    };
  }
  return {
    title: `${faults.length} cameras send no picture`,
    line: `${list(names)}. What they see is less well covered.${tail}`,
  };
}

/** Return that somebody knows of a fault, and who. */
function handledBy(s: Situation, which: (alert: Alert) => boolean): string {
  const alert = s.open.find((a) => isActive(a) && which(a));
  const how = alert && handling(alert, s.now);
  if (how !== "acknowledged" && how !== "shelved") return "";
  const by = actor(how === "shelved" ? alert?.shelved?.by : alert?.ack?.by);
  return ` ${how === "shelved" ? "Shelved" : "Acknowledged"}${by ? ` by ${by}` : ""}.`;
}

function unarmed(s: Situation): Status | null {
  if (s.armed > 0) return null;
  const why = s.rules === 0 ? "There are no rules yet." : s.next ? `Next: ${s.next}.` : "";
  return {
    ...base, row: 6, look: "dashed", icon: "unarmed", title: "Nothing is armed",
    line: `No alert for people can fire. ${why}`.trim(),
  };
}

function clear(s: Situation): Status {
  const ended = s.open.filter((alert) => !isActive(alert)).length;
  const shelved = s.open.filter((alert) => isActive(alert)).length;
  const line = ended
    ? `Nothing active. ${count(ended, "ended alert is", "ended alerts are")} still to be closed.`
    : shelved
      ? `${count(shelved, "alert is", "alerts are")} shelved. Every rule and camera is working.`
      : "Nothing open. Every rule and camera is working.";
  return { ...base, row: 7, look: "clear", icon: "clear", title: "All clear", line };
}

/** Return where the alarm is and how long it has held. */
function sentence(alert: Alert, now: number): string {
  if (alert.end !== null || alert.part) return where(alert, now);
  const place = alert.place ? `${named(alert.place)}. ` : "";
  return `${place}For ${whole(now - alert.start)}, still there.`;
}

const sentenceOf = (text: string): string =>
  text.charAt(0).toUpperCase() + text.slice(1) + (/[.?]$/.test(text) ? "" : ".");

const lower = (text: string): string => text.charAt(0).toLowerCase() + text.slice(1);
