// Marks of people: 12 slots, 4 shapes by 3 fills. A person keeps the slot until it leaves.

/** The order in which slots are given: neighbours differ most. */
export const ORDER = [10, 2, 3, 12, 8, 1, 9, 5, 6, 11, 7, 4] as const;

export const SHAPES = ["disc", "square", "pill", "plus"] as const;
export const FILLS = ["solid", "ring", "half"] as const;

export interface Mark {
  slot: number;
  shape: (typeof SHAPES)[number];
  fill: (typeof FILLS)[number];
}

/** Slots of the people present, and when each slot was given last. */
export interface Marks {
  slots: ReadonlyMap<number, number>;
  given: ReadonlyMap<number, number>;
  count: number;
}

export const noMarks: Marks = { slots: new Map(), given: new Map(), count: 0 };

/** Return the marks after a snapshot with these people. */
export function assign(marks: Marks, present: readonly number[]): Marks {
  const here = new Set(present);
  const fresh = present.filter((id) => !marks.slots.has(id));
  const gone = [...marks.slots.keys()].some((id) => !here.has(id));
  if (fresh.length === 0 && !gone) return marks;
  const slots = new Map([...marks.slots].filter(([id]) => here.has(id)));
  const given = new Map(marks.given);
  let count = marks.count;
  for (const id of fresh) {
    const taken = new Set(slots.values());
    const free = ORDER.filter((slot) => !taken.has(slot));
    const slot = free[0] ?? leastRecent(given);
    slots.set(id, slot);
    given.set(slot, ++count);
  }
  return { slots, given, count };
}

const leastRecent = (given: ReadonlyMap<number, number>): number =>
  [...ORDER].sort((a, b) => (given.get(a) ?? 0) - (given.get(b) ?? 0))[0] as number;

/** Return the shape and fill of a slot from 1 to 12. */
export const mark = (slot: number): Mark => ({
  slot,
  shape: SHAPES[(slot - 1) % 4] as Mark["shape"],
  fill: FILLS[Math.floor((slot - 1) / 4) % 3] as Mark["fill"],
});

/** Return the slot of a person; of one who has none now, the same each time. */
export const slotOf = (slots: ReadonlyMap<number, number>, id: number): number =>
  slots.get(id) ?? (Math.abs(id - 1) % 12) + 1;
