// Bodies: capsules as flat shapes that face the camera, all people in one buffer.

import {
  BufferAttribute, BufferGeometry, DynamicDrawUsage, InstancedBufferAttribute,
  InstancedBufferGeometry, Mesh, ShaderMaterial, Vector2,
} from "three";
import type { Rgb } from "../draw/palette.ts";
import type { P3 } from "./segments.ts";

const LEAST_PX = 0.9; // radius
const RIM_PX = 2.4;

const VERTEX = /* glsl */ `
  attribute vec3 a, b;
  attribute vec4 tone;  // colour; 1 dashed, 2 ring, 0 solid
  attribute float radius;
  uniform vec2 size;
  uniform float rim, back;
  varying vec2 at, start, end;
  varying vec2 radii;
  varying vec4 ink;
  void main() {
    vec4 va = viewMatrix * vec4(a, 1.0);
    vec4 vb = viewMatrix * vec4(b, 1.0);
    vec4 p = projectionMatrix * va;
    vec4 q = projectionMatrix * vb;
    if (p.w < 0.05 || q.w < 0.05) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
    float perMetre = projectionMatrix[1][1] * size.y * 0.5;
    start = p.xy / p.w * size * 0.5;
    end = q.xy / q.w * size * 0.5;
    radii = max(vec2(radius * perMetre / p.w, radius * perMetre / q.w), vec2(${LEAST_PX}));
    float widest = max(radii.x, radii.y) + rim + 1.0;
    vec2 way = end - start;
    float len = length(way);
    way = len > 1e-3 ? way / len : vec2(1.0, 0.0);
    vec2 across = vec2(-way.y, way.x);
    vec2 corner = (position.x < 0.5 ? start : end) + way * (position.x - 0.5) * 2.0 * widest
      + across * position.y * widest;
    at = corner;
    vec4 base = position.x < 0.5 ? p : q;
    gl_Position = vec4(corner / (size * 0.5) * base.w, base.z + back * base.w, base.w);
    ink = tone;
  }`;

const FRAGMENT = /* glsl */ `
  uniform float rim;
  uniform vec3 rimTone;
  varying vec2 at, start, end;
  varying vec2 radii;
  varying vec4 ink;
  void main() {
    vec2 way = end - start;
    float len2 = max(dot(way, way), 1e-6);
    float s = clamp(dot(at - start, way) / len2, 0.0, 1.0);
    float r = mix(radii.x, radii.y, s);
    float away = distance(at, start + s * way) - r;
    if (rim > 0.0) {
      if (away > rim) discard;
      gl_FragColor = vec4(rimTone, 1.0);
    } else {
      if (away > 0.5) discard;
      if (ink.a > 1.5 && away < -max(1.6, r * 0.22)) discard;
      if (ink.a > 0.5 && ink.a < 1.5 && mod(s * sqrt(len2), 7.0) > 4.0) discard;
      gl_FragColor = vec4(ink.rgb, clamp(0.5 - away, 0.0, 1.0));
    }
  }`;

export const SOLID = 0;
export const DASHED = 1;
export const RING = 2;

export class Bodies {
  readonly meshes: Mesh[];
  #geometry = new InstancedBufferGeometry();
  #rim: ShaderMaterial;
  #fill: ShaderMaterial;
  #room = 0;
  #n = 0;
  #torsos = new BufferGeometry();
  #torsoRoom = 0;
  #torsoN = 0;
  #torsoMaterial: ShaderMaterial;

