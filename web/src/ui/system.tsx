import { PastRow } from "./alerts.tsx";
import { acknowledge } from "./card.tsx";
import { Glyph, Icon } from "./icons.tsx";
import { useStore } from "./use.ts";
import { camerasLive } from "./top.tsx";
import {
  actor, handled, handling, isActive, isFault, REASONS, type Alert,
} from "../state/alerts.ts";
import type { CameraHealth, Health } from "../state/messages.ts";
import { dataTime, open, type State } from "../state/state.ts";
import { clock, count, duration, named } from "../state/words.ts";
import { store } from "../store.ts";

const STATES = { live: "Live", stale: "Stale", down: "Down", ended: "Ended" };

export function System() {
  const { state } = useStore();
  const health = state.health;
  return (
    <div class="system">
      <main class="left" aria-label="System">
        <div class="head"><h2>Cameras</h2><span class="note">{health ? camerasLive(state) : "unknown"}</span></div>
        {health && <Cameras health={health} state={state} />}
        <div class="head"><h2>Rules</h2></div>
        <Rules state={state} />
        <div class="head"><h2>Events</h2></div>
        <Changes state={state} />
      </main>
      <aside class="right" aria-label="Delay, storage and workers">
        <Delay health={health} />
        <Tracking health={health} />
        <Stored health={health} />
        <Workers health={health} />
        <div class="footer">
          <p>Supports people on duty. Not a certified safety function.</p>
        </div>
      </aside>
    </div>
  );
}

function Cameras({ health, state }: { health: Health; state: State }) {
  const lost = state.link === "lost";
  return (
    <table class="grid">
      <thead>
        <tr>
          <th>Camera</th><th>State</th><th class="n">Rate</th><th class="n">Age</th>
          <th class="wide">Clock</th><th class="n wide">Left out</th><th class="wide">Because</th>
        </tr>
      </thead>
      <tbody>
        {Object.entries(health.cameras).map(([name, camera]) => (
          <Row key={name} name={name} camera={camera} state={state} lost={lost} />
        ))}
      </tbody>
    </table>
  );
}

function Row(
  { name, camera, state, lost }:
  { name: string; camera: CameraHealth; state: State; lost: boolean },
) {
  const fault = isFault(camera.state);
  const row = (
    <tr class={fault ? "fault" : ""} data-camera={name}>
      <td>
        <span class="name">
          {fault ? <Glyph severity="warning" /> : <Icon name="camera" size={16} />}{named(name)}
        </span>
      </td>
      <td class="state">{lost ? "Unknown" : STATES[camera.state]}</td>
      <td class="n">{camera.fps.toFixed(1)} /s</td>
      <td class="n">{camera.age_s === null ? "Never" : duration(camera.age_s)}</td>
      <td class="soft wide">{camera.clock === "sender" ? "From the camera" : "Unknown, arrival"}</td>
      <td class="n wide">{camera.dropped}</td>
      <td class="soft wide">{dropsInWords(camera)}</td>
    </tr>
  );
  if (lost || !(fault || camera.fault)) return row;
  return (
    <>
      {row}
      {fault ? <Why name={name} camera={camera} state={state} /> : <Doubt name={name} fault={camera.fault} />}
    </>
  );
}

/** What is wrong with a camera that sends pictures all the same. */
function Doubt({ name, fault }: { name: string; fault: string | null | undefined }) {
  return (
    <tr class="fault"><td class="why" colSpan={7}><div><p>{named(name)}: {fault}</p></div></td></tr>
  );
}

