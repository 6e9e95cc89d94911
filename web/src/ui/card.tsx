import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { useAway } from "./dialog.tsx";
import { Glyph, Icon } from "./icons.tsx";
import { home, write } from "../state/address.ts";
import {
  actor, figures, handled, handling, isMomentary, lasted, REASONS, title, where, type Alert,
} from "../state/alerts.ts";
import type { Reason } from "../state/messages.ts";
import { clock, duration, SEVERITY, whole } from "../state/words.ts";
import { store } from "../store.ts";

const SHELVES_S: [string, number][] = [["15 min", 900], ["1 h", 3600], ["4 h", 14400], ["8 h", 28800]];

interface Props {
  group: readonly Alert[];
  now: number;
  /** Whether keys act on this card, which then shows them. */
  keyed: boolean;
  /** Told the alerts whose form is open; none when it is shut. */
  onForm: (ids: readonly string[]) => void;
}

const isUrgent = (alert: Alert): boolean =>
  alert.severity === "alarm" || alert.severity === "critical";

function age(alert: Alert, now: number, zone: string): string {
  if (isMomentary(alert)) return clock(alert.start, zone);
  if (alert.end !== null) return `${duration(lasted(alert, now))} long`;
  if (alert.predicted) return "now";
  if (!Number.isFinite(alert.start)) return "";
  const passed = whole(now - alert.start);
  if (!isUrgent(alert)) return passed;
  return alert.raisedFrom ? `${passed} ago` : `${clock(alert.start, zone)}, ${passed} ago`;
}

export function Card({ group, now, keyed, onForm }: Props) {
  const alert = group[0] as Alert;
  const how = handling(alert, now);
  const zone = store.state.site?.timezone ?? "UTC";
  const cameras = store.state.site?.cameras.length ?? 0;
  const fresh = how === "new" && !alert.predicted && isUrgent(alert);
  const pulse = usePulse(alert, fresh);
  const hollow = how === "acknowledged" || how === "shelved";
  const classes = [
    "card moving", alert.predicted ? "warning" : alert.severity, fresh && "fresh",
    pulse && "pulse", hollow && "hollow", how === "closed" && "closed",
  ].filter(Boolean).join(" ");
  const real = how === "new" && !alert.predicted ? figures(alert, cameras) : [];
  const title_ = group.length > 1 ? `${group.length} x ${title(alert)}` : title(alert, true);
  return (
    <li class={classes} data-alert={alert.id} data-handling={how}>
      <div class="first">
        <Glyph severity={alert.predicted ? "warning" : alert.severity} open={how !== "closed"} />
        <b>{alert.predicted ? "Warning" : SEVERITY[alert.severity]}</b>
        <span class="did">{handled(alert, now, (t) => clock(t, zone))}</span>
        <time>{age(alert, now, zone)}</time>
      </div>
      <h3>{title_}</h3>
      <p class="where">{line(alert, how, now, zone)}</p>
      {real.length > 0 && (
        <dl class="real">
          {real.map((one) => (
            <div key={one.words}><dt>{one.value}</dt><dd>{one.words}</dd></div>
          ))}
        </dl>
      )}
      <Acts group={group} now={now} keyed={keyed} onForm={onForm} />
      {group.length > 1 && (
        <details class="all">
          <summary>Show all {group.length}</summary>
          <ul>
            {group.map((one) => (
              <li key={one.id}>
                <a href={write({ ...home, page: "review", subject: one.id })}>
                  {clock(one.start, zone)}{one.people[0] !== undefined && `, person ${one.people[0]}`}
                </a>
              </li>
            ))}
          </ul>
        </details>
      )}
    </li>
  );
}

function line(alert: Alert, how: string, now: number, zone: string): string {
  const by = (who: string | null, t: number) =>
    `${actor(who) ? `${actor(who)}, ` : ""}${clock(t, zone).slice(0, 5)}.`;
  if (how === "closed" && alert.closed) {
    const note = alert.closed.note ? `“${alert.closed.note}” ` : "";
    return `${note}${by(alert.closed.by, alert.closed.t)}`;
  }
  if (how === "shelved" && alert.shelved) {
    const said = [alert.shelved.note, actor(alert.shelved.by)].filter(Boolean).map((one) => `${one}.`);
    return [where(alert, now), ...said].join(" ");
  }
  if (how === "acknowledged" && alert.ack) {
    return `${where(alert, now)} ${by(alert.ack.by, alert.ack.t)}`;
  }
  return `${where(alert, now)}${how === "ended" ? " Not acknowledged." : ""}`;
}

/** Tell whether the outline pulses: for five seconds after an alert came, or rose. */
function usePulse(alert: Alert, fresh: boolean): boolean {
  const [on, set] = useState(fresh);
  const key = `${alert.id} ${alert.severity}`;
  useEffect(() => {
    if (!fresh) {
      set(false);
      return undefined;
    }
    set(true);
    const timer = setTimeout(() => set(false), 5000);
    return () => clearTimeout(timer);
  }, [key, fresh]);
  return on;
}

/** Acknowledge every alert of a card. */
export function acknowledge(group: readonly Alert[]): void {
  for (const alert of group) {
    void store.act(alert.id, { phase: "ack" }, "Acknowledged.");
  }
}

/** Replay an alert from five seconds before it began: here, or in Review where it is older. */
export function replay(alert: Alert): void {
  if (!Number.isFinite(alert.start)) return;
  if (alert.start < store.history.from || store.history.length === 0) {
    store.go({ ...home, page: "review", subject: alert.id });
    return;
  }
  store.set({ playing: true });
  store.page("live");
  store.replay(alert.start - 5);
}

