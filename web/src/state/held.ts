// Cards that hold still while the pointer is among them.

import type { Alert, Alerts } from "./alerts.ts";

/** Return the alerts of each card: what is held. */
export const idsOf = (groups: readonly Alert[][]): string[][] =>
  groups.map((group) => group.map((alert) => alert.id));

/** Return the cards in the order that is held; those with none of the alerts held wait. */
export function inOrder(
  held: readonly (readonly string[])[], groups: readonly Alert[][],
): { shown: Alert[][]; waiting: number } {
  const shown = new Set<Alert[]>();
  for (const ids of held) {
    for (const group of groups) {
      if (group.some((alert) => ids.includes(alert.id))) shown.add(group);
    }
  }
  return { shown: [...shown], waiting: groups.length - shown.size };
}

/** Return what a card is called: by its first alert, for others join it. */
export const cardKey = (group: readonly Alert[]): string =>
  group.reduce((first, alert) => (alert.start < first.start ? alert : first), group[0] as Alert).id;

/** Return the cards with the alerts that a form is open for on one of their own, until they are closed. */
export function withForm(
  groups: readonly Alert[][], ids: readonly string[], alerts: Alerts,
): Alert[][] {
  const kept = ids.flatMap((id) => alerts.get(id) ?? []).filter((alert) => !alert.closed);
  if (kept.length === 0) return [...groups];
  const at = groups.findIndex((group) => group.some((alert) => ids.includes(alert.id)));
  const others = groups.map((group) => group.filter((alert) => !ids.includes(alert.id)));
  others.splice(Math.max(0, at), 0, kept);
  return others.filter((group) => group.length > 0);
}
