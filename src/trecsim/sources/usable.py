"""Which 2D poses a site can use."""

import math
from collections.abc import Iterator
from dataclasses import replace

from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.skeleton import COCO17, HALPE26
from trecsim.sources.base import Arrival
from trecsim.sources.camera_mailbox import Fault
from trecsim.values import Poses2D


def usable(
    arrivals: Iterator[Arrival[Poses2D]], rig: Rig, fault: Fault
) -> Iterator[Arrival[Poses2D]]:
    """Leave out 2D poses that cannot be used, so that one bad camera stops no other.

    Parameters
    ----------
    arrivals
        2D poses as they come.
    rig
        The cameras.
    fault
        Is told what is wrong, once for each camera.
    """
    told: set[str] = set()
    for arrived in arrivals:
        item = arrived.item
        arrival = arrived if item is None else replace(arrived, item=coco17(item))
        wrong = None if arrival.item is None else _what_is_wrong(arrival.item, rig)
        if wrong is None or arrival.item is None:
            yield arrival
        elif arrival.item.camera not in told:
            told.add(arrival.item.camera)
            fault(InputError(f"camera {arrival.item.camera!r}: {wrong}; such images are left out"))


def coco17(poses: Poses2D) -> Poses2D:
    """Return 2D poses with the joints of COCO-17, which pages and rules of sites are made for.

    They are the first of Halpe-26; other poses are returned as they are.
    """
    joints = len(COCO17.joints)
    if poses.xy_px.shape[1:] != (len(HALPE26.joints), 2):
        return poses
    return replace(poses, xy_px=poses.xy_px[:, :joints], score=poses.score[:, :joints])


def _what_is_wrong(poses: Poses2D, rig: Rig) -> str | None:
    n_joint = len(COCO17.joints)
    if poses.camera not in rig.names:
        return f"expected a camera of the rig ({', '.join(rig.names)})"
    if not math.isfinite(poses.t_s):
        return f"expected images at a finite time, found t_s = {poses.t_s}"
    people = len(poses.xy_px)
    if poses.xy_px.shape != (people, n_joint, 2) or poses.score.shape != (people, n_joint):
        return f"expected poses of {n_joint} joints, found arrays of {poses.xy_px.shape}"
    return None
