import assert from "node:assert/strict";
import { test } from "node:test";
import {
  actor, cards, figures, handled, handling, holds, measured, openAlerts, outages, title, where, withEvent,
  type Alert, type Alerts,
} from "../src/state/alerts.ts";
import { isBack } from "../src/state/faults.ts";
import type { CloudEvent } from "../src/state/messages.ts";
import { event, health, T } from "./made.ts";

const none: Alerts = new Map();
const fold = (...events: CloudEvent[]): Alerts =>
  events.reduce((all, one) => withEvent(all, one, T), none);
const only = (alerts: Alerts): Alert => [...alerts.values()][0] as Alert;

const NEW = event({ event: "e", phase: "new", people: [{ person: 14 }], probability: 0.98,
  measures: { past_the_edge_m: 1.23 }, evidence: { cameras: ["a", "b"] } });

test("an event that comes twice changes nothing", () => {
  assert.deepEqual(fold(NEW, NEW), fold(NEW));
});

test("handling follows the phases", () => {
  const how = (...more: CloudEvent[]) => handling(only(fold(NEW, ...more)), T);
  const phase = (name: CloudEvent["data"]["phase"], more = {}) => event({ event: "e", phase: name, ...more });
  assert.equal(how(), "new");
  assert.equal(how(phase("end", { t_end_s: T })), "ended");
  assert.equal(how(phase("ack")), "acknowledged");
  assert.equal(how(phase("ack"), phase("end", { t_end_s: T })), "closed");
  assert.equal(how(phase("shelve", { until_s: T + 60 })), "shelved");
  assert.equal(how(phase("shelve", { until_s: T - 1 })), "new");
  assert.equal(how(phase("shelve", { until_s: T + 60 }), phase("unshelve")), "new");
  assert.equal(how(phase("close", { reason: "test" })), "closed");
  assert.equal(how(phase("close", { reason: "test" }), phase("reopen")), "new");
});

test("rising severity takes acknowledgement and shelving away", () => {
  const raised = fold(NEW, event({ event: "e", phase: "ack" }),
    event({ event: "e", phase: "update", severity: "critical" }));
  assert.equal(handling(only(raised), T), "new");
  assert.equal(handled(only(raised), T, String), "raised from Alarm");
});

test("an early warning becomes the alarm in place", () => {
  const early = event({ event: "e", phase: "new", predicted: true, t_start_s: T + 1.6, people: [{ person: 14 }], edge: "edge" });
  assert.equal(title(only(fold(early)), true), "Person 14 heads for edge");
  assert.equal(handled(only(fold(early)), T, String), "early, in 1.6 s");
  const both = fold(early, event({ event: "e", phase: "update", predicted: false, t_start_s: T }));
  assert.equal(both.size, 1);
  assert.equal(title(only(both), true), "Person 14 beyond platform edge");
  assert.equal(only(both).raisedFrom, null);
});

test("figures tell cameras, certainty and one measure with its unit", () => {
  assert.deepEqual(figures(only(fold(NEW)), 3), [
    { value: "2 of 3", words: "cameras see it" },
    { value: "98 %", words: "certain" },
    { value: "1.2 m", words: "past the edge" },
  ]);
});

test("cards come in order: not acknowledged, then severity, then newest", () => {
  const make = (id: string, severity: "warning" | "alarm", start: number) =>
    event({ event: id, phase: "new", severity, t_start_s: T - start });
  const alerts = fold(
    make("old", "warning", 90), make("acked", "alarm", 5), event({ event: "acked", phase: "ack" }),
    make("new", "warning", 10), make("alarm", "alarm", 60),
  );
  assert.deepEqual(openAlerts(alerts, T).map((a) => a.id), ["alarm", "new", "old", "acked"]);
});

test("ten alerts of a rule in ten minutes become one card, nine do not", () => {
  const many = (n: number) => openAlerts(fold(
    ...Array.from({ length: n }, (_, i) => event({ event: `e${i}`, phase: "new", zone: "strip" })),
  ), T);
  assert.equal(cards(many(9), T).length, 9);
  assert.deepEqual(cards(many(10), T).map((group) => group.length), [10]);
});

const silent = (phase: CloudEvent["data"]["phase"], more = {}): CloudEvent => ({
  id: `c-${phase}`, type: "trecsim.camera.health.v1",
  data: {
    event: "c", phase, seq: 0, camera: "north", severity: "warning", state: "stale",
    fault: "camera north is stale: connection refused", t_start_s: T - 6, t_end_s: null,
    rule: { id: "camera-health", kind: "camera.health" }, measures: { age_s: 6 }, ...more,
  },
});

