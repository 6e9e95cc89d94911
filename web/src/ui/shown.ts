// What scene, plan and tiles draw now, derived once per snapshot.

import { handling, holds, isActive, isFault, outages, urgent, type Alert } from "../state/alerts.ts";
import type { Severity } from "../state/messages.ts";
import { dataTime, open } from "../state/state.ts";
import type { PlanInput } from "../draw/plan.ts";
import { store } from "../store.ts";

const PATH_S = 10;

interface Concerned {
  alarmed: Map<number, Severity>;
  active: Map<string, Severity>;
  faulty: Set<string>;
}

/** Return the alerts that hold at the moment that is shown, the most urgent first. */
export function shownAlerts(): Alert[] {
  const { state, address, replaying } = store;
  if (address.page === "review") {
    const alert = state.alerts.get(address.subject ?? "");
    return alert && holds(alert, address.t ?? NaN) ? [alert] : [];
  }
  if (!replaying) {
    const now = dataTime(state);
    return open(state).filter((one) => isActive(one) && handling(one, now) !== "shelved");
  }
  const t = address.t ?? NaN;
  return [...state.alerts.values()].filter((one) => holds(one, t)).sort(urgent);
}

/** Return who, where and which camera the alerts that are shown are about. */
export function concerned(): Concerned {
  const { state, address, replaying } = store;
  const alarmed = new Map<number, Severity>();
  const active = new Map<string, Severity>();
  for (const alert of shownAlerts()) {
    const severity = alert.predicted ? "warning" : alert.severity;
    for (const person of alert.people) if (!alarmed.has(person)) alarmed.set(person, severity);
    if (alert.place && !active.has(alert.place)) active.set(alert.place, severity);
  }
  const t = address.t ?? NaN;
  const faulty = new Set(
    replaying || address.page === "review"
      ? outages(state.alerts).filter((one) => t >= one.from && t < one.to)
        .map((one) => one.camera)
      : Object.entries(state.health?.cameras ?? {})
        .filter(([, camera]) => isFault(camera.state))
        .map(([name]) => name),
  );
  return { alarmed, active, faulty };
}

/** The map of density is that of so long [s], in cells of this side [m]. */
const [HEAT_S, CELL_M] = [60, 0.5];
let heated: { t: number; heat: ReadonlyMap<string, number> } = { t: NaN, heat: new Map() };

/** Return the mean number of people per cell, computed once a second. */
function heat(t: number): ReadonlyMap<string, number> {
  if (!(Math.abs(t - heated.t) < 1)) heated = { t, heat: store.film.heat(t, HEAT_S, CELL_M) };
  return heated.heat;
}

/** Return what the plan draws; null before the site is known. */
export function planInput(names: boolean): PlanInput | null {
  const { state, shown, own, address } = store;
  if (!state.site) return null;
  return {
    site: state.site,
    snapshot: shown,
    slots: store.slots,
    paths: shown ? store.film.paths(shown.t, PATH_S) : new Map(),
    selected: address.person,
    ...concerned(),
    layers: own.layers,
    heat: own.layers.density && shown ? { cell: CELL_M, people: heat(shown.t) } : null,
    names,
    chosen: address.page === "zones" ? address.subject : null,
  };
}
