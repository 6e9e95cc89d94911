// The last ten minutes, in packed form: for replay, for paths and for the timeline.

import { JOINTS, type Person, type Snapshot, type Vehicle } from "./people.ts";
import type { PersonState } from "./messages.ts";
import type { Point } from "./site.ts";

export const KEPT_S = 600;
const MOST_BYTES = 150e6;
const STATES: PersonState[] = ["provisional", "confirmed", "coasting"];
const PROVISIONAL = STATES.indexOf("provisional");
const HELD_S = 2;
const MISSING = -32768;

/** One moment: joints in mm relative to the person's floor point, sigma in cm. */
interface Packed {
  t: number;
  sent: number;
  ids: Int32Array;
  states: Uint8Array;
  unseen: Float32Array;
  floor: Float32Array;
  joints: Int16Array;
  sigma: Uint8Array;
  support: Uint8Array;
  vehicles: Vehicle[];
}

function pack(snapshot: Snapshot): Packed {
  const n = snapshot.people.length;
  const packed: Packed = {
    t: snapshot.t, sent: snapshot.sent,
    ids: new Int32Array(n), states: new Uint8Array(n), unseen: new Float32Array(n),
    floor: new Float32Array(2 * n), joints: new Int16Array(3 * JOINTS * n),
    sigma: new Uint8Array(JOINTS * n), support: new Uint8Array(JOINTS * n),
    vehicles: snapshot.vehicles,
  };
  snapshot.people.forEach((person, i) => {
    const [x, y] = person.floor;
    packed.ids[i] = person.id;
    packed.states[i] = STATES.indexOf(person.state);
    packed.unseen[i] = person.unseen;
    packed.floor.set([x, y], 2 * i);
    for (let k = 0; k < 3 * JOINTS; k++) {
      const from = k % 3 === 0 ? x : k % 3 === 1 ? y : 0;
      const mm = Math.round(((person.xyz[k] ?? NaN) - from) * 1000);
      packed.joints[3 * JOINTS * i + k] = Number.isFinite(mm)
        ? Math.max(-32767, Math.min(32767, mm))
        : MISSING;
    }
    for (let j = 0; j < JOINTS; j++) {
      const cm = Math.round((person.sigma[j] ?? NaN) * 100);
      packed.sigma[JOINTS * i + j] = Number.isFinite(cm) ? Math.min(254, cm) : 255;
    }
    packed.support.set(person.support, JOINTS * i);
  });
  return packed;
}

function unpack(packed: Packed): Snapshot {
  const people: Person[] = [...packed.ids].map((id, i) => {
    const [x, y] = [packed.floor[2 * i] ?? NaN, packed.floor[2 * i + 1] ?? NaN];
    const xyz = new Float32Array(3 * JOINTS);
    for (let k = 0; k < 3 * JOINTS; k++) {
      const mm = packed.joints[3 * JOINTS * i + k] ?? MISSING;
      const from = k % 3 === 0 ? x : k % 3 === 1 ? y : 0;
      xyz[k] = mm === MISSING ? NaN : mm / 1000 + from;
    }
    const sigma = Float32Array.from(
      packed.sigma.subarray(JOINTS * i, JOINTS * (i + 1)),
      (cm) => (cm === 255 ? NaN : cm / 100),
    );
    const support = packed.support.slice(JOINTS * i, JOINTS * (i + 1));
    return {
      id, xyz, sigma, support,
      state: STATES[packed.states[i] ?? 1] ?? "confirmed",
      unseen: packed.unseen[i] ?? NaN,
      posture: null, velocity: null, forecast: [],
      floor: [x, y],
    };
  });
  return { t: packed.t, sent: packed.sent, people, vehicles: packed.vehicles };
}

const bytes = (packed: Packed): number =>
  packed.ids.length * (4 + 1 + 4 + 8 + 6 * JOINTS + 2 * JOINTS) + 120 + 100 * packed.vehicles.length;

/** Ten minutes of snapshots. The one large thing that changes in place. */
export class History {
  #frames: Packed[] = [];
  #head = 0;
  #bytes = 0;
  #firstSeen = new Map<number, number>();
  readonly keep: number;

  constructor(keep: number = KEPT_S) {
    this.keep = keep;
  }

