import assert from "node:assert/strict";
import { test } from "node:test";
import { readSite } from "../src/state/site.ts";
import { boxesAt } from "../src/state/volumes.ts";

const chair = {
  size_m: [0.6, 2.4, 1.2], bottom_m: 0.3, path_m: [[-8, 2], [0, 2], [0, 6]], path_s: [0, 8, 10],
  start_s: 100, period_s: 7.5,
};
const site = readSite({ site: { volumes: { chair, fed: { size_m: [4, 2, 2], feed: "trucks", path_m: [], path_s: [0] } } } });

test("a volume with a timetable is read, and one whose positions a feed tells is left out", () => {
  assert.deepEqual(site.volumes.map((one) => [one.name, one.bottom, one.periodS]), [["chair", 0.3, 7.5]]);
});

test("boxes are where the timetable says, turned as they go, and as many as are under way", () => {
  const [volume] = site.volumes;
  assert.ok(volume);
  const middles = (now: number) => boxesAt(volume, now).map((box) =>
    [0, 1].map((k) => Math.round(box.reduce((sum, p) => sum + (p[k] as number) / 4, 0) * 1000) / 1000));
  assert.deepEqual(middles(99), []);
  assert.deepEqual(middles(104), [[-4, 2]]);
  assert.deepEqual(middles(108.5), [[-7, 2], [0, 3]]);
  const [, turned] = boxesAt(volume, 108.5);
  const along = Math.max(...(turned ?? []).map((p) => p[1])) - 3;
  assert.ok(Math.abs(along - 0.3) < 1e-9); // 0.6 m long, now along y
});
