"""Draw what other tools make of exported tracks: glTF and BVH in three.js, joint angles.

Needs three.js, as the build of the operator page installs it, and Chromium.

Run: ``python benchmarks/tool_pictures.py [THREE_FOLDER]``
"""

import functools
import http.server
import shutil
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np

from film_pictures import run
from harness.machine import ROOT

SCENE, SEED, SECONDS, AT_S = "crossing-50cm", 3, 12.0, 2.0
PICTURES = ROOT / "docs" / "pictures"
THREE = ROOT / "web" / "node_modules" / "three"
SIZE = (1280, 470)
PAGE = """<!doctype html><html><head><style>body{margin:0;display:flex;background:#f7f8f9}
figure{margin:0;position:relative}p{position:absolute;left:14px;top:6px;margin:0;font:17px sans-serif;color:#5b656e}</style>
<script type="importmap">{"imports":{"three":"./three/build/three.module.js"}}</script></head>
<body><figure><p>walk.glb</p><canvas id="glb" width="640" height="470"></canvas></figure>
<figure><p>walk_0.bvh and walk_1.bvh</p><canvas id="bvh" width="640" height="470"></canvas></figure>
<script type="module">
import * as T from "three";
import { GLTFLoader } from "./three/examples/jsm/loaders/GLTFLoader.js";
import { BVHLoader } from "./three/examples/jsm/loaders/BVHLoader.js";
const [at, x, z] = [AT, MIDDLE_X, MIDDLE_Z];
function stage(id) {
  const renderer = new T.WebGLRenderer({ canvas: document.getElementById(id), antialias: true });
  const scene = new T.Scene();
  scene.background = new T.Color(0xf7f8f9);
  scene.add(new T.HemisphereLight(0xffffff, 0xb9c1c7, 3));
  const grid = new T.GridHelper(8, 8, 0xb9c1c7, 0xd3d8dc);
  grid.position.set(x, 0, z);
  scene.add(grid);
  const camera = new T.PerspectiveCamera(34, 640 / 470, 0.1, 100);
  camera.position.set(x + 1.6, 1.9, z + 4.4);
  camera.lookAt(x, 0.85, z);
  return { scene, draw: () => renderer.render(scene, camera) };
}
const one = stage("glb");
const gltf = await new GLTFLoader().loadAsync("walk.glb");
const mixer = new T.AnimationMixer(gltf.scene);
mixer.clipAction(gltf.animations[0]).play();
mixer.setTime(at);
gltf.scene.traverse((node) => { node.frustumCulled = false; });
one.scene.add(gltf.scene);
one.draw();
const two = stage("bvh");
for (const [person, colour] of [[0, 0x0072b2], [1, 0xd55e00]]) {
  const { skeleton, clip } = await new BVHLoader().loadAsync(`walk_${person}.bvh`);
  const root = skeleton.bones[0];
  const player = new T.AnimationMixer(root);
  player.clipAction(clip).play();
  player.setTime(at);
  const helper = new T.SkeletonHelper(root);
  helper.material.color = new T.Color(colour);
  helper.material.vertexColors = false;
  helper.material.linewidth = 2;
  two.scene.add(root, helper);
  for (const bone of skeleton.bones) {
    const ball = new T.Mesh(new T.SphereGeometry(0.022), new T.MeshLambertMaterial({ color: colour }));
    bone.add(ball);
  }
}
two.scene.updateMatrixWorld(true);
two.draw();
document.title = "drawn";
</script></body></html>"""  # noqa: E501


def main() -> int:
    """Draw both pictures; return the exit status."""
    three = Path(sys.argv[1]) if sys.argv[1:] else THREE
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scene = folder / "scene"
        tracks = scene / "tracks.parquet"
        run("simulate", SCENE, "--out", scene, "--seconds", SECONDS, "--seed", SEED)
        run("track", scene / "rig.toml", scene / "poses.jsonl", "--out", tracks, "--lag-s", 0.2)
        for ending in (".glb", ".bvh", ".angles.csv"):
            run("export", tracks, folder / f"walk{ending}", "--butterworth-hz", 6)
        draw_angles(folder / "walk.angles.csv", PICTURES / "joint-angles.svg")
        draw_in_three(folder, tracks, three, PICTURES / "three.png")
    return 0


def draw_in_three(folder: Path, tracks: Path, three: Path, out: Path) -> None:
    """Let Chromium draw the glTF and the BVH files with three.js."""
    from playwright.sync_api import sync_playwright

    from trecsim.floor_points import floor_xy
    from trecsim.store.tracks import read_tracks

    (folder / "three").symlink_to(three.resolve())
    there = next(one for one in read_tracks(tracks) if one.t_s >= AT_S)
    x_m, y_m = floor_xy(there.xyz_m, there.support).mean(axis=0)
    page = PAGE.replace("AT,", f"{AT_S},", 1).replace("MIDDLE_X", f"{x_m:.2f}")
    (folder / "index.html").write_text(page.replace("MIDDLE_Z", f"{-y_m:.2f}"), encoding="utf-8")
    handler = functools.partial(_Quiet, directory=str(folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    flags = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=flags)
        view = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
        view.on("console", lambda message: print(message.text, file=sys.stderr))
        view.goto(f"http://127.0.0.1:{server.server_address[1]}/index.html")
        view.wait_for_function("document.title === 'drawn'", timeout=60_000)
        view.screenshot(path=str(out))
        browser.close()
    server.shutdown()


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Say nothing about requests."""


def draw_angles(table: Path, out: Path) -> None:
    """Draw the knee and hip flexion of one person over time."""
    from matplotlib.figure import Figure

    from trecsim.export.person_colours import COLOURS

    names = table.read_text(encoding="utf-8").partition("\n")[0].split(",")
    rows = np.genfromtxt(table, delimiter=",", skip_header=1)
    rows = rows[rows[:, 1] == rows[0, 1]]
    figure = Figure(figsize=(9.0, 2.6), layout="constrained")
    for place, part in enumerate(("knee", "hip"), 1):
        axes = figure.add_subplot(1, 2, place)
        for side, colour in (("left", COLOURS[0]), ("right", COLOURS[1])):
            column = names.index(f"{side}_{part}_flexion_deg")
            axes.plot(rows[:, 0], rows[:, column], color=colour, label=side)
        axes.set(xlabel="time [s]", ylabel=f"{part} flexion [degrees]", xlim=(2.0, 7.0))
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, loc="upper right")
    figure.savefig(out, metadata={"Date": None})


if __name__ == "__main__":
    sys.exit(main())
