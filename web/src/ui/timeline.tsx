import { useRef } from "preact/hooks";
import { Icon } from "./icons.tsx";
import { Drawn } from "./planview.tsx";
import { useStore } from "./use.ts";
import { getRecordings } from "../net/api.ts";
import { home } from "../state/address.ts";
import { handling, outages } from "../state/alerts.ts";
import { KEPT_S } from "../state/history.ts";
import { dataTime } from "../state/state.ts";
import { clock, hourMinute } from "../state/words.ts";
import { drawGlyph, fit, font, type Pen } from "../draw/mark.ts";
import { alpha, palette, type Palette } from "../draw/palette.ts";
import { store } from "../store.ts";

const TOP = 18; // below the times
const BOTTOM = 43;

interface Scale {
  from: number;
  to: number;
  x: (t: number) => number;
}

const scale = (width: number): Scale => {
  const to = dataTime(store.state);
  const from = to - KEPT_S;
  return { from, to, x: (t) => ((t - from) / KEPT_S) * (width - 8) };
};

export function Timeline() {
  const shop = useStore();
  const box = useRef<HTMLDivElement>(null);
  const dragging = useRef(false);
  const replaying = shop.replaying;
  const lost = shop.state.link === "lost";
  const under = (event: PointerEvent): number => {
    const width = box.current?.clientWidth ?? 1;
    const left = box.current?.getBoundingClientRect().left ?? 0;
    return scale(width).from + ((event.clientX - left) / (width - 8)) * KEPT_S;
  };
  return (
    <section class="timeline" aria-label="Last ten minutes">
      <button type="button" class="button quiet icon" disabled={shop.history.length === 0}
        aria-label={replaying && !shop.own.playing ? "Play" : "Pause"} title="Space"
        onClick={pause}>
        <Icon name={replaying && !shop.own.playing ? "play" : "pause"} />
      </button>
      <button type="button" class="button quiet icon" aria-label="Back 10 seconds"
        title="Back 10 seconds" disabled={shop.history.length === 0}
        onClick={() => { store.set({ playing: true }); store.replay(shop.time - 10); }}>
        <Icon name="review" />
      </button>
      <div
        class="track" ref={box} role="slider" tabIndex={0} aria-label="Time shown"
        aria-valuemin={finite(shop.history.from)} aria-valuemax={finite(shop.history.to)}
        aria-valuenow={Math.round(shop.time)}
        aria-valuetext={replaying ? clock(shop.time, shop.state.site?.timezone ?? "UTC") : "Live"}
        onPointerDown={(event) => {
          const t = under(event);
          if (shop.history.length === 0 || t < shop.history.from - 1) return void older(t);
          dragging.current = true;
          event.currentTarget.setPointerCapture(event.pointerId);
          store.set({ playing: false });
          store.replay(t);
        }}
        onPointerMove={(event) => dragging.current && store.replay(under(event))}
        onPointerUp={() => { dragging.current = false; }}
      >
        <Drawn label="People present and alerts of the last ten minutes" draw={draw} />
      </div>
      <button type="button" class={`button go ${replaying ? "primary" : ""}`} disabled={lost && !replaying}
        onClick={() => store.go({ t: null }, true)}>
        {lost && !replaying ? "Offline" : replaying ? "Back to live" : (
          <><span class="dot" />Live</>
        )}
      </button>
    </section>
  );
}

/** Show in Review what was recorded before this page was opened. */
async function older(t: number): Promise<void> {
  try {
    const found = (await getRecordings()).find((one) => one.from_s <= t && t <= one.to_s);
    if (found) store.go({ ...home, page: "review", subject: found.id, t });
    else store.toast("This page was not open then, and nothing is recorded of that time.");
  } catch (error) {
    store.toast(`Could not look for a recording: ${error instanceof Error ? error.message : String(error)}`);
  }
}

const finite = (t: number): number => (Number.isFinite(t) ? Math.round(t) : 0);

/** Pause: stand still at this moment, or play on from there. */
export function pause(): void {
  if (store.history.length === 0) return;
  if (!store.replaying) {
    store.set({ playing: false });
    store.replay(store.history.to);
  } else if (store.own.playing) store.set({ playing: false });
  else {
    store.set({ playing: true });
    store.replay(store.time);
  }
}

