"""Animated glTF in one binary file: a skinned skeleton per person, y up, metres.

Each joint is a node whose translation is animated at the recorded times, so a viewer shows the
tracks themselves, not a fit. Joints never rotate; the skin is three crossed ribbons per limb and an
octahedron per joint, which look the same from everywhere. Who is absent is scaled to nothing.
"""

import json
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Shaped

from trecsim.errors import InputError
from trecsim.export.axes import y_up
from trecsim.export.base import About
from trecsim.export.held import held, visible_changes
from trecsim.export.motions import Motion, PersonMotion
from trecsim.export.person_colours import rgb
from trecsim.skeleton import Skeleton

_RIBBON_M, _JOINT_M = 0.012, 0.03  # half the width of a limb, radius of a joint
_FLOAT, _USHORT, _UBYTE = 5126, 5123, 5121
_KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_MOST_BYTES = (1 << 32) - (1 << 16)


def write_glb(motion: Motion, path: Path, about: About) -> None:
    """Write everybody as one animated scene."""
    scene = _Scene()
    mesh = _Mesh.of(about.skeleton, scene)
    for one in motion.people:
        _add_person(scene, one, motion, mesh, about.skeleton)
    with path.open("wb") as file:
        for chunk in scene.chunks(motion.t0_s):
            file.write(chunk)


@dataclass(slots=True)
class _Scene:
    accessors: list[dict[str, Any]] = field(default_factory=list)
    views: list[dict[str, Any]] = field(default_factory=list)
    blobs: list[bytes] = field(default_factory=list)
    length: int = 0
    nodes: list[dict[str, Any]] = field(default_factory=list)
    roots: list[int] = field(default_factory=list)
    meshes: list[dict[str, Any]] = field(default_factory=list)
    materials: list[dict[str, Any]] = field(default_factory=list)
    skins: list[dict[str, Any]] = field(default_factory=list)
    channels: list[dict[str, Any]] = field(default_factory=list)
    samplers: list[dict[str, Any]] = field(default_factory=list)

    def accessor(self, values: Shaped[np.ndarray, "..."], *, bounds: bool = False) -> int:
        """Store numbers; return the index of their accessor."""
        kinds = {"f": _FLOAT, "u": _USHORT if values.dtype.itemsize == 2 else _UBYTE}
        blob = np.ascontiguousarray(values).tobytes()
        blob += b"\0" * (-len(blob) % 4)
        flat = values.reshape(len(values), -1)
        entry: dict[str, Any] = {
            "bufferView": len(self.views),
            "componentType": kinds[values.dtype.kind],
            "count": len(flat),
            "type": _KINDS[flat.shape[1]],
        }
        if bounds:
            entry |= {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        self.views.append({"buffer": 0, "byteOffset": self.length, "byteLength": len(blob)})
        self.blobs.append(blob)
        self.length += len(blob)
        if self.length > _MOST_BYTES:
            raise InputError("a GLB file holds at most 4 GB; export one --person at a time")
        self.accessors.append(entry)
        return len(self.accessors) - 1

    def node(self, **entry: Any) -> int:
        """Add a node; return its index."""
        self.nodes.append(entry)
        return len(self.nodes) - 1

    def animate(self, node: int, what: str, times: int, values: int, how: str = "LINEAR") -> None:
        """Animate a property of a node."""
        target = {"node": node, "path": what}
        self.channels.append({"sampler": len(self.samplers), "target": target})
        self.samplers.append({"input": times, "output": values, "interpolation": how})

    def chunks(self, t0_s: float) -> list[bytes]:
        """Return the content of the file."""
        parts = {
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "skins": self.skins,
            "accessors": self.accessors,
            "bufferViews": self.views,
        }
        document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "trecsim"},
            "scene": 0,
            "scenes": [{"nodes": self.roots, "extras": {"first_time_s": t0_s}}],
            **{name: part for name, part in parts.items() if part},
            "buffers": [{"byteLength": self.length}],
        }
        if self.channels:
            document["animations"] = [
                {"name": "tracks", "channels": self.channels, "samplers": self.samplers}
            ]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        whole = 12 + 8 + len(text) + 8 + self.length
        return [
            struct.pack("<4sII", b"glTF", 2, whole),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", self.length, b"BIN\0"),
            *self.blobs,
        ]