/** What is wrong with a camera, and what can be done about its alert. */
function Why({ name, camera, state }: { name: string; camera: CameraHealth; state: State }) {
  const now = dataTime(state);
  const zone = state.site?.timezone ?? "UTC";
  const since = camera.age_s === null
    ? "no picture yet" : `no picture since ${clock(now - camera.age_s, zone)}`;
  const alert = open(state).find((one) => one.camera === name && isActive(one));
  const how = alert && handling(alert, now);
  const by = alert && actor(how === "shelved" ? alert.shelved?.by : alert.ack?.by);
  const done = how === "acknowledged" || how === "shelved"
    ? ` ${named(handled(alert as Alert, now, (t) => clock(t, zone)))}${by ? ` by ${by}` : ""}.` : "";
  return (
    <tr class="fault">
      <td class="why" colSpan={7}>
        <div>
          <p>{named(name)}: {since}{camera.fault ? `; ${camera.fault}` : ""}{camera.fault?.endsWith("?") ? "" : "."}{done}</p>
          {alert && how === "new" && store.mayAct && (
            <>
              <button type="button" class="button" onClick={() => acknowledge([alert])}>Acknowledge</button>
              <button type="button" class="button quiet" onClick={() => void store.act(
                alert.id, { phase: "shelve", until_s: now + 3600 }, "Shelved for 1 h.", { phase: "unshelve" },
              )}>Shelve 1 h</button>
            </>
          )}
        </div>
      </td>
    </tr>
  );
}

const REASONS_OUT: Record<string, string> = {
  queue: "no time for the poses", late: "too late", decode: "damaged", size: "of another size",
};

/** Return why images were left out, the most frequent reason first. */
function dropsInWords(camera: CameraHealth): string {
  return Object.entries(camera.dropped_by ?? {})
    .filter(([, n]) => n > 0)
    .sort((a, b) => b[1] - a[1])
    .map(([reason, n]) => `${n} ${REASONS_OUT[reason] ?? reason.replaceAll("_", " ")}`)
    .join(", ");
}

