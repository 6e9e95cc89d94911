import assert from "node:assert/strict";
import { test } from "node:test";
import { openAlerts, withEvent, type Alert, type Alerts } from "../src/state/alerts.ts";
import type { CloudEvent } from "../src/state/messages.ts";
import { status, type Situation } from "../src/state/status.ts";
import { event, health, T } from "./made.ts";

const fold = (...events: CloudEvent[]): Alert[] => {
  const alerts = events.reduce((all: Alerts, one) => withEvent(all, one, T), new Map());
  return openAlerts(alerts, T);
};

const well: Situation = {
  link: "open", lastTime: T, waitFor: NaN, connectingFor: 10, now: T, health: health(), age: 0.2,
  hasPeople: true, open: [],
  armed: 9, rules: 9, next: null, timezone: "UTC",
};

const ALARM = event({ event: "e", phase: "new", edge: "track-2", people: [{ person: 14 }] });

test("all clear needs a connection, live cameras, running stages and armed rules", () => {
  const said = status(well);
  assert.equal(said.row, 7);
  assert.equal(said.title, "All clear");
});

test("before the first message the page is connecting, never all clear", () => {
  for (const link of ["connecting", "open"] as const) {
    const said = status({ ...well, link, health: null });
    assert.equal(said.row, 0);
    assert.equal(said.title, "Connecting…");
  }
});

test("not all clear while rules fail, or a camera that sends pictures has a fault", () => {
  const rules = { armed: 9, total: 9, fault: "strip: it cannot judge" };
  const failing = status({ ...well, health: health({ rules }) });
  assert.equal(failing.row, 5);
  assert.equal(failing.title, "Rules fail");
  assert.equal(failing.line, "Alerts for people may be missing: strip: it cannot judge.");
  const frozen = health();
  const [name, camera] = Object.entries(frozen.cameras)[0]!;
  frozen.cameras[name] = { ...camera, fault: "it has shown the same image for 10 s" };
  const said = status({ ...well, health: frozen });
  assert.equal(said.row, 5);
  assert.match(said.title, /^Camera .* is in doubt$/);
  assert.equal(said.line, "It has shown the same image for 10 s.");
});

test("row 1: without messages nothing is known, whatever was known before", () => {
  const said = status({ ...well, link: "lost", waitFor: 3.2, open: fold(ALARM) });
  assert.equal(said.row, 1);
  assert.equal(said.title, "No connection");
  assert.match(said.line, /^State of the site unknown since \d\d:\d\d:\d\d\. Trying again in 4 s\.$/);
});

test("row 2: a stopped fusion comes before alarms", () => {
  const stalled = health({ fusion: { state: "stalled", age_s: 6.2 } });
  const said = status({ ...well, health: stalled, open: fold(ALARM) });
  assert.equal(said.row, 2);
  assert.equal(said.title, "Watching has stopped");
  assert.equal(said.line, "3D people: no result for 6 s.");
});

test("row 3: one alarm tells what, where and since when", () => {
  const said = status({ ...well, open: fold(ALARM) });
  assert.equal(said.row, 3);
  assert.equal(said.look, "filled");
  assert.equal(said.title, "Person beyond platform edge");
  assert.equal(said.line, "Track 2. For 7 s, still there.");
});

test("row 3: of several alarms the critical one comes first", () => {
  const critical = event({ event: "f", phase: "new", severity: "critical", rule: { id: "f", kind: "body.fall" } });
  const said = status({ ...well, open: fold(ALARM, critical) });
  assert.equal(said.severity, "critical");
  assert.equal(said.title, "2 alarms");
  assert.equal(said.line, "First: person fell.");
});

test("row 3: an alarm that ended without acknowledgement still stands", () => {
  const said = status({ ...well, open: fold(ALARM, event({ event: "e", phase: "end", t_end_s: T })) });
  assert.equal(said.row, 3);
  assert.match(said.line, /Over after 7\.0 s/);
});

test("row 4: an acknowledged alarm that goes on is outlined", () => {
  const said = status({ ...well, open: fold(ALARM, event({ event: "e", phase: "ack", by: "k" })) });
  assert.equal(said.row, 4);
  assert.equal(said.look, "outlined");
  assert.equal(said.title, "1 alarm, acknowledged");
});

test("row 5: a stale camera is named", () => {
  const sick = health();
  sick.cameras.north = { state: "stale", fps: 0, age_s: 6, clock: "sender", dropped: 0 };
  const said = status({ ...well, health: sick });
  assert.equal(said.row, 5);
  assert.equal(said.title, "Camera North is stale");
});

test("row 5: who acknowledged a silent camera is named; one that is back speaks until acknowledged", () => {
  const silent = (phase: "new" | "ack", more = {}) => ({
    ...event({ event: "c", phase, severity: "warning", camera: "north",
      rule: { id: "camera-health", kind: "camera.health" }, ...more }),
  });
  const sick = health();
  sick.cameras.north = { state: "down", fps: 0, age_s: 60, clock: "sender", dropped: 0 };
  const known = fold(silent("new"), silent("ack", { by: "k.meier" }));
  assert.match(status({ ...well, health: sick, open: known }).line, /Acknowledged by k\.meier\.$/);
  const back = (alerts: Alert[]) => alerts.map((alert) => ({ ...alert, back: true }));
  const said = status({ ...well, open: back(fold(silent("new"))) });
  assert.equal(said.row, 5);
  assert.equal(said.title, "Camera North sends pictures again");
  assert.equal(status({ ...well, open: back(known) }).row, 7);
});

test("row 5: several silent cameras are counted and named", () => {
  const sick = health();
  for (const name of ["north", "south"]) {
    sick.cameras[name] = { state: "down", fps: 0, age_s: null, clock: "arrival", dropped: 0 };
  }
  const said = status({ ...well, health: sick });
  assert.equal(said.title, "2 cameras send no picture");
  assert.match(said.line, /^North and South\./);
});

test("row 5: storage that fails is told while people are tracked", () => {
  const full = health({ store: { state: "failing", fault: "the disk is full" } });
  const said = status({ ...well, health: full });
  assert.equal(said.title, "Nothing is recorded");
  assert.match(said.line, /the disk is full/);
});

test("row 6: without armed rules nothing is clear", () => {
  assert.equal(status({ ...well, armed: 0 }).row, 6);
  assert.match(status({ ...well, armed: 0, rules: 0 }).line, /There are no rules yet/);
});

test("a warning that is shelved no longer speaks in the sentence", () => {
  const warning = event({ event: "w", phase: "new", severity: "warning", zone: "strip" });
  assert.equal(status({ ...well, open: fold(warning) }).row, 5);
  const shelved = event({ event: "w", phase: "shelve", severity: "warning", until_s: T + 900 });
  const said = status({ ...well, open: fold(warning, shelved) });
  assert.equal(said.row, 7);
  assert.match(said.line, /1 alert is shelved/);
});

test("row 2: old people are no people, whatever the health says", () => {
  const said = status({ ...well, age: 4.2 });
  assert.equal(said.row, 2);
  assert.equal(said.line, "3D people: no result for 4 s.");
  assert.equal(status({ ...well, age: NaN, hasPeople: false }).row, 0);
});

test("row 2: a recording that has ended is no longer watched", () => {
  const ended = health({ fusion: { state: "ended", age_s: 60 } });
  assert.equal(status({ ...well, health: ended }).title, "The recording has ended");
});
