"""Run inside Blender: opens a BVH or glTF file and prints where its joints are, frame by frame.

blender --background --factory-startup --python blender_reader.py -- FILE FRAME...
"""

import json
import sys

import bpy

path, *frames = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.wm.read_factory_settings(use_empty=True)
if path.endswith(".bvh"):
    from io_anim_bvh import import_bvh

    # Blender 3.4 opens it with the mode rU, which Python 3.11 has no more.
    import_bvh.open = lambda name, mode: open(name)  # noqa: SIM115
    bpy.ops.import_anim.bvh(
        filepath=path, global_scale=1.0, axis_forward="-Z", axis_up="Y", update_scene_fps=True
    )
else:
    import numpy as np

    np.bool = bool  # the importer of Blender 3.4 wants it; NumPy 1.24 has it no more
    bpy.ops.import_scene.gltf(filepath=path)
scene = bpy.context.scene
fps = scene.render.fps / scene.render.fps_base
places = []
for text in frames:
    # BVH: a frame is a frame. glTF: times, at the rate of the scene.
    at = float(text) + 1.0 if path.endswith(".bvh") else float(text) * fps
    scene.frame_set(int(at), subframe=at - int(at))
    found = {}
    for thing in bpy.data.objects:
        if thing.type == "ARMATURE":
            for bone in thing.pose.bones:
                place, _, scale = (thing.matrix_world @ bone.matrix).decompose()
                found[bone.name] = [*place, min(scale)]
        else:
            place, _, scale = thing.matrix_world.decompose()
            found[thing.name] = [*place, min(scale)]
    places.append(found)
print("PLACES " + json.dumps(places))
