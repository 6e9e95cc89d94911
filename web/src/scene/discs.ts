// Flat ellipses on the floor: shadows of people, and where they may be next.

import {
  BufferAttribute, DynamicDrawUsage, EqualStencilFunc, IncrementStencilOp, InstancedBufferAttribute,
  InstancedBufferGeometry, Mesh, ShaderMaterial,
} from "three";
import type { Rgb } from "../draw/palette.ts";

const VERTEX = /* glsl */ `
  attribute vec4 place; // x, y, half axes
  attribute float turn;
  attribute vec4 tone;
  uniform float height;
  varying vec2 at;
  varying vec4 ink;
  void main() {
    at = position.xy;
    ink = tone;
    vec2 p = position.xy * place.zw;
    vec2 q = vec2(cos(turn) * p.x - sin(turn) * p.y, sin(turn) * p.x + cos(turn) * p.y);
    gl_Position = projectionMatrix * viewMatrix * vec4(place.xy + q, height, 1.0);
  }`;

const FRAGMENT = /* glsl */ `
  varying vec2 at;
  varying vec4 ink;
  void main() {
    if (dot(at, at) > 1.0) discard;
    gl_FragColor = ink;
  }`;

export class Discs {
  readonly mesh: Mesh;
  #geometry = new InstancedBufferGeometry();
  #material: ShaderMaterial;
  #room = 0;
  #n = 0;

  /** With `union`, a place that several discs cover is painted once; `level` numbers the layers. */
  constructor(height: number, order: number, union: number | null = null) {
    this.#material = new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { height: { value: height } },
      transparent: true, depthWrite: false,
      ...(union === null ? {} : {
        stencilWrite: true, stencilFunc: EqualStencilFunc, stencilRef: union,
        stencilZPass: IncrementStencilOp,
      }),
    });
    this.#geometry.setAttribute("position", new BufferAttribute(
      new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3,
    ));
    this.#geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.mesh = new Mesh(this.#geometry, this.#material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = order;
    this.#grow(128);
  }

  #attribute(name: string): InstancedBufferAttribute {
    return this.#geometry.getAttribute(name) as InstancedBufferAttribute;
  }

  #grow(room: number): void {
    this.#geometry.dispose();
    for (const [name, per] of [["place", 4], ["turn", 1], ["tone", 4]] as const) {
      const values = new Float32Array(room * per);
      if (this.#room > 0) values.set(this.#attribute(name).array as Float32Array);
      const made = new InstancedBufferAttribute(values, per);
      made.setUsage(DynamicDrawUsage);
      this.#geometry.setAttribute(name, made);
    }
    this.#room = room;
  }

  begin(): void {
    this.#n = 0;
  }

  add(x: number, y: number, a: number, b: number, turn: number, tone: Rgb, alpha: number): void {
    if (this.#n === this.#room) this.#grow(this.#room * 2);
    const i = this.#n++;
    (this.#attribute("place").array as Float32Array).set([x, y, a, b], 4 * i);
    (this.#attribute("turn").array as Float32Array)[i] = turn;
    (this.#attribute("tone").array as Float32Array).set([...tone, alpha], 4 * i);
  }

  end(): void {
    for (const name of ["place", "turn", "tone"]) this.#attribute(name).needsUpdate = true;
    this.#geometry.instanceCount = this.#n;
    this.mesh.visible = this.#n > 0;
  }

  dispose(): void {
    this.#geometry.dispose();
    this.#material.dispose();
  }
}
