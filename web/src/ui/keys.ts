// Keys. None acts while a field has the focus, nor just after the cards changed their order.

import { acknowledge, replay } from "./card.tsx";
import { justOrdered, keyed, keyedGroup } from "./alerts.tsx";
import { pause } from "./timeline.tsx";
import { PAGES } from "../state/address.ts";
import { store } from "../store.ts";

type Act = (event: KeyboardEvent) => void;

const MUTE_S = 300;

const EVERYWHERE: Record<string, Act> = {
  "?": () => store.set({ menu: store.own.menu === "help" ? null : "help" }),
  m: () => store.set({ mutedUntil: store.state.local + MUTE_S }),
};

const step = (by: number): void => {
  if (store.film.length === 0) return;
  store.set({ playing: false });
  store.replay(store.time + by);
};

const frame = (by: number): void => {
  if (store.film.length === 0) return;
  store.set({ playing: false });
  store.replay(store.film.step(store.time, by));
};

const onCard = (act: (alert: NonNullable<ReturnType<typeof keyed>>) => void): Act => () => {
  const alert = keyed(store.state);
  if (alert && !justOrdered()) act(alert);
};

const LIVE: Record<string, Act> = {
  a: onCard(() => store.mayAct && acknowledge(keyedGroup(store.state))),
  r: onCard(replay),
  g: onCard((alert) => {
    const person = alert.people[0];
    if (person !== undefined) store.go({ view: "alarm", t: null });
    else if (alert.camera) store.go({ view: `camera:${alert.camera}` });
  }),
  l: () => store.go({ t: null }, true),
  " ": pause,
  ArrowLeft: () => step(-1),
  ArrowRight: () => step(1),
  Home: () => step(-Infinity),
  End: () => store.go({ t: null }, true),
  ",": () => frame(-1),
  ".": () => frame(1),
  "0": () => store.go({ view: "overview" }),
  f: () => store.go({ view: store.address.view === "plan" ? "overview" : "plan" }),
  o: () => store.state.site?.edges.length && store.go({ view: "edge" }),
  t: () => store.address.person !== null
    && store.go({ view: store.address.view === "follow" ? "overview" : "follow" }),
  n: () => store.set({ menu: store.own.menu === "layers" ? null : "layers" }),
  "/": () => store.set({ menu: "go to" }),
};

const SPEEDS = [0.25, 0.5, 1, 2, 4];

const speed = (by: number): void => {
  const at = SPEEDS.indexOf(store.own.speed) + by;
  store.set({ speed: SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, at))] ?? 1 });
};

const item = (by: number): void => {
  const items = [...document.querySelectorAll<HTMLButtonElement>(".review .item")];
  const at = items.findIndex((one) => one.getAttribute("aria-current") === "true");
  const next = items[at < 0 ? 0 : Math.min(items.length - 1, Math.max(0, at + by))];
  next?.click();
  next?.scrollIntoView({ block: "nearest" });
};

/** Choose a reason of the form that closes an alert; true when there is such a form. */
function reason(digit: number): boolean {
  const button = document.querySelectorAll<HTMLButtonElement>(".reasons button")[digit - 1];
  button?.click();
  button?.focus();
  return button !== undefined;
}

const REVIEW: Record<string, Act> = {
  x: () => {
    const { subject } = store.address;
    if (subject && store.state.alerts.has(subject)) void store.review(subject);
  },
  c: () => document.querySelector<HTMLButtonElement>(".reasons button")?.focus(),
  j: () => item(1),
  k: () => item(-1),
  "[": () => speed(-1),
  "]": () => speed(1),
  " ": () => {
    store.set({ playing: !store.own.playing });
    if (store.address.t !== null) store.replay(store.address.t);
  },
  ArrowLeft: () => store.address.t !== null && step(-1),
  ArrowRight: () => store.address.t !== null && step(1),
  ",": () => store.address.t !== null && frame(-1),
  ".": () => store.address.t !== null && frame(1),
};

const PAGE_KEYS: Partial<Record<string, Record<string, Act>>> = { live: LIVE, review: REVIEW };

function camera(digit: number): void {
  const camera = store.state.site?.cameras[digit - 1];
  if (camera) store.go({ view: `camera:${camera.name}` });
}

/** Select the next person while the scene has the focus; true when there was one. */
function nextPerson(back: boolean): boolean {
  const people = (store.shown?.people ?? []).map((person) => person.id).sort((a, b) => a - b);
  const now = store.address.person;
  const at = now === null ? (back ? people.length : -1) : people.indexOf(now);
  const next = people[at + (back ? -1 : 1)];
  if (next === undefined) return false;
  store.go({ person: next }, true);
  return true;
}

function escape(): void {
  if (store.own.menu) store.set({ menu: null });
  else if (store.address.person !== null) {
    store.go({ person: null, view: store.address.view === "follow" ? "overview" : store.address.view }, true);
  }
}

function pressed(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (event.key === "Escape") return escape();
  if (target.closest("input:not([type=checkbox]):not([type=radio]), textarea, select")) return;
  if (event.altKey && /^[1-4]$/.test(event.key)) {
    event.preventDefault();
    return store.page(PAGES[Number(event.key) - 1] ?? "live");
  }
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (target.closest("dialog") && event.key !== "?") return;
  if (target.closest("form") && !/^[1-9]$/.test(event.key)) return;
  if (event.key === "Tab" && target.closest(".view") && store.address.page === "live") {
    if (nextPerson(event.shiftKey)) event.preventDefault();
    return;
  }
  // A button or link that has the focus takes Space itself.
  if (event.key === " " && target.closest("button, a, label")) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const act = EVERYWHERE[event.key] ?? EVERYWHERE[key]
    ?? PAGE_KEYS[store.address.page]?.[key];
  if (act) {
    event.preventDefault();
    act(event);
  } else if (/^[1-9]$/.test(event.key)) {
    if (!reason(Number(event.key)) && store.address.page === "live") camera(Number(event.key));
  }
}

export function listen(): void {
  addEventListener("keydown", pressed);
  addEventListener("pointerdown", (event) => {
    const target = event.target as HTMLElement;
    const menu = store.own.menu;
    if ((menu === "user" || menu === "layers") && !target.closest(".menu, [aria-expanded]")) {
      store.set({ menu: null });
    }
  });
}
