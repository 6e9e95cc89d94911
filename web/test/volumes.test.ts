import assert from "node:assert/strict";
import { test } from "node:test";
import { History } from "../src/state/history.ts";
import { readSnapshot } from "../src/state/people.ts";
import { readSite } from "../src/state/site.ts";
import { boxesAt, boxesIn } from "../src/state/volumes.ts";
import { snapshot, T } from "./made.ts";

const chair = {
  size_m: [0.6, 2.4, 1.2], bottom_m: 0.3, path_m: [[-8, 2], [0, 2], [0, 6]], path_s: [0, 8, 10],
  start_s: 100, period_s: 7.5,
};
const site = readSite({ site: { volumes: {
  chair, truck: { size_m: [4, 2, 2], feed: "trucks", path_m: [], path_s: [0], start_s: 0 }, none: { size_m: [1, 1, 1] },
} } });

test("volumes are read with a timetable or a feed, and one that has neither is left out", () => {
  assert.deepEqual(
    site.volumes.map((one) => [one.name, one.fed, one.bottom, one.periodS]),
    [["chair", false, 0.3, 7.5], ["truck", true, 0, null]],
  );
});

test("the vehicles of a feed are where the snapshot says, now and in the history", () => {
  const truck = site.volumes.find((one) => one.fed);
  assert.ok(truck);
  const moment = readSnapshot({
    ...snapshot(T, []),
    volumes: [
      { volume: "truck", id: "7", xy_m: [3, 1], heading_deg: 90 },
      { volume: "other", id: "", xy_m: [0, 0], heading_deg: 0 },
    ],
  }, null);
  const history = new History();
  history.add(moment);
  for (const shown of [moment, history.at(T)]) {
    assert.ok(shown);
    const corners = boxesIn(truck, shown).map((box) => box.map((p) => p.map((x) => Math.round(x * 1000) / 1000)));
    assert.deepEqual(corners, [[[4, -1], [4, 3], [2, 3], [2, -1]]]); // 4 m long, along y
  }
  assert.deepEqual(boxesIn(truck, readSnapshot(snapshot(T, []), null)), []);
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
