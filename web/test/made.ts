// Values that tests start from.

import type { CloudEvent, EventData, Health, PersonMessage, SnapshotMessage } from "../src/state/messages.ts";

export const T = 1_796_045_512;

export const person = (id: number, more: Partial<PersonMessage> = {}): PersonMessage => ({
  person: id,
  state: "confirmed",
  seen_s: 0,
  posture: "unknown",
  xyz_m: Array.from({ length: 17 }, (_, j): [number, number, number] => [id, j / 10, 1 + j / 100]),
  sigma_m: Array(17).fill(0.02) as number[],
  support: Array(17).fill(3) as number[],
  ...more,
});

export const snapshot = (t: number, people: PersonMessage[]): SnapshotMessage => ({
  type: "snapshot", sent_s: t + 0.2, t_s: t, people,
});

export const health = (more: Partial<Health> = {}): Health => ({
  status: "ok",
  t_s: T,
  cameras: {
    north: { state: "live", fps: 25, age_s: 0.1, clock: "sender", dropped: 0 },
    south: { state: "live", fps: 25, age_s: 0.1, clock: "sender", dropped: 0 },
  },
  fusion: { state: "running", age_s: 0.1 },
  store: { state: "writing" },
  ...more,
});

let seq = 0;

export const event = (data: Partial<EventData> & Pick<EventData, "event" | "phase">): CloudEvent => ({
  id: `${data.event}-${data.phase}-${seq++}`,
  type: "trecsim.edge.platform.v1",
  data: {
    seq: 0, severity: "alarm", rule: { id: "edge", kind: "edge.platform" },
    ...(data.phase === "new" ? { t_start_s: T - 7, t_detect_s: T - 6.8 } : {}),
    ...data,
  },
});