  /** Add a snapshot; one that is not newer than the last starts the history anew. */
  add(snapshot: Snapshot): void {
    if (snapshot.t <= this.to - 60) this.clear();
    if (snapshot.t <= this.to) return;
    const packed = pack(snapshot);
    this.#frames.push(packed);
    this.#bytes += bytes(packed);
    for (const id of packed.ids) if (!this.#firstSeen.has(id)) this.#firstSeen.set(id, snapshot.t);
    this.#forget(snapshot.t - this.keep);
    if (this.#bytes > MOST_BYTES) this.#thin();
  }

  clear(): void {
    this.#frames = [];
    this.#head = 0;
    this.#bytes = 0;
    this.#firstSeen.clear();
  }

  #forget(before: number): void {
    while ((this.#frames[this.#head]?.t ?? Infinity) < before) {
      this.#bytes -= bytes(this.#frames[this.#head] as Packed);
      this.#head++;
    }
    if (this.#head > 2000 && this.#head > this.#frames.length / 2) {
      this.#frames = this.#frames.slice(this.#head);
      this.#head = 0;
    }
  }

  /** Leave out every other moment of the older half. */
  #thin(): void {
    const kept = this.#frames.slice(this.#head);
    const half = Math.floor(kept.length / 2);
    this.#frames = kept.filter((_, i) => i >= half || i % 2 === 0);
    this.#head = 0;
    this.#bytes = this.#frames.reduce((sum, frame) => sum + bytes(frame), 0);
  }

  get length(): number {
    return this.#frames.length - this.#head;
  }

  get bytes(): number {
    return this.#bytes;
  }

  /** Time of the oldest moment; -Infinity where there is none. */
  get from(): number {
    return this.#frames[this.#head]?.t ?? -Infinity;
  }

  get to(): number {
    return this.#frames[this.#frames.length - 1]?.t ?? -Infinity;
  }

  /** Index of the last moment at or before t; one less than the first where there is none. */
  #at(t: number): number {
    let [low, high] = [this.#head, this.#frames.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((this.#frames[middle] as Packed).t <= t) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  /** Return the snapshot shown at a time: the last one at or before it. */
  at(t: number): Snapshot | null {
    const index = Math.max(this.#head, this.#at(t));
    const packed = this.#frames[index];
    return packed ? unpack(packed) : null;
  }

  /** Return the time of the moment so many steps from the one at t. */
  step(t: number, steps: number): number {
    const index = Math.max(this.#head, Math.min(this.#frames.length - 1, this.#at(t) + steps));
    return this.#frames[index]?.t ?? t;
  }

  /** Return since when a person is here, as far as this page knows. */
  since(id: number): number {
    return this.#firstSeen.get(id) ?? NaN;
  }

  /** Return the floor points of everybody present at t over the last seconds, oldest first. */
  paths(t: number, seconds: number, every = 0.1): Map<number, Point[]> {
    const end = this.#at(t);
    const now = this.#frames[end];
    const found = new Map<number, Point[]>();
    if (!now || end < this.#head) return found;
    for (const id of now.ids) found.set(id, []);
    let last = -Infinity;
    for (let i = Math.max(this.#head, this.#at(t - seconds)); i <= end; i++) {
      const frame = this.#frames[i] as Packed;
      if (frame.t - last < every && i !== end) continue;
      last = frame.t;
      frame.ids.forEach((id, k) => {
        const point: Point = [frame.floor[2 * k] ?? NaN, frame.floor[2 * k + 1] ?? NaN];
        if (Number.isFinite(point[0])) found.get(id)?.push(point);
      });
    }
    return found;
  }

  /** Return the speed of a person at t from the floor points of the last half second [m/s]. */
  velocity(id: number, t: number): Point | null {
    const [a, b] = [this.#at(t - 0.5), this.#at(t)];
    const [old, now] = [this.#frames[Math.max(a, this.#head)], this.#frames[b]];
    if (!old || !now || now.t - old.t < 0.2) return null;
    const [i, j] = [old.ids.indexOf(id), now.ids.indexOf(id)];
    if (i < 0 || j < 0) return null;
    const of = (axis: number) =>
      ((now.floor[2 * j + axis] ?? NaN) - (old.floor[2 * i + axis] ?? NaN)) / (now.t - old.t);
    return [of(0), of(1)];
  }

  /** Return the number of people in so many equal parts of a span; NaN where nothing is known. */
  counts(from: number, to: number, parts: number): Float32Array {
    const counts = new Float32Array(parts).fill(NaN);
    const width = (to - from) / parts;
    for (let i = Math.max(this.#head, this.#at(from)); i < this.#frames.length; i++) {
      const frame = this.#frames[i] as Packed;
      const part = Math.floor((frame.t - from) / width);
      if (part < 0 || part >= parts) continue;
      const before = counts[part] ?? NaN;
      const there = frame.states.reduce((n, state) => n + Number(state !== PROVISIONAL), 0);
      counts[part] = Number.isFinite(before) ? Math.max(before, there) : there;
    }
    // A moment counts until the next one, if that comes soon.
    const reach = Math.ceil(HELD_S / width);
    let last = -Infinity;
    for (let part = 0; part < parts; part++) {
      if (Number.isFinite(counts[part])) last = part;
      else if (part - last < reach) counts[part] = counts[last] ?? NaN;
    }
    return counts;
  }

  /** Return the mean number of people in each cell of the floor over the last seconds before t. */
  heat(t: number, seconds: number, cell: number, every = 0.5): Map<string, number> {
    const found = new Map<string, number>();
    let [last, moments] = [-Infinity, 0];
    for (let i = Math.max(this.#head, this.#at(t - seconds)); i <= this.#at(t); i++) {
      const frame = this.#frames[i] as Packed;
      if (frame.t - last < every) continue;
      last = frame.t;
      moments++;
      frame.states.forEach((state, k) => {
        const [x, y] = [frame.floor[2 * k] ?? NaN, frame.floor[2 * k + 1] ?? NaN];
        if (state === PROVISIONAL || !Number.isFinite(x)) return;
        const key = `${Math.floor(x / cell)} ${Math.floor(y / cell)}`;
        found.set(key, (found.get(key) ?? 0) + 1);
      });
    }
    for (const [key, count] of found) found.set(key, count / moments);
    return found;
  }
}
