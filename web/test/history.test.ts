import assert from "node:assert/strict";
import { test } from "node:test";
import { History } from "../src/state/history.ts";
import { counted, readSnapshot } from "../src/state/people.ts";
import { person, snapshot, T } from "./made.ts";

const at = (t: number, ...ids: number[]) =>
  readSnapshot(snapshot(t, ids.map((id) => person(id))), null);

test("a moment comes back with joints to the millimetre, missing ones missing", () => {
  const history = new History();
  const one = person(7);
  one.xyz_m[3] = [null, null, null];
  one.sigma_m[3] = null;
  const before = readSnapshot(snapshot(T, [one]), null);
  history.add(before);
  const after = history.at(T)?.people[0];
  before.people[0]?.xyz.forEach((x, k) => {
    const y = after?.xyz[k] ?? 0;
    assert.ok(Number.isNaN(x) ? Number.isNaN(y) : Math.abs(x - y) < 6e-4, `${k}: ${x} and ${y}`);
  });
  assert.ok(Number.isNaN(after?.sigma[3]));
  assert.equal(after?.state, "confirmed");
});

test("only the last ten minutes are kept", () => {
  const history = new History();
  for (let s = 0; s <= 700; s++) history.add(at(T + s, 1));
  assert.equal(history.from, T + 100);
  assert.equal(history.to, T + 700);
});

test("the moment shown at a time is the last one before it", () => {
  const history = new History();
  for (const s of [0, 1, 2]) history.add(at(T + s, s + 1));
  assert.equal(history.at(T + 1.9)?.people[0]?.id, 2);
  assert.equal(history.at(T - 5)?.people[0]?.id, 1);
  assert.equal(history.step(T + 1.9, -1), T);
  assert.equal(history.step(T + 1.9, 1), T + 2);
});

test("paths end now, begin ten seconds ago, and belong to those who are here", () => {
  const history = new History();
  for (let s = 0; s < 20; s++) history.add(at(T + s, ...(s < 15 ? [1, 2] : [2])));
  const paths = history.paths(T + 19, 10);
  assert.deepEqual([...paths.keys()], [2]);
  assert.equal(paths.get(2)?.length, 11);
});

test("a clock that was set back starts the history anew", () => {
  const history = new History();
  history.add(at(T, 1));
  history.add(at(T - 3600, 1));
  assert.equal(history.length, 1);
  assert.equal(history.to, T - 3600);
});

test("counts are unknown where nothing was heard", () => {
  const history = new History();
  history.add(at(T + 5, 1, 2));
  assert.deepEqual([...history.counts(T, T + 10, 2)], [NaN, 2]);
});

test("who is only provisional does not count", () => {
  const history = new History();
  const both = readSnapshot(snapshot(T, [person(1), person(2, { state: "provisional" })]), null);
  history.add(both);
  assert.deepEqual([...history.counts(T, T + 1, 1)], [1]);
  assert.equal(counted(both), 1);
});
