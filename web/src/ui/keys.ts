// Keys. None acts while a field has the focus, nor just after the cards changed their order.

import { acknowledge, replay } from "./card.tsx";
import { justOrdered, keyed } from "./alerts.tsx";
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
  if (store.history.length === 0) return;
  store.set({ playing: false });
  store.replay(store.time + by);
};

const frame = (by: number): void => {
  if (store.history.length === 0) return;
  store.set({ playing: false });
  store.replay(store.history.step(store.time, by));
};

const onCard = (act: (alert: NonNullable<ReturnType<typeof keyed>>) => void): Act => () => {
  const alert = keyed(store.state);
  if (alert && !justOrdered()) act(alert);
};

const LIVE: Record<string, Act> = {
  a: onCard((alert) => store.mayAct && acknowledge([alert])),
  r: onCard(replay),
  g: onCard((alert) => {
    const person = alert.people[0];
    if (person !== undefined) store.go({ view: "alarm", person, t: null });
    else if (alert.camera) store.go({ view: `camera:${alert.camera}` });
  }),
  l: () => store.go({ t: null }, true),
  " ": pause,
  ArrowLeft: () => step(-1),
  ArrowRight: () => step(1),
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
  if (event.ctrlKey || event.metaKey || event.altKey || store.own.menu === "help") return;
  if (event.key === "Tab" && target.closest(".view") && store.address.page === "live") {
    if (nextPerson(event.shiftKey)) event.preventDefault();
    return;
  }
  // A button or link that has the focus takes Space itself.
  if (event.key === " " && target.closest("button, a, label")) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const act = EVERYWHERE[event.key] ?? EVERYWHERE[key]
    ?? (store.address.page === "live" ? LIVE[key] : undefined);
  if (act) {
    event.preventDefault();
    act(event);
  } else if (store.address.page === "live" && /^[1-9]$/.test(event.key)) camera(Number(event.key));
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
