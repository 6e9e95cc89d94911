"""Conditions on moving volumes: who is about to be hit, and who is still on one."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.safety.ahead import Ahead, Expected
from trecsim.safety.conditions.base import LEAST, Judged, joints_in
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import Prism
from trecsim.safety.rule_scene import Scene
from trecsim.safety.volumes import Moving


def inside_boxes(scene: Scene, boxes: list[Prism]) -> Float64[np.ndarray, "seen joint"]:
    """Return the probability that each supported joint of seen people is in one of the boxes."""
    inside: Float64[np.ndarray, "seen joint"] = np.zeros(scene.counts.shape)
    for box in boxes:
        near = scene.near(box.polygon)
        if not len(near):
            continue
        found = box.of_joints(scene.seen[near], *scene.joints, scene.counts[near])
        inside[near] = np.maximum(inside[near], found)
    return inside


@dataclass(frozen=True, slots=True)
class NearVolume:
    """A joint that a camera supports is near a moving volume; graver: inside it.

    Attributes
    ----------
    volume
        The volume.
    distance_m
        Distance that counts as near [m].
    """

    volume: Moving
    distance_m: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        fault = self.volume.fault(scene.signals, scene.t_s)
        if fault is not None:
            return Judged({}, fault=fault)
        volume = self.volume.told(scene.signals)
        near = inside_boxes(scene, volume.boxes(scene.t_s, self.distance_m))
        hit = inside_boxes(scene, volume.boxes(scene.t_s))
        findings = {}
        for n in np.flatnonzero((near > LEAST).any(axis=1)):
            grave = float(hit[n].max())
            joints = joints_in((hit[n] if grave >= LIKELY else near[n]) >= LIKELY)
            found = Finding(float(near[n].max()), {}, graver=grave, joints=joints)
            findings[int(scene.people.id[scene.seen[n]])] = found
        return Judged(findings)

    def expect(self, ahead: Ahead, within_s: float) -> Mapping[int, Expected]:
        """Look ahead for where people and volumes will meet; see `Foreseeing`."""
        volume = self.volume.told(ahead.signals)
        boxes = [volume.boxes(ahead.t_s + s, self.distance_m) for s in ahead.ahead_s.tolist()]
        polygons = [[box.polygon for box in these] for these in boxes]
        return ahead.in_moving(polygons, volume.z_m).expected(within_s)


@dataclass(frozen=True, slots=True)
class OnVolume:
    """A joint that a camera supports is inside a moving volume that is some way on.

    Attributes
    ----------
    volume
        The volume.
    after_s
        It counts once the volume has been under way for so long [s].
    """

    volume: Moving
    after_s: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        fault = self.volume.fault(scene.signals, scene.t_s)
        if fault is not None:
            return Judged({}, fault=fault)
        volume = self.volume.told(scene.signals)
        inside = inside_boxes(scene, volume.boxes(scene.t_s, after_s=self.after_s))
        findings = {}
        for n in np.flatnonzero((inside > LEAST).any(axis=1)):
            found = Finding(float(inside[n].max()), {}, joints=joints_in(inside[n] >= LIKELY))
            findings[int(scene.people.id[scene.seen[n]])] = found
        return Judged(findings)
