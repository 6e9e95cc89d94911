// The trial of a draft on a recording: how many alerts, beside the live rules, each to be played.

import { useEffect, useState } from "preact/hooks";
import { useDesk } from "./desk.ts";
import { Glyph, Icon } from "./icons.tsx";
import { kindName } from "./ruleform.tsx";
import { useStore } from "./use.ts";
import { useAway } from "./dialog.tsx";
import { getRecordings, type Recording } from "../net/api.ts";
import type { Episode, Trial } from "../net/drafts.ts";
import { home } from "../state/address.ts";
import { clock, count, day, duration, hourMinute, named, UNIX_FROM_S } from "../state/words.ts";
import { store } from "../store.ts";

/** So much of the end of a recording is tried unless all of it is asked for [s]. */
const PART_S = 3600;
const SHOWN = 200;

const recordingName = (one: Recording, zone: string): string =>
  one.from_s >= UNIX_FROM_S ? `${day(one.from_s, zone)}, ${hourMinute(one.from_s, zone)}` : one.id;

export function TryButton() {
  const desk = useDesk();
  const [open, setOpen] = useState(false);
  const [films, setFilms] = useState<Recording[] | null>(null);
  const box = useAway<HTMLDivElement>(open, () => setOpen(false));
  const zone = store.state.site?.timezone ?? "UTC";
  useEffect(() => {
    if (open) getRecordings().then((found) => setFilms([...found].reverse()), () => setFilms([]));
  }, [open]);
  const start = (film: Recording, seconds: number) => {
    setOpen(false);
    void desk.try(film.id, Math.max(film.from_s, film.to_s - seconds), film.to_s);
  };
  const wrong = desk.keeping === "wrong" || desk.keeping === "conflict";
  return (
    <div class="try" ref={box}>
      <button type="button" class="button" aria-expanded={open} aria-haspopup="true"
        disabled={desk.trying || wrong} title={wrong ? "Put right what is wrong first" : ""}
        onClick={() => setOpen(!open)}>
        {desk.trying ? <span class="spin"><Icon name="connecting" size={16} /></span> : <Icon name="play" size={15} />}
        {desk.trying ? "Trying…" : "Try on a recording"}
      </button>
      {open && (
        <div class="menu">
          {films === null && <p>Looking for recordings…</p>}
          {films?.length === 0 && <p>Nothing is recorded yet.</p>}
          {films?.slice(0, 12).map((film) => {
            const length = film.to_s - film.from_s;
            return (
              <div key={film.id} class="film">
                <button type="button" onClick={() => start(film, PART_S)}>
                  {recordingName(film, zone)}
                  <span class="end">{length > PART_S ? "last hour" : duration(length)}</span>
                </button>
                {length > PART_S && (
                  <button type="button" onClick={() => start(film, Infinity)}>
                    {recordingName(film, zone)}<span class="end">all {duration(length)}</span>
                  </button>
                )}
              </div>
            );
          })}
        </div>
      )}
    </div>
  );
}

/** Return how many alerts that somebody closed as true would no longer fire. */
export function lost(trial: Trial): number {
  const real = new Set(
    [...store.state.alerts.values()].filter((one) => one.closed?.reason === "true").map((one) => one.id),
  );
  return trial.episodes.filter((one) => one.in === "live" && real.has(one.event)).length;
}

const total = (trial: Trial, side: "draft" | "live"): number =>
  Object.values(trial.rules).reduce((sum, one) => sum + one[side], 0);

export function Counts({ trial }: { trial: Trial }) {
  const figures: [number, string][] = [
    [total(trial, "draft"), "alerts as drafted"], [total(trial, "live"), "with live rules"],
    [lost(trial), "true ones lost"],
  ];
  return (
    <dl class="counts">
      {figures.map(([value, words]) => <div key={words}><dt>{words}</dt><dd>{value}</dd></div>)}
    </dl>
  );
}

type Shown = "draft" | "new" | "gone";

export function TrialBox() {
  const { trial } = useDesk();
  const { state } = useStore();
  const [shown, setShown] = useState<Shown | null>(null);
  if (!trial) return null;
  const zone = state.site?.timezone ?? "UTC";
  const lists: Record<Shown, Episode[]> = {
    draft: trial.episodes.filter((one) => one.in !== "live"),
    new: trial.episodes.filter((one) => one.in === "draft"),
    gone: trial.episodes.filter((one) => one.in === "live"),
  };
  const from = trial.from_s ?? 0;
  const when = from >= UNIX_FROM_S ? `${day(from, zone)}, ${hourMinute(from, zone)}` : trial.recording;
  const tabs: [Shown, string][] = [
    ["draft", `All ${lists.draft.length}`], ["new", `New ${lists.new.length}`],
    ["gone", `Gone ${lists.gone.length}`],
  ];
  const list = shown ? lists[shown] : [];
  return (
    <section class="trial" aria-label="Trial">
      <p class="when">Tried on {when}
        <span class="end">{duration((trial.to_s ?? 0) - from)}, {count(trial.people, "person", "people")}</span>
      </p>
      <Counts trial={trial} />
      {Object.keys(trial.rules).length > 0 && (
        <table>
          <thead><tr><th scope="col">Rule</th><th scope="col">Draft</th><th scope="col">Live</th></tr></thead>
          <tbody>
            {Object.entries(trial.rules).map(([rule, one]) => (
              <tr key={rule}><th scope="row">{named(rule)}</th><td>{one.draft}</td><td>{one.live}</td></tr>
            ))}
          </tbody>
        </table>
      )}
      {trial.episodes.length > 0 && (
        <div class="segments" role="group" aria-label="Alerts that are listed">
          {tabs.map(([key, words]) => (
            <button key={key} type="button" aria-pressed={shown === key}
              onClick={() => setShown(shown === key ? null : key)}>{words}</button>
          ))}
        </div>
      )}
      {shown && (
        <ul class="episodes">
          {list.slice(0, SHOWN).map((one) => (
            <li key={one.event}>
              <button type="button" class="item" onClick={() => store.go({
                ...home, page: "review", subject: trial.recording, t: Math.max(from, one.t_start_s - 5),
              })}>
                <Glyph severity={one.severity} open={one.in !== "live"} />
                <b>{named(one.rule)}</b>
                <span class="end">{clock(one.t_start_s, zone)}</span>
                <span class="second">
                  {[kindName(one.kind), one.people.length === 1 && `person ${one.people[0]}`]
                    .filter(Boolean).join(", ")}
                </span>
              </button>
            </li>
          ))}
          {list.length > SHOWN && <li class="empty">{list.length - SHOWN} more.</li>}
        </ul>
      )}
    </section>
  );
}
