import assert from "node:assert/strict";
import { test } from "node:test";
import { backOff, read } from "../src/net/connection.ts";
import { ageOf, dataTime, open, initial, reduce, statusOf, type Action, type State } from "../src/state/state.ts";
import { parse, write } from "../src/state/address.ts";
import { readSite } from "../src/state/site.ts";
import { event, health, person, snapshot, T } from "./made.ts";

const after = (...actions: Action[]): State => actions.reduce(reduce, initial(T));

const message = (m: Extract<Action, { type: "message" }>["message"], local: number): Action =>
  ({ type: "message", message: m, local });

const HEALTH = { type: "health" as const, sent_s: T, ...health() };

test("three seconds of silence are a lost connection, and the next message ends it", () => {
  const heard = after(message(HEALTH, T));
  assert.equal(reduce(heard, { type: "tick", local: T + 2.9 }).link, "open");
  const lost = reduce(heard, { type: "tick", local: T + 3.1 });
  assert.equal(lost.link, "lost");
  const back = reduce(lost, message(HEALTH, T + 38));
  assert.equal(back.link, "open");
  assert.equal(back.back?.missed, 38);
});

test("alerts that come after a lost connection are counted", () => {
  const back = after(
    message(HEALTH, T), { type: "tick", local: T + 5 }, message(HEALTH, T + 10),
    message({ type: "event", sent_s: T + 10, event: event({ event: "e", phase: "new" }) }, T + 10),
  );
  assert.equal(back.back?.alerts, 1);
  assert.equal(open(back).length, 1);
});

test("a closed connection that never spoke is still connecting, then lost", () => {
  const first = after({ type: "closed", local: T, retryAt: T + 1 });
  assert.equal(first.link, "connecting");
  assert.equal(reduce(first, { type: "closed", local: T, retryAt: T + 2 }).link, "lost");
});

test("the tries come after 1, 2, 4, 8 and then every 15 seconds", () => {
  assert.deepEqual([0, 1, 2, 3, 4, 5, 60].map(backOff), [1, 2, 4, 8, 15, 15, 15]);
});

test("the server's clock is the one of the least delayed message", () => {
  const state = after(
    message({ ...HEALTH, sent_s: T + 100 }, T + 0.05), message({ ...HEALTH, sent_s: T + 101 }, T + 3),
  );
  assert.ok(Math.abs(state.ahead - 99.95) < 0.01);
});

test("malformed messages are no messages", () => {
  for (const text of ["", "{", "[]", "null", "7", '{"type":"snapshot"}',
    '{"type":"snapshot","sent_s":1,"people":3}', '{"type":"health","sent_s":1}',
    '{"type":"event","sent_s":1,"event":{}}']) assert.equal(read(text), null);
  assert.equal(read(JSON.stringify(snapshot(T, [])))?.type, "snapshot");
});

test("a message of an unknown kind shows that the server lives, and changes nothing else", () => {
  const strange = { type: "weather", sent_s: T } as never;
  const state = after(message(HEALTH, T), message(strange, T + 1));
  assert.equal(state.heardAt, T + 1);
  assert.equal(statusOf(state).row, 0);
});

test("people keep their mark until they leave", () => {
  const state = after(message(snapshot(T, [person(1), person(2)]), T));
  const both = [state.marks.slots.get(1), state.marks.slots.get(2)];
  assert.deepEqual(both, [10, 2]);
  const later = reduce(state, message(snapshot(T + 1, [person(2), person(3)]), T + 1));
  assert.equal(later.marks.slots.get(2), 2);
  assert.equal(later.marks.slots.get(3), 10);
});

test("a forecast is carried between the snapshots that bring one, and gets shorter", () => {
  const forecast = [{ t_s: T + 1, xy_m: [1, 1] as [number, number], cov_m2: [1, 0, 1] as [number, number, number] }];
  const state = after(
    message(snapshot(T, [person(1, { forecast })]), T), message(snapshot(T + 0.04, [person(1)]), T),
  );
  assert.ok(Math.abs((state.snapshot?.people[0]?.forecast[0]?.ahead ?? 0) - 0.96) < 1e-6);
});

test("the address holds page, view, person, subject and time, and nothing is lost on the way", () => {
  for (const address of [
    { page: "live", view: "overview", person: null, subject: null, t: null },
    { page: "live", view: "camera:north east", person: 14, subject: null, t: 1796045512.6 },
    { page: "review", view: "overview", person: null, subject: "a/b c", t: 3.25 },
  ] as const) {
    const [path = "", search = ""] = write(address).split("?");
    assert.deepEqual(parse(path, search), address);
  }
  assert.equal(parse("/nonsense/%E0", "?p=x&t=").page, "live");
});

test("a site that is malformed is drawn as far as it goes", () => {
  const site = readSite({ version: "a", site: {
    name: "s", timezone: "Mars/Olympus", cameras: { broken: { K: 3 }, none: null },
    zones: { line: { polygon_m: [[0, 0], [1, 1]] }, good: { polygon_m: [[0, 0], [1, 0], [1, 1]] } },
    edges: { e: { points_m: [[0, 0], ["x", 0], [4, 0]] } }, floor_m: [1, 1, 0, 0],
  } });
  assert.equal(site.timezone, "UTC");
  assert.deepEqual(site.cameras, []);
  assert.deepEqual(site.zones.map((zone) => zone.name), ["good"]);
  assert.deepEqual(site.edges[0]?.points, [[0, 0], [4, 0]]);
  assert.ok(site.floor.high[0] > site.floor.low[0]);
  assert.equal(readSite(null).name, "site");
});

test("a recording of a live site is played on its own clock, up to its end", () => {
  const site = readSite({ version: "", site: { name: "s", kind: "recording" } });
  const playing = after(
    { type: "site", site },
    message({ ...HEALTH, sent_s: T + 86400 }, T),
    message({ ...snapshot(T, [person(1)]), sent_s: T + 86400 }, T),
    { type: "tick", local: T + 1 },
  );
  assert.ok(Number.isNaN(ageOf(playing)));
  assert.ok(Math.abs(dataTime(playing) - (T + 1)) < 0.01);
  assert.equal(statusOf(playing).title, "Nothing is armed");
  const ended = reduce(playing, message(
    { ...HEALTH, sent_s: T + 86500, fusion: { state: "ended" } }, T + 100,
  ));
  assert.equal(dataTime(ended), T);
  assert.equal(statusOf(ended).title, "The recording has ended");
});

test("people of a live site who are a day old are not watched", () => {
  const late = after(
    message(HEALTH, T), message({ ...snapshot(T - 86400, [person(1)]), sent_s: T }, T),
  );
  assert.equal(statusOf(late).title, "Watching has stopped");
});
