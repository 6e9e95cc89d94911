// The store: state, its history, and who wants to know when it changes.

import {
  act, getEvents, getMe, getReviewed, getSite, markReviewed, SignedOut, type Act,
} from "./net/api.ts";
import { Connection } from "./net/connection.ts";
import { home, parse, write, type Address } from "./state/address.ts";
import { assign, noMarks } from "./state/marks.ts";
import { History } from "./state/history.ts";
import { readSite } from "./state/site.ts";
import { dataTime, initial, reduce, type Action, type State } from "./state/state.ts";
import { clock } from "./state/words.ts";
import type { Snapshot } from "./state/people.ts";

const now = (): number => Date.now() / 1000;

/** What the person at this page has set; kept in this browser where it should outlast a visit. */
export interface Own {
  theme: "system" | "light" | "dark";
  sound: boolean;
  mutedUntil: number;
  layers: Record<Layer, boolean>;
  follow: boolean;
  playing: boolean;
  speed: number;
  menu: string | null;
  toast: { text: string; undo: (() => void) | null; until: number } | null;
}

export type Layer =
  | "paths" | "forecasts" | "zones" | "density" | "cameras" | "numbers" | "uncertainty";
export const LAYERS: Record<Layer, string> = {
  paths: "Last 10 s", forecasts: "Next 4 s", zones: "Zones and edges", density: "Density, on the plan",
  cameras: "Cameras",
  numbers: "Numbers", uncertainty: "Uncertainty",
};

/** How often the site is asked for again [s]: while it is not complete, and later. */
const [ASK_SOON_S, ASK_S] = [2, 20];

type Kept = Pick<Own, "theme" | "layers">;

function kept(): Kept {
  const plain: Kept = {
    theme: "system",
    layers: {
      paths: true, forecasts: true, zones: true, density: false, cameras: true, numbers: true,
      uncertainty: true,
    },
  };
  try {
    const found = JSON.parse(localStorage.getItem("trecsim") ?? "{}") as Partial<Kept>;
    return { ...plain, ...found, layers: { ...plain.layers, ...found.layers } };
  } catch {
    return plain;
  }
}

export class Store {
  state: State = initial(now());
  own: Own = {
    ...kept(), sound: false, mutedUntil: 0, follow: false, playing: true, speed: 1, menu: null, toast: null,
  };
  address: Address = parse(location.pathname, location.search);
  readonly history = new History();
  /** The snapshot on the screen: the live one, or that of a replay. */
  shown: Snapshot | null = null;
  /** The last new alert in words, for those who listen to the page. */
  announcement = "";

  #slow = new Set<() => void>();
  #fast = new Set<() => void>();
  #pending = false;
  #told = 0;
  #connection: Connection;
  #started = false;

