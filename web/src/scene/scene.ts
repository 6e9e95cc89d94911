// The scene in 3D: one buffer per kind of thing, drawn when something has changed.

import { Scene as Graph, LinearSRGBColorSpace, Vector2, Vector3, WebGLRenderer, Color } from "three";
import { Bodies, DASHED, RING, SOLID } from "./bodies.ts";
import { Discs } from "./discs.ts";
import { extent, Eye } from "./eye.ts";
import { Ground, severityInk } from "./ground.ts";
import { drawCallout, drawChips, drawMetres, drawName, type Chip } from "./labels.ts";
import { Segments, type P3 } from "./segments.ts";
import {
  ellipse, HEAD, HEAD_M, isDashed, joint, LIMBS, P50, P90, showsForecast, topOf,
  TORSO,
} from "../draw/body.ts";
import { ground, halves } from "../draw/halves.ts";
import { fit } from "../draw/mark.ts";
import { mix, palette, rgb, type Palette, type Rgb } from "../draw/palette.ts";
import { slotOf } from "../state/marks.ts";
import type { Severity } from "../state/messages.ts";
import { JOINTS, type Person, type Snapshot } from "../state/people.ts";
import type { Camera, Point, Site } from "../state/site.ts";
import { invert } from "../draw/lens.ts";
import { boxesIn } from "../state/volumes.ts";
import { named } from "../state/words.ts";

export interface SceneInput {
  site: Site | null;
  snapshot: Snapshot | null;
  slots: ReadonlyMap<number, number>;
  paths: ReadonlyMap<number, readonly Point[]>;
  selected: number | null;
  view: string;
  layers: {
    paths: boolean; forecasts: boolean; zones: boolean; cameras: boolean; numbers: boolean;
    uncertainty: boolean;
  };
  alarmed: ReadonlyMap<number, Severity>;
  active: ReadonlyMap<string, Severity>;
  faulty: ReadonlySet<string>;
  /** The person an open alarm is about: others step back. */
  alarm: number | null;
  callout: { person: number; title: string; line: string } | null;
}

export interface Hands {
  pick(person: number | null): void;
  moved(): void;
}

const FRUSTUM_M = 0.95;
const NEAR_CAMERA_M = 4;

/** Whether a view is so close to people that cameras would stand in front of them. */
const isNear = (view: string): boolean => view === "alarm" || view === "follow";

export class Scene {
  #box: HTMLElement;
  #canvas = document.createElement("canvas");
  #over = document.createElement("canvas");
  #renderer: WebGLRenderer;
  #graph = new Graph();
  #size = new Vector2(1, 1);
  #eye: Eye;
  #ground = new Ground();
  #shadows = new Discs(0.006, 4);
  #wide = new Discs(0.01, 5, 0);
  #narrow = new Discs(0.012, 6, 1);
  #still: Segments;
  #moving: Segments;
  #bodies: Bodies;
  #input: SceneInput | null = null;
  #built = "";
  #frame = 0;
  #watch: ResizeObserver;
  #chips: { person: number; box: [number, number, number, number] }[] = [];
  #hands: Hands;