@dataclass(frozen=True, slots=True)
class _Mesh:
    """Accessors that all people share."""

    attributes: dict[str, int]
    indices: int
    inverse_binds: int

    @classmethod
    def of(cls, skeleton: Skeleton, scene: _Scene) -> "_Mesh":
        corners: list[tuple[float, ...]] = []
        joints: list[int] = []
        faces: list[tuple[int, int, int]] = []
        axes = np.eye(3)
        for a, b in skeleton.limbs:
            for axis in axes * _RIBBON_M:
                n = len(corners)
                corners += [tuple(-axis), tuple(axis), tuple(axis), tuple(-axis)]
                joints += [a, a, b, b]
                faces += [(n, n + 1, n + 2), (n, n + 2, n + 3)]
        for joint in range(len(skeleton.joints)):
            n = len(corners)
            corners += [tuple(sign * axis) for axis in axes * _JOINT_M for sign in (1.0, -1.0)]
            joints += [joint] * 6
            faces += [
                (n + x, n + y, n + z) if (x + y + z) % 2 == 0 else (n + x, n + z, n + y)
                for x in (0, 1) for y in (2, 3) for z in (4, 5)
            ]  # fmt: skip
        owners = np.zeros((len(joints), 4), np.uint8)
        owners[:, 0] = joints
        weights = np.zeros((len(joints), 4), np.float32)
        weights[:, 0] = 1.0
        binds = np.broadcast_to(np.eye(4, dtype=np.float32), (len(skeleton.joints), 4, 4))
        return cls(
            {
                "POSITION": scene.accessor(np.array(corners, np.float32), bounds=True),
                "JOINTS_0": scene.accessor(owners),
                "WEIGHTS_0": scene.accessor(weights),
            },
            scene.accessor(np.array(faces, np.uint16).reshape(-1, 1)),
            scene.accessor(binds.reshape(-1, 16)),
        )


def _add_person(
    scene: _Scene, one: PersonMotion, motion: Motion, mesh: _Mesh, skeleton: Skeleton
) -> None:
    name = f"person_{one.person}"
    positions = np.ascontiguousarray(y_up(held(one.xyz_m)).transpose(1, 0, 2))
    joints = [
        scene.node(name=f"{name}_{joint}", translation=positions[number, 0].tolist())
        for number, joint in enumerate(skeleton.joints)
    ]
    root = scene.node(name=name, children=joints, extras={"person": one.person})
    scene.skins.append(
        {"joints": joints, "inverseBindMatrices": mesh.inverse_binds, "skeleton": root}
    )
    scene.materials.append(
        {
            "name": name,
            "doubleSided": True,
            "pbrMetallicRoughness": {
                "baseColorFactor": [*(round(part**2.2, 4) for part in rgb(one.person)), 1.0],
                "metallicFactor": 0.0,
                "roughnessFactor": 0.9,
            },
        }
    )
    primitive = {
        "attributes": mesh.attributes,
        "indices": mesh.indices,
        "material": len(scene.materials) - 1,
    }
    scene.meshes.append({"name": name, "primitives": [primitive]})
    skin = scene.node(name=f"{name}_body", mesh=len(scene.meshes) - 1, skin=len(scene.skins) - 1)
    scene.roots += [root, skin]
    times = scene.accessor((one.t_s - motion.t0_s).astype(np.float32)[:, None], bounds=True)
    for number, joint in enumerate(joints):
        scene.animate(joint, "translation", times, scene.accessor(positions[number]))
    known = one.known
    _hide(scene, root, one, one.present, motion, from_the_start=True)
    for number, joint in enumerate(joints):
        if not known[one.present, number].all():
            _hide(scene, joint, one, known[:, number], motion)


def _hide(
    scene: _Scene,
    node: int,
    one: PersonMotion,
    there: np.ndarray,
    motion: Motion,
    from_the_start: bool = False,
) -> None:
    """Scale a node to nothing where it is not known."""
    keys = list(visible_changes(there, one.t_s, motion.longest_step_s))
    if from_the_start and one.t_s[0] > motion.t0_s:
        keys.insert(0, (motion.t0_s, False))
    times = np.array([[at - motion.t0_s] for at, _ in keys], np.float32)
    scale = np.array([[float(shown)] * 3 for _, shown in keys], np.float32)
    scene.animate(node, "scale", scene.accessor(times, bounds=True), scene.accessor(scale), "STEP")
