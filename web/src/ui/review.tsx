import { useEffect, useRef, useState } from "preact/hooks";
import { Close, acknowledge } from "./card.tsx";
import { around, recordings, type Film } from "./film.ts";
import { Glyph, Icon } from "./icons.tsx";
import { Drawn } from "./planview.tsx";
import { Stage } from "./stage.tsx";
import { Tiles } from "./tiles.tsx";
import { useStore } from "./use.ts";
import type { Recording } from "../net/api.ts";
import { figures, handling, lasted, REASONS, title, where, type Alert } from "../state/alerts.ts";
import { dataTime } from "../state/state.ts";
import { clock, count, day, duration, hourMinute, named, SEVERITY, UNIX_FROM_S } from "../state/words.ts";
import { fit, font } from "../draw/mark.ts";
import { alpha, palette } from "../draw/palette.ts";
import { store } from "../store.ts";

const SPEEDS: [number, string][] = [[0.25, "¼"], [0.5, "½"], [1, "1×"], [2, "2×"], [4, "4×"]];
const [BEFORE_S, AFTER_S] = [30, 60];

type Tab = "todo" | "all" | "recordings";

export function Review() {
  const shop = useStore();
  const { subject, t } = shop.address;
  const [films, setFilms] = useState<Recording[] | null>(null);
  const [fault, setFault] = useState("");
  const film = useRef<Film | null>(null);
  const alert = subject ? (shop.state.alerts.get(subject) ?? null) : null;
  const recording = chosen(films, subject, alert);

  useEffect(() => {
    recordings().then(setFilms, (error: Error) => {
      setFilms([]);
      setFault(error.message);
    });
    return () => store.load(null);
  }, []);

  useEffect(() => {
    if (!films || !subject || t !== null) return;
    const start = alert ? alert.start - 5 : (recording?.from_s ?? NaN);
    if (Number.isFinite(start)) store.go({ t: start }, true);
  }, [films, subject, t]);

  useEffect(() => {
    if (!films || t === null) return;
    if (!recording) {
      if (store.loaded) store.load(null);
      return;
    }
    around(film.current, recording, t).then(
      (next) => { film.current = next; setFault(""); },
      (error: Error) => setFault(error.message),
    );
  }, [films, recording?.id, t === null ? null : Math.round(t)]);

  const span = alert
    ? { from: alert.start - BEFORE_S, to: alert.start + AFTER_S }
    : recording ? { from: recording.from_s, to: recording.to_s } : null;
  return (
    <div class="review">
      <List films={films} subject={subject} />
      <main class="middle" aria-label="Replay">
        <Stage />
        <Tiles />
        <Lanes span={span} alert={alert} />
        <Controls fault={fault} has={shop.film.length > 0 && t !== null} />
      </main>
      <Why alert={alert} recording={recording} />
    </div>
  );
}

/** Return the recording that the address names, or the one that holds the alert. */
function chosen(
  films: Recording[] | null, subject: string | null, alert: Alert | null,
): Recording | null {
  if (!films) return null;
  if (alert) {
    return films.find((one) => one.from_s <= alert.start && alert.start <= one.to_s) ?? null;
  }
  return films.find((one) => one.id === subject) ?? null;
}

function List({ films, subject }: { films: Recording[] | null; subject: string | null }) {
  const { state } = useStore();
  const [tab, setTab] = useState<Tab>("all");
  const now = dataTime(state);
  const all = [...state.alerts.values()].sort((a, b) => b.start - a.start);
  const todo = all.filter((alert) => handling(alert, now) !== "closed" || (alert.end !== null && !alert.closed));
  const tabs: [Tab, string][] = [
    ["todo", `To review ${todo.length}`], ["all", `Alerts ${all.length}`],
    ["recordings", `Recordings${films ? ` ${films.length}` : ""}`],
  ];
  const shown = tab === "todo" ? todo : tab === "all" ? all : [];
  return (
    <section class="list" aria-label="Alerts and recordings">
      <div class="head">
        <Icon name="calendar" size={16} />
        <h2>{state.site ? day(now, state.site.timezone) : ""}</h2>
      </div>
      <div class="tabs">
        <div class="segments" role="group" aria-label="What is listed">
          {tabs.map(([key, name]) => (
            <button key={key} type="button" aria-pressed={tab === key} onClick={() => setTab(key)}>{name}</button>
          ))}
        </div>
      </div>
      <div class="scroll">
        {shown.map((alert) => <Item key={alert.id} alert={alert} now={now} current={alert.id === subject} />)}
        {tab !== "recordings" && shown.length === 0 && (
          <p class="empty">{tab === "todo" ? "Nothing is left to review." : "No alert so far."}</p>
        )}
        {(tab === "recordings" || all.length === 0) && (films ?? []).map((film) => (
          <FilmItem key={film.id} film={film} current={film.id === subject} />
        ))}
        {tab === "recordings" && films?.length === 0 && (
          <p class="empty">Nothing is recorded. The site file's table [output] turns recording on.</p>
        )}
      </div>
      <div class="keys">
        <span class="key">J</span><span class="key">K</span>next, previous
      </div>
    </section>
  );
}

