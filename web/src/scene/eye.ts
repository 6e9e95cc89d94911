// Where the scene is seen from: presets, a short flight between them, and the hand's orbit.

import { MathUtils, MOUSE, OrthographicCamera, PerspectiveCamera, TOUCH, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Camera, Site } from "../state/site.ts";

const FLIGHT_S = 0.25;
const FOLLOW_S = 0.4;
const DOWN = MathUtils.degToRad(34);

interface Pose {
  at: Vector3;
  look: Vector3;
  fov: number;
}

const still = (): boolean => matchMedia("(prefers-reduced-motion: reduce)").matches;

export class Eye {
  readonly perspective = new PerspectiveCamera(48, 1, 0.1, 400);
  readonly flat = new OrthographicCamera(-1, 1, 1, -1, 0.1, 400);
  #controls: OrbitControls;
  #site: Site | null = null;
  #view = "";
  #from: Pose | null = null;
  #to: Pose | null = null;
  #started = 0;
  #rig: Camera | null = null;
  /** Whether a hand has moved the eye since the view was chosen. */
  #touched = false;
  #aspect = 1;
  #size: [number, number] = [1, 1];

  constructor(element: HTMLElement, moved: () => void, change: () => void) {
    this.perspective.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.perspective, element);
    this.#controls.enableDamping = false;
    this.#controls.minDistance = 1.5;
    this.#controls.maxPolarAngle = Math.PI / 2 - 0.03;
    this.#controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
    this.#controls.touches = { ONE: TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
    this.#controls.addEventListener("start", () => {
      this.#to = null;
      this.#rig = null;
      this.#touched = true;
      this.#lens();
      moved();
    });
    this.#controls.addEventListener("change", change);
  }

  get camera(): PerspectiveCamera | OrthographicCamera {
    return this.#view === "top" ? this.flat : this.perspective;
  }

  size(width: number, height: number): void {
    this.#size = [width, height];
    this.#aspect = width / Math.max(1, height);
    this.#lens();
    this.#top();
    const fits = this.#view === "overview" && !this.#touched;
    if (fits && this.#site) this.#fly(overview(this.#site, this.#aspect), true);
  }

  /** Take a view; return whether the eye moves to it. */
  set(site: Site, view: string, person: readonly [number, number] | null): boolean {
    const fresh = site !== this.#site || view !== this.#view;
    const first = this.#site === null;
    this.#site = site;
    this.#view = view;
    if (view === "follow" && person) return this.#follow(person);
    if (!fresh) return false;
    this.#touched = false;
    this.#rig = site.cameras.find((camera) => `camera:${camera.name}` === view) ?? null;
    this.#controls.enabled = view !== "top";
    this.#controls.maxDistance = 3 * extent(site);
    if (view === "top") this.#top();
    this.#fly(this.#pose(site, view, person), first || this.#rig !== null || still());
    return true;
  }

  #pose(site: Site, view: string, person: readonly [number, number] | null): Pose {
    if (this.#rig) {
      const { at, ahead, lens } = this.#rig;
      const from = new Vector3(...at);
      const fov = 2 * MathUtils.radToDeg(Math.atan(lens.height / 2 / lens.fy));
      return { at: from, look: from.clone().addScaledVector(new Vector3(...ahead), 4), fov };
    }
    if (view === "alarm" && person) return near(site, person, 12, 30, 39);
    if (view === "follow" && person) return near(site, person, 5, 37, 48);
    const edge = site.edges[0];
    if (view === "edge" && edge) return along(edge.points);
    return overview(site, this.#aspect);
  }

  #fly(to: Pose, at_once: boolean): void {
    this.#started = performance.now();
    this.#from = at_once ? null : this.#now();
    this.#to = to;
    if (at_once) this.#take(to, 1);
  }

  #now(): Pose {
    return {
      at: this.perspective.position.clone(), look: this.#controls.target.clone(),
      fov: this.perspective.fov,
    };
  }

  /** Go behind the person, damped. */
  #follow(person: readonly [number, number]): boolean {
    const look = new Vector3(person[0], person[1], 1);
    const target = this.#controls.target;
    const way = new Vector3().subVectors(this.perspective.position, target);
    const flat = Math.hypot(way.x, way.y) || 1;
    const want = new Vector3(look.x + (4 * way.x) / flat, look.y + (4 * way.y) / flat, 3);
    const now = performance.now();
    const share = still() ? 1 : 1 - Math.exp(-(now - this.#started) / 1000 / FOLLOW_S);
    this.#started = now;
    this.#rig = null;
    this.#to = null;
    target.lerp(look, share);
    this.perspective.position.lerp(want, share);
    this.perspective.lookAt(target);
    this.#lens();
    return true;
  }

  /** Move on; return whether there is more to come. */
  step(): boolean {
    if (!this.#to) return false;
    const share = this.#from ? Math.min(1, (performance.now() - this.#started) / 1000 / FLIGHT_S) : 1;
    this.#take(this.#to, 1 - (1 - share) ** 3);
    if (share < 1) return true;
    this.#to = null;
    return false;
  }

  #take(to: Pose, share: number): void {
    const from = this.#from ?? to;
    this.perspective.position.lerpVectors(from.at, to.at, share);
    this.#controls.target.lerpVectors(from.look, to.look, share);
    this.perspective.fov = from.fov + (to.fov - from.fov) * share;
    this.perspective.lookAt(this.#controls.target);
    this.#lens();
  }

  #lens(): void {
    const camera = this.perspective;
    camera.aspect = this.#aspect;
    camera.clearViewOffset();
    if (this.#rig) {
      // The whole picture of the camera is seen, its middle where the lens has it.
      const { width, height, fx, fy, cx, cy } = this.#rig.lens;
      const shape = width / height;
      const tall = this.#aspect < shape ? shape / this.#aspect : 1;
      camera.fov = 2 * MathUtils.radToDeg(Math.atan(((height / 2) * tall) / fy));
      const [w, h] = this.#size;
      const scale = h / (height * tall);
      camera.setViewOffset(
        w, h, (width / 2 - cx) * scale * (fy / fx), (height / 2 - cy) * scale, w, h,
      );
    }
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }

  #top(): void {
    if (!this.#site) return;
    const { low, high } = this.#site.floor;
    const [dx, dy] = [high[0] - low[0], high[1] - low[1]];
    const turned = dy > dx;
    const [long, short] = turned ? [dy, dx] : [dx, dy];
    const half = Math.max(long / this.#aspect, short) * 0.56;
    this.flat.left = -half * this.#aspect;
    this.flat.right = half * this.#aspect;
    this.flat.top = half;
    this.flat.bottom = -half;
    this.flat.position.set((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, 60);
    this.flat.up.set(turned ? -1 : 0, turned ? 0 : 1, 0);
    this.flat.lookAt(this.flat.position.x, this.flat.position.y, 0);
    this.flat.updateProjectionMatrix();
    this.flat.updateMatrixWorld();
  }

  dispose(): void {
    this.#controls.dispose();
  }
}

export const extent = ({ floor: { low, high } }: Site): number =>
  Math.max(4, high[0] - low[0], high[1] - low[1]);

/** All of the site from its longer side: from where an edge is in front, if there is one. */
function overview(site: Site, aspect: number): Pose {
  const { low, high } = site.floor;
  const [dx, dy] = [high[0] - low[0], high[1] - low[1]];
  const look = new Vector3((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, 0.6);
  const fov = 48;
  const half = Math.tan(MathUtils.degToRad(fov / 2));
  const [long, short] = dy > dx ? [dy, dx] : [dx, dy];
  const wide = (0.5 * long * 1.04) / (half * aspect);
  const deep = (0.5 * short * Math.sin(DOWN) * 1.25 + 1) / half;
  const away = Math.max(wide, deep, 4) + 0.42 * short * Math.cos(DOWN);
  const edge = site.edges[0]?.points;
  const middle = edge
    ? edge.reduce((sum, p) => sum + p[dy > dx ? 0 : 1], 0) / edge.length
    : -Infinity;
  const side = middle > (dy > dx ? look.x : look.y) ? 1 : -1;
  const flat = away * Math.cos(DOWN);
  const at = new Vector3(
    look.x + (dy > dx ? side * flat : 0), look.y + (dy > dx ? 0 : side * flat),
    look.z + away * Math.sin(DOWN),
  );
  return { at, look, fov };
}

function near(
  site: Site, [x, y]: readonly [number, number], away: number, down: number, fov: number,
): Pose {
  const home = overview(site, 1.6);
  const look = new Vector3(x, y, 0.9);
  const turn = Math.atan2(home.at.y - home.look.y, home.at.x - home.look.x);
  const angle = MathUtils.degToRad(down);
  return {
    look, fov,
    at: new Vector3(
      x + away * Math.cos(angle) * Math.cos(turn), y + away * Math.cos(angle) * Math.sin(turn),
      0.9 + away * Math.sin(angle),
    ),
  };
}

/** Along an edge, from above its beginning. */
function along(points: readonly (readonly [number, number])[]): Pose {
  const [a, b] = [points[0] as readonly [number, number], points[points.length - 1] as readonly [number, number]];
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  const [ux, uy] = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
  return {
    at: new Vector3(a[0] - ux * 5 - uy * -1.5, a[1] - uy * 5 + ux * -1.5, 4),
    look: new Vector3(a[0] + ux * length * 0.4, a[1] + uy * length * 0.4, 0.6),
    fov: 48,
  };
}