  constructor(element: HTMLElement, hands: Hands) {
    this.#box = element;
    this.#hands = hands;
    this.#over.className = "over";
    element.append(this.#canvas, this.#over);
    this.#renderer = new WebGLRenderer({ canvas: this.#canvas, antialias: true, stencil: true });
    // Colours are those of the style sheet as they stand: nothing is lit, nothing converted.
    this.#renderer.outputColorSpace = LinearSRGBColorSpace;
    this.#still = new Segments(this.#size, 3);
    this.#moving = new Segments(this.#size, 10);
    this.#bodies = new Bodies(this.#size);
    this.#graph.add(
      ...this.#ground.meshes, this.#shadows.mesh, this.#wide.mesh, this.#narrow.mesh,
      this.#still.mesh, this.#moving.mesh, ...this.#bodies.meshes,
    );
    this.#eye = new Eye(this.#canvas, hands.moved, () => this.#soon());
    this.#watch = new ResizeObserver(() => this.#resize());
    this.#watch.observe(element);
    this.#canvas.addEventListener("pointerdown", this.#press);
    this.#canvas.addEventListener("pointerup", this.#release);
    document.addEventListener("visibilitychange", this.#visible);
    this.#resize();
  }

  /** Number of draw calls of the last picture. */
  get calls(): number {
    return this.#renderer.info.render.calls;
  }

  show(input: SceneInput): void {
    this.#input = input;
    this.#soon();
  }

  dispose(): void {
    cancelAnimationFrame(this.#frame);
    this.#watch.disconnect();
    document.removeEventListener("visibilitychange", this.#visible);
    this.#eye.dispose();
    for (const part of [
      this.#ground, this.#shadows, this.#wide, this.#narrow, this.#still, this.#moving, this.#bodies,
    ]) part.dispose();
    this.#renderer.dispose();
    this.#canvas.remove();
    this.#over.remove();
  }

  #visible = (): void => {
    if (!document.hidden) this.#soon();
  };

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#box;
    if (width === 0 || height === 0) return;
    this.#renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.#renderer.setSize(width, height, false);
    this.#size.set(width, height);
    this.#eye.size(width, height);
    this.#soon();
  }

  #soon(): void {
    if (this.#frame === 0 && !document.hidden) {
      this.#frame = requestAnimationFrame(() => {
        this.#frame = 0;
        this.#draw();
      });
    }
  }

  #draw(): void {
    const input = this.#input;
    const c = palette();
    this.#renderer.setClearColor(new Color(...rgb(c.sky)), 1);
    if (input?.site) {
      const person = this.#person(input, input.view === "alarm" ? input.alarm : input.selected);
      this.#eye.set(input.site, input.view, person ? person.floor : null);
      if (this.#eye.step()) this.#soon();
      this.#build(input, input.site, c);
      this.#people(input, c);
      this.#ground.eye(this.#eye.camera.position);
    }
    this.#renderer.render(this.#graph, this.#eye.camera);
    this.#labels(input, c);
    this.#box.dataset.calls = String(this.calls);
    this.#box.dataset.drawn = String(input?.snapshot?.people.length ?? "");
  }

  #person(input: SceneInput, id: number | null): Person | null {
    return input.snapshot?.people.find((person) => person.id === id) ?? null;
  }

  /** Build what does not move, when it has changed. */
  #build(input: SceneInput, site: Site, c: Palette): void {
    const key = JSON.stringify([
      site.version, site.name, c.floor, [...input.active], [...input.faulty], input.layers.zones,
      input.layers.cameras, input.view, site.cameras.length, site.zones.length,
    ]);
    if (key === this.#built) return;
    this.#built = key;
    this.#ground.build(site, c, input.active, input.layers.zones);
    const lines = this.#still;
    lines.begin();
    if (input.layers.zones) zoneLines(lines, site, c, input.active);
    for (const edge of site.edges) {
      const severity = input.active.get(edge.name);
      lines.chain(
        edge.points.map((p): P3 => [p[0], p[1], 0.01]),
        rgb(severity ? severityInk(c, severity) : c.edge), { width: 2 },
      );
    }
    for (const { points } of site.walls) {
      lines.chain(points.map((p): P3 => [p[0], p[1], 0.01]), rgb(c.text3), { width: 4 });
    }
    if (input.layers.cameras && !isNear(input.view)) {
      for (const camera of site.cameras) {
        if (input.view !== `camera:${camera.name}`) {
          frustum(lines, camera, c, input.faulty.has(camera.name));
        }
      }
    }
    lines.end();
  }

  #people(input: SceneInput, c: Palette): void {
    const parts = [this.#shadows, this.#wide, this.#narrow, this.#moving, this.#bodies];
    for (const part of parts) part.begin();
    this.#bodies.rimTone = rgb(c.floor);
    for (const person of input.snapshot?.people ?? []) this.#one(input, c, person);
    if (input.site && input.layers.zones && input.snapshot) {
      for (const volume of input.site.volumes) {
        for (const box of boxesIn(volume, input.snapshot)) {
          prism(this.#moving, box, volume.bottom, volume.bottom + volume.size[2], rgb(c.text2), {
            width: 1.6, alpha: 0.9,
          });
        }
      }
    }
    for (const part of parts) part.end();
  }

  #one(input: SceneInput, c: Palette, person: Person): void {
    const severity = input.alarmed.get(person.id) ?? null;
    const selected = person.id === input.selected;
    const slot = slotOf(input.slots, person.id);
    const back = input.alarm !== null && input.alarm !== person.id;
    const tone = rgb(this.#tone(c, person, severity, selected, slot, back));
    const own = severity ? severityInk(c, severity) : (c.marks[slot - 1] ?? c.text2);
    const trace = rgb(person.state === "provisional" ? c.text3 : own);
    this.#shadows.add(
      person.floor[0], person.floor[1], 0.24, 0.24, 0, [0, 0, 0], c.dark ? 0.4 : 0.13,
    );
    this.#limbs(person, tone);
    if (input.layers.paths) this.#path(input.paths.get(person.id) ?? [], trace, selected || !!severity);
    if (input.layers.forecasts && !back) this.#forecast(person, trace, selected);
    if (selected || severity) this.#ring(person, rgb(severity ? own : c.accent));
    if (selected) this.#joints(input, c, person, rgb(own));
  }

  #tone(
    c: Palette, person: Person, severity: Severity | null, selected: boolean, slot: number,
    back: boolean,
  ): string {
    if (severity === "alarm" || severity === "critical") return c.bodyAlarm;
    if (person.state === "provisional") return mix(c.bodyProvisional, c.floor, back ? 0.38 : 0);
    const plain = selected ? (c.marks[slot - 1] ?? c.body) : c.body;
    return mix(plain, c.floor, back ? 0.38 : 0);
  }

  #limbs(person: Person, tone: Rgb): void {
    const floor = rgb(palette().floor);
    const soft = (share: number): Rgb =>
      [0, 1, 2].map((i) => (tone[i] ?? 0) * share + (floor[i] ?? 0) * (1 - share)) as unknown as Rgb;
    const faint = soft(person.state === "provisional" ? 0.85 : 0.55);
    for (const [a, b, radius] of LIMBS) {
      const dashed = isDashed(person, a, b);
      this.#bodies.capsule(
        joint(person, a), joint(person, b), radius, dashed ? faint : tone, dashed ? DASHED : SOLID,
      );
    }
    const head = joint(person, HEAD);
    const sure = person.state === "confirmed";
    this.#bodies.capsule(head, head, HEAD_M, sure ? tone : faint, sure ? SOLID : RING);
    if (sure) this.#bodies.torso(TORSO.map((j) => joint(person, j)), tone, 0.33);
  }

  #path(points: readonly Point[], tone: Rgb, wide: boolean): void {
    const n = points.length;
    const most = wide ? 4 : 2.6;
    for (let i = 1; i < n; i++) {
      const [a, b] = [points[i - 1] as Point, points[i] as Point];
      const [s, t] = [(i - 1) / n, i / n];
      this.#moving.add([a[0], a[1], 0.02], [b[0], b[1], 0.02], tone, {
        width: 0.8 + (most - 0.8) * s, widthEnd: 0.8 + (most - 0.8) * t,
        alpha: 0.04 + 0.76 * s ** 1.5, alphaEnd: 0.04 + 0.76 * t ** 1.5,
      });
    }
  }

  #forecast(person: Person, tone: Rgb, selected: boolean): void {
    const forecast = person.forecast;
    if (!showsForecast(person, selected)) return;
    const outlines = [1, 2, 4].map((s) =>
      forecast.reduce((a, b) => (Math.abs(b.ahead - s) < Math.abs(a.ahead - s) ? b : a)));
    for (const f of forecast) {
      const w = ellipse(f.cov, P90);
      this.#wide.add(f.at[0], f.at[1], w.a, w.b, w.turn, tone, 0.12);
      const n = ellipse(f.cov, P50);
      this.#narrow.add(f.at[0], f.at[1], n.a, n.b, n.turn, tone, 0.16);
      if (outlines.includes(f)) {
        this.#circle(f.at, w.a, w.b, w.turn, tone, { width: 1, alpha: 0.75 }, 36);
      }
    }
    const line: P3[] = [[person.floor[0], person.floor[1], 0.025],
      ...forecast.map((f): P3 => [f.at[0], f.at[1], 0.025])];
    this.#moving.chain(line, tone, { width: 1.6, dash: [4, 4] });
  }

  #circle(
    at: Point, a: number, b: number, turn: number, tone: Rgb,
    stroke: { width: number; alpha?: number }, parts: number,
  ): void {
    const points = Array.from({ length: parts }, (_, i): P3 => {
      const angle = (2 * Math.PI * i) / parts;
      const [u, v] = [a * Math.cos(angle), b * Math.sin(angle)];
      return [
        at[0] + u * Math.cos(turn) - v * Math.sin(turn),
        at[1] + u * Math.sin(turn) + v * Math.cos(turn), 0.02,
      ];
    });
    this.#moving.chain(points, tone, stroke, true);
  }

  #ring(person: Person, tone: Rgb): void {
    this.#circle(person.floor, 0.55, 0.55, 0, tone, { width: 2 }, 40);
  }

  /** Joints of the selected person, with what is not known well. */
  #joints(input: SceneInput, c: Palette, person: Person, tone: Rgb): void {
    const dot = rgb(c.floor);
    for (let j = 5; j < JOINTS; j++) {
      const p = joint(person, j);
      if (Number.isFinite(p[0])) this.#bodies.capsule(toward(p, this.#eye.camera.position), toward(p, this.#eye.camera.position), 0.016, dot, SOLID);
      const sigma = person.sigma[j] ?? NaN;
      if (input.layers.uncertainty && sigma > 0.03) this.#facing(p, 1.5 * sigma, tone);
    }
  }

  /** A circle that faces the eye. */
  #facing(p: P3, radius: number, tone: Rgb): void {
    const camera = this.#eye.camera;
    const right = new Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
    const up = new Vector3().setFromMatrixColumn(camera.matrixWorld, 1);
    const points = Array.from({ length: 28 }, (_, i): P3 => {
      const angle = (2 * Math.PI * i) / 28;
      const [u, v] = [radius * Math.cos(angle), radius * Math.sin(angle)];
      return [
        p[0] + u * right.x + v * up.x, p[1] + u * right.y + v * up.y, p[2] + u * right.z + v * up.z,
      ];
    });
    this.#moving.chain(points, tone, { width: 1.2, alpha: 0.9, dash: [3, 2] }, true);
  }

  /** Return the place of a point on the screen [px]; null behind the eye. */
  #screen(p: P3): { x: number; y: number; far: number } | null {
    const camera = this.#eye.camera;
    const v = new Vector3(...p).applyMatrix4(camera.matrixWorldInverse);
    const far = -v.z;
    if (far < 0.1) return null;
    v.applyMatrix4(camera.projectionMatrix);
    return { x: (v.x * 0.5 + 0.5) * this.#size.x, y: (0.5 - v.y * 0.5) * this.#size.y, far };
  }

  #labels(input: SceneInput | null, c: Palette): void {
    const sheet = fit(this.#over);
    this.#chips = [];
    if (!sheet || !input?.site) return;
    const { pen } = sheet;
    this.#metres(pen, c, input.site);
    if (input.layers.cameras && !isNear(input.view)) this.#names(pen, c, input);
    if (!input.layers.numbers) return;
    let callout = (): void => undefined;
    const chips = (input.snapshot?.people ?? []).flatMap((person): Chip[] => {
      const top = this.#screen(topOf(person));
      const foot = this.#screen([person.floor[0], person.floor[1], 0]);
      if (!top || !foot) return [];
      const called = input.callout?.person === person.id;
      if (called && input.callout) {
        const { title, line } = input.callout;
        const severity = input.alarmed.get(person.id) ?? "alarm";
        callout = () => drawCallout(pen, c, severity, title, line, top.x, top.y);
        return [];
      }
      return [{
        person: person.id,
        slot: slotOf(input.slots, person.id),
        state: person.state,
        unseen: person.unseen,
        x: top.x, y: top.y - 4,
        tall: Math.hypot(foot.y - top.y, foot.x - top.x),
        far: top.far,
        selected: person.id === input.selected,
        severity: input.alarmed.get(person.id) ?? null,
      }];
    });
    this.#chips = drawChips(pen, c, chips);
    callout(); // over all chips
  }

  #names(pen: CanvasRenderingContext2D, c: Palette, input: SceneInput): void {
    for (const camera of input.site?.cameras ?? []) {
      if (input.view === `camera:${camera.name}`) continue;
      const at = this.#screen(camera.at);
      if (!at || at.far < NEAR_CAMERA_M || at.y < 80) continue;
      drawName(pen, c, named(camera.name), at.x, at.y, input.faulty.has(camera.name));
    }
  }

  #metres(pen: CanvasRenderingContext2D, c: Palette, site: Site): void {
    const { low, high } = site.floor;
    const across = high[0] - low[0] >= high[1] - low[1];
    const long = extent(site);
    const each = long > 60 ? 10 : 5;
    const eye = this.#eye.camera.position;
    const [from, to] = across ? [low[0], high[0]] : [low[1], high[1]];
    const near = across
      ? (eye.y < (low[1] + high[1]) / 2 ? low[1] - 0.4 : high[1] + 0.4)
      : (eye.x < (low[0] + high[0]) / 2 ? low[0] - 0.4 : high[0] + 0.4);
    for (let m = Math.ceil(from / each) * each; m <= to; m += each) {
      const at = this.#screen(across ? [m, near, 0] : [near, m, 0]);
      const within = at && at.x > 20 && at.x < this.#size.x - 20;
      if (within && at.y > 70 && at.y < this.#size.y - 44) drawMetres(pen, c, `${m} m`, at.x, at.y + 8);
    }
  }

  #pressed: [number, number] = [0, 0];

  #press = (event: PointerEvent): void => {
    this.#pressed = [event.offsetX, event.offsetY];
  };

  #release = (event: PointerEvent): void => {
    const [x, y] = [event.offsetX, event.offsetY];
    if (Math.hypot(x - this.#pressed[0], y - this.#pressed[1]) > 5) return;
    const chip = this.#chips.find(
      ({ box }) => x >= box[0] - 2 && x <= box[2] + 2 && y >= box[1] - 2 && y <= box[3] + 2,
    );
    this.#hands.pick(chip?.person ?? this.#under(x, y));
  };

  #under(x: number, y: number): number | null {
    let best: { person: number; away: number } | null = null;
    for (const person of this.#input?.snapshot?.people ?? []) {
      const top = this.#screen(topOf(person));
      const foot = this.#screen([person.floor[0], person.floor[1], 0]);
      if (!top || !foot) continue;
      const tall = Math.max(20, foot.y - top.y);
      const away = Math.hypot((x - (top.x + foot.x) / 2) * 2, y - (top.y + foot.y) / 2);
      if (away < tall * 0.6 && (!best || away < best.away)) best = { person: person.id, away };
    }
    return best?.person ?? null;
  }
}

