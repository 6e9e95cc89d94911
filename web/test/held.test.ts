import assert from "node:assert/strict";
import { test } from "node:test";
import { withEvent, type Alert, type Alerts } from "../src/state/alerts.ts";
import { cardKey, idsOf, inOrder } from "../src/state/held.ts";
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
