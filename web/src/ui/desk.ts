// The desk of the zone editor: the draft in hand, its past, and what the server says of it.

import { useEffect, useState } from "preact/hooks";
import {
  dropDraft, getDraft, getKinds, getParts, makeLive, putDraft, Refused, tryDraft,
  type Draft, type Trial,
} from "../net/drafts.ts";
import { nothing, same, type Kind, type Parts, type Remark } from "../state/draft.ts";
import { store } from "../store.ts";

const KEEP_MS = 600;
const MOST_STEPS = 100;

type Keeping = "live" | "changed" | "keeping" | "kept" | "wrong" | "conflict" | "failed";

export class Desk {
  live: Parts = nothing;
  version = "";
  kinds: Kind[] = [];
  parts: Parts = nothing;
  revision = 0;
  by = "";
  keeping: Keeping = "live";
  /** What is wrong, and what is doubtful. */
  faults: Remark[] = [];
  remarks: Remark[] = [];
  said = "";
  trial: Trial | null = null;
  trying = false;
  loaded = false;
  hasFile = true;
  fault = "";

  #past: Parts[] = [];
  #future: Parts[] = [];
  #merging = "";
  #timer = 0;
  #tell = new Set<() => void>();
  #sending = false;

  subscribe(tell: () => void): () => void {
    this.#tell.add(tell);
    return () => this.#tell.delete(tell);
  }

  #changed(): void {
    for (const tell of [...this.#tell]) tell();
  }

  get csrf(): string | null {
    return store.state.me?.csrf ?? null;
  }

  get mayEdit(): boolean {
    const role = store.state.me?.role ?? null;
    return this.loaded && this.hasFile && (role === null || role === "admin");
  }

  get isDraft(): boolean {
    return !same(this.live, this.parts);
  }

  get canUndo(): boolean { return this.#past.length > 0; }
  get canRedo(): boolean { return this.#future.length > 0; }

  /** Load the live version and the draft; what is in hand and not kept stays in hand. */
  async load(force = false): Promise<void> {
    if (!force && (this.keeping === "wrong" || this.keeping === "changed")) return;
    try {
      const [live, draft, kinds] = await Promise.all([
        getParts(), getDraft(), this.kinds.length ? this.kinds : getKinds(),
      ]);
      const { version, remarks, zones, lines, edges, exclusions, portals, rules } = live;
      this.live = { zones, lines, edges, exclusions, portals, rules };
      this.version = version;
      this.hasFile = live.has_file;
      this.kinds = kinds;
      if (draft && draft.based_on === version) this.#take(draft);
      else this.#taken(this.live, 0, "", remarks);
      if (draft && draft.based_on !== version) {
        this.revision = draft.revision;
        this.said = "The site file has changed since the last draft, which is left out.";
      }
      this.loaded = true;
      this.fault = "";
    } catch (error) {
      this.fault = words(error);
    }
    this.#changed();
  }

  #take(draft: Draft): void {
    const { zones, lines, edges } = draft;
    const { exclusions, portals, rules } = this.live;
    this.#taken(
      {
        zones, lines, edges, exclusions: draft.exclusions ?? exclusions,
        portals: draft.portals ?? portals, rules: draft.rules ?? rules,
      },
      draft.revision, draft.by, draft.remarks,
    );
  }

  #taken(parts: Parts, revision: number, by: string, remarks: Remark[]): void {
    this.parts = parts;
    this.revision = revision;
    this.by = by;
    this.remarks = remarks;
    this.faults = [];
    this.said = "";
    this.keeping = revision > 0 ? "kept" : "live";
    this.#past = [];
    this.#future = [];
  }

  /** Change the draft. Changes in a row that `merge` names the same are undone as one. */
  change(next: Parts, merge = ""): void {
    if (!this.mayEdit || next === this.parts || same(next, this.parts)) return;
    if (!merge || merge !== this.#merging) {
      this.#past = [...this.#past.slice(-MOST_STEPS), this.parts];
    }
    this.#merging = merge;
    this.#future = [];
    this.#put(next);
  }

