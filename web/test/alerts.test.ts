import assert from "node:assert/strict";
import { test } from "node:test";
import {
  cameraAlerts, cards, figures, handled, handling, openAlerts, pastOutages, title, where, withEvent,
  type Alert, type Alerts,
} from "../src/state/alerts.ts";
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

test("a silent camera is an alert, once: not beside one that the server tells of", () => {
  const sick = health();
  sick.cameras.north = { state: "stale", fps: 0, age_s: 6, clock: "sender", dropped: 0 };
  const derived = cameraAlerts(sick, none, T);
  assert.deepEqual(derived.map((a) => [a.camera, a.start, a.stored]), [["north", T - 6, false]]);
  assert.equal(title(derived[0] as Alert), "Camera North sends no picture");
  const told = fold({
    id: "c", type: "trecsim.camera.silent.v1",
    data: { event: "c", phase: "new", seq: 0, camera: "north", severity: "warning", t_start_s: T - 6 },
  });
  assert.deepEqual(cameraAlerts(sick, told, T), []);
  assert.match(where(only(told), T), /^No picture for 6 s\./);
});

test("a camera that is back is told with how long it was silent, unless the server tells it", () => {
  const outages = new Map([["north", [{ from: T - 60, to: T - 50 }, { from: T - 5, to: Infinity }]]]);
  const past = pastOutages(outages, none);
  assert.deepEqual(past.map((a) => [a.start, a.end]), [[T - 60, T - 50]]);
  assert.equal(title(past[0] as Alert), "Camera North sent no picture");
  const told = fold({
    id: "c", type: "trecsim.camera.silent.v1",
    data: { event: "c", phase: "new", seq: 0, camera: "north", severity: "warning" },
  });
  assert.deepEqual(pastOutages(outages, told), []);
});
