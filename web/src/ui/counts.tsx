// How many people are in each zone, how densely, and how many crossed each line.

import { useStore } from "./use.ts";
import type { Counts } from "../state/messages.ts";
import { hourMinute, named } from "../state/words.ts";
import { store } from "../store.ts";

/** From level E on a zone is crowded, from F on people cannot walk freely. */
const LOOK: Partial<Record<string, string>> = { E: "warning", F: "alarm" };

export function CountsBox() {
  const { state, replaying, address } = useStore();
  const counts = state.health?.counts;
  const selected = address.person !== null;
  if (!counts || replaying || selected) return null;
  const zones = Object.entries(counts.zones);
  const lines = Object.entries(counts.lines);
  if (zones.length + lines.length === 0) return null;
  const old = state.link === "lost";
  return (
    <section class={`countsbox ${old ? "old" : ""}`} aria-label="Counts">
      <div class="head">
        <h2>Counts</h2>
        <span class="note">{old ? "then" : since(counts, lines.length > 0)}</span>
        <div class="end">
          <button type="button" class="button quiet" aria-pressed={store.own.layers.density}
            onClick={() => store.set({
              layers: { ...store.own.layers, density: !store.own.layers.density },
            })}>Density</button>
        </div>
      </div>
      <ul>
        {zones.map(([name, zone]) => (
          <li key={`zone ${name}`}>
            <b>{named(name)}</b>
            {zone.density_pm2 !== null && zone.level !== null && (
              <span class={`level ${LOOK[zone.level] ?? ""}`}
                title="Level of service of walkways, A to F">
                {zone.density_pm2.toFixed(2)} /m², {zone.level}
              </span>
            )}
            <span class="n">{zone.inside}</span>
          </li>
        ))}
        {lines.map(([name, line]) => (
          <li key={`line ${name}`}>
            <b>{named(name)}</b>
            <span class="ways">in {line.in}, out {line.out}</span>
          </li>
        ))}
      </ul>
    </section>
  );
}

function since(counts: Counts, hasLines: boolean): string {
  if (!hasLines || counts.since_s === null) return "now";
  return `now; lines since ${hourMinute(counts.since_s, store.state.site?.timezone ?? "UTC")}`;
}
