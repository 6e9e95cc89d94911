// What does not move: the floor with its grid, zones, and the walls below edges.

import {
  BufferAttribute, BufferGeometry, Color, Mesh, ShaderMaterial, ShapeUtils, Vector2, Vector3,
} from "three";
import { DROP_M, ground, halves, rim } from "../draw/halves.ts";
import { rgb, type Palette } from "../draw/palette.ts";
import type { Severity } from "../state/messages.ts";
import type { Point, Site } from "../state/site.ts";

const FLOOR_VERTEX = /* glsl */ `
  varying vec2 at;
  void main() {
    at = position.xy;
    gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
  }`;

const FLOOR_FRAGMENT = /* glsl */ `
  varying vec2 at;
  uniform vec3 plane, fine, coarse;
  uniform vec3 eye;
  float line(vec2 p, float each) {
    vec2 w = max(fwidth(p / each), 1e-5);
    vec2 away = abs(fract(p / each - 0.5) - 0.5) / w;
    float worn = clamp(1.5 - max(w.x, w.y) * 3.0, 0.0, 1.0);
    return (1.0 - min(min(away.x, away.y), 1.0)) * worn;
  }
  void main() {
    float far = distance(eye, vec3(at, 0.0));
    float fade = 1.0 - smoothstep(25.0, 60.0, far);
    vec3 c = plane;
    c = mix(c, fine, line(at, 1.0) * fade);
    c = mix(c, coarse, line(at, 5.0) * max(fade, 0.35));
    gl_FragColor = vec4(c, 1.0);
  }`;

const ZONE_VERTEX = /* glsl */ `
  attribute vec4 tone;
  varying vec4 ink;
  void main() {
    ink = tone;
    gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
  }`;

const ZONE_FRAGMENT = /* glsl */ `
  varying vec4 ink;
  uniform float ratio;
  void main() {
    // An alpha above one says: hatched.
    float hatched = step(1.0, ink.a);
    float stripe = step(mod((gl_FragCoord.x - gl_FragCoord.y) / ratio, 9.0), 1.0);
    gl_FragColor = vec4(ink.rgb, mix(ink.a, ink.a - 1.0 + 0.22 * stripe, hatched));
  }`;

export class Ground {
  readonly meshes: Mesh[];
  #floor: Mesh;
  #zones: Mesh;
  #walls: Mesh;
  #floorMaterial: ShaderMaterial;

  constructor() {
    this.#floorMaterial = new ShaderMaterial({
      vertexShader: FLOOR_VERTEX, fragmentShader: FLOOR_FRAGMENT,
      uniforms: {
        plane: { value: new Color() }, fine: { value: new Color() }, coarse: { value: new Color() },
        eye: { value: new Vector3() },
      },
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    const flat = (): ShaderMaterial =>
      new ShaderMaterial({
        vertexShader: ZONE_VERTEX, fragmentShader: ZONE_FRAGMENT, transparent: true,
        depthWrite: false, side: 2, uniforms: { ratio: { value: window.devicePixelRatio } },
      });
    this.#floor = new Mesh(new BufferGeometry(), this.#floorMaterial);
    this.#zones = new Mesh(new BufferGeometry(), flat());
    const wall = flat();
    wall.depthWrite = true;
    this.#walls = new Mesh(new BufferGeometry(), wall);
    this.meshes = [this.#walls, this.#floor, this.#zones];
    this.meshes.forEach((mesh, i) => {
      mesh.frustumCulled = false;
      mesh.renderOrder = i;
    });
  }

  eye(at: Vector3): void {
    (this.#floorMaterial.uniforms.eye as { value: Vector3 }).value.copy(at);
  }

  build(
    site: Site, c: Palette, active: ReadonlyMap<string, Severity>, zones: boolean,
  ): void {
    set(this.#floor, triangles(halves(site).floor).flatMap((p) => [p[0], p[1], 0]), []);
    const uniforms = this.#floorMaterial.uniforms as Record<string, { value: Color }>;
    uniforms.plane?.value.set(...rgb(c.floor));
    uniforms.fine?.value.set(...rgb(c.grid1));
    uniforms.coarse?.value.set(...rgb(c.grid5));
    this.#fill(site, c, active, zones);
    this.#wall(site, c);
  }

  #fill(site: Site, c: Palette, active: ReadonlyMap<string, Severity>, shown: boolean): void {
    const at: number[] = [];
    const tones: number[] = [];
    const parts = halves(site);
    for (const zone of shown ? site.zones : []) {
      const severity = active.get(zone.name);
      const ink = rgb(severity ? severityInk(c, severity) : c.zone);
      const alpha = (severity ? 0.14 : 0.07) + (zone.restricted || severity ? 1 : 0);
      for (const p of triangles(zone.polygon)) {
        at.push(p[0], p[1], ground(parts, zone) + 0.004);
        tones.push(...ink, alpha);
      }
    }
    set(this.#zones, at, tones);
  }

  /** The wall below an edge, and the ground at its foot where the edge crosses the site. */
  #wall(site: Site, c: Palette): void {
    const at: number[] = [];
    const tones: number[] = [];
    const put = (points: readonly (readonly number[])[], ink: string): void => {
      for (const p of points) {
        at.push(p[0] as number, p[1] as number, p[2] as number);
        tones.push(...rgb(ink), 0.999);
      }
    };
    const parts = halves(site);
    if (parts.below) {
      put(triangles(parts.below).map((p) => [p[0], p[1], -DROP_M]), c.track);
      const top = rim(parts);
      if (top) put(wall(...top), c.wall);
    }
    for (const { points } of parts.below ? site.edges.slice(1) : site.edges) {
      for (let i = 0; i + 1 < points.length; i++) {
        put(wall(points[i] as Point, points[i + 1] as Point), c.wall);
      }
    }
    set(this.#walls, at, tones);
  }

  dispose(): void {
    for (const mesh of this.meshes) {
      mesh.geometry.dispose();
      (mesh.material as ShaderMaterial).dispose();
    }
  }
}

export const severityInk = (c: Palette, severity: Severity): string =>
  ({ critical: c.critical, alarm: c.bodyAlarm, warning: c.warnFill, info: c.info })[severity];

function wall(a: Point, b: Point): number[][] {
  return [[...a, 0], [...b, 0], [...b, -DROP_M], [...a, 0], [...b, -DROP_M], [...a, -DROP_M]];
}

function triangles(polygon: readonly Point[]): Point[] {
  const points = polygon.map(([x, y]) => new Vector2(x, y));
  if (ShapeUtils.isClockWise(points)) points.reverse();
  return ShapeUtils.triangulateShape(points, [])
    .flat()
    .map((i): Point => [points[i]?.x ?? 0, points[i]?.y ?? 0]);
}

function set(mesh: Mesh, at: number[], tones: number[]): void {
  mesh.geometry.dispose();
  mesh.geometry = new BufferGeometry();
  mesh.geometry.setAttribute("position", new BufferAttribute(new Float32Array(at), 3));
  if (tones.length > 0) {
    mesh.geometry.setAttribute("tone", new BufferAttribute(new Float32Array(tones), 4));
  }
  mesh.visible = at.length > 0;
}
