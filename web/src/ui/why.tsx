// Why an alert fired, whether it is real, its times, and what is done about it.

import { useEffect, useRef, useState } from "preact/hooks";
import { Close, acknowledge, Shelve } from "./card.tsx";
import { Glyph, Icon } from "./icons.tsx";
import { useStore } from "./use.ts";
import { getCurve, type Curve, type Recording } from "../net/api.ts";
import {
  actor, figures, handling, isMomentary, lasted, measured, outages, REASONS, title, where, type Alert,
} from "../state/alerts.ts";
import { faultRule, why } from "../state/faults.ts";
import { dataTime } from "../state/state.ts";
import { clock, count, day, duration, list, named, percent, SEVERITY } from "../state/words.ts";
import { store } from "../store.ts";

const [WIDTH, HEIGHT, LEFT, BOTTOM] = [316, 120, 38, 18];
/** A replay of this much around the beginning [s]. */
const AROUND_S = 5;

/** Return joints in words: both sides of one as one. */
function joints(names: readonly string[]): string {
  const bare = names.map((name) => name.replace(/^(left|right)_/, ""));
  const words = [...new Set(bare)].map((name) => {
    const both = bare.filter((one) => one === name).length > 1;
    const whole = names.find((one) => one.endsWith(name)) ?? name;
    return both ? `both ${name}s` : whole.replaceAll("_", " ");
  });
  return words.length > 4 ? `${names.length} of 17` : list(words);
}

const KEPT = new Map<string, Curve>();

/** The rule in words, the probability over time, and what is needed for an alert. */
function Fired({ alert }: { alert: Alert }) {
  const key = `${alert.id} ${alert.end}`;
  const [curve, setCurve] = useState<Curve | null>(KEPT.get(key) ?? null);
  const [fault, setFault] = useState("");
  useEffect(() => {
    let gone = false;
    setFault("");
    setCurve(KEPT.get(key) ?? null);
    if (KEPT.has(key)) return undefined;
    getCurve(alert.id).then(
      (found) => {
        if (alert.end !== null) KEPT.set(key, found);
        if (!gone) setCurve(found);
      },
      (error: Error) => !gone && setFault(error.message),
    );
    return () => { gone = true; };
  }, [key]);
  if (!curve) {
    return (
      <>
        <p>{sentence(alert, null)}</p>
        <p class="soft">{fault ? `No curve: ${fault}.` : "Reading the recording…"}</p>
      </>
    );
  }
  return (
    <>
      <p>{sentence(alert, curve)}</p>
      <Probability alert={alert} curve={curve} />
      <Measures curve={curve} />
    </>
  );
}

function sentence(alert: Alert, curve: Curve | null): string {
  if (!curve) return `Rule ${named(alert.rule)}.`;
  const held = Math.max(curve.on_delay_s, curve.hold_s);
  const needs = `at least ${percent(curve.p_on)} certain${held > 0 ? ` for ${duration(held)}` : ""}`;
  return `${curve.about.replaceAll("`", "")} It has to be ${needs}.`;
}

