// The time that Review replays: its lanes and its controls.

import { useEffect, useRef, useState } from "preact/hooks";
import { Icon } from "./icons.tsx";
import { Drawn } from "./planview.tsx";
import { useStore } from "./use.ts";
import { outages, type Alert } from "../state/alerts.ts";
import { clock, named } from "../state/words.ts";
import { fit, font, type Pen } from "../draw/mark.ts";
import { alpha, palette } from "../draw/palette.ts";
import { store } from "../store.ts";

const SPEEDS: [number, string][] = [[0.25, "¼"], [0.5, "½"], [1, "1×"], [2, "2×"], [4, "4×"]];

export interface Span { from: number; to: number }

/** The time around an alert, or of a recording; drag to move. */
export function Lanes({ span, alert }: { span: Span | null; alert: Alert | null }) {
  const shop = useStore();
  const box = useRef<HTMLDivElement>(null);
  const dragging = useRef(false);
  const latest = useRef({ span, alert });
  latest.current = { span, alert };
  useEffect(() => store.draw(), [span?.from, span?.to, alert]);
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
  const film = store.film;
  const [filmFrom, filmTo] = [Math.max(span.from, film.from), Math.min(span.to, film.to)];
  for (const top of [20, 38]) {
    lane(top, span.from, span.to, c.text3, 0.1);
    if (film.length > 0 && filmTo > filmFrom) lane(top, filmFrom, filmTo, c.text3, 0.14);
  }
  drawOutages(pen, span, x);
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

/** The second lane: when a camera was not live. */
function drawOutages(pen: Pen, span: Span, x: (t: number) => number): void {
  const c = palette();
  pen.font = font(600, 11);
  pen.textAlign = "center";
  for (const { camera, from, to } of outages(store.state.alerts)) {
    const [left, right] = [x(Math.max(span.from, from)), x(Math.min(span.to, to))];
    if (to < span.from || from > span.to || right - left < 1) continue;
    pen.fillStyle = alpha(c.warnFill, 0.16);
    pen.fillRect(left, 38, right - left, 14);
    pen.strokeStyle = c.warn;
    pen.lineWidth = 1;
    pen.setLineDash([3, 2]);
    pen.strokeRect(left + 0.5, 38.5, right - left - 1, 13);
    pen.setLineDash([]);
    const text = `${named(camera)} silent`;
    if (pen.measureText(text).width + 12 > right - left) continue;
    pen.fillStyle = c.warn;
    pen.fillText(text, (left + right) / 2, 45.5);
  }
}

export function Controls({ fault, has, why }: { fault: string; has: boolean; why: string }) {
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
      {fault ? <span role="alert">{fault}</span> : !has && <span class="note">{why}</span>}
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
