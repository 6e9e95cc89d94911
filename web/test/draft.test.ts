import assert from "node:assert/strict";
import { test } from "node:test";
import {
  changes, crosses, drafted, kindOf, least, most, nothing, renamed, same, snap, withCorners, withHeights,
  withKey, without, type Parts,
} from "../src/state/draft.ts";
import { readSite, type Point } from "../src/state/site.ts";
import { readWeek, writeWeek } from "../src/state/schedule.ts";

const parts: Parts = {
  ...nothing,
  zones: { strip: { polygon_m: [[0, 0], [2, 0], [2, 1]] } },
  lines: { gate: { points_m: [[0, 0], [1, 0]] } },
  rules: [
    { id: "a", kind: "zone.enter", zone: "strip" }, { id: "b", kind: "line.cross", line: "gate" },
  ],
};

test("a place that is renamed takes its rules along, and keeps a name that is taken", () => {
  const next = renamed(parts, "zones", "strip", "exit");
  assert.deepEqual(Object.keys(next.zones), ["exit"]);
  assert.equal(next.rules[0]?.zone, "exit");
  assert.equal(renamed(parts, "zones", "strip", "two words"), parts);
});

test("a place that is removed takes its rules away", () => {
  const next = without(parts, "zones", "strip");
  assert.equal(kindOf(next, "strip"), null);
  assert.deepEqual(next.rules.map((rule) => rule.id), ["b"]);
});

test("a bed has corners and a height as a zone has, a portal two ends as a line, and both are told", () => {
  const corners: Point[] = [[0, 0], [2, 0], [2, 1], [0, 1]];
  const bed = withHeights(withCorners(parts, "exclusions", "bed", corners), "exclusions", "bed", [0, 0.8]);
  assert.deepEqual(bed.exclusions.bed, { polygon_m: corners, z_m: [0, 0.8] });
  const both = withCorners(bed, "portals", "north", [[0, 4], [2, 4]]);
  assert.deepEqual(both.portals.north, { points_m: [[0, 4], [2, 4]] });
  assert.deepEqual([least("exclusions"), least("portals"), most("portals")], [3, 2, 2]);
  assert.equal(kindOf(both, "north"), "portals");
  assert.deepEqual(changes(parts, both), ["Bed added", "North added"]);
  const site = drafted(readSite({}), both);
  assert.deepEqual(site.exclusions.map((one) => [one.name, one.z]), [["bed", [0, 0.8]]]);
  assert.deepEqual(site.portals.map((one) => one.name), ["north"]);
});

test("changes are told by name, and no change is none", () => {
  const moved = withCorners(parts, "zones", "strip", [[0, 0], [3, 0], [2, 1]]);
  assert.deepEqual(changes(parts, withKey(moved, 0, "severity", "alarm")), ["Strip changed", "rule a changed"]);
  assert.deepEqual(changes(parts, withKey(withKey(parts, 0, "x", 1), 0, "x", undefined)), []);
  assert.ok(same(parts, { ...parts, rules: parts.rules.map((rule) => ({ ...rule })) }));
});

test("sides that cross, touch or have no length are told", () => {
  assert.equal(crosses([[0, 0], [2, 0], [2, 2], [0, 2]]), false);
  assert.equal(crosses([[0, 0], [2, 2], [2, 0], [0, 2]]), true);
  assert.equal(crosses([[0, 0], [2, 0], [2, 2], [1, 0]]), true);
  assert.equal(crosses([[0, 0], [0, 0], [2, 2]]), true);
});

test("corners lie on a grid of 0.1 m, freely, or in line with the one before", () => {
  assert.deepEqual(snap([1.234, 5.678], false, null), [1.2, 5.7]);
  assert.deepEqual(snap([1.2344, 5.678], true, null), [1.234, 5.678]);
  assert.deepEqual(snap([3.2, 0.4], false, [1, 0]), [3.2, 0]);
  assert.deepEqual(snap([1.2, 3.4], false, [1, 0]), [1, 3.4]);
});

test("hours of a week are read and written as the site file has them", () => {
  for (const ranges of [
    ["Mo-Su 22:00-06:00"], ["Mo-Fr 08:00-12:00"], ["Sa-Su 00:00-24:00"], ["Mo,We 09:00-17:00"],
    ["Fr 22:00-06:00"],
  ]) {
    const week = readWeek(ranges);
    assert.ok(week);
    assert.deepEqual(writeWeek(week), ranges);
  }
  assert.equal(readWeek(["Mo 08:30-09:00"]), null);
  assert.equal(readWeek(["Mon 08:00-09:00"]), null);
  const all = readWeek(["00:00-24:00"]);
  assert.ok(all);
  assert.equal(writeWeek(all), undefined);
  const mixed = readWeek(["Mo-Fr 22:00-06:00", "Sa,Su 22:00-08:00"]);
  assert.ok(mixed);
  assert.deepEqual(readWeek(writeWeek(mixed) ?? []), mixed);
});