function Probability({ alert, curve }: { alert: Alert; curve: Curve }) {
  const shop = useStore();
  const box = useRef<SVGSVGElement>(null);
  const [from, to] = [curve.t_s[0] ?? 0, curve.t_s.at(-1) ?? 1];
  const x = (t: number) => LEFT + ((t - from) / Math.max(1e-3, to - from)) * (WIDTH - LEFT - 2);
  const y = (p: number) => 6 + (1 - p) * (HEIGHT - BOTTOM - 12);
  const zone = shop.state.site?.timezone ?? "UTC";
  const t = shop.address.t;
  const pick = (event: PointerEvent) => {
    const area = box.current?.getBoundingClientRect();
    if (!area || (event.type === "pointermove" && event.buttons === 0)) return;
    const share = ((event.clientX - area.left) / area.width * WIDTH - LEFT) / (WIDTH - LEFT - 2);
    store.set({ playing: false });
    store.replay(from + Math.min(1, Math.max(0, share)) * (to - from));
  };
  const end = Math.min(alert.end ?? to, to);
  const marks: [number, string][] = [
    ...(alert.warned === null ? [] : [[alert.warned, "Early warning"] as [number, string]]),
    [alert.detected, "Detected"],
  ];
  const about = `Probability of the condition from ${clock(from, zone)} to ${clock(to, zone)}; `
    + `an alert from ${percent(curve.p_on)} on, over below ${percent(curve.p_off)}.`;
  return (
    <svg class={`curve ${alert.severity}`} ref={box} viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img"
      aria-label={about} onPointerDown={pick} onPointerMove={pick}>
      <rect class="spell" x={x(alert.start)} y="6" width={Math.max(1, x(end) - x(alert.start))}
        height={y(0) - 6} />
      {[0, 1].map((p) => <path key={p} class="grid" d={`M${LEFT} ${y(p)}H${WIDTH - 2}`} />)}
      <text x={LEFT - 6} y={y(0) + 4} class="axis">0 %</text>
      {([["p_on", curve.p_on], ["p_off", curve.p_off]] as [string, number][]).map(([name, p]) => (
        <g key={name}>
          <path class="limit" d={`M${LEFT} ${y(p)}H${WIDTH - 2}`} />
          <text x={LEFT - 6} y={y(p) + 4} class="axis">{Math.round(100 * p)} %</text>
        </g>
      ))}
      {runs(curve).map((run, i) => (
        <path key={i} class="line" d={run.map(([at, p], k) =>
          `${k ? "L" : "M"}${x(at).toFixed(1)} ${y(p).toFixed(1)}`).join("")} />
      ))}
      {marks.map(([at, words]) => at >= from && at <= to && (
        <g key={words}>
          <path class="mark" d={`M${x(at)} 6V${HEIGHT - BOTTOM - 6}`} />
          <text x={x(at) + (words === "Detected" ? 3 : -3)} y={HEIGHT - 4}
            class={words === "Detected" ? "after" : "before"}>{words}</text>
        </g>
      ))}
      {t !== null && t >= from && t <= to && <path class="head" d={`M${x(t)} 2V${HEIGHT - BOTTOM}`} />}
    </svg>
  );
}

/** Return the parts of a curve in which somebody could be judged. */
function runs({ t_s, probability }: Curve): [number, number][][] {
  const found: [number, number][][] = [];
  let open: [number, number][] | null = null;
  probability.forEach((p, i) => {
    if (p === null) open = null;
    else {
      if (!open) found.push((open = []));
      open.push([t_s[i] as number, p]);
    }
  });
  return found;
}

/** The figures of the rule at the moment that is shown, each beside its limit. */
function Measures({ curve }: { curve: Curve }) {
  const { address } = useStore();
  const t = address.t;
  if (t === null) return null;
  const at = curve.t_s.reduce((best, time, i) =>
    Math.abs(time - t) < Math.abs((curve.t_s[best] ?? Infinity) - t) ? i : best, 0);
  const now = Object.entries(curve.measures).flatMap(([name, row]) => {
    const value = row[at];
    return value === null || value === undefined ? [] : [measured(name, value)];
  });
  const limits = Object.entries(curve.keys).filter((one): one is [string, number] => typeof one[1] === "number");
  const p = curve.probability[at];
  return (
    <dl class="facts-list now">
      <div><dt>At this moment</dt><dd>{p === null || p === undefined ? "not seen" : `${percent(p)} certain`}</dd></div>
      {now.map((one) => <div key={one.words}><dt>{named(one.words)}</dt><dd>{one.value}</dd></div>)}
      {limits.map(([name, value]) => {
        const one = measured(name, value);
        return <div key={name}><dt>Limit: {one.words}</dt><dd>{one.value}</dd></div>;
      })}
    </dl>
  );
}

