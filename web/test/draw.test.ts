import assert from "node:assert/strict";
import { test } from "node:test";
import { ellipse } from "../src/draw/body.ts";
import { invert, lens, toCamera, toPixel, type Lens } from "../src/draw/lens.ts";
import { mark, ORDER } from "../src/state/marks.ts";
import { floorPoint, inside, toPath } from "../src/state/people.ts";
import { clock, duration, named, percent, plusMinus } from "../src/state/words.ts";

const camera = (more = {}): Lens => lens({
  size_px: [1920, 1080], K: [[1100, 0, 960], [0, 1100, 540], [0, 0, 1]],
  T_cam_world: [[1, 0, 0, 0], [0, 0, -1, 1.5], [0, 1, 0, 3], [0, 0, 0, 1]], ...more,
}) as Lens;

const near = (a: readonly number[], b: readonly number[], tolerance = 1e-9) => {
  a.forEach((x, i) => assert.ok(Math.abs(x - (b[i] ?? NaN)) < tolerance, `${a} and ${b}`));
};

test("a point ahead of the camera lies where the pinhole puts it", () => {
  const { T } = camera();
  const p = toCamera(T, 0.5, 1, 1.5);
  near(p, [0.5, 0, 4]);
  near(toPixel(camera(), p), [960 + 1100 * 0.125, 540]);
  near(invert(T, p), [0.5, 1, 1.5]);
});

test("distortion is that of the rig file: brown and fisheye, as OpenCV gives them", () => {
  const brown = camera({ distortion_model: "brown", distortion: [-0.3, 0.1, 0.001, -0.002, 0.01] });
  // cv2.projectPoints of (0.5, -0.25, 1)
  near(toPixel(brown, [0.5, -0.25, 1]), [1461.9139, 289.043], 1e-3);
  const fisheye = camera({ distortion_model: "fisheye", distortion: [0.05, -0.01, 0.002, 0.0] });
  // cv2.fisheye.projectPoints of (0.5, -0.25, 1)
  near(toPixel(fisheye, [0.5, -0.25, 1]), [1467.7121, 286.1439], 1e-3);
});

test("an ellipse has the axes and the direction of its covariance", () => {
  const { a, b, turn } = ellipse([2, 1, 2], 1);
  near([a, b, turn], [Math.sqrt(3), 1, Math.PI / 4], 1e-9);
});

test("the floor point is that of the supported ankles, else of the hips", () => {
  const xyz = new Float32Array(51).fill(NaN);
  xyz.set([1, 2, 0], 45);
  xyz.set([3, 2, 0], 48);
  xyz.set([5, 5, 1], 33);
  const support = new Uint8Array(17);
  support[15] = 2;
  near(floorPoint(xyz, support), [1, 2]);
  support[16] = 1;
  near(floorPoint(xyz, support), [2, 2]);
  near(floorPoint(xyz, new Uint8Array(17)), [5, 5]);
});

test("inside and distance", () => {
  const square = [[0, 0], [2, 0], [2, 2], [0, 2]] as const;
  assert.equal(inside(square, [1, 1]), true);
  assert.equal(inside(square, [3, 1]), false);
  assert.equal(toPath(square, [3, 1], true), 1);
  assert.equal(toPath([[0, 0], [2, 0]], [1, 3]), 3);
});

test("the twelve slots are twelve different marks", () => {
  assert.equal(new Set(ORDER.map((slot) => JSON.stringify({ ...mark(slot), slot: 0 }))).size, 12);
  assert.deepEqual(mark(7), { slot: 7, shape: "pill", fill: "ring" });
});

test("numbers and times are written as the page writes them", () => {
  assert.deepEqual([0.04, 6.44, 9.97, 38.2, 372, 7500].map(duration),
    ["0.0 s", "6.4 s", "10 s", "38 s", "6 min", "2 h 5 min"]);
  assert.deepEqual([0.995, 0.976, 0.005].map(percent), ["over 99 %", "98 %", "below 1 %"]);
  assert.deepEqual([0.021, 0.001, NaN].map(plusMinus), ["± 2 cm", "± 1 cm", "Unknown"]);
  assert.equal(clock(1_796_045_512.6, "Europe/Zurich"), "14:31:52");
  assert.equal(clock(1_796_045_512.6, "Europe/Zurich", 2), "14:31:52.60");
  assert.equal(clock(75.25, "UTC", 2), "00:01:15.25");
  assert.equal(named("edge-strip_2"), "Edge strip 2");
});
