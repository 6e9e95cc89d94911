// Tones of open alerts, if the person has asked for sound: never by themselves.

import { handling, title, type Alert } from "../state/alerts.ts";
import type { Severity } from "../state/messages.ts";
import { dataTime, open } from "../state/state.ts";
import { named, SEVERITY } from "../state/words.ts";
import { store } from "../store.ts";

/** How often a tone comes again [s]; null for once. */
const EVERY_S: Record<Severity, number | null> = {
  critical: 2, alarm: 5, warning: null, info: null,
};
const TONES_HZ: Record<Severity, number[]> = {
  critical: [988, 784, 988], alarm: [880, 659], warning: [587], info: [],
};

let context: AudioContext | null = null;
let last = -Infinity;
const sounded = new Set<string>();
const announced = new Set<string>();

function play(severity: Severity): void {
  context ??= new AudioContext();
  void context.resume();
  TONES_HZ[severity].forEach((hz, i) => {
    const at = (context as AudioContext).currentTime + 0.22 * i;
    const tone = new OscillatorNode(context as AudioContext, { frequency: hz, type: "triangle" });
    const volume = new GainNode(context as AudioContext, { gain: 0 });
    volume.gain.setValueAtTime(0, at);
    volume.gain.linearRampToValueAtTime(0.25, at + 0.02);
    volume.gain.linearRampToValueAtTime(0, at + 0.2);
    tone.connect(volume).connect((context as AudioContext).destination);
    tone.start(at);
    tone.stop(at + 0.22);
  });
}

/** Say a new alert once, for those who listen to the page. */
function announce(alert: Alert): void {
  const key = `${alert.id} ${alert.severity}`;
  if (announced.has(key)) return;
  announced.add(key);
  const place = alert.place ? ` ${named(alert.place)}.` : "";
  store.announcement = `${SEVERITY[alert.severity]}. ${title(alert, true)}.${place}`;
}

function check(): void {
  const now = dataTime(store.state);
  const fresh = open(store.state).filter((alert) => handling(alert, now) === "new" && !alert.predicted);
  for (const alert of [...fresh].reverse()) announce(alert);
  const first = fresh[0];
  if (!first || !store.own.sound || store.own.mutedUntil > store.state.local) return;
  const key = `${first.id} ${first.severity}`;
  const every = EVERY_S[first.severity];
  const due = every === null ? !sounded.has(key) : performance.now() / 1000 - last >= every;
  if (!due) return;
  sounded.add(key);
  last = performance.now() / 1000;
  play(first.severity);
}

export function sounds(): void {
  store.subscribe(check);
}
