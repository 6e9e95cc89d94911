import { useEffect, useRef, useState } from "preact/hooks";
import { Close, acknowledge } from "./card.tsx";
import { around, recordings, type Film } from "./film.ts";
import { Glyph, Icon } from "./icons.tsx";
import { Controls, Lanes } from "./reel.tsx";
import { List } from "./reviewlist.tsx";
import { Stage } from "./stage.tsx";
import { Tiles } from "./tiles.tsx";
import { useStore } from "./use.ts";
import type { Recording } from "../net/api.ts";
import { actor, figures, handling, lasted, REASONS, title, where, type Alert } from "../state/alerts.ts";
import { faultRule, why } from "../state/faults.ts";
import { dataTime } from "../state/state.ts";
import { clock, count, day, duration, named, SEVERITY } from "../state/words.ts";
import { store } from "../store.ts";

const [BEFORE_S, AFTER_S] = [30, 60];
const LOOK_AGAIN_MS = 15_000;

export function Review() {
  const shop = useStore();
  const { subject, t } = shop.address;
  const [films, setFilms] = useState<Recording[] | null>(null);
  const [fault, setFault] = useState("");
  const film = useRef<Film | null>(null);
  const alert = subject ? (shop.state.alerts.get(subject) ?? null) : null;
  const recording = chosen(films, subject, alert);

  useEffect(() => {
    // A recording that still runs grows.
    const look = () => recordings().then(setFilms, (error: Error) => {
      setFilms((before) => before ?? []);
      setFault(error.message);
    });
    void look();
    const timer = setInterval(() => !document.hidden && void look(), LOOK_AGAIN_MS);
    return () => clearInterval(timer);
  }, [subject]);

  useEffect(() => () => store.load(null), []);

  useEffect(() => {
    if (!films || !subject || t !== null) return;
    const start = alert ? alert.start - 5 : (recording?.from_s ?? NaN);
    if (!Number.isFinite(start)) return;
    store.set({ playing: true });
    store.go({ t: start }, true);
  }, [films, subject, t, alert?.id, recording?.id]);

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
  const has = t !== null && shop.film.length > 0
    && t >= shop.film.from - 1 && t <= shop.film.to + 1;
  return (
    <div class="review">
      <List films={films} subject={subject} />
      <main class="middle" aria-label="Replay">
        <Stage />
        <Tiles />
        <Lanes span={span} alert={alert} />
        <Controls fault={fault} has={has} why={nothing(films, subject, alert, recording)} />
      </main>
      <Why alert={alert} recording={recording} />
    </div>
  );
}

/** Return why there is nothing to replay. */
function nothing(
  films: Recording[] | null, subject: string | null, alert: Alert | null, recording: Recording | null,
): string {
  if (!subject) return "Choose an alert or a recording.";
  if (!films || recording) return "Loading…";
  return alert ? "No recording holds this moment." : "There is no such alert or recording.";
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

function Why({ alert, recording }: { alert: Alert | null; recording: Recording | null }) {
  const shop = useStore();
  const { state } = shop;
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
              : "Choose an alert or a recording. Then stands here why an alert fired, whether it is real, and its times."}
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
          {alert.part ? faultRule(alert) : `Rule ${named(alert.rule)}.`}
        </p>
        {why(alert) && <p class="soft">{named(why(alert))}.</p>}
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
          {alert.ack && <div><dt>Acknowledged</dt><dd>{clock(alert.ack.t, zone)} {actor(alert.ack.by)}</dd></div>}
          {alert.closed && <div><dt>Closed</dt><dd>{clock(alert.closed.t, zone)} {actor(alert.closed.by)}</dd></div>}
          {alert.closed && <div><dt>As</dt><dd>{REASONS[alert.closed.reason]}</dd></div>}
        </dl>
      </div>
      <div class="block">
        <button type="button" class="button" aria-pressed={shop.reviewed.has(alert.id)}
          onClick={() => void store.review(alert.id)}>
          {shop.reviewed.has(alert.id) && <Icon name="check" size={16} />}
          Reviewed<span class="key">X</span>
        </button>
      </div>
      {store.mayAct && (
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
