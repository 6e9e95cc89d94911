import assert from "node:assert/strict";
import { test } from "node:test";
import { withEvent, type Alert, type Alerts } from "../src/state/alerts.ts";
import { cardKey, idsOf, inOrder, withForm } from "../src/state/held.ts";
import { event, T } from "./made.ts";

const alert = (id: string, start = T): Alert => {
  const alerts: Alerts = withEvent(
    new Map(), event({ event: id, phase: "new", t_start_s: start, t_detect_s: start }), T,
  );
  return alerts.get(id) as Alert;
};

test("a card stays under the pointer when another alert joins it", () => {
  const [a, b, c] = [alert("a", T - 9), alert("b", T - 5), alert("c", T - 1)];
  const held = idsOf([[b], [a]]);
  const { shown, waiting } = inOrder(held, [[c, a], [b]]);
  assert.deepEqual(idsOf(shown), [["b"], ["c", "a"]]);
  assert.equal(waiting, 0);
});

test("what is new waits, and a card that is gone leaves no hole", () => {
  const [a, b, c] = [alert("a"), alert("b"), alert("c")];
  const { shown, waiting } = inOrder(idsOf([[a], [b]]), [[c], [b]]);
  assert.deepEqual(idsOf(shown), [["b"]]);
  assert.equal(waiting, 1);
});

test("cards that split stay both, each once", () => {
  const [a, b] = [alert("a"), alert("b")];
  const { shown, waiting } = inOrder(idsOf([[b, a]]), [[b], [a]]);
  assert.deepEqual(idsOf(shown), [["b"], ["a"]]);
  assert.equal(waiting, 0);
  assert.equal(inOrder(idsOf([[a], [b]]), [[b, a]]).shown.length, 1);
});

test("a card keeps its name, and what is typed in it, when another alert joins", () => {
  const [a, b] = [alert("a", T - 9), alert("b", T - 1)];
  assert.equal(cardKey([a]), cardKey([b, a]));
  assert.notEqual(cardKey([b]), cardKey([a]));
});

test("a card on which somebody writes stays when its alert is over, and goes when it is closed", () => {
  const [a, b, c] = [alert("a"), alert("b"), alert("c")];
  const alerts = new Map([a, b, c].map((one) => [one.id, one]));
  assert.deepEqual(idsOf(withForm([[c]], ["b", "a"], alerts)), [["b", "a"], ["c"]]);
  assert.deepEqual(idsOf(withForm([[c], [b], [a]], ["a"], alerts)), [["c"], ["b"], ["a"]]);
  const closed = { reason: "true" as const, note: null, by: null, t: T };
  alerts.set("a", { ...a, closed });
  assert.deepEqual(idsOf(withForm([[c]], ["a"], alerts)), [["c"]]);
});

test("an alert that joins a card on which somebody writes gets a card of its own", () => {
  const [a, b] = [alert("a"), alert("b")];
  const alerts = new Map([a, b].map((one) => [one.id, one]));
  assert.deepEqual(idsOf(withForm([[b, a]], ["a"], alerts)), [["a"], ["b"]]);
});