  /** The next change is undone by itself. */
  settle(): void {
    this.#merging = "";
  }

  undo(): void {
    const before = this.#past.at(-1);
    if (!before) return;
    this.#past = this.#past.slice(0, -1);
    this.#future = [...this.#future, this.parts];
    this.#merging = "";
    this.#put(before);
  }

  redo(): void {
    const next = this.#future.at(-1);
    if (!next) return;
    this.#future = this.#future.slice(0, -1);
    this.#past = [...this.#past, this.parts];
    this.#put(next);
  }

  #put(parts: Parts): void {
    this.parts = parts;
    this.trial = null;
    if (this.keeping !== "conflict") this.keeping = "changed";
    this.#changed();
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => void this.keep(), KEEP_MS);
  }

  /** Keep the draft on the server. */
  async keep(): Promise<boolean> {
    clearTimeout(this.#timer);
    if (this.keeping === "conflict" || this.#sending) return false;
    if (this.keeping !== "changed") return this.keeping === "kept";
    const sent = this.parts;
    this.#sending = true;
    this.keeping = "keeping";
    this.#changed();
    try {
      const kept = await putDraft(this.version, this.revision, sent, this.csrf);
      this.revision = kept.revision;
      this.by = kept.by;
      this.remarks = kept.remarks;
      this.faults = [];
      this.said = "";
      this.keeping = "kept";
    } catch (error) {
      this.#refused(error);
    }
    this.#sending = false;
    if (this.parts !== sent && !this.#conflicts()) {
      this.keeping = "changed";
      this.#timer = window.setTimeout(() => void this.keep(), KEEP_MS);
    }
    this.#changed();
    return (this.keeping as Keeping) === "kept";
  }

  #conflicts(): boolean {
    return this.keeping === "conflict";
  }

  #refused(error: unknown): void {
    this.said = words(error);
    if (error instanceof Refused && error.status === 422) {
      this.faults = error.faults;
      this.keeping = "wrong";
    } else if (error instanceof Refused && error.status === 409) this.keeping = "conflict";
    else this.keeping = "failed";
  }

  /** Put what is in hand over what somebody else has kept. */
  async overwrite(): Promise<void> {
    const mine = this.parts;
    await this.load(true);
    this.keeping = "changed";
    this.parts = mine;
    await this.keep();
  }

  async discard(): Promise<void> {
    try {
      if (this.revision > 0) await dropDraft(this.csrf);
      this.keeping = "live";
      await this.load(true);
    } catch (error) {
      store.toast(`Could not discard it: ${words(error)}`);
    }
  }

  async makeLive(): Promise<boolean> {
    if (this.keeping === "changed" && !(await this.keep())) return false;
    try {
      await makeLive(this.version, this.revision, this.csrf);
      this.trial = null;
      await this.load(true);
      store.toast("The draft is live. The version before is kept.");
      void store.refresh();
      return true;
    } catch (error) {
      this.#refused(error);
      this.#changed();
      return false;
    }
  }

  /** Try the draft, beside the live rules, on a part of a recording. */
  async try(recording: string, from: number, to: number): Promise<void> {
    this.trying = true;
    this.trial = null;
    this.said = "";
    this.#changed();
    try {
      if (this.keeping === "changed") await this.keep();
      this.trial = await tryDraft(this.version, recording, from, to, this.csrf);
    } catch (error) {
      this.said = `Could not try it: ${words(error)}`;
    }
    this.trying = false;
    this.#changed();
  }
}

const words = (error: unknown): string => (error instanceof Error ? error.message : String(error));

export const desk = new Desk();

/** Draw the component anew when the draft changes. */
export function useDesk(): Desk {
  const [, again] = useState(0);
  useEffect(() => desk.subscribe(() => again((n) => n + 1)), []);
  return desk;
}
