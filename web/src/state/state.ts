// The whole state of the page, and what a message or a person's action makes of it.

import { openAlerts, withEvent, type Alert, type Alerts } from "./alerts.ts";
import { isBack } from "./faults.ts";
import { assign, noMarks, type Marks } from "./marks.ts";
import type { CloudEvent, Health, Me, StreamMessage } from "./messages.ts";
import { readSnapshot, type Snapshot } from "./people.ts";
import type { Site } from "./site.ts";
import { STALLED_S, status, type Status } from "./status.ts";
import { UNIX_FROM_S } from "./words.ts";

/** Without a message for longer, the page has no connection [s]. */
export const SILENT_S = 3;

export type Access = "unknown" | "in" | "out";

export interface State {
  access: Access;
  me: Me | null;
  site: Site | null;
  health: Health | null;
  snapshot: Snapshot | null;
  marks: Marks;
  alerts: Alerts;
  /** Id of the last event, from which the server resumes. */
  lastEvent: string | number | null;
  link: "connecting" | "open" | "lost";
  tries: number;
  /** The page's own clock [s]. */
  local: number;
  startedAt: number;
  heardAt: number;
  retryAt: number;
  /** Server's time less our own; the least delayed message tells it best. */
  ahead: number;
  lastSent: number;
  /** What the page says after a lost connection came back; null once it has been read. */
  back: { missed: number; alerts: number; at: number } | null;
}

export type Action =
  | { type: "message"; message: StreamMessage; local: number }
  | { type: "tick"; local: number }
  | { type: "site"; site: Site }
  | { type: "events"; events: CloudEvent[]; last: string | number | null }
  | { type: "access"; access: Access; me?: Me | null }
  | { type: "opened"; local: number }
  | { type: "closed"; local: number; retryAt: number }
  | { type: "trying" }
  | { type: "seen back" };

export const initial = (local: number): State => ({
  access: "unknown",
  me: null,
  site: null,
  health: null,
  snapshot: null,
  marks: noMarks,
  alerts: new Map(),
  lastEvent: null,
  link: "connecting",
  tries: 0,
  local,
  startedAt: local,
  heardAt: NaN,
  retryAt: NaN,
  ahead: NaN,
  lastSent: NaN,
  back: null,
});

/** Return the server's time now [s]. */
export const serverTime = (state: State): number =>
  state.local + (Number.isFinite(state.ahead) ? state.ahead : 0);

/** Tell whether a recording is played: its people are of another day, or count from its start. */
export const isRecording = (state: State): boolean =>
  state.site?.recording === true || (state.snapshot?.t ?? UNIX_FROM_S) < UNIX_FROM_S;

/** Return now on the clock of the snapshots: the server's, or that of a recording up to its end. */
export function dataTime(state: State): number {
  const snapshot = state.snapshot;
  if (!snapshot || !isRecording(state)) return serverTime(state);
  if (state.health?.fusion.state === "ended") return snapshot.t;
  return snapshot.t + Math.max(0, serverTime(state) - snapshot.sent);
}

export function reduce(state: State, action: Action): State {
  switch (action.type) {
    case "message":
      return heard(state, action.message, action.local);
    case "tick":
      return ticked({ ...state, local: action.local });
    case "site":
      return { ...state, site: action.site };
    case "events":
      return {
        ...state,
        alerts: action.events.reduce((all, e) => withEvent(all, e, dataTime(state)), state.alerts),
        lastEvent: action.last ?? state.lastEvent,
      };
    case "access":
      return { ...state, access: action.access, me: action.me ?? state.me };
    case "opened":
      return { ...state, local: action.local, tries: 0, retryAt: NaN };
    case "closed":
      return {
        ...state, local: action.local, retryAt: action.retryAt, tries: state.tries + 1,
        link: Number.isFinite(state.heardAt) || state.tries > 0 ? "lost" : state.link,
      };
    case "trying":
      return { ...state, retryAt: NaN };
    case "seen back":
      return { ...state, back: null };
  }
}

function ticked(state: State): State {
  const silent = state.local - state.heardAt > SILENT_S;
  const back = state.back && state.local - state.back.at > 8 ? null : state.back;
  const link = state.link === "open" && silent ? "lost" : state.link;
  return { ...state, link, back };
}

function heard(before: State, message: StreamMessage, local: number): State {
  const offset = message.sent_s - local;
  const missed = local - before.heardAt;
  const returned = before.link === "lost" && missed > SILENT_S;
  const state: State = {
    ...before,
    local, heardAt: local, link: "open", tries: 0, retryAt: NaN,
    lastSent: message.sent_s,
    // A delay makes the offset smaller, never larger; forget slowly, for clocks drift.
    ahead: Number.isFinite(before.ahead) ? Math.max(offset, before.ahead - 1e-4) : offset,
    back: returned ? { missed, alerts: 0, at: local } : before.back,
  };
  switch (message.type) {
    case "snapshot":
      return withSnapshot(state, readSnapshot(message, state.snapshot));
    case "health":
      return { ...state, health: message };
    case "event":
      return {
        ...state,
        alerts: withEvent(state.alerts, message.event, dataTime(state)),
        lastEvent: message.event.id,
        back: state.back && message.event.data.phase === "new"
          ? { ...state.back, alerts: state.back.alerts + 1 }
          : state.back,
      };
    default:
      return state; // a kind of message that a newer server sends
  }
}

function withSnapshot(state: State, snapshot: Snapshot): State {
  const marks = assign(state.marks, snapshot.people.map((person) => person.id));
  return { ...state, snapshot, marks };
}

/** Return all open alerts, those about faults included, the most urgent first. */
export const open = (state: State): Alert[] =>
  openAlerts(state.alerts, dataTime(state)).map((alert) =>
    isBack(alert, state.health) ? { ...alert, back: true } : alert);

/** Return how old the newest people are [s]; NaN before the first, and for a recording. */
export const ageOf = (state: State): number =>
  state.snapshot && !isRecording(state) ? serverTime(state) - state.snapshot.t : NaN;

/** Whether what is known of people is too old to be shown as what is there now. */
export const isOld = (state: State): boolean => state.link === "lost" || ageOf(state) > STALLED_S;

/** Return the status sentence of the site now. */
export function statusOf(state: State): Status {
  const site = state.site;
  return status({
    link: state.link,
    lastTime: state.lastSent,
    waitFor: state.retryAt - state.local,
    connectingFor: state.local - state.startedAt,
    now: dataTime(state),
    health: state.health,
    age: ageOf(state),
    hasPeople: state.snapshot !== null,
    open: open(state),
    armed: state.health?.rules?.armed ?? site?.armed ?? 0,
    rules: state.health?.rules?.total ?? site?.rules ?? 0,
    next: null,
    timezone: site?.timezone ?? "UTC",
  });
}
