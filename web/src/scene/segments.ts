// Lines of any width in pixels: one instanced buffer, one draw call.

import {
  BufferAttribute, DynamicDrawUsage, InstancedBufferAttribute, InstancedBufferGeometry, Mesh,
  ShaderMaterial, Vector2,
} from "three";
import type { Rgb } from "../draw/palette.ts";

export type P3 = readonly [number, number, number];

const VERTEX = /* glsl */ `
  attribute vec3 a, b;
  attribute vec4 ca, cb;
  attribute vec4 look; // width at a and b [px], dash and gap [px]
  uniform vec2 size;
  varying vec4 tone;
  varying float along;
  varying vec2 dash;
  void main() {
    vec4 p = projectionMatrix * viewMatrix * vec4(a, 1.0);
    vec4 q = projectionMatrix * viewMatrix * vec4(b, 1.0);
    // Cut at the near plane, where a point behind the camera would turn over.
    float near = 0.02;
    if (p.w < near && q.w < near) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
    if (p.w < near) p = mix(p, q, (near - p.w) / (q.w - p.w));
    else if (q.w < near) q = mix(q, p, (near - q.w) / (p.w - q.w));
    vec2 s = p.xy / p.w * size * 0.5;
    vec2 e = q.xy / q.w * size * 0.5;
    vec2 way = e - s;
    float len = max(length(way), 1e-4);
    way /= len;
    float end = position.x;
    float width = mix(look.x, look.y, end);
    vec4 at = mix(p, q, end);
    vec2 off = vec2(-way.y, way.x) * position.y * width * 0.5 + way * (end - 0.5) * 0.6;
    gl_Position = at + vec4(off / size * 2.0 * at.w, 0.0, 0.0);
    tone = mix(ca, cb, end);
    along = end * len;
    dash = look.zw;
  }`;

const FRAGMENT = /* glsl */ `
  varying vec4 tone;
  varying float along;
  varying vec2 dash;
  void main() {
    if (dash.y > 0.0 && mod(along, dash.x + dash.y) > dash.x) discard;
    gl_FragColor = tone;
  }`;

const PARTS = [["a", 3], ["b", 3], ["ca", 4], ["cb", 4], ["look", 4]] as const;

export interface Stroke {
  width?: number;
  widthEnd?: number;
  alpha?: number;
  alphaEnd?: number;
  dash?: readonly [number, number];
}

export class Segments {
  readonly mesh: Mesh;
  #geometry = new InstancedBufferGeometry();
  #material: ShaderMaterial;
  #room = 0;
  #n = 0;

  constructor(size: Vector2, order: number) {
    this.#material = new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { size: { value: size } },
      transparent: true, depthWrite: false, side: 2,
    });
    this.#geometry.setAttribute("position", new BufferAttribute(
      new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]), 3,
    ));
    this.#geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.mesh = new Mesh(this.#geometry, this.#material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = order;
    this.#grow(256);
  }

  #values(name: string): Float32Array {
    return this.#geometry.getAttribute(name).array as Float32Array;
  }

  #grow(room: number): void {
    this.#geometry.dispose();
    for (const [name, per] of PARTS) {
      const values = new Float32Array(room * per);
      if (this.#room > 0) values.set(this.#values(name));
      const made = new InstancedBufferAttribute(values, per);
      made.setUsage(DynamicDrawUsage);
      this.#geometry.setAttribute(name, made);
    }
    this.#room = room;
  }

  begin(): void {
    this.#n = 0;
  }

  add(a: P3, b: P3, tone: Rgb, stroke: Stroke = {}): void {
    const { width = 1.3, alpha = 1, dash = [0, 0] } = stroke;
    const { widthEnd = width, alphaEnd = alpha } = stroke;
    if (this.#n === this.#room) this.#grow(this.#room * 2);
    const i = this.#n++;
    this.#values("a").set(a, 3 * i);
    this.#values("b").set(b, 3 * i);
    this.#values("ca").set([...tone, alpha], 4 * i);
    this.#values("cb").set([...tone, alphaEnd], 4 * i);
    this.#values("look").set([width, widthEnd, dash[0], dash[1]], 4 * i);
  }

  chain(points: readonly P3[], tone: Rgb, stroke: Stroke = {}, closed = false): void {
    const n = points.length;
    for (let i = 0; i < (closed ? n : n - 1); i++) {
      this.add(points[i] as P3, points[(i + 1) % n] as P3, tone, stroke);
    }
  }

  end(): void {
    for (const [name] of PARTS) {
      (this.#geometry.getAttribute(name) as InstancedBufferAttribute).needsUpdate = true;
    }
    this.#geometry.instanceCount = this.#n;
    this.mesh.visible = this.#n > 0;
  }

  dispose(): void {
    this.#geometry.dispose();
    this.#material.dispose();
  }
}
