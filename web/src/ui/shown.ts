// What scene, plan and tiles draw now, derived once per snapshot.

import { handling, isActive, isFault, type Alert } from "../state/alerts.ts";
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
  const reviewing = store.address.page === "review";
  for (const alert of reviewing ? reviewed() : open(state)) {
    if (!reviewing && (!isActive(alert) || handling(alert, now) === "shelved")) continue;
    const severity = alert.predicted ? "warning" : alert.severity;
    for (const person of alert.people) if (!alarmed.has(person)) alarmed.set(person, severity);
    if (alert.place && !active.has(alert.place)) active.set(alert.place, severity);
  }
  const faulty = new Set(
    reviewing ? [] : Object.entries(state.health?.cameras ?? {})
      .filter(([, camera]) => isFault(camera.state))
      .map(([name]) => name),
  );
  return { alarmed, active, faulty };
}

/** Return the alert that Review shows, while it holds. */
function reviewed(): Alert[] {
  const alert = store.state.alerts.get(store.address.subject ?? "");
  const t = store.address.t ?? NaN;
  return alert && t >= alert.start && t <= (alert.end ?? Infinity) ? [alert] : [];
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
    names,
    chosen: address.page === "zones" ? address.subject : null,
  };
}