type Form = "shelve" | "close" | "menu" | null;

function Acts({ group, now, keyed, onForm }: Props) {
  const alert = group[0] as Alert;
  const how = handling(alert, now);
  const [form, show] = useState<Form>(null);
  const setForm = (next: Form) => {
    show(next);
    onForm(next === "shelve" || next === "close" ? group.map((one) => one.id) : []);
  };
  const done = () => setForm(null);
  const box = useAway<HTMLDivElement>(form === "menu", done);
  if (form === "shelve") return <Shelve group={group} done={done} now={now} />;
  if (form === "close") return <Close group={group} done={done} />;
  const canAct = store.mayAct && store.state.link !== "lost";
  const isOpen = how === "new" || how === "ended";
  const ack = canAct && isOpen && !alert.predicted;
  const primary = isUrgent(alert) ? "primary grow" : "";
  const buttons = [
    ack && (
      <button key="ack" type="button" class={`button ${primary}`} onClick={() => acknowledge(group)}>
        Acknowledge{keyed && <span class="key">A</span>}
      </button>
    ),
    !alert.part && Number.isFinite(alert.start) && how !== "shelved" && (
      <button key="replay" type="button" class={`button ${ack ? "" : "grow"}`}
        onClick={() => replay(alert)}>
        <Icon name="play" size={15} />Replay{keyed && <span class="key">R</span>}
      </button>
    ),
    canAct && (how === "acknowledged" || (how === "ended" && !isUrgent(alert))) && (
      <button key="close" type="button" class="button" onClick={() => setForm("close")}>Close…</button>
    ),
    canAct && how === "shelved" && (
      <button key="unshelve" type="button" class="button quiet"
        onClick={() => void store.act(alert.id, { phase: "unshelve" }, "No longer shelved.")}>
        End shelving
      </button>
    ),
    canAct && (how === "new" || (how === "ended" && isUrgent(alert))) && (
      <button key="more" type="button" class="button quiet icon" aria-label="More"
        aria-haspopup="true" aria-expanded={form === "menu"}
        onClick={() => setForm(form ? null : "menu")}>
        <Icon name="more" />
      </button>
    ),
  ].filter(Boolean);
  if (buttons.length === 0) return null;
  return (
    <div class="acts" ref={box}>
      {buttons}
      {form === "menu" && (
        <div class="menu">
          {how === "new" && <button type="button" onClick={() => setForm("shelve")}>Shelve…</button>}
          <button type="button" onClick={() => setForm("close")}>Close…</button>
        </div>
      )}
    </div>
  );
}

function onEscape(event: KeyboardEvent, done: (() => void) | undefined): void {
  if (event.key !== "Escape" || !done) return;
  event.stopPropagation(); // Escape would also deselect
  done();
}

export function Shelve({ group, done, now }: { group: readonly Alert[]; done: () => void; now: number }) {
  const note = useRef<HTMLInputElement>(null);
  // A browser heeds autofocus once per page; without the focus what is typed would be keys.
  useLayoutEffect(() => note.current?.focus(), []);
  const shelve = (seconds: number) => {
    for (const alert of group) {
      const what = { phase: "shelve" as const, until_s: now + seconds, note: note.current?.value.trim() || undefined };
      void store.act(alert.id, what, "Shelved.", { phase: "unshelve" });
    }
    done();
  };
  return (
    <form onSubmit={(event) => event.preventDefault()} onKeyDown={(event) => onEscape(event, done)}>
      <input class="field" ref={note} placeholder="Why, as: technician called" aria-label="Why" />
      <div class="row" role="group" aria-label="Shelve for">
        {SHELVES_S.map(([text, seconds]) => (
          <button key={text} type="button" class="button" onClick={() => shelve(seconds)}>{text}</button>
        ))}
        <button type="button" class="button quiet" onClick={done}>Cancel</button>
      </div>
    </form>
  );
}

export function Close({ group, done }: { group: readonly Alert[]; done?: () => void }) {
  const [reason, setReason] = useState<Reason>("true");
  const [note, setNote] = useState("");
  const first = useRef<HTMLButtonElement>(null);
  useLayoutEffect(() => {
    if (done) first.current?.focus(); // opened from a card, which had the focus
  }, []);
  const missing = reason === "false" && note.trim() === "";
  const close = () => {
    const what = { phase: "close" as const, reason, note: note.trim() || undefined };
    for (const alert of group) {
      void store.act(alert.id, what, `Closed as ${REASONS[reason].toLowerCase()}.`, { phase: "reopen" });
    }
    done?.();
  };
  return (
    <form onSubmit={(event) => { event.preventDefault(); if (!missing) close(); }}
      onKeyDown={(event) => onEscape(event, done)}>
      <div class="reasons" role="group" aria-label="Close as">
        {(Object.keys(REASONS) as Reason[]).map((one, i) => (
          <button key={one} ref={i === 0 ? first : undefined} type="button" class="button"
            aria-pressed={reason === one}
            onClick={() => setReason(one)}>
            {REASONS[one]} <span class="key">{i + 1}</span>
          </button>
        ))}
      </div>
      <input class="field" value={note} aria-label="Note"
        placeholder={reason === "false" ? "Note, needed for a false alarm" : "Note"}
        onInput={(event) => setNote(event.currentTarget.value)} />
      <div class="row">
        <button type="submit" class="button primary" disabled={missing}
          title={missing ? "A false alarm needs a note" : ""}>
          {group.length > 1 ? `Close all ${group.length}` : "Close alert"}
        </button>
        {done && <button type="button" class="button quiet" onClick={done}>Cancel</button>}
      </div>
    </form>
  );
}
