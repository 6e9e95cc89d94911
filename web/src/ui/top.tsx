import { useEffect } from "preact/hooks";
import { ModeFact } from "./mode.tsx";
import { useStore } from "./use.ts";
import { Glyph, Icon } from "./icons.tsx";
import { isFault } from "../state/alerts.ts";
import { counted } from "../state/people.ts";
import { dataTime, isOld, isRecording, serverTime, statusOf, type State } from "../state/state.ts";
import type { Status } from "../state/status.ts";
import { clock, count, day, duration, whole } from "../state/words.ts";
import { store, type Store } from "../store.ts";

export function StatusIcon({ status, size }: { status: Status; size: number }) {
  if (status.icon === "severity" && status.severity) {
    return (
      <Glyph severity={status.severity} size={size} reversed={status.look === "filled"} />
    );
  }
  if (status.icon === "connecting") {
    return <span class="spin"><Icon name="connecting" size={size} /></span>;
  }
  return <Icon name={status.icon === "severity" ? "clear" : status.icon} size={size} />;
}

export function StatusBlock() {
  const status = statusOf(useStore().state);
  const site = store.state.site?.name;
  useEffect(() => {
    document.title = site ? `${status.title} - ${site}` : status.title;
  }, [status.title, site]);
  const classes = `status ${status.look} ${status.severity ?? ""}`;
  return (
    <div class={classes} data-row={status.row}>
      <StatusIcon status={status} size={32} />
      <div>
        {/* The line counts seconds: only the sentence is said aloud when it changes. */}
        <div role="status"><h1>{status.title}</h1></div>
        <p title={status.line}>{status.line}</p>
      </div>
    </div>
  );
}

const live = (state: State): [number, number] => {
  const cameras = Object.values(state.health?.cameras ?? {});
  return [cameras.filter((camera) => camera.state === "live").length, cameras.length];
};

/** Return how far the newest people lie behind now, in words. */
export function behind(state: State): string {
  const snapshot = state.snapshot;
  if (!snapshot) return "";
  if (isRecording(state)) return "recording";
  const late = serverTime(state) - snapshot.t;
  return late < 0 ? "0.0 s behind" : `${duration(late)} behind`;
}

function Fact(
  { name, value, note, kind, to, old }:
  { name: string; value: string; note?: string; kind: string; to?: () => void; old?: boolean },
) {
  return (
    <button type="button" class={`fact ${kind} ${old ? "old" : ""}`} onClick={to}>
      <span class="name">{name}</span>
      <span class="value">{value}{note && <small>{note}</small>}</span>
    </button>
  );
}

export function Facts() {
  const { state } = useStore();
  const system = () => store.page("system");
  return (
    <div class="facts">
      {state.link === "lost" ? <LostFacts state={state} /> : (
        <>
          <Fact
            kind="people" name="People" to={() => document.getElementById("twin")?.focus()}
            value={state.snapshot ? String(counted(state.snapshot)) : "Unknown"}
            note={state.snapshot && isOld(state) ? "then" : ""}
            old={!state.snapshot || isOld(state)}
          />
          <CamerasFact state={state} to={system} />
          <RulesFact state={state} />
          <ModeFact />
        </>
      )}
      <Time state={state} />
      <Sound store={store} />
    </div>
  );
}

function CamerasFact({ state, to }: { state: State; to: () => void }) {
  const [good, all] = live(state);
  if (!state.health) return <Fact kind="cameras" name="Cameras" value="Unknown" old to={to} />;
  if (all === 0) return <Fact kind="cameras" name="Cameras" value="None yet" to={to} />;
  return <Fact kind="cameras" name="Cameras" value={`${good} of ${all}`} note="live" to={to} />;
}

function RulesFact({ state }: { state: State }) {
  const rules = state.health?.rules ?? null;
  const [armed, total] = rules
    ? [rules.armed, rules.total]
    : [state.site?.armed ?? 0, state.site?.rules ?? 0];
  const to = () => store.page("zones");
  if (!state.site) return <Fact kind="rules" name="Rules armed" value="Unknown" old to={to} />;
  return <Fact kind="rules" name="Rules armed" value={`${armed} of ${total}`} to={to} />;
}

function LostFacts({ state }: { state: State }) {
  const age = state.local - state.heardAt;
  const people = state.snapshot ? String(counted(state.snapshot)) : "Unknown";
  return (
    <>
      <Fact
        kind="last" name="Last picture"
        value={Number.isFinite(age) ? `${whole(age)} ago` : "Never"}
      />
      <Fact kind="people" name="People" value={people} note={state.snapshot ? "then" : ""} old />
      <Fact kind="cameras" name="Cameras" value="Unknown" old />
      <Fact kind="rules" name="Rules armed" value="Unknown" old />
    </>
  );
}

function Time({ state }: { state: State }) {
  const zone = state.site?.timezone ?? "UTC";
  const t = dataTime(state);
  return (
    <div class="fact time">
      <span class="name">
        <span class="date">{day(t, zone)}</span>
        {state.link !== "lost" && <span class="late">{behind(state)}</span>}
      </span>
      <span class="value">
        <time>{clock(t, zone)}</time>
        {state.link !== "lost" && <small>{behind(state)}</small>}
      </span>
    </div>
  );
}

function Sound({ store }: { store: Store }) {
  const { sound, mutedUntil } = store.own;
  const left = mutedUntil - store.state.local;
  const muted = sound && left > 0;
  const text = !sound ? "Sound off" : muted ? `Muted ${Math.ceil(left / 60)} min` : "Sound on";
  const toggle = () =>
    muted ? store.set({ mutedUntil: 0 }) : store.set({ sound: !sound, mutedUntil: 0 });
  return (
    <button type="button" class="fact sound" aria-pressed={sound} onClick={toggle}>
      <Icon name={sound && !muted ? "sound" : "mute"} />
      {text}
    </button>
  );
}

/** Return what does not work: cameras, the 3D people, the storage. */
export function faults({ health }: State): string[] {
  if (!health) return [];
  const cameras = Object.entries(health.cameras)
    .filter(([, camera]) => isFault(camera.state))
    .map(([name]) => name);
  return [
    ...cameras,
    ...(health.fusion.state === "stalled" ? ["3D people"] : []),
    ...(health.store.state === "failing" ? ["storage"] : []),
  ];
}

export const camerasLive = (state: State): string => {
  const [good, all] = live(state);
  return `${good} of ${count(all, "camera")} live`;
};