  constructor(size: Vector2) {
    const make = (rim: number, back: number): ShaderMaterial =>
      new ShaderMaterial({
        vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true,
        uniforms: {
          size: { value: size }, rim: { value: rim }, back: { value: back },
          rimTone: { value: [1, 1, 1] },
        },
      });
    this.#rim = make(RIM_PX, 0.0015);
    this.#fill = make(0, 0);
    this.#geometry.setAttribute("position", new BufferAttribute(
      new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]), 3,
    ));
    this.#geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const rim = new Mesh(this.#geometry, this.#rim);
    const fill = new Mesh(this.#geometry, this.#fill);
    this.#torsoMaterial = new ShaderMaterial({
      vertexShader: `attribute vec4 tone; varying vec4 ink;
        void main() { ink = tone;
          gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
          gl_Position.z += 0.0008 * gl_Position.w; }`,
      fragmentShader: `varying vec4 ink; void main() { gl_FragColor = ink;
      }`,
      transparent: true, depthWrite: false, side: 2,
    });
    const torso = new Mesh(this.#torsos, this.#torsoMaterial);
    this.meshes = [rim, torso, fill];
    this.meshes.forEach((mesh, i) => {
      mesh.frustumCulled = false;
      mesh.renderOrder = 20 + i;
    });
    this.#grow(512);
    this.#growTorsos(32);
  }

  set rimTone(tone: Rgb) {
    (this.#rim.uniforms.rimTone as { value: number[] }).value = [...tone];
  }

  #attribute(name: string): InstancedBufferAttribute {
    return this.#geometry.getAttribute(name) as InstancedBufferAttribute;
  }

  #grow(room: number): void {
    this.#geometry.dispose();
    for (const [name, per] of [["a", 3], ["b", 3], ["tone", 4], ["radius", 1]] as const) {
      const values = new Float32Array(room * per);
      if (this.#room > 0) values.set(this.#attribute(name).array as Float32Array);
      const made = new InstancedBufferAttribute(values, per);
      made.setUsage(DynamicDrawUsage);
      this.#geometry.setAttribute(name, made);
    }
    this.#room = room;
  }

  #growTorsos(room: number): void {
    this.#torsos.dispose();
    for (const [name, per] of [["position", 3], ["tone", 4]] as const) {
      const values = new Float32Array(room * 4 * per);
      if (this.#torsoRoom > 0) {
        values.set((this.#torsos.getAttribute(name) as BufferAttribute).array as Float32Array);
      }
      const made = new BufferAttribute(values, per);
      made.setUsage(DynamicDrawUsage);
      this.#torsos.setAttribute(name, made);
    }
    this.#torsos.setIndex(
      Array.from({ length: room }, (_, i) => [0, 1, 2, 0, 2, 3].map((k) => 4 * i + k)).flat(),
    );
    this.#torsoRoom = room;
  }

  begin(): void {
    this.#n = 0;
    this.#torsoN = 0;
  }

  capsule(a: P3, b: P3, radius: number, tone: Rgb, kind: number): void {
    if (!Number.isFinite(a[0] + b[0])) return;
    if (this.#n === this.#room) this.#grow(this.#room * 2);
    const i = this.#n++;
    (this.#attribute("a").array as Float32Array).set(a, 3 * i);
    (this.#attribute("b").array as Float32Array).set(b, 3 * i);
    (this.#attribute("tone").array as Float32Array).set([...tone, kind], 4 * i);
    (this.#attribute("radius").array as Float32Array)[i] = radius;
  }

  torso(corners: readonly P3[], tone: Rgb, alpha: number): void {
    if (corners.some((p) => !Number.isFinite(p[0]))) return;
    if (this.#torsoN === this.#torsoRoom) this.#growTorsos(this.#torsoRoom * 2);
    const i = this.#torsoN++;
    const position = this.#torsos.getAttribute("position").array as Float32Array;
    const tones = this.#torsos.getAttribute("tone").array as Float32Array;
    corners.forEach((p, k) => {
      position.set(p, 3 * (4 * i + k));
      tones.set([...tone, alpha], 4 * (4 * i + k));
    });
  }

  end(): void {
    for (const name of ["a", "b", "tone", "radius"]) this.#attribute(name).needsUpdate = true;
    this.#geometry.instanceCount = this.#n;
    for (const name of ["position", "tone"]) {
      (this.#torsos.getAttribute(name) as BufferAttribute).needsUpdate = true;
    }
    this.#torsos.setDrawRange(0, 6 * this.#torsoN);
    const [rim, torso, fill] = this.meshes as [Mesh, Mesh, Mesh];
    rim.visible = fill.visible = this.#n > 0;
    torso.visible = this.#torsoN > 0;
  }

  dispose(): void {
    this.#geometry.dispose();
    this.#torsos.dispose();
    for (const material of [this.#rim, this.#fill, this.#torsoMaterial]) material.dispose();
  }
}
