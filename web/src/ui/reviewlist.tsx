// What can be reviewed: alerts by day, and recordings.

import { useState } from "preact/hooks";
import { Glyph, Icon } from "./icons.tsx";
import { useStore } from "./use.ts";
import type { Recording } from "../net/api.ts";
import { handling, isMomentary, lasted, REASONS, title, type Alert } from "../state/alerts.ts";
import { dataTime } from "../state/state.ts";
import { count, day, duration, hourMinute, named, UNIX_FROM_S } from "../state/words.ts";
import { store } from "../store.ts";

type Tab = "todo" | "all" | "recordings";

export function List({ films, subject }: { films: Recording[] | null; subject: string | null }) {
  const shop = useStore();
  const { state } = shop;
  const [chosen, setTab] = useState<Tab | null>(null);
  const tab = chosen ?? (films?.some((film) => film.id === subject) ? "recordings" : "all");
  const now = dataTime(state);
  const zone = state.site?.timezone ?? "UTC";
  const all = [...state.alerts.values()].sort((a, b) => b.start - a.start);
  const todo = all.filter((alert) => !alert.closed && !shop.reviewed.has(alert.id));
  const tabs: [Tab, string][] = [
    ["todo", `To review ${todo.length}`], ["all", `Alerts ${all.length}`],
    ["recordings", `Recordings${films ? ` ${films.length}` : ""}`],
  ];
  const shown = tab === "todo" ? todo : tab === "all" ? all : [];
  const listed = tab === "recordings" || (tab === "all" && all.length === 0) ? (films ?? []) : [];
  return (
    <section class="list" aria-label="Alerts and recordings">
      <div class="tabs">
        <div class="segments" role="group" aria-label="What is listed">
          {tabs.map(([key, name]) => (
            <button key={key} type="button" aria-pressed={tab === key} onClick={() => setTab(key)}>{name}</button>
          ))}
        </div>
      </div>
      <div class="scroll">
        {tab !== "recordings" && shown.length === 0 && (
          <p class="empty">{tab === "todo" ? "Nothing is left to review." : "No alert so far."}</p>
        )}
        {byDay(shown, (alert) => alert.start, zone, now).map(([name, alerts]) => (
          <section key={name}>
            <h2 class="since">{name}</h2>
            {alerts.map((alert) => <Item key={alert.id} alert={alert} now={now} current={alert.id === subject} />)}
          </section>
        ))}
        {tab === "all" && listed.length > 0 && <h2 class="since">Recordings</h2>}
        {byDay(listed, (film) => film.from_s, zone, now).map(([name, ones]) => (
          <section key={name}>
            {tab === "recordings" && <h2 class="since">{name}</h2>}
            {ones.map((film) => <FilmItem key={film.id} film={film} current={film.id === subject} />)}
          </section>
        ))}
        {tab === "recordings" && films?.length === 0 && (
          <p class="empty">Nothing is recorded. The site file's table [output] turns recording on.</p>
        )}
      </div>
      <div class="keys">
        <span class="key">J</span><span class="key">K</span>next, previous
        <span class="end"><span class="key">X</span>reviewed</span>
      </div>
    </section>
  );
}

/** Return things by the name of their day, in their order. */
function byDay<Thing>(
  things: readonly Thing[], at: (thing: Thing) => number, zone: string, now: number,
): [string, Thing[]][] {
  const days = new Map<string, Thing[]>();
  for (const thing of things) {
    const name = day(at(thing), zone) === day(now, zone) ? "Today" : day(at(thing), zone);
    days.set(name, [...(days.get(name) ?? []), thing]);
  }
  return [...days];
}

/** Return what is left to do about an alert, or what was decided. */
function left(alert: Alert, now: number): string {
  if (alert.closed) return REASONS[alert.closed.reason];
  if (!store.reviewed.has(alert.id)) return "To review";
  return handling(alert, now) === "acknowledged" ? "Acknowledged" : alert.ack ? "To close" : "To acknowledge";
}

function Item({ alert, now, current }: { alert: Alert; now: number; current: boolean }) {
  const dot = !alert.closed && !store.reviewed.has(alert.id);
  return (
    <button type="button" class="item" aria-current={current ? "true" : undefined}
      onClick={() => store.go({ subject: alert.id, t: null })}>
      <Glyph severity={alert.severity} open={!alert.closed} />
      <b title={title(alert)}>{title(alert)}</b>
      <span class="end">{hourMinute(alert.start, store.state.site?.timezone ?? "UTC")}</span>
      <span class="second">
        {[alert.place && named(alert.place), !isMomentary(alert) && `for ${duration(lasted(alert, now))}`]
          .filter(Boolean).join(", ")}
        <span class={dot ? "todo" : ""}>{left(alert, now)}</span>
      </span>
    </button>
  );
}

function FilmItem({ film, current }: { film: Recording; current: boolean }) {
  const zone = store.state.site?.timezone ?? "UTC";
  const dated = film.from_s >= UNIX_FROM_S;
  return (
    <button type="button" class="item" aria-current={current ? "true" : undefined}
      onClick={() => store.go({ subject: film.id, t: null })}>
      <Icon name="review" size={16} />
      <b>{dated ? `${day(film.from_s, zone)}, ${hourMinute(film.from_s, zone)}` : film.id}</b>
      <span class="end">{duration(film.to_s - film.from_s)}</span>
      <span class="second">{count(film.people, "person", "people")}</span>
    </button>
  );
}
