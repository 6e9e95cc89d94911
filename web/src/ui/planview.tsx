import { useEffect, useRef } from "preact/hooks";
import { Icon } from "./icons.tsx";
import { planInput } from "./shown.ts";
import { use } from "./use.ts";
import { fit } from "../draw/mark.ts";
import { palette } from "../draw/palette.ts";
import { drawPlan, type PlanView } from "../draw/plan.ts";
import { store } from "../store.ts";

/** A canvas on which `draw` is called for each snapshot, and after a change of size or theme. */
export function Drawn(
  { draw, label, onPick }:
  { draw: (canvas: HTMLCanvasElement) => void; label: string; onPick?: (x: number, y: number) => void },
) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const latest = useRef(draw);
  latest.current = draw;
  useEffect(() => {
    const paint = () => {
      if (canvas.current && !document.hidden) latest.current(canvas.current);
    };
    const size = new ResizeObserver(paint);
    if (canvas.current) size.observe(canvas.current);
    const off = store.onDraw(paint);
    paint();
    return () => {
      off();
      size.disconnect();
    };
  }, []);
  return (
    <canvas
      ref={canvas} role="img" aria-label={label}
      onClick={onPick && ((event) => onPick(event.offsetX, event.offsetY))}
    />
  );
}

/** Select the person nearest to a place of the plan. */
function pick(view: PlanView | null, x: number, y: number): void {
  if (!view) return;
  const near = (store.shown?.people ?? [])
    .map((person) => {
      const [px, py] = view.to(person.floor);
      return { id: person.id, away: Math.hypot(px - x, py - y) };
    })
    .filter((one) => one.away < 24)
    .sort((a, b) => a.away - b.away)[0];
  store.go({ person: near?.id ?? null }, true);
}

export function Plan({ large }: { large: boolean }) {
  const view = useRef<PlanView | null>(null);
  return (
    <Drawn
      label="Floor plan with people"
      onPick={(x, y) => pick(view.current, x, y)}
      draw={(canvas) => {
        const input = planInput(large);
        const sheet = fit(canvas);
        if (!input || !sheet) return;
        view.current = drawPlan(
          sheet.pen, palette(), sheet.width, sheet.height, large ? 56 : 14, input,
        );
      }}
    />
  );
}

export function PlanBox() {
  const site = use((s) => s.state.site);
  const lost = use((s) => s.state.link === "lost" && !s.replaying);
  const [w, h] = site
    ? [site.floor.high[0] - site.floor.low[0], site.floor.high[1] - site.floor.low[1]]
    : [0, 0];
  const size = site ? `${Math.max(w, h).toFixed(0)} × ${Math.min(w, h).toFixed(0)} m` : "";
  return (
    <section class={`planbox ${lost ? "old" : ""}`} aria-label="Plan">
      <div class="head">
        <h2>Plan</h2><span class="note">{size}</span>
        <div class="end">
          <span class="key">F</span>
          <button type="button" class="button quiet icon" aria-label="Large plan"
            onClick={() => store.go({ view: "plan" })}>
            <Icon name="expand" size={16} />
          </button>
        </div>
      </div>
      <div class="body"><Plan large={false} /></div>
    </section>
  );
}
