import { useEffect, useRef, useState } from "preact/hooks";
import { Card } from "./card.tsx";
import { Glyph } from "./icons.tsx";
import { useStore } from "./use.ts";
import { home, write } from "../state/address.ts";
import {
  cards, closedAlerts, handling, REASONS, title, type Alert,
} from "../state/alerts.ts";
import { cardKey, idsOf, inOrder, withForm } from "../state/held.ts";
import { dataTime, open, type State } from "../state/state.ts";
import { clock, count, day, duration, hourMinute } from "../state/words.ts";
import { store } from "../store.ts";

const HOLD_MS = 500;

/** The cards as they are shown: they hold still while the pointer is among them. */
function useHeld(groups: Alert[][]): {
  shown: Alert[][]; waiting: number; hold: (on: boolean) => void; release: () => void;
} {
  const [held, setHeld] = useState<string[][] | null>(null);
  const timer = useRef(0);
  const ids = idsOf(groups);
  const order = useRef(ids);
  if (!held) {
    if (first(order.current) !== first(ids)) ordered = performance.now();
    order.current = ids;
  }
  useEffect(() => () => clearTimeout(timer.current), []);
  return {
    ...(held ? inOrder(held, groups) : { shown: groups, waiting: 0 }),
    hold: (on) => {
      clearTimeout(timer.current);
      if (on) setHeld((before) => before ?? order.current);
      else timer.current = window.setTimeout(() => setHeld(null), HOLD_MS);
    },
    release: () => setHeld(null),
  };
}

const first = (ids: readonly string[][]): string => ids.map((card) => card[0]).join();

let ordered = -Infinity;

/** Tell whether the order of the cards changed a moment ago: keys wait then. */
export const justOrdered = (): boolean => performance.now() - ordered < HOLD_MS;

/** Return the card on which keys act: the first that is not acknowledged. */
export function keyed(state: State): Alert | null {
  const now = dataTime(state);
  return open(state).find((a) => ["new", "ended"].includes(handling(a, now))) ?? null;
}

/** Return the alerts of the card on which keys act. */
export function keyedGroup(state: State): Alert[] {
  const first = keyed(state);
  const groups = cards(open(state), dataTime(state));
  return first ? (groups.find((group) => group[0]?.id === first.id) ?? [first]) : [];
}

export function Alerts() {
  const { state } = useStore();
  const now = dataTime(state);
  const all = open(state);
  const [writing, setWriting] = useState<readonly string[]>([]);
  const held = useHeld(withForm(cards(all, now), writing, state.alerts));
  const lost = state.link === "lost";
  const key = keyed(state);
  const number = lost ? "unknown" : all.length || (state.health ? "none" : "");
  return (
    <aside class="alerts" aria-label="Alerts">
      <div class="head"><h2>Alerts</h2><span class="note">{number}</span></div>
      <div class="scroll" onPointerEnter={() => held.hold(true)} onPointerLeave={() => held.hold(false)}>
        {lost && (
          <div class="none">
            <strong>Alerts unknown</strong>
            <p>The list below ends at {clock(state.lastSent, state.site?.timezone ?? "UTC")}.</p>
          </div>
        )}
        {held.waiting > 0 && (
          <button type="button" class="held" onClick={held.release}>
            Show {count(held.waiting, "new alert")}
          </button>
        )}
        <ul class={lost ? "dimmed" : ""}>
          {held.shown.map((group) => (
            <Card key={cardKey(group)} group={group} now={now} keyed={group[0]?.id === key?.id}
              onForm={setWriting} />
          ))}
        </ul>
        {!lost && all.length === 0 && <None state={state} />}
        <Past state={state} dimmed={lost} />
      </div>
    </aside>
  );
}

function None({ state }: { state: State }) {
  if (!state.health || !state.site) return null;
  const now = dataTime(state);
  const last = closedAlerts(state.alerts, now)[0];
  if ((state.health.rules?.total ?? state.site.rules) === 0) {
    return (
      <div class="none">
        <strong>No rules yet</strong>
        <p>Alerts for people need a zone, line or edge. Cameras that send no picture are told here already.</p>
        <button type="button" class="button" onClick={() => store.page("zones")}>Zones</button>
      </div>
    );
  }
  const zone = state.site.timezone;
  const as = last?.closed ? `, closed as ${REASONS[last.closed.reason].toLowerCase()}` : ", acknowledged";
  return (
    <div class="none">
      <strong>No open alerts</strong>
      {last && <p>Last one {hourMinute(last.start, zone)}{as}.</p>}
    </div>
  );
}

function how(alert: Alert): string {
  if (alert.closed) return REASONS[alert.closed.reason];
  return alert.part && alert.end !== null ? `for ${duration(alert.end - alert.start)}` : "Acknowledged";
}

const PAST_SHOWN = 30;

/** Alerts that are over and dealt with, by day, the newest first. */
function Past({ state, dimmed }: { state: State; dimmed: boolean }) {
  const now = dataTime(state);
  const zone = state.site?.timezone ?? "UTC";
  const past = closedAlerts(state.alerts, now).slice(0, PAST_SHOWN);
  const days = [...new Set(past.map((alert) => day(alert.start, zone)))];
  return (
    <>
      {days.map((one) => (
        <section key={one} class={dimmed ? "dimmed" : ""}>
          <h3 class="since">{one === day(now, zone) ? "Today" : one}</h3>
          <ul class="past">
            {past.filter((alert) => day(alert.start, zone) === one)
              .map((alert) => <PastRow key={alert.id} alert={alert} zone={zone} />)}
          </ul>
        </section>
      ))}
    </>
  );
}

/** A line of a list of alerts, which leads to Review. */
export function PastRow(
  { alert, zone, end = how(alert), open = false }:
  { alert: Alert; zone: string; end?: string; open?: boolean },
) {
  const address = { ...home, page: "review" as const, subject: alert.id };
  return (
    <li>
      <a class="one" href={write(address)} onClick={(event) => {
        if (event.metaKey || event.ctrlKey || event.shiftKey) return;
        event.preventDefault();
        store.go(address);
      }}>
        <time>{hourMinute(alert.start, zone)}</time>
        <Glyph severity={alert.severity} open={open} />
        <span class="what">{title(alert)}</span>
        <span class="how">{end}</span>
      </a>
    </li>
  );
}
