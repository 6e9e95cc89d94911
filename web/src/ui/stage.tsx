import { useEffect, useRef, useState } from "preact/hooks";
import { Glyph, Icon } from "./icons.tsx";
import { Plan } from "./planview.tsx";
import { concerned, shownAlerts } from "./shown.ts";
import { useStore } from "./use.ts";
import { palette } from "../draw/palette.ts";
import type { Scene } from "../scene/scene.ts";
import { handling, isActive, measured, what } from "../state/alerts.ts";
import type { Severity } from "../state/messages.ts";
import { dataTime, isOld, open, type State } from "../state/state.ts";
import { clock, named, whole } from "../state/words.ts";
import { LAYERS, store, type Layer, type Store } from "../store.ts";

const PATH_S = 10;

let webgl: boolean | null = null;

/** Tell whether this browser draws in 3D. */
export function hasWebGL(): boolean {
  if (webgl === null) {
    try {
      webgl = document.createElement("canvas").getContext("webgl2") !== null;
    } catch {
      webgl = false;
    }
  }
  return webgl;
}

const isAlarm = (severity: Severity): severity is "alarm" | "critical" =>
  severity === "alarm" || severity === "critical";

/** Return the first alarm that is open and about a person. */
function alarmOf(state: State): { person: number; severity: "alarm" | "critical" } | null {
  const now = dataTime(state);
  for (const alert of open(state)) {
    const { severity } = alert;
    if (!isActive(alert) || handling(alert, now) === "shelved" || !isAlarm(severity)) continue;
    const person = alert.people[0];
    if (person !== undefined) return { person, severity };
  }
  return null;
}

export function Stage() {
  const shop = useStore();
  const reviewing = shop.address.page === "review";
  const lost = shop.state.link === "lost" && !reviewing;
  const flat = shop.address.view === "plan" || !hasWebGL();
  const old = isOld(shop.state) && !reviewing && !shop.replaying;
  const classes = `stage ${old ? "old" : ""} ${shop.replaying && !reviewing ? "replay" : ""}`;
  return (
    <div class={classes}>
      {flat ? <div class="view"><Plan large /></div> : <View />}
      <Tools shop={shop} />
      <Hint shop={shop} />
      {!lost && <Legend shop={shop} />}
      {lost && !shop.replaying && Number.isFinite(shop.state.heardAt) && <Lost state={shop.state} />}
    </div>
  );
}

function View() {
  const box = useRef<HTMLDivElement>(null);
  const [failed, setFailed] = useState("");
  useEffect(() => {
    let scene: Scene | null = null;
    let gone = false;
    const offs: (() => void)[] = [];
    void import("../scene/scene.ts").then(({ Scene }) => {
      if (gone || !box.current) return;
      scene = new Scene(box.current, {
        pick: (person) => store.go({ person }, true),
        moved: () => {
          if (store.address.view === "follow") store.go({ view: "overview" }, true);
        },
      });
      let told: unknown[] = [];
      const show = () => { told = feed(scene as Scene, told); };
      offs.push(store.onDraw(show), store.subscribe(show));
      show();
    }).catch((error: unknown) => setFailed(String(error)));
    return () => {
      gone = true;
      for (const off of offs) off();
      scene?.dispose();
    };
  }, []);
  if (failed) return <div class="view"><Plan large /></div>;
  return (
    <div class="view" ref={box} tabIndex={0} role="img"
      aria-label="People in 3D. The same people stand in the table after this picture." />
  );
}

/** Show the scene anew, if anything that it shows has changed. */
function feed(scene: Scene, before: unknown[]): unknown[] {
  const { state, shown, own, address } = store;
  const callout = calloutOf();
  const about = concerned();
  const told = [
    state.site, shown, address.person, address.view, own.layers, palette(),
    JSON.stringify([callout, [...about.alarmed], [...about.active], [...about.faulty]]),
  ];
  if (told.every((one, i) => one === before[i])) return before;
  scene.show({
    site: state.site,
    snapshot: shown,
    slots: store.slots,
    paths: shown ? store.film.paths(shown.t, PATH_S) : new Map(),
    selected: address.person,
    view: address.view,
    layers: own.layers,
    alarm: callout?.person ?? null,
    callout,
    ...about,
  });
  return told;
}

function calloutOf(): { person: number; title: string; line: string } | null {
  const alert = shownAlerts().find((one) => one.people.length > 0 && isAlarm(one.severity));
  if (!alert) return null;
  const { measures } = alert;
  const measure = Object.entries(measures)[0];
  const real = measure ? measured(...measure) : null;
  const length = whole(Math.max(0, Math.min(store.time, alert.end ?? Infinity) - alert.start));
  return {
    person: alert.people[0] as number,
    title: what(alert),
    line: real ? `${real.value} ${real.words}, ${length}` : `for ${length}`,
  };
}

