// What scene, plan and tiles draw now, derived once per snapshot.

import { handling, isActive, isFault } from "../state/alerts.ts";
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

/** Return who, where and which camera open alerts are about. */
export function concerned(): Concerned {
  const { state } = store;
  const now = dataTime(state);
  const alarmed = new Map<number, Severity>();
  const active = new Map<string, Severity>();
  for (const alert of open(state)) {
    if (!isActive(alert) || handling(alert, now) === "shelved") continue;
    const severity = alert.predicted ? "warning" : alert.severity;
    for (const person of alert.people) if (!alarmed.has(person)) alarmed.set(person, severity);
    if (alert.place && !active.has(alert.place)) active.set(alert.place, severity);
  }
  const faulty = new Set(
    Object.entries(state.health?.cameras ?? {})
      .filter(([, camera]) => isFault(camera.state))
      .map(([name]) => name),
  );
  return { alarmed, active, faulty };
}

/** Return what the plan draws; null before the site is known. */
export function planInput(names: boolean): PlanInput | null {
  const { state, shown, own, address } = store;
  if (!state.site) return null;
  return {
    site: state.site,
    snapshot: shown,
    slots: state.marks.slots,
    paths: shown ? store.history.paths(shown.t, PATH_S) : new Map(),
    selected: address.person,
    ...concerned(),
    layers: own.layers,
    names,
  };
}
