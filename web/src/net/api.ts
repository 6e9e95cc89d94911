// Requests of the page. Each error says what could not be done, in the server's words.

import type { CloudEvent, Me, Modes, Reason } from "../state/messages.ts";

export class SignedOut extends Error {}

declare global {
  interface Window {
    /** The answer to who is signed in, asked for before the page was loaded; taken once. */
    me?: Promise<Response> | undefined;
  }
}

const request = (path: string, options: RequestInit = {}): Promise<Response> =>
  checked(fetch(path, { credentials: "same-origin", cache: "no-store", ...options }));

async function checked(asked: Promise<Response>): Promise<Response> {
  const response = await asked;
  if (response.status === 401) throw new SignedOut("signed out");
  return response;
}

async function json<T>(path: string, accept: readonly number[] = [200]): Promise<T> {
  const response = await request(path);
  if (!accept.includes(response.status)) throw new Error(await reason(response));
  return (await response.json()) as T;
}

/** Return why the server refused, in its words where it gives some. */
async function reason(response: Response): Promise<string> {
  try {
    const body = (await response.json()) as Record<string, unknown>;
    const text = body.error ?? body.detail ?? body.message;
    if (typeof text === "string" && text) return text;
  } catch {
    // no JSON: the number tells
  }
  return `The server answered ${response.status}.`;
}

async function send(path: string, body: unknown, csrf: string | null): Promise<unknown> {
  const headers: Record<string, string> = { "Content-Type": "application/json" };
  if (csrf) headers["X-CSRF-Token"] = csrf;
  const response = await request(path, { method: "POST", headers, body: JSON.stringify(body) });
  if (!response.ok) throw new Error(await reason(response));
  return response.status === 204 ? null : response.json().catch(() => null);
}

export const getSite = (): Promise<unknown> => json("/api/site");

/** Return who is signed in; null where the server has no users. */
export async function getMe(): Promise<Me | null> {
  const asked = window.me;
  delete window.me;
  const response = await (asked ? checked(asked) : request("/api/me"));
  return response.ok ? ((await response.json()) as Me) : null;
}

export async function signIn(user: string, password: string): Promise<void> {
  const response = await fetch("/api/login", {
    method: "POST",
    credentials: "same-origin",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ user, password }),
  });
  if (response.ok) return;
  if (response.status === 429) throw new Error("Too many tries. Wait a minute, then try again.");
  if (response.status === 401) throw new Error("Name or password is wrong.");
  throw new Error(await reason(response));
}

export const signOut = (csrf: string | null): Promise<unknown> => send("/api/logout", {}, csrf);

export async function getEvents(): Promise<{ events: CloudEvent[]; last: string | number | null }> {
  const body = await json<unknown>("/api/events", [200, 404]);
  const rows = Array.isArray(body) ? body : ((body as { events?: unknown[] })?.events ?? []);
  const events: CloudEvent[] = [];
  let last: string | number | null = null;
  for (const row of rows as (CloudEvent & { event?: CloudEvent })[]) {
    const event = row.event ?? row;
    if (event?.data?.event) events.push(event);
    last = row.id ?? last;
  }
  return { events, last };
}

export interface Act {
  phase: "ack" | "shelve" | "unshelve" | "close" | "reopen";
  until_s?: number;
  reason?: Reason;
  note?: string;
}

/** Do something to an alert; return the event that comes of it. */
export async function act(event: string, what: Act, csrf: string | null): Promise<CloudEvent | null> {
  const body = await send(`/api/events/${encodeURIComponent(event)}`, what, csrf);
  const made = (body as { event?: CloudEvent } | null)?.event;
  return made?.data?.event ? made : null;
}

/** Return the alerts that this user has reviewed. */
export const getReviewed = async (): Promise<string[]> =>
  (await json<{ events?: string[] }>("/api/users/me/reviewed")).events ?? [];

export const markReviewed = (event: string, reviewed: boolean, csrf: string | null): Promise<unknown> =>
  send("/api/users/me/reviewed", { events: [event], reviewed }, csrf);

export interface Recording {
  id: string;
  from_s: number;
  to_s: number;
  people: number;
}

export async function getRecordings(): Promise<Recording[]> {
  const body = await json<unknown>("/api/recordings", [200, 404]);
  const rows = Array.isArray(body) ? body : ((body as { recordings?: unknown[] })?.recordings ?? []);
  return rows as Recording[];
}

/** Return the snapshots of a part of a recording: one message a line. */
export async function getSnapshots(id: string, from: number, to: number): Promise<string[]> {
  const query = `from_s=${from.toFixed(3)}&to_s=${to.toFixed(3)}`;
  const response = await request(`/api/recordings/${encodeURIComponent(id)}/snapshots?${query}`);
  if (!response.ok) throw new Error(await reason(response));
  return (await response.text()).split("\n").filter(Boolean);
}

export interface Curve {
  rule: string;
  kind: string;
  about: string;
  person: number | null;
  p_on: number;
  p_off: number;
  on_delay_s: number;
  off_delay_s: number;
  hold_s: number;
  keys: Record<string, number | string>;
  t_s: number[];
  probability: (number | null)[];
  measures: Record<string, (number | null)[]>;
}

/** Return the probability of an alert's condition over time, as the recording gives it. */
export const getCurve = (event: string): Promise<Curve> =>
  json(`/api/events/${encodeURIComponent(event)}/why`);

export const getModes = (): Promise<Modes> => json("/api/mode");

/** Put a mode in force, or a rule off; return what holds then. */
export const setMode = async (
  what: { mode?: string | null; until_s?: number; bypass?: { rule: string; until_s?: number } },
  csrf: string | null,
): Promise<Modes> => (await send("/api/mode", what, csrf)) as Modes;
