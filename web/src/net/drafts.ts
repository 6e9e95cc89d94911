// Requests of the zone editor.

import { SignedOut } from "./api.ts";
import type { Kind, Parts, Remark } from "../state/draft.ts";

export interface LiveParts extends Parts {
  version: string;
  remarks: Remark[];
  has_file: boolean;
}

export interface Draft extends Omit<Parts, "rules" | "exclusions" | "portals"> {
  exclusions: Parts["exclusions"] | null;
  portals: Parts["portals"] | null;
  based_on: string;
  revision: number;
  by: string;
  rules: Parts["rules"] | null;
  remarks: Remark[];
}

export interface Episode {
  event: string;
  rule: string;
  kind: string;
  severity: "info" | "warning" | "alarm" | "critical";
  t_start_s: number;
  t_end_s: number | null;
  probability: number;
  people: number[];
  place: string | null;
  in: "both" | "draft" | "live";
}

export interface Trial {
  recording: string;
  moments: number;
  people: number;
  from_s: number | null;
  to_s: number | null;
  rules: Record<string, { draft: number; live: number }>;
  episodes: Episode[];
  left_out: number;
}

export interface Version { version: string; until_s: number }

/** What the server refused, with what is wrong in a draft, place by place. */
export class Refused extends Error {
  readonly status: number;
  readonly faults: Remark[];

  constructor(status: number, text: string, faults: Remark[] = []) {
    super(text);
    this.status = status;
    this.faults = faults;
  }
}

async function ask<T>(
  path: string, method = "GET", body: unknown = undefined, csrf: string | null = null,
): Promise<T> {
  const headers: Record<string, string> = body === undefined ? {} : { "Content-Type": "application/json" };
  if (csrf) headers["X-CSRF-Token"] = csrf;
  const response = await fetch(path, {
    method, headers, credentials: "same-origin", cache: "no-store",
    body: body === undefined ? null : JSON.stringify(body),
  });
  if (response.status === 401) throw new SignedOut("signed out");
  if (response.status === 204) return null as T;
  const answer = (await response.json().catch(() => ({}))) as Record<string, unknown>;
  if (!response.ok) {
    const text = typeof answer.error === "string" ? answer.error : `The server answered ${response.status}.`;
    throw new Refused(response.status, text, (answer.faults as Remark[] | undefined) ?? []);
  }
  return answer as T;
}

export const getParts = (): Promise<LiveParts> => ask("/api/site/parts");
export const getDraft = (): Promise<Draft | null> => ask("/api/site/draft");
export const getKinds = async (): Promise<Kind[]> =>
  (await ask<{ kinds: Kind[] }>("/api/site/kinds")).kinds;
export const getVersions = async (): Promise<Version[]> =>
  (await ask<{ versions: Version[] }>("/api/site/history")).versions;
export const getVersion = (version: string): Promise<Parts> => ask(`/api/site/history/${version}`);

export const putDraft = (
  based_on: string, revision: number, parts: Parts, csrf: string | null,
): Promise<Draft> => ask("/api/site/draft", "PUT", { based_on, revision, ...parts }, csrf);

export const dropDraft = (csrf: string | null): Promise<null> =>
  ask("/api/site/draft", "DELETE", undefined, csrf);

export const makeLive = (
  based_on: string, revision: number, csrf: string | null,
): Promise<{ version: string }> => ask("/api/site/draft/live", "POST", { based_on, revision }, csrf);

export const tryDraft = (
  based_on: string, recording: string, from_s: number, to_s: number, csrf: string | null,
): Promise<Trial> =>
  ask("/api/site/draft/try", "POST", { based_on, recording, from_s, to_s }, csrf);