  constructor() {
    this.#connection = new Connection(() => this.#streamAddress(), {
      opened: () => {
        this.dispatch({ type: "opened", local: now() });
        // A server that came back may have another site, and knows what happened meanwhile.
        void this.refresh();
      },
      message: (message) => this.dispatch({ type: "message", message, local: now() }),
      closed: (wait) => {
        this.dispatch({ type: "closed", local: now(), retryAt: now() + wait });
        void this.#stillSignedIn();
      },
      trying: () => this.dispatch({ type: "trying" }),
    });
    addEventListener("popstate", () => {
      this.address = parse(location.pathname, location.search);
      this.#show();
      this.changed();
    });
    document.addEventListener("visibilitychange", () => this.draw());
    setInterval(() => this.dispatch({ type: "tick", local: now() }), 250);
  }

  #streamAddress(): string {
    const base = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/api/stream`;
    const last = this.state.lastEvent;
    return last === null ? base : `${base}?last_event_id=${encodeURIComponent(String(last))}`;
  }

  /** Open the stream where that is allowed; site and events are asked for once it is open. */
  async start(): Promise<void> {
    try {
      const me = await getMe();
      this.dispatch({ type: "access", access: "in", me });
      this.own = { ...this.own, sound: this.#keptSound() };
    } catch (error) {
      if (error instanceof SignedOut) {
        this.dispatch({ type: "access", access: "out" });
        return;
      }
    }
    if (!this.#started) this.#connection.open();
    this.#started = true;
  }

  /** Ask for site and events. What cannot be had is told by the stream, or asked for again. */
  async refresh(): Promise<void> {
    this.#askedAt = now();
    const site = getSite().then((body) => this.dispatch({ type: "site", site: readSite(body) }));
    const events = getEvents().then((found) => this.dispatch({ type: "events", ...found }));
    const reviewed = getReviewed().then((found) => { this.reviewed = new Set(found); });
    await Promise.allSettled([site, events, reviewed]);
  }

  #askedAt = -Infinity;

  /** Ask for the site again: at once while cameras are missing, else now and then. */
  #keepSite(): void {
    const { access, health, link, site, local } = this.state;
    if (access !== "in" || link !== "open") return;
    const known = new Set(site?.cameras.map((camera) => camera.name));
    const missing = Object.keys(health?.cameras ?? {}).some((name) => !known.has(name));
    if (local - this.#askedAt < (missing ? ASK_SOON_S : ASK_S)) return;
    this.#askedAt = local;
    getSite().then(
      (body) => {
        const next = readSite(body);
        const now = this.state.site;
        const same = now?.version === next.version && now.cameras.length === next.cameras.length;
        if (!same) this.dispatch({ type: "site", site: next });
      },
      () => undefined, // no connection: the stream tells that
    );
  }

  async #stillSignedIn(): Promise<void> {
    try {
      await getMe();
    } catch (error) {
      if (!(error instanceof SignedOut)) return;
      this.#connection.close();
      this.#started = false;
      this.dispatch({ type: "access", access: "out" });
    }
  }

  tryNow(): void {
    this.#connection.open();
  }

  dispatch(action: Action): void {
    const before = this.state;
    this.state = reduce(before, action);
    if (this.state === before) return;
    const fresh = this.state.snapshot;
    if (fresh && fresh !== before.snapshot) {
      this.history.add(fresh);
      if (!this.replaying) {
        this.shown = this.address.page === "review" ? this.shown : fresh;
        this.draw();
      }
      this.#soon();
      return;
    }
    if (action.type === "tick") this.#keepSite();
    // Site, events and health show in the pictures too; while nothing is heard, time alone does.
    if (action.type !== "tick" || this.state.link === "lost") this.draw();
    this.changed();
  }

  /** Tell the parts of the page that show words; after snapshots at most four times a second. */
  #soon(): void {
    if (performance.now() - this.#told > 240) this.changed();
  }

  changed(): void {
    if (this.#pending) return;
    this.#pending = true;
    queueMicrotask(() => {
      this.#pending = false;
      this.#told = performance.now();
      for (const tell of [...this.#slow]) tell();
    });
  }

  #drawing = 0;

  /** Tell the parts of the page that draw people, once per picture of the screen. */
  draw(): void {
    if (this.#drawing !== 0 || document.hidden) return;
    this.#drawing = requestAnimationFrame(() => {
      this.#drawing = 0;
      document.documentElement.dataset.t = String(this.shown?.t ?? "");
      for (const tell of [...this.#fast]) tell();
    });
  }

  subscribe(tell: () => void): () => void {
    this.#slow.add(tell);
    return () => this.#slow.delete(tell);
  }

  onDraw(tell: () => void): () => void {
    this.#fast.add(tell);
    return () => this.#fast.delete(tell);
  }

  set(own: Partial<Own>): void {
    this.own = { ...this.own, ...own };
    const { theme, sound, layers } = this.own;
    try {
      localStorage.setItem("trecsim", JSON.stringify({ theme, layers }));
      if (own.sound !== undefined) localStorage.setItem(this.#soundKey, String(sound));
    } catch {
      // a browser that keeps nothing: the choice holds until the page is closed
    }
    this.changed();
    this.draw();
  }

  /** Whether somebody wants sound is kept for each user: several sit at one machine. */
  get #soundKey(): string {
    return `trecsim sound ${this.state.me?.user ?? ""}`;
  }

  #keptSound(): boolean {
    try {
      return localStorage.getItem(this.#soundKey) === "true";
    } catch {
      return false;
    }
  }

  go(to: Partial<Address>, replace = false): void {
    this.address = { ...this.address, ...to };
    const text = write(this.address);
    if (text !== location.pathname + location.search) {
      if (replace) history.replaceState(null, "", text);
      else history.pushState(null, "", text);
    }
    this.#show();
    this.changed();
    this.draw();
  }

  page(page: Address["page"]): void {
    if (this.own.menu === "layers" || this.own.menu === "user") this.set({ menu: null });
    this.go({ ...home, page, person: page === "live" ? this.address.person : null });
  }

  /** A part of a recording that Review shows; null where it shows the last ten minutes. */
  loaded: History | null = null;
  #filmMarks = noMarks;

  /** The history on which a replay runs. */
  get film(): History {
    return this.address.page === "review" && this.loaded ? this.loaded : this.history;
  }

  /** Slots of the marks of those who are shown. */
  get slots(): ReadonlyMap<number, number> {
    return this.address.page === "review" ? this.#filmMarks.slots : this.state.marks.slots;
  }

  /** Time shown: that of the replay, else now. */
  get time(): number {
    return this.address.t ?? dataTime(this.state);
  }

  get replaying(): boolean {
    const { page, t } = this.address;
    return t !== null && (page === "live" || page === "review");
  }

  #show(): void {
    const t = this.address.t;
    if (!this.replaying || t === null) {
      this.shown = this.address.page === "review" ? null : this.state.snapshot;
      return;
    }
    this.shown = this.film.length > 0 ? this.film.at(t) : null;
    const present = this.shown?.people.map((person) => person.id) ?? [];
    this.#filmMarks = assign(this.#filmMarks, present);
  }

  /** Show a part of a recording in Review, or the last ten minutes. */
  load(film: History | null): void {
    this.loaded = film;
    this.#filmMarks = noMarks;
    this.#show();
    this.#goOn();
    this.changed();
    this.draw();
  }

  #playedAt = NaN;
  #playing = 0;
  #writing = 0;

  /** Move a replay on with each picture that the screen shows. */
  #play = (): void => {
    const at = performance.now() / 1000;
    const passed = at - this.#playedAt;
    this.#playedAt = at;
    const t = this.address.t;
    if (t === null || !this.replaying || !this.own.playing) {
      this.#playing = 0;
      return;
    }
    this.#playing = requestAnimationFrame(this.#play);
    const next = t + Math.min(passed, 1) * this.own.speed;
    if (next < this.film.to) this.replay(next);
    else if (this.address.page === "live") this.go({ t: null }, true);
    else this.set({ playing: false });
  };

  /** Show a moment of the last ten minutes. */
  replay(t: number): void {
    const within = Math.min(this.film.to, Math.max(this.film.from, t));
    if (!Number.isFinite(within)) return;
    this.address = { ...this.address, t: within };
    this.#show();
    this.draw();
    this.#soon();
    // Browsers limit how often the address may change.
    clearTimeout(this.#writing);
    this.#writing = window.setTimeout(() => this.go({}, true), 400);
    this.#goOn();
  }

  /** Play on, unless paused. */
  #goOn(): void {
    if (!this.replaying || !this.own.playing || this.#playing) return;
    this.#playedAt = performance.now() / 1000;
    this.#playing = requestAnimationFrame(this.#play);
  }

  /** Return the moment that a time of day names, within the last day; null where it is none. */
  momentOf(text: string): number | null {
    const found = /^(\d{1,2}):(\d{2})(?::(\d{2}(?:\.\d+)?))?$/.exec(text.trim());
    if (!found) return null;
    const wanted = Number(found[1]) * 3600 + Number(found[2]) * 60 + Number(found[3] ?? 0);
    const now = dataTime(this.state);
    const shown = clock(now, this.state.site?.timezone ?? "UTC").split(":").map(Number);
    const today = (shown[0] ?? 0) * 3600 + (shown[1] ?? 0) * 60 + (shown[2] ?? 0) + (now % 1);
    return now - ((today - wanted + 86400) % 86400);
  }

  toast(text: string, undo: (() => void) | null = null): void {
    this.set({ toast: { text, undo, until: now() + 5 } });
    setTimeout(() => {
      if (this.own.toast && this.own.toast.until <= now() + 0.1) this.set({ toast: null });
    }, 5000);
  }

  get mayAct(): boolean {
    return this.state.me?.role !== "viewer";
  }

  /** Do something to an alert, and say that it was done, or why not; offer to undo it. */
  async act(event: string, what: Act, done: string, undo: Act | null = null): Promise<void> {
    try {
      const made = await act(event, what, this.state.me?.csrf ?? null);
      if (made) this.dispatch({ type: "events", events: [made], last: null });
      this.toast(done, undo && (() => void this.act(event, undo, "Undone.")));
    } catch (error) {
      this.toast(`Could not do it: ${error instanceof Error ? error.message : String(error)}`);
    }
  }

  /** Alerts that this user has reviewed. */
  reviewed: ReadonlySet<string> = new Set();

  /** Mark an alert as reviewed by this user, or take the mark away. */
  async review(event: string): Promise<void> {
    const done = !this.reviewed.has(event);
    const next = new Set(this.reviewed);
    if (done) next.add(event);
    else next.delete(event);
    try {
      await markReviewed(event, done, this.state.me?.csrf ?? null);
      this.reviewed = next;
      this.changed();
    } catch (error) {
      this.toast(`Could not do it: ${error instanceof Error ? error.message : String(error)}`);
    }
  }
}

export const store = new Store();