/** Return a point moved a little toward the eye, so that it lies on the limb. */
function toward(p: P3, eye: Vector3): P3 {
  const way = new Vector3(eye.x - p[0], eye.y - p[1], eye.z - p[2]).normalize();
  return [p[0] + 0.06 * way.x, p[1] + 0.06 * way.y, p[2] + 0.06 * way.z];
}

function zoneLines(
  lines: Segments, site: Site, c: Palette, active: ReadonlyMap<string, Severity>,
): void {
  const parts = halves(site);
  for (const zone of site.zones) {
    const severity = active.get(zone.name);
    const tone = rgb(severity ? severityInk(c, severity) : c.zone);
    const foot = ground(parts, zone);
    const at = (z: number) => zone.polygon.map((p): P3 => [p[0], p[1], z]);
    lines.chain(at(foot + 0.008), tone, { width: 1.3 }, true);
    if (!severity) continue;
    const top = zone.z[1];
    const faint = { width: 1, alpha: 0.6 };
    lines.chain(at(top), tone, faint, true);
    for (const p of zone.polygon) lines.add([p[0], p[1], foot], [p[0], p[1], top], tone, faint);
  }
  for (const line of site.lines) {
    lines.chain(line.points.map((p): P3 => [p[0], p[1], 0.008]), rgb(c.zone), { width: 1.6, dash: [8, 4] });
  }
  for (const one of site.exclusions) {
    const faint = { width: 1, alpha: 0.7 };
    prism(lines, one.polygon, ground(parts, one) + 0.008, one.z[1], rgb(c.text3), faint);
  }
  for (const portal of site.portals) {
    lines.chain(portal.points.map((p): P3 => [p[0], p[1], 0.008]), rgb(c.text2), { width: 3, dash: [2, 4] });
  }
  for (const volume of site.volumes) {
    const path = volume.path.map((p): P3 => [p[0], p[1], 0.008]);
    lines.chain(path, rgb(c.text3), { width: 1, dash: [1, 4] });
  }
}