export function Why({ alert, recording }: { alert: Alert | null; recording: Recording | null }) {
  const shop = useStore();
  const { state } = shop;
  const [shelving, setShelving] = useState(false);
  useEffect(() => setShelving(false), [alert?.id]);
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
  const silent = [...new Set(outages(state.alerts)
    .filter((one) => one.from <= (alert.end ?? now) && one.to >= alert.start).map((one) => one.camera))];
  const real = figures(alert, state.site?.cameras.length ?? 0);
  return (
    <aside class="why" aria-label="About the alert">
      <div class="block">
        <p class="first"><Glyph severity={alert.severity} open={!alert.closed} />{SEVERITY[alert.severity]}</p>
        <h2>{title(alert, true)}</h2>
        <p class="soft">{where(alert, now)}</p>
      </div>
      <div class="block">
        <h3>Why it fired{!alert.part && <span class="end">Rule: {named(alert.rule)}</span>}</h3>
        {alert.part ? <p>{faultRule(alert)}</p> : <Fired alert={alert} />}
        {why(alert) && <p class="soft">{named(why(alert))}.</p>}
      </div>
      {real.length > 0 && (
        <div class="block">
          <h3>Is it real?</h3>
          <ul class="checks">
            {real.map((one) => <li key={one.words}><Icon name="check" size={16} />{named(one.words)}<span class="end">{one.value}</span></li>)}
            {alert.joints.length > 0 && (
              <li><Icon name="check" size={16} />Joints<span class="end">{joints(alert.joints)}</span></li>
            )}
            {alert.cameras.length > 0 && (
              <li><Icon name="camera" size={16} />Seen by<span class="end">{list(alert.cameras.map(named))}</span></li>
            )}
            {silent.length > 0 && (
              <li class="odd"><Glyph severity="warning" size={14} />{list(silent.map(named))} was silent</li>
            )}
          </ul>
        </div>
      )}
      <div class="block">
        <h3>Times</h3>
        <dl class="facts-list">
          {alert.lead !== null && <div><dt>Early warning</dt><dd>{duration(alert.lead)} before</dd></div>}
          <div><dt>{alert.predicted ? "Expected" : "Began"}</dt><dd>{clock(alert.start, zone, 2)}</dd></div>
          <div><dt>Detected</dt><dd>{`${duration(Math.max(0, alert.detected - alert.start))} later`}</dd></div>
          {!isMomentary(alert) &&
            <div><dt>Lasted</dt><dd>{alert.end === null ? "still there" : duration(lasted(alert, now))}</dd></div>}
          {alert.ack && <div><dt>Acknowledged</dt><dd>{clock(alert.ack.t, zone)} {actor(alert.ack.by)}</dd></div>}
          {alert.closed && <div><dt>Closed</dt><dd>{clock(alert.closed.t, zone)} {actor(alert.closed.by)}</dd></div>}
          {alert.closed?.note && <div><dt>Note</dt><dd>{alert.closed.note}</dd></div>}
          {alert.closed && <div><dt>As</dt><dd>{REASONS[alert.closed.reason]}</dd></div>}
        </dl>
      </div>
      <div class="block">
        <button type="button" class="button" onClick={() => {
          store.set({ playing: true });
          store.replay(alert.start - AROUND_S);
        }}><Icon name="play" size={15} />{2 * AROUND_S} s around</button>
        <button type="button" class="button" aria-pressed={shop.reviewed.has(alert.id)}
          onClick={() => void store.review(alert.id)}>
          {shop.reviewed.has(alert.id) && <Icon name="check" size={16} />}
          Reviewed<span class="key">X</span>
        </button>
      </div>
      {store.mayAct && (
        <div class="block">
          {!shelving && (
            <div class="acts">
              {(how === "new" || how === "ended") && (
                <button type="button" class="button" onClick={() => acknowledge([alert])}>Acknowledge</button>
              )}
              {how === "new" && (
                <button type="button" class="button" onClick={() => setShelving(true)}>Shelve…</button>
              )}
              {how === "shelved" && (
                <button type="button" class="button"
                  onClick={() => void store.act(alert.id, { phase: "unshelve" }, "No longer shelved.")}>
                  End shelving
                </button>
              )}
            </div>
          )}
          {shelving && <Shelve group={[alert]} now={now} done={() => setShelving(false)} />}
          {!alert.closed && alert.end !== null && <Close key={alert.id} group={[alert]} />}
          {alert.closed && (
            <button type="button" class="button"
              onClick={() => void store.act(alert.id, { phase: "reopen" }, "Open again.")}>Reopen</button>
          )}
        </div>
      )}
    </aside>
  );
}
