import { useEffect, useRef, useState } from "preact/hooks";
import { Glyph, Icon } from "./icons.tsx";
import {
  figures, handled, handling, lasted, REASONS, title, where, type Alert,
} from "../state/alerts.ts";
import type { Reason } from "../state/messages.ts";
import { clock, duration, named, SEVERITY, whole } from "../state/words.ts";
import { store } from "../store.ts";

const SHELVES_S: [string, number][] = [["15 min", 900], ["1 h", 3600], ["4 h", 14400], ["8 h", 28800]];

interface Props {
  group: readonly Alert[];
  now: number;
  /** Whether keys act on this card, which then shows them. */
  keyed: boolean;
}

const isUrgent = (alert: Alert): boolean =>
  alert.severity === "alarm" || alert.severity === "critical";

function age(alert: Alert, now: number, zone: string): string {
  if (alert.end !== null) return `${duration(lasted(alert, now))} long`;
  if (alert.predicted) return "now";
  if (!Number.isFinite(alert.start)) return "";
  const passed = whole(now - alert.start);
  return isUrgent(alert) ? `${clock(alert.start, zone)}, ${passed} ago` : passed;
}

export function Card({ group, now, keyed }: Props) {
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
      <Acts group={group} now={now} keyed={keyed} />
    </li>
  );
}

function line(alert: Alert, how: string, now: number, zone: string): string {
  const by = (who: string | null, t: number) =>
    `${who ? `${who}, ` : ""}${clock(t, zone).slice(0, 5)}.`;
  if (how === "closed" && alert.closed) {
    const note = alert.closed.note ? `“${alert.closed.note}” ` : "";
    return `${note}${by(alert.closed.by, alert.closed.t)}`;
  }
  if (how === "shelved" && alert.shelved) {
    return `${alert.shelved.note ? `${alert.shelved.note}. ` : ""}${alert.shelved.by ?? ""}`;
  }
  if (how === "acknowledged" && alert.ack) {
    return `${where(alert, now)} ${by(alert.ack.by, alert.ack.t)}`;
  }
  const raised = alert.raisedFrom ? ` Raised from ${named(alert.raisedFrom)}.` : "";
  const tail = how === "ended" ? " Not acknowledged." : "";
  return `${where(alert, now)}${raised}${tail}`;
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
    if (alert.stored) void store.act(alert.id, { phase: "ack" }, "Acknowledged.");
  }
}

/** Replay an alert from five seconds before it began. */
export function replay(alert: Alert): void {
  if (store.history.length === 0 || !Number.isFinite(alert.start)) return;
  store.set({ playing: true });
  store.page("live");
  store.replay(alert.start - 5);
}

function Acts({ group, now, keyed }: Props) {
  const alert = group[0] as Alert;
  const how = handling(alert, now);
  const [form, setForm] = useState<"shelve" | "close" | "menu" | null>(null);
  const canAct = alert.stored && store.mayAct;
  const canReplay = alert.start >= store.history.from;
  const done = () => setForm(null);
  if (form === "shelve") return <Shelve alert={alert} done={done} now={now} />;
  if (form === "close") return <Close alert={alert} done={done} />;
  const ack = canAct && (how === "new" || how === "ended") && !alert.predicted;
  const primary = alert.severity === "warning" || alert.severity === "info" ? "" : "primary";
  const buttons = [
    ack && (
      <button key="ack" type="button" class={`button ${primary} ${primary && "grow"}`}
        onClick={() => acknowledge(group)}>
        Acknowledge{keyed && <span class="key">A</span>}
      </button>
    ),
    canReplay && !alert.camera && how !== "shelved" && (
      <button key="replay" type="button" class={`button ${ack ? "" : "grow"}`}
        onClick={() => replay(alert)}>
        <Icon name="play" size={15} />Replay{keyed && <span class="key">R</span>}
      </button>
    ),
    canAct && how === "acknowledged" && (
      <button key="close" type="button" class="button" onClick={() => setForm("close")}>Close…</button>
    ),
    canAct && how === "new" && alert.camera && (
      <button key="shelve" type="button" class="button quiet" onClick={() => setForm("shelve")}>
        Shelve
      </button>
    ),
    canAct && how === "shelved" && (
      <button key="unshelve" type="button" class="button quiet"
        onClick={() => void store.act(alert.id, { phase: "unshelve" }, "No longer shelved.")}>
        End shelving
      </button>
    ),
    canAct && how === "closed" && alert.closed && (
      <button key="reopen" type="button" class="button quiet"
        onClick={() => void store.act(alert.id, { phase: "reopen" }, "Open again.")}>
        Reopen
      </button>
    ),
    canAct && how === "new" && !alert.camera && (
      <button key="more" type="button" class="button quiet icon" aria-label="More"
        aria-expanded={form === "menu"} onClick={() => setForm(form ? null : "menu")}>
        <Icon name="more" />
      </button>
    ),
  ].filter(Boolean);
  if (buttons.length === 0) return null;
  return (
    <div class="acts">
      {buttons}
      {form === "menu" && (
        <div class="menu">
          <button type="button" onClick={() => setForm("shelve")}>Shelve…</button>
          <button type="button" onClick={() => setForm("close")}>Close…</button>
        </div>
      )}
    </div>
  );
}

function Shelve({ alert, done, now }: { alert: Alert; done: () => void; now: number }) {
  const note = useRef<HTMLInputElement>(null);
  const shelve = (seconds: number) => {
    const what = { phase: "shelve" as const, until_s: now + seconds, note: note.current?.value ?? "" };
    void store.act(alert.id, what, "Shelved.");
    done();
  };
  return (
    <form onSubmit={(event) => event.preventDefault()}>
      <input class="field" ref={note} placeholder="Why, as: technician called" aria-label="Why" />
      <div class="row">
        {SHELVES_S.map(([text, seconds]) => (
          <button key={text} type="button" class="button" onClick={() => shelve(seconds)}>{text}</button>
        ))}
        <button type="button" class="button quiet" onClick={done}>Cancel</button>
      </div>
    </form>
  );
}

export function Close({ alert, done }: { alert: Alert; done?: () => void }) {
  const [reason, setReason] = useState<Reason>("true");
  const [note, setNote] = useState("");
  const missing = reason === "false" && note.trim() === "";
  const close = () => {
    void store.act(alert.id, { phase: "close", reason, note: note.trim() }, "Closed.");
    done?.();
  };
  return (
    <form onSubmit={(event) => { event.preventDefault(); if (!missing) close(); }}>
      <div class="reasons" role="group" aria-label="Close as">
        {(Object.keys(REASONS) as Reason[]).map((one, i) => (
          <button key={one} type="button" class="button" aria-pressed={reason === one}
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
          title={missing ? "A false alarm needs a note" : ""}>Close alert</button>
        {done && <button type="button" class="button quiet" onClick={done}>Cancel</button>}
      </div>
    </form>
  );
}
