// Reads a glTF file with three.js; prints where the named nodes are at some times.
// node three_reader.mjs THREE_FOLDER FILE TIMES_AS_JSON

import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [folder, file, times] = process.argv.slice(2);
const load = (name) => import(pathToFileURL(`${folder}/${name}`).href);
const { AnimationMixer, Vector3 } = await load("build/three.module.js");
const { GLTFLoader } = await load("examples/jsm/loaders/GLTFLoader.js");
globalThis.self = globalThis;
const bytes = readFileSync(file);
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
new GLTFLoader().parse(buffer, "", (gltf) => {
  const mixer = new AnimationMixer(gltf.scene);
  mixer.clipAction(gltf.animations[0]).play();
  const told = JSON.parse(times).map((time) => {
    mixer.setTime(time);
    gltf.scene.updateMatrixWorld(true);
    const nodes = {};
    gltf.scene.traverse((node) => {
      if (!node.isBone) return;
      const scale = Math.hypot(...node.matrixWorld.elements.slice(0, 3));
      nodes[node.name] = [...node.getWorldPosition(new Vector3()).toArray(), scale];
    });
    return nodes;
  });
  console.log(JSON.stringify(told));
}, (error) => { throw error; });
