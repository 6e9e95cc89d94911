import assert from "node:assert/strict";
import { test } from "node:test";
import { ground, halves, rim } from "../src/draw/halves.ts";
import { readSite, type Zone } from "../src/state/site.ts";

const site = (edge: number[][]) =>
  readSite({ site: { edges: { e: { points_m: edge } }, floor_m: [-10, -3, 10, 5] } });

test("an edge across the site cuts the floor; the drop lies to the left of the way", () => {
  const parts = halves(site([[9, 0], [-9, 0]]));
  assert.ok(parts.floor.every(([, y]) => y >= 0));
  assert.ok(parts.below?.every(([, y]) => y <= 0));
  assert.deepEqual(rim(parts)?.map(([x]) => x).sort((a, b) => a - b), [-10, 10]);
  const zone = { name: "z", polygon: [[0, -2], [1, -2], [1, -1]], z: [0, 2], restricted: false } as Zone;
  assert.ok(ground(parts, zone) < -1);
  assert.equal(ground(parts, { ...zone, polygon: [[0, 1], [1, 1], [1, 2]] }), 0);
});

test("a short edge, and one with a bend, cut nothing", () => {
  assert.equal(halves(site([[2, 0], [-2, 0]])).below, null);
  assert.equal(halves(site([[9, 0], [0, 1], [-9, 0]])).below, null);
  assert.equal(halves(site([])).below, null);
});