/** Draw the rims of a body over a polygon, and its corners. */
function prism(
  lines: Segments, polygon: readonly Point[], low: number, high: number, tone: Rgb,
  look: { width: number; alpha: number },
): void {
  for (const z of [low, high]) lines.chain(polygon.map((p): P3 => [p[0], p[1], z]), tone, look, true);
  for (const p of polygon) lines.add([p[0], p[1], low], [p[0], p[1], high], tone, look);
}

function frustum(lines: Segments, camera: Camera, c: Palette, faulty: boolean): void {
  const { width, height, fx, fy, cx, cy } = camera.lens;
  const corner = (u: number, v: number): P3 =>
    invert(camera.lens.T, [
      ((u - cx) / fx) * FRUSTUM_M, ((v - cy) / fy) * FRUSTUM_M, FRUSTUM_M,
    ]);
  const corners = [corner(0, 0), corner(width, 0), corner(width, height), corner(0, height)];
  const tone = rgb(faulty ? c.warnFill : c.line2);
  const stroke = { width: 1.3, ...(faulty ? { dash: [4, 3] as const } : {}) };
  lines.chain(corners, tone, stroke, true);
  for (const p of corners) lines.add(camera.at, p, tone, stroke);
  lines.add(camera.at, [camera.at[0], camera.at[1], 0], tone, { width: 1, alpha: 0.45, dash: [2, 4] });
}