/** How often each rule fired, and how often that was false. */
function Rules({ state }: { state: State }) {
  const byRule = new Map<string, Alert[]>();
  for (const alert of state.alerts.values()) {
    if (!alert.part && alert.rule) {
      byRule.set(alert.rule, [...(byRule.get(alert.rule) ?? []), alert]);
    }
  }
  if (byRule.size === 0) {
    return (
      <p class="empty">
        {(state.site?.rules ?? 0) === 0
          ? "No rules yet. How often each fires, and how often that was false, stands here."
          : "No rule has fired yet."}
      </p>
    );
  }
  return (
    <table class="grid">
      <thead><tr><th>Rule</th><th>Where</th><th class="n">Alerts</th><th class="n">False</th></tr></thead>
      <tbody>
        {[...byRule].map(([rule, alerts]) => (
          <tr key={rule}>
            <td><span class="name"><Glyph severity={alerts[0]?.severity ?? "info"} open={false} />{named(rule)}</span></td>
            <td class="soft">{named(alerts[0]?.place ?? "Everywhere")}</td>
            <td class="n">{alerts.length}</td>
            <td class="n">{alerts.filter((one) => one.closed?.reason === "false").length}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function lastedIn(alert: Alert): string {
  const closed = alert.closed ? `, closed as ${REASONS[alert.closed.reason].toLowerCase()}` : "";
  const by = actor(alert.closed?.by ?? alert.ack?.by);
  const who = by ? (alert.closed ? ` by ${by}` : `, acknowledged by ${by}`) : "";
  const length = alert.end === null ? "still there" : `over after ${duration(alert.end - alert.start)}`;
  return `${length}${closed}${who}`;
}

function Changes({ state }: { state: State }) {
  const zone = state.site?.timezone ?? "UTC";
  const all = [...state.alerts.values()]
    .sort((a, b) => b.start - a.start)
    .slice(0, 20);
  if (all.length === 0) return <p class="empty">Nothing has happened since the start.</p>;
  return (
    <ul class="past">
      {all.map((alert) => (
        <PastRow key={alert.id} alert={alert} zone={zone}
          open={alert.end === null && !alert.closed} end={lastedIn(alert)} />
      ))}
    </ul>
  );
}

const ms = (of: number): string =>
  of < 9.95 ? `${of.toFixed(1)} ms` : of < 999.5 ? `${of.toFixed(0)} ms` : `${(of / 1000).toFixed(2)} s`;

/** The stages that an image goes through until its people are known; their times add up. */
const WAY: Record<string, string> = {
  "image to poses": "2D poses", sync: "All cameras", fusion: "3D people",
};
const WHOLE = "image to people";
/** What happens then, beside each other. */
const THEN: Record<string, string> = { publish: "Sending to the page", store: "Writing to the disk" };

function Delay({ health }: { health: Health | null }) {
  const all = health?.stages ?? {};
  const way = Object.entries(WAY).flatMap(([key, name]) => (all[key] ? [{ name, stage: all[key] }] : []));
  const then = Object.entries(THEN).flatMap(([key, name]): [string, string][] =>
    (all[key] ? [[name, ms(all[key].median_ms)]] : []));
  const total = Math.max(all[WHOLE]?.median_ms ?? 0, way.reduce((sum, { stage }) => sum + stage.median_ms, 0));
  let start = 0;
  return (
    <>
      <div class="head"><h2>Delay, picture to people</h2><div class="end note">median</div></div>
      <div class="block">
        {way.length === 0 ? <p class="note">Not measured yet.</p> : (
          <>
            <p class="big">
              {ms(total)}
              {all[WHOLE] && <small>95 of 100 below {ms(all[WHOLE].p95_ms)}</small>}
            </p>
            <div class="bars">
              {way.map(({ name, stage }) => {
                const from = start;
                start += stage.median_ms;
                return (
                  <div key={name}>
                    <span>{name}</span>
                    <svg viewBox="0 0 100 6" preserveAspectRatio="none" aria-hidden="true">
                      <rect class="back" width="100" height="6" />
                      <rect class="bar" x={(100 * from) / total} height="6"
                        width={Math.max(0.8, (100 * stage.median_ms) / total)} />
                    </svg>
                    <b>{ms(stage.median_ms)}</b>
                  </div>
                );
              })}
            </div>
          </>
        )}
      </div>
      {then.length > 0 && <Facts rows={then} />}
    </>
  );
}

function Facts({ rows }: { rows: [string, string][] }) {
  return (
    <div class="block">
      <dl class="facts-list">
        {rows.map(([name, value]) => <div key={name}><dt>{name}</dt><dd>{value}</dd></div>)}
      </dl>
    </div>
  );
}

const FUSION = { starting: "Starting", running: "Running", stalled: "Stopped", ended: "Ended" };

function Tracking({ health }: { health: Health | null }) {
  const fusion = health?.fusion;
  const estimate = health?.stages?.estimate;
  return (
    <>
      <div class="head"><h2>3D people</h2></div>
      <Facts rows={[
        ["State", fusion ? FUSION[fusion.state] : "Unknown"],
        ["Results", fusion?.rate_hz === undefined ? "Unknown" : `${fusion.rate_hz.toFixed(1)} /s`],
        ...(estimate ? [["2D poses of an image", ms(estimate.median_ms)] as [string, string]] : []),
        ["Time of one result", fusion?.step_ms == null ? "Unknown" : `${fusion.step_ms.toFixed(1)} ms`],
      ]} />
    </>
  );
}

const STORE = { off: "Off", writing: "Writing", failing: "Fails" };

function Stored({ health }: { health: Health | null }) {
  const stored = health?.store;
  return (
    <>
      <div class="head"><h2>Stored data</h2></div>
      <Facts rows={[
        ["Recording", stored ? STORE[stored.state] : "Unknown"],
        ...(stored?.fault ? [["Why", stored.fault] as [string, string]] : []),
      ]} />
    </>
  );
}

function Workers({ health }: { health: Health | null }) {
  const restarts = Object.entries(health?.restarts ?? {}).filter(([, n]) => n > 0);
  return (
    <>
      <div class="head"><h2>Restarted workers</h2></div>
      {restarts.length === 0
        ? <p class="empty">None since the start.</p>
        : <Facts rows={restarts.map(([name, n]) => [named(name), count(n, "time")])} />}
    </>
  );
}