function Tools({ shop }: { shop: Store }) {
  const view = shop.address.view;
  const flat = view === "plan" || !hasWebGL();
  const site = shop.state.site;
  const alarm = shop.address.page === "review" ? null : alarmOf(shop.state);
  const presets: [string, string][] = [
    ["overview", "Overview"],
    ...(site && site.edges.length > 0 ? [["edge", "Edge"] as [string, string]] : []),
    ["top", "Top"],
    ["follow", "Follow"],
  ];
  const follow = shop.address.person === null;
  const camera = view.startsWith("camera:") ? view.slice(7) : null;
  return (
    <div class="tools">
      {shop.replaying && (
        <span class="pill">
          <Icon name="review" size={18} />Replay <time>{clock(shop.time, site?.timezone ?? "UTC", 2)}</time>
        </span>
      )}
      {hasWebGL() && (
        <div class="segments" role="group" aria-label="Kind of view">
          <button type="button" aria-pressed={!flat} onClick={() => flat && store.go({ view: "overview" })}>
            <Icon name="cube" size={16} />3D
          </button>
          <button type="button" aria-pressed={flat} title="F" onClick={() => store.go({ view: "plan" })}>
            <Icon name="plan" size={16} />Plan
          </button>
        </div>
      )}
      {!flat && (
        <div class="segments views" role="group" aria-label="View">
          {alarm && (
            <button type="button" class="first alarm-view" aria-pressed={view === "alarm"} title="G"
              onClick={() => store.go({ view: "alarm" })}>
              <Glyph severity={alarm.severity} size={14} />Alarm
            </button>
          )}
          {presets.map(([key, name]) => (
            <button key={key} type="button" aria-pressed={view === key}
              class={key === "overview" ? "first" : ""}
              disabled={key === "follow" && follow}
              title={key === "follow" && follow ? "Select a person first" : ""}
              onClick={() => store.go({ view: key })}>{name}</button>
          ))}
          {camera && <button type="button" aria-pressed>{named(camera)}</button>}
        </div>
      )}
      <Layers shop={shop} />
    </div>
  );
}

function Layers({ shop }: { shop: Store }) {
  const shown = shop.own.menu === "layers";
  return (
    <div class="end">
      <div class="segments">
        <button type="button" class="layers" aria-label="Layers" aria-expanded={shown} title="Layers (N)"
          onClick={() => store.set({ menu: shown ? null : "layers" })}>
          <Icon name="layers" size={16} /><span class="word">Layers</span>
        </button>
        <button type="button" class="square" aria-label="Full screen" title="Full screen" onClick={fullScreen}>
          <Icon name="expand" size={16} />
        </button>
      </div>
      {shown && (
        <div class="menu" role="group" aria-label="Layers">
          {(Object.keys(LAYERS) as Layer[]).map((layer) => (
            <label key={layer}>
              <input type="checkbox" checked={shop.own.layers[layer]}
                onChange={(event) => store.set({
                  layers: { ...shop.own.layers, [layer]: event.currentTarget.checked },
                })} />
              {LAYERS[layer]}
            </label>
          ))}
        </div>
      )}
    </div>
  );
}

function fullScreen(): void {
  if (document.fullscreenElement) void document.exitFullscreen();
  else void document.querySelector(".stage")?.requestFullscreen?.();
}

function Hint({ shop }: { shop: Store }) {
  const { state } = shop;
  if (shop.address.page === "review") return null;
  const waited = state.local - state.startedAt > 3;
  if (!state.snapshot && waited && state.link !== "lost") {
    return <p class="hint">Waiting for the first people message.</p>;
  }
  if (!hasWebGL()) return <p class="hint">3D needs WebGL. The plan shows the same people.</p>;
  if (shop.replaying && alarmOf(state)) {
    return (
      <button type="button" class="button newalarm" onClick={() => store.go({ t: null }, true)}>
        New alarm now. Back to live <span class="key">L</span>
      </button>
    );
  }
  return null;
}

function Legend({ shop }: { shop: Store }) {
  const { paths, forecasts } = shop.own.layers;
  const some = forecasts && (shop.shown?.people ?? []).some((one) => one.forecast.length > 0);
  return (
    <ul class="legend" aria-hidden="true">
      {paths && <li>
        <svg width="26" height="6"><path d="M0 3h26" stroke="currentColor" stroke-width="2.5" opacity=".7" /></svg>
        Last 10 s
      </li>}
      {some && <li>
        <svg width="34" height="12">
          <ellipse cx="17" cy="6" rx="16.5" ry="5.5" fill="currentColor" opacity=".18" />
          <ellipse cx="17" cy="6" rx="9" ry="3.2" fill="currentColor" opacity=".3" />
          <path d="M3 6h28" stroke="currentColor" stroke-width="1.5" stroke-dasharray="3 3" />
        </svg>
        Next 4 s, 50 and 90 %
      </li>}
      <li>
        <svg width="14" height="14">
          <circle cx="7" cy="7" r="5.5" fill="none" stroke="currentColor" stroke-width="1.5" stroke-dasharray="3 2.4" />
        </svg>
        Not yet confirmed
      </li>
    </ul>
  );
}

function Lost({ state }: { state: State }) {
  return (
    <div class="lostbox" role="alert">
      <Icon name="lost" size={28} />
      <h2>This page has lost the server</h2>
      <p>
        What you see is {whole(state.local - state.heardAt)} old. Alerts may have fired since.
        They still go to the outputs of the site if the server runs.
      </p>
      <div class="row">
        <button type="button" class="button primary" onClick={() => store.tryNow()}>Try now</button>
      </div>
    </div>
  );
}