function Item({ alert, now, current }: { alert: Alert; now: number; current: boolean }) {
  const how = handling(alert, now);
  const done = how === "closed" && alert.closed !== null;
  const tell = alert.closed
    ? REASONS[alert.closed.reason]
    : how === "closed" ? "To close" : how === "acknowledged" ? "Acknowledged" : "To review";
  return (
    <button type="button" class="item" aria-current={current ? "true" : undefined}
      onClick={() => store.go({ subject: alert.id, t: null })}>
      <Glyph severity={alert.severity} open={!done} />
      <b>{title(alert)}</b>
      <span class="end">{hourMinute(alert.start, store.state.site?.timezone ?? "UTC")}</span>
      <span class="soft">
        {[alert.place && named(alert.place), `for ${duration(lasted(alert, now))}`]
          .filter(Boolean).join(", ")}
      </span>
      <span class={`end ${done ? "" : "todo"}`}>{tell}</span>
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
      <span class="soft">{count(film.people, "person", "people")}</span>
      <span />
    </button>
  );
}

interface Span { from: number; to: number }

/** The time around an alert, or of a recording; drag to move. */
function Lanes({ span, alert }: { span: Span | null; alert: Alert | null }) {
  const shop = useStore();
  const box = useRef<HTMLDivElement>(null);
  const dragging = useRef(false);
  const latest = useRef({ span, alert });
  latest.current = { span, alert };
  const zone = shop.state.site?.timezone ?? "UTC";
  const at = (event: PointerEvent) => {
    const area = box.current?.getBoundingClientRect();
    if (!area || !span) return;
    const share = Math.min(1, Math.max(0, (event.clientX - area.left) / area.width));
    store.replay(span.from + share * (span.to - span.from));
  };
  return (
    <div class="timeline">
      <div class="track" ref={box} role="slider" tabIndex={0} aria-label="Time shown"
        aria-valuemin={Math.round(span?.from ?? 0)} aria-valuemax={Math.round(span?.to ?? 0)}
        aria-valuenow={Math.round(shop.address.t ?? 0)}
        aria-valuetext={shop.address.t === null ? "" : clock(shop.address.t, zone)}
        onPointerDown={(event) => {
          dragging.current = true;
          event.currentTarget.setPointerCapture(event.pointerId);
          at(event);
        }}
        onPointerMove={(event) => dragging.current && at(event)}
        onPointerUp={() => { dragging.current = false; }}>
        <Drawn label="Time around the alert"
          draw={(canvas) => drawLanes(canvas, latest.current.span, latest.current.alert)} />
      </div>
    </div>
  );
}

function drawLanes(canvas: HTMLCanvasElement, span: Span | null, alert: Alert | null): void {
  const sheet = fit(canvas);
  if (!sheet || !span || span.to <= span.from) return;
  const { pen, width } = sheet;
  const c = palette();
  const zone = store.state.site?.timezone ?? "UTC";
  const x = (t: number) => ((t - span.from) / (span.to - span.from)) * width;
  const lane = (top: number, from: number, to: number, ink: string, a = 1) => {
    pen.fillStyle = alpha(ink, a);
    pen.fillRect(x(from), top, Math.max(2, x(to) - x(from)), 14);
  };
  pen.font = font(500, 11);
  pen.textBaseline = "middle";
  for (let i = 0; i <= 6; i++) {
    const t = span.from + ((span.to - span.from) * i) / 6;
    pen.textAlign = i === 0 ? "left" : i === 6 ? "right" : "center";
    pen.fillStyle = c.text2;
    pen.fillText(clock(t, zone), x(t), 10);
  }
  lane(20, span.from, span.to, c.text3, 0.16);
  lane(38, span.from, span.to, c.text3, 0.16);
  const film = store.film;
  if (film.length > 0) lane(38, Math.max(span.from, film.from), Math.min(span.to, film.to), c.text3, 0.3);
  if (alert) {
    const ink = { critical: c.criticalFill, alarm: c.alarmFill, warning: c.warnFill, info: c.info }[alert.severity];
    lane(20, alert.start, Math.min(span.to, alert.end ?? span.to), ink);
    if (alert.ack && alert.ack.t < span.to) {
      pen.fillStyle = c.text;
      pen.fillRect(x(alert.ack.t), 18, 2, 18);
      pen.fillRect(x(alert.ack.t), 18, 8, 5);
    }
  }
  const t = store.address.t;
  if (t === null) return;
  pen.fillStyle = c.text;
  pen.fillRect(x(t) - 1, 16, 2, 40);
  pen.beginPath();
  pen.moveTo(x(t) - 5, 14);
  pen.lineTo(x(t) + 5, 14);
  pen.lineTo(x(t), 21);
  pen.fill();
}

