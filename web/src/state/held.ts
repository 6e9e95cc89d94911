// Cards that hold still while the pointer is among them.

import type { Alert } from "./alerts.ts";

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
