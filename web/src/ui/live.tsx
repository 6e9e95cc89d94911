import { Alerts } from "./alerts.tsx";
import { CountsBox } from "./counts.tsx";
import { PlanBox } from "./planview.tsx";
import { Selection } from "./selection.tsx";
import { Stage } from "./stage.tsx";
import { Tiles } from "./tiles.tsx";
import { Timeline } from "./timeline.tsx";
import { use, useStore } from "./use.ts";
import { zoneAt } from "../state/people.ts";
import { named } from "../state/words.ts";
import { store } from "../store.ts";

export function Live() {
  const picked = use((s) => s.address.person !== null);
  return (
    <div class={`live-page ${picked ? "picked" : ""}`}>
      <main class="left" aria-label="Live">
        <Stage />
        <Tiles />
        <Timeline />
        <Twin />
      </main>
      <div class="right">
        <Alerts />
        <Selection />
        <CountsBox />
        <PlanBox />
      </div>
    </div>
  );
}

/** The people of the scene as a table, for those who do not see it. */
export function Twin() {
  const { shown, state } = useStore();
  const people = shown?.people ?? [];
  return (
    <section class="table-twin" aria-label="People as a table">
      <table id="twin" tabIndex={0}>
        <caption>People as a table</caption>
        <thead>
          <tr><th>Person</th><th>State</th><th>Zone</th><th>x</th><th>y</th><th>Speed</th></tr>
        </thead>
        <tbody>
          {people.map((person) => {
            const v = person.velocity ?? store.film.velocity(person.id, shown?.t ?? NaN);
            const zone = state.site ? zoneAt(state.site.zones, person.floor) : null;
            return (
              <tr key={person.id}>
                <th scope="row">
                  <button type="button" class="button quiet"
                    onClick={() => store.go({ person: person.id }, true)}>{person.id}</button>
                </th>
                <td>{person.state}</td>
                <td>{zone ? named(zone) : "none"}</td>
                <td>{person.floor[0].toFixed(1)} m</td>
                <td>{person.floor[1].toFixed(1)} m</td>
                <td>{v ? `${Math.hypot(v[0], v[1]).toFixed(1)} m/s` : "Unknown"}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </section>
  );
}
