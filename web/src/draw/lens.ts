// Cameras: where a point of the world lies in the raw, distorted picture.

type Row = readonly [number, number, number, number];
export type Matrix34 = readonly [Row, Row, Row];

export interface Lens {
  width: number;
  height: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  model: "none" | "brown" | "fisheye";
  k: readonly number[];
  T: Matrix34;
}

const isRow = (value: unknown): value is Row =>
  Array.isArray(value) && value.length === 4 && value.every((x) => Number.isFinite(x));

/** Return the lens that a camera of a rig file describes; null where it is not complete. */
export function lens(value: Record<string, unknown>): Lens | null {
  const size = value.size_px as number[] | undefined;
  const K = value.K as number[][] | undefined;
  const T = value.T_cam_world as unknown[] | undefined;
  if (!Array.isArray(size) || !Array.isArray(K) || !Array.isArray(T)) return null;
  const rows = T.slice(0, 3);
  if (rows.length < 3 || !rows.every(isRow)) return null;
  const [fx, fy, cx, cy] = [K[0]?.[0], K[1]?.[1], K[0]?.[2], K[1]?.[2]];
  if (!(fx && fy) || cx === undefined || cy === undefined || !(size[0] && size[1])) return null;
  const model = value.distortion_model;
  return {
    width: size[0],
    height: size[1],
    fx, fy, cx, cy,
    model: model === "brown" || model === "fisheye" ? model : "none",
    k: Array.isArray(value.distortion) ? (value.distortion as number[]) : [],
    T: rows as unknown as Matrix34,
  };
}

/** Return a point of the world in the camera's frame: x right, y down, z forward [m]. */
export function toCamera(T: Matrix34, x: number, y: number, z: number): [number, number, number] {
  const [a, b, c] = T;
  return [
    a[0] * x + a[1] * y + a[2] * z + a[3],
    b[0] * x + b[1] * y + b[2] * z + b[3],
    c[0] * x + c[1] * y + c[2] * z + c[3],
  ];
}

/** Return a point of the camera's frame in the world [m]. */
export function invert(T: Matrix34, p: readonly [number, number, number]): [number, number, number] {
  const [a, b, c] = T;
  const [x, y, z] = [p[0] - a[3], p[1] - b[3], p[2] - c[3]];
  return [
    a[0] * x + b[0] * y + c[0] * z,
    a[1] * x + b[1] * y + c[1] * z,
    a[2] * x + b[2] * y + c[2] * z,
  ];
}

/** Return the pixel of a point in the camera's frame, which must lie ahead of the camera. */
export function toPixel(lens: Lens, p: readonly [number, number, number]): [number, number] {
  const x = p[0] / p[2];
  const y = p[1] / p[2];
  const [u, v] =
    lens.model === "brown" ? brown(lens.k, x, y)
    : lens.model === "fisheye" ? fisheye(lens.k, x, y)
    : [x, y];
  return [lens.fx * u + lens.cx, lens.fy * v + lens.cy];
}

function brown(k: readonly number[], x: number, y: number): [number, number] {
  const [k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0] = k;
  // Far outside the picture the polynomial folds back; there the limit of the picture is enough.
  const r2 = Math.min(x * x + y * y, 4);
  const radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)));
  const scale = radial > 0.2 ? radial : 0.2;
  return [
    x * scale + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
    y * scale + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
  ];
}

function fisheye(k: readonly number[], x: number, y: number): [number, number] {
  const [k1 = 0, k2 = 0, k3 = 0, k4 = 0] = k;
  const r = Math.hypot(x, y);
  if (r < 1e-9) return [x, y];
  const a = Math.atan(r);
  const a2 = a * a;
  const bent = a * (1 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4))));
  return [(x * bent) / r, (y * bent) / r];
}
