// Loading parts of recordings for Review.

import { getRecordings, getSnapshots, type Recording } from "../net/api.ts";
import { History } from "../state/history.ts";
import { readSnapshot } from "../state/people.ts";
import type { SnapshotMessage } from "../state/messages.ts";
import { store } from "../store.ts";

const BEFORE_S = 40;
const AFTER_S = 80;
/** So near to the end of what is loaded the next part is fetched [s]. */
const SOON_S = 10;

export interface Film {
  recording: Recording;
  from: number;
  to: number;
}

let busy = false;

/** Return the recordings, the newest first. */
export const recordings = async (): Promise<Recording[]> =>
  (await getRecordings()).sort((a, b) => b.from_s - a.from_s);

/** Load what lies around a moment of a recording, unless it is there. */
export async function around(
  film: Film | null, recording: Recording, t: number,
): Promise<Film | null> {
  const same = film?.recording.id === recording.id;
  const covered = same && t >= film.from
    && (t <= film.to - SOON_S || film.to >= recording.to_s) && t <= film.to;
  if (covered || busy) return film;
  busy = true;
  try {
    const from = Math.max(recording.from_s, t - BEFORE_S);
    const to = Math.min(recording.to_s, t + AFTER_S);
    const history = new History(Infinity);
    let before = null;
    for (const line of await getSnapshots(recording.id, from, to)) {
      const message = JSON.parse(line) as SnapshotMessage;
      if (!Array.isArray(message.people)) continue;
      before = readSnapshot({ ...message, sent_s: message.sent_s ?? message.t_s }, before);
      history.add(before);
    }
    store.load(history);
    return { recording, from, to };
  } finally {
    busy = false;
  }
}