test("a camera that falls silent is told with its reason, and how long it was silent when over", () => {
  const alert = only(fold(silent("new")));
  assert.equal(title(alert), "Camera North sends no picture");
  assert.equal(where(alert, T),
    "No picture for 6 s: connection refused. Its part of the site is less well covered.");
  const over = only(fold(silent("new"), silent("end", { t_end_s: T - 1 })));
  assert.equal(title(over), "Camera North sent no picture");
  assert.equal(where(over, T), "Picture back after 5.0 s.");
  assert.deepEqual(figures(over, 2), []);
  assert.deepEqual(outages(fold(silent("new"), silent("end", { t_end_s: T - 1 }))),
    [{ camera: "north", from: T - 6, to: T - 1 }]);
});

test("faults of 3D people and storage have their own words", () => {
  const fault = (kind: string, said: string) => only(fold({
    id: kind, type: `trecsim.${kind}.v1`,
    data: { event: kind, phase: "new", seq: 0, severity: "alarm", t_start_s: T - 4, fault: said,
      rule: { id: kind, kind } },
  }));
  const fusion = fault("fusion.health", "the fusion has stopped");
  assert.equal(title(fusion), "Watching has stopped");
  assert.equal(where(fusion, T), "No 3D people for 4 s. No alert for people can fire.");
  const store = fault("store.health", "nothing is recorded: no space left");
  assert.equal(title(store), "Nothing is recorded");
  assert.equal(where(store, T), "People are tracked. Storage fails for 4 s: no space left.");
});

test("a fault of the site is about nobody of those who were there", () => {
  assert.deepEqual(only(fold(silent("new", { people: [{ person: 14 }] }))).people, []);
});

test("a part that works again is not said to fail, although its alert goes on", () => {
  const well = health();
  const alert = only(fold(silent("new")));
  assert.equal(isBack(alert, well), true);
  assert.equal(title({ ...alert, back: true }), "Camera North sends pictures again");
  well.cameras.north = { state: "down", fps: 0, age_s: 12, clock: "sender", dropped: 0 };
  assert.equal(isBack(alert, well), false);
  assert.equal(isBack(only(fold(silent("new"), silent("end", { t_end_s: T }))), health()), false);
});

test("who did something is named, but not whoever sits at a machine without users", () => {
  assert.deepEqual(["k.meier", "token", "local", null].map(actor), ["k.meier", "a program", "", ""]);
});

test("an alert holds between its beginning and its end, one of a moment for two seconds", () => {
  const lasting = only(fold(NEW, event({ event: "e", phase: "end", t_end_s: T })));
  assert.deepEqual([T - 8, T - 7, T, T + 1].map((t) => holds(lasting, t)), [false, true, true, false]);
  const moment = only(fold(event({ event: "e", phase: "new", t_start_s: T, t_end_s: T })));
  assert.deepEqual([T, T + 2, T + 3].map((t) => holds(moment, t)), [true, true, false]);
});

test("an early warning keeps its lead, and is detected when what was expected begins", () => {
  const warned = event({ event: "e", phase: "new", predicted: true, t_start_s: T + 1.8, t_detect_s: T, lead_s: 1.8 });
  const begun = event({
    event: "e", phase: "update", predicted: false, t_start_s: T + 1.7, t_detect_s: T + 1.9, lead_s: 1.7,
  });
  const early = only(fold(warned));
  assert.deepEqual([early.predicted, early.lead, early.warned, early.detected], [true, 1.8, T, T]);
  const real = only(fold(warned, begun));
  assert.deepEqual(
    [real.predicted, real.lead, real.warned, real.start, real.detected], [false, 1.7, T, T + 1.7, T + 1.9],
  );
});

test("what an early warning expects is told in percent, within how long", () => {
  assert.deepEqual(measured("probability_2s", 0.934), { value: "93 %", words: "within 2 s" });
  assert.deepEqual(measured("probability_0.5s", 0.003), { value: "below 1 %", words: "within 0.5 s" });
  assert.deepEqual(measured("duration_s", 1.25), { value: "1.3 s", words: "duration" });
});

test("what happens in a moment does not last, and is not over after no time", () => {
  const moment = only(fold(event({ event: "e", phase: "new", line: "left", t_start_s: T, t_end_s: T })));
  assert.equal(where(moment, T + 9), "Left.");
  const lasting = only(fold(NEW, event({ event: "e", phase: "end", t_end_s: T })));
  assert.match(where(lasting, T + 9), /Over after 7\.0 s/);
});