function draw(canvas: HTMLCanvasElement): void {
  const sheet = fit(canvas);
  if (!sheet) return;
  const c = palette();
  const s = scale(sheet.width);
  drawTimes(sheet.pen, c, s, sheet.width);
  drawPeople(sheet.pen, c, s, sheet.width);
  drawOutages(sheet.pen, c, s);
  drawAlerts(sheet.pen, c, s);
  drawHead(sheet.pen, c, s.x(Math.min(s.to, store.time)));
}

function drawTimes(pen: Pen, c: Palette, s: Scale, width: number): void {
  const zone = store.state.site?.timezone ?? "UTC";
  pen.font = font(500, 11);
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillStyle = c.text2;
  pen.strokeStyle = c.line;
  pen.lineWidth = 1;
  for (let t = Math.ceil(s.from / 60) * 60; t < s.to - 25; t += 60) {
    const x = Math.round(s.x(t)) + 0.5;
    if (t >= 0 && x > 16 && x < width - 24) pen.fillText(hourMinute(t, zone), x, 10);
    pen.beginPath();
    pen.moveTo(x, TOP + 4);
    pen.lineTo(x, BOTTOM);
    pen.stroke();
  }
}

function drawPeople(pen: Pen, c: Palette, s: Scale, width: number): void {
  const parts = Math.max(40, Math.floor((width - 8) / 3));
  const counts = store.history.counts(s.from, s.to, parts);
  const most = Math.max(4, ...[...counts].filter(Number.isFinite));
  const w = (width - 8) / parts;
  pen.fillStyle = alpha(c.text3, 0.28);
  pen.beginPath();
  const height = (n: number) => (Number.isFinite(n) ? 2 + (n / most) * 12 : 0);
  counts.forEach((n, i) => {
    if (Number.isFinite(n)) pen.rect(i * w, BOTTOM - height(n), w + 0.5, height(n));
  });
  pen.fill();
  // Hatched where nothing is known: before this page was opened, or while it had no connection.
  pen.save();
  pen.beginPath();
  counts.forEach((n, i) => {
    if (!Number.isFinite(n)) pen.rect(i * w, BOTTOM - 8, w + 0.5, 8);
  });
  pen.clip();
  pen.strokeStyle = alpha(c.text3, 0.35);
  pen.lineWidth = 1;
  pen.beginPath();
  for (let x = -20; x < width + 20; x += 6) {
    pen.moveTo(x, BOTTOM);
    pen.lineTo(x + 8, BOTTOM - 8);
  }
  pen.stroke();
  pen.restore();
}

function drawOutages(pen: Pen, c: Palette, s: Scale): void {
  pen.strokeStyle = c.warnFill;
  pen.lineWidth = 2;
  pen.setLineDash([4, 2]);
  for (const span of outages(store.state.alerts)) {
    if (span.to < s.from || !Number.isFinite(span.from)) continue;
    pen.beginPath();
    pen.moveTo(s.x(Math.max(s.from, span.from)), BOTTOM + 3);
    pen.lineTo(s.x(Math.min(s.to, span.to)), BOTTOM + 3);
    pen.stroke();
  }
  pen.setLineDash([]);
}

function drawAlerts(pen: Pen, c: Palette, s: Scale): void {
  const now = dataTime(store.state);
  const fill = { critical: c.criticalFill, alarm: c.alarmFill, warning: c.warnFill, info: c.info };
  for (const alert of store.state.alerts.values()) {
    if (!(alert.start >= s.from && alert.start <= s.to)) continue;
    const x = s.x(alert.start);
    const closed = handling(alert, now) === "closed";
    pen.strokeStyle = closed ? c.text3 : fill[alert.severity];
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(x, TOP + 8);
    pen.lineTo(x, BOTTOM);
    pen.stroke();
    if (closed) {
      pen.fillStyle = c.text3;
      pen.beginPath();
      pen.arc(x, TOP + 6, 4, 0, 2 * Math.PI);
      pen.fill();
    } else drawGlyph(pen, alert.severity, x, TOP + 5, 13, fill[alert.severity], c.panel);
  }
}

function drawHead(pen: Pen, c: Palette, x: number): void {
  pen.fillStyle = c.text;
  pen.fillRect(x - 1, TOP, 2, BOTTOM - TOP + 4);
  pen.beginPath();
  pen.moveTo(x - 5, TOP - 3);
  pen.lineTo(x + 5, TOP - 3);
  pen.lineTo(x + 1, TOP + 4);
  pen.lineTo(x - 1, TOP + 4);
  pen.fill();
}
