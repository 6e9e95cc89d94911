import { useEffect, useRef, useState } from "preact/hooks";
import { around, recordings, type Film } from "./film.ts";
import { Controls, Lanes } from "./reel.tsx";
import { List } from "./reviewlist.tsx";
import { Stage } from "./stage.tsx";
import { Tiles } from "./tiles.tsx";
import { useStore } from "./use.ts";
import type { Recording } from "../net/api.ts";
import { Why } from "./why.tsx";
import type { Alert } from "../state/alerts.ts";
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