function Controls({ fault, has }: { fault: string; has: boolean }) {
  const shop = useStore();
  const [text, setText] = useState("");
  const zone = shop.state.site?.timezone ?? "UTC";
  const t = shop.address.t;
  const frame = (by: number) => {
    store.set({ playing: false });
    if (t !== null) store.replay(store.film.step(t, by));
  };
  const go = (event: Event) => {
    event.preventDefault();
    const moment = store.momentOf(text);
    if (moment !== null) store.replay(moment);
    setText("");
  };
  return (
    <div class="controls">
      <button type="button" class="button quiet icon" aria-label="One picture back" disabled={!has}
        onClick={() => frame(-1)}><Icon name="back" /></button>
      <button type="button" class="button icon" disabled={!has}
        aria-label={shop.own.playing ? "Pause" : "Play"} onClick={toggle}>
        <Icon name={shop.own.playing ? "pause" : "play"} />
      </button>
      <button type="button" class="button quiet icon" aria-label="One picture on" disabled={!has}
        onClick={() => frame(1)}><Icon name="forward" /></button>
      <div class="segments" role="group" aria-label="Speed">
        {SPEEDS.map(([speed, name]) => (
          <button key={name} type="button" aria-pressed={shop.own.speed === speed}
            onClick={() => store.set({ speed })}>{name}</button>
        ))}
      </div>
      {fault ? <span role="alert">{fault}</span> : !has && <span class="note">Choose an alert or a recording.</span>}
      <div class="end">
        <form onSubmit={go}>
          <input class="field" aria-label="Go to a time" value={text}
            placeholder={t === null ? "hh:mm:ss" : clock(t, zone, 2)}
            onInput={(event) => setText(event.currentTarget.value)} />
        </form>
        <button type="button" class="button" disabled={t === null} onClick={copy}>
          <Icon name="link" size={16} />Link
        </button>
      </div>
    </div>
  );
}

function toggle(): void {
  store.set({ playing: !store.own.playing });
  if (store.address.t !== null) store.replay(store.address.t);
}

async function copy(): Promise<void> {
  try {
    await navigator.clipboard.writeText(location.href);
    store.toast("The link to this moment is copied.");
  } catch {
    store.toast("The address of this page is the link to this moment.");
  }
}

function Why({ alert, recording }: { alert: Alert | null; recording: Recording | null }) {
  const { state } = useStore();
  const zone = state.site?.timezone ?? "UTC";
  const now = dataTime(state);
  if (!alert) {
    return (
      <aside class="why" aria-label="About">
        <div class="none">
          <strong>{recording ? "Recording" : "Nothing chosen"}</strong>
          <p>
            {recording
              ? `${day(recording.from_s, zone)} ${clock(recording.from_s, zone)} to ${clock(recording.to_s, zone)}, ${count(recording.people, "person", "people")}. Joints only: no picture is kept.`
              : "Choose an alert or a recording on the left. What stands here then: why an alert fired, whether it is real, and its times."}
          </p>
        </div>
      </aside>
    );
  }
  const how = handling(alert, now);
  const real = figures(alert, state.site?.cameras.length ?? 0);
  return (
    <aside class="why" aria-label="About the alert">
      <div class="block">
        <p class="first"><Glyph severity={alert.severity} open={!alert.closed} />{SEVERITY[alert.severity]}</p>
        <h2>{title(alert, true)}</h2>
        <p class="soft">{where(alert, now)}</p>
      </div>
      <div class="block">
        <h3>Why it fired</h3>
        <p>
          {alert.camera
            ? "A camera that sends no picture for 2 s is stale, after 10 s it is down."
            : `Rule ${named(alert.rule)}.`}
        </p>
      </div>
      {real.length > 0 && (
        <div class="block">
          <h3>Is it real?</h3>
          <ul class="checks">
            {real.map((one) => <li key={one.words}><Icon name="check" size={16} />{one.words}<span class="end">{one.value}</span></li>)}
          </ul>
        </div>
      )}
      <div class="block">
        <h3>Times</h3>
        <dl class="facts-list">
          <div><dt>Began</dt><dd>{clock(alert.start, zone, 2)}</dd></div>
          <div><dt>Detected</dt><dd>{`${duration(Math.max(0, alert.detected - alert.start))} later`}</dd></div>
          <div><dt>Lasted</dt><dd>{alert.end === null ? "still there" : duration(lasted(alert, now))}</dd></div>
          {alert.ack && <div><dt>Acknowledged</dt><dd>{clock(alert.ack.t, zone).slice(0, 5)} {alert.ack.by ?? ""}</dd></div>}
          {alert.closed && <div><dt>Closed</dt><dd>{REASONS[alert.closed.reason]} {alert.closed.by ?? ""}</dd></div>}
        </dl>
      </div>
      {alert.stored && store.mayAct && (
        <div class="block">
          {(how === "new" || how === "ended") && (
            <button type="button" class="button" onClick={() => acknowledge([alert])}>Acknowledge</button>
          )}
          {!alert.closed && alert.end !== null && <Close key={alert.id} alert={alert} />}
          {alert.closed && (
            <button type="button" class="button"
              onClick={() => void store.act(alert.id, { phase: "reopen" }, "Open again.")}>Reopen</button>
          )}
        </div>
      )}
    </aside>
  );
}
