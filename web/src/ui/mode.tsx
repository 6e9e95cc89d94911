// The mode of the site: what it arms, and how to put another in its place for a while.

import { useEffect, useState } from "preact/hooks";
import { useAway } from "./dialog.tsx";
import { Icon } from "./icons.tsx";
import { useStore } from "./use.ts";
import { getModes, setMode } from "../net/api.ts";
import type { Modes } from "../state/messages.ts";
import { serverTime } from "../state/state.ts";
import { clock, count, list, named } from "../state/words.ts";
import { store } from "../store.ts";

const HOURS = [1, 4, 8];
const ALL = "";

export function ModeFact() {
  const { state } = useStore();
  const [modes, setModes] = useState<Modes | null>(null);
  const [open, setOpen] = useState(false);
  const box = useAway<HTMLDivElement>(open, () => setOpen(false));
  const site = state.site;
  const mode = state.health?.rules?.mode ?? (state.health ? null : site?.mode ?? null);
  const has = site !== null && !site.recording && Object.keys(site.modes).length > 0;
  useEffect(() => {
    if (has) getModes().then(setModes, () => undefined);
  }, [has, mode, open, site?.version, state.health?.rules?.armed]);
  if (!has && !mode) return null;
  const zone = site?.timezone ?? "UTC";
  const chosen = modes?.chosen && modes.chosen.until_s > serverTime(state) ? modes.chosen : null;
  const note = chosen ? `to ${clock(chosen.until_s, zone).slice(0, 5)}` : "";
  const shown = mode ? named(mode) : "All rules";
  if (!store.mayAct || !has) {
    return (
      <div class="fact mode"><span class="name">Mode</span>
        <span class="value">{shown}{note && <small>{note}</small>}</span>
      </div>
    );
  }
  return (
    <div class="holder" ref={box}>
      <button type="button" class="fact mode" aria-haspopup="true" aria-expanded={open}
        onClick={() => setOpen(!open)}>
        <span class="name">Mode</span>
        <span class="value">{shown}{note && <small>{note}</small>}</span>
      </button>
      {open && <Menu modes={modes} done={(next) => { setModes(next); setOpen(false); }} />}
    </div>
  );
}

function Menu({ modes, done }: { modes: Modes | null; done: (modes: Modes) => void }) {
  const { state } = useStore();
  const [asked, setAsked] = useState<{ mode?: string; rule?: string } | null>(null);
  const site = state.site;
  if (!site) return null;
  const zone = site.timezone;
  const put = async (what: Parameters<typeof setMode>[0], said: string) => {
    try {
      done(await setMode(what, state.me?.csrf ?? null));
      store.toast(said);
    } catch (error) {
      store.toast(`Could not do it: ${error instanceof Error ? error.message : String(error)}`);
    }
  };
  if (asked) {
    const name = asked.rule ? `Rule ${named(asked.rule)} off` : asked.mode ? named(asked.mode) : "All rules";
    return (
      <div class="menu mode" role="group" aria-label={`${name} until`}>
        <p class="over">{name} for</p>
        {HOURS.map((hours) => {
          const until = serverTime(state) + hours * 3600;
          const at = clock(until, zone).slice(0, 5);
          return (
            <button key={hours} type="button" onClick={() => void put(
              asked.rule ? { bypass: { rule: asked.rule, until_s: until } } : { mode: asked.mode ?? ALL, until_s: until },
              `${name} to ${at}.`,
            )}>{count(hours, "hour")}<span class="end">to {at}</span></button>
          );
        })}
        <button type="button" onClick={() => setAsked(null)}>Cancel</button>
      </div>
    );
  }
  const off = Object.entries(modes?.bypassed ?? {});
  return (
    <div class="menu mode">
      <p class="over">Mode, for a while</p>
      {Object.entries(site.modes).map(([name, one]) => (
        <button key={name} type="button" onClick={() => setAsked({ mode: name })}>
          {modes?.mode === name ? <Icon name="check" size={16} /> : <span class="gap" />}
          <span>{named(name)}<small>{one.off.length ? `off: ${list(one.off.map(named))}` : "all rules on"}</small></span>
        </button>
      ))}
      <button type="button" onClick={() => setAsked({ mode: ALL })}>
        {modes?.mode === null ? <Icon name="check" size={16} /> : <span class="gap" />}<span>All rules</span>
      </button>
      {modes?.chosen && (
        <button type="button" onClick={() => void put({ mode: null }, "By schedule again.")}>
          <span class="gap" /><span>Back to the schedule<small>{modes.scheduled ? named(modes.scheduled) : "all rules on"}</small></span>
        </button>
      )}
      <p class="over">Rules</p>
      {off.map(([rule, one]) => (
        <button key={rule} type="button" onClick={() => void put({ bypass: { rule } }, `Rule ${named(rule)} is armed again.`)}>
          <span class="gap" /><span>Arm {named(rule)} again<small>off to {clock(one.until_s, zone).slice(0, 5)}{one.by !== "local" && `, ${one.by}`}</small></span>
        </button>
      ))}
      <select class="field" aria-label="Switch off a rule" value=""
        onChange={(event) => event.currentTarget.value && setAsked({ rule: event.currentTarget.value })}>
        <option value="">Switch off a rule…</option>
        {site.ruleIds.filter((rule) => !(modes?.bypassed ?? {})[rule])
          .map((rule) => <option key={rule} value={rule}>{named(rule)}</option>)}
      </select>
      <p>Each ends by itself, after {Math.round((modes?.longest_s ?? 28800) / 3600)} h at most.</p>
    </div>
  );
}
