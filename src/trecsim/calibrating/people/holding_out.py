"""Parts of a recording against each other: halves of the time, people, cameras left out."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.people.adjusting import Adjusted, adjusted
from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.found import Found
from trecsim.calibrating.people.observations import Observations, observations
from trecsim.calibrating.people.pose_uncertainty import (
    clock_sd,
    pose_covariance,
    rig_of,
    turned_between,
)
from trecsim.calibrating.people.priors import Distance
from trecsim.geometry import Rig

SHORTEST_S = 6.0  # of a recording that is halved
FEWEST = 300  # observations of a part


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The rig from a part of the recording, beside another one.

    Attributes
    ----------
    kind, name
        ``"time"``, ``"person"`` or ``"camera"``, and which.
    cameras
        Numbers of the cameras compared.
    turn_deg
        How far each is turned between the two [degrees].
    expected_deg
        What the covariance lets expect, root mean square [degrees].
    late_s, expected_late_s
        Of halves, how far each clock differs between the two at the middle of the recording, most
        clocks taken to be right, and the largest standard deviation of that [s].
    """

    kind: str
    name: str
    cameras: Int64[np.ndarray, " found"]
    turn_deg: Float64[np.ndarray, " found"]
    expected_deg: Float64[np.ndarray, " found"]
    late_s: Float64[np.ndarray, " found"] = field(default_factory=lambda: np.zeros(0))
    expected_late_s: float = np.inf


def parts(found: Found, records: tuple[CameraRecord, ...], cameras: Rig) -> list[Part]:
    """Return what parts of the recording say of the cameras, beside the whole or each other."""
    return [
        *_halves(found, records, cameras),
        *_without_people(found, records, cameras),
        *_without_cameras(found, records, cameras),
    ]


def halves(found: Found, records: tuple[CameraRecord, ...]) -> tuple[Observations, ...]:
    """Return the halves of a recording; nothing where one of them shows too little."""
    t_s = found.seen.t_s
    if not len(t_s) or np.ptp(t_s) < SHORTEST_S:
        return ()
    middle_s = float(np.median(t_s))
    both = tuple(
        observations(found.tracks, records, found.chain, found.rig.state, between=between)
        for between in ((-np.inf, middle_s), (middle_s, np.inf))
    )
    wanted = int(found.priors.found.sum())
    enough = (one.count >= FEWEST and len(np.unique(one.sights.cam)) >= wanted for one in both)
    return both if all(enough) else ()


def _halves(found: Found, records: tuple[CameraRecord, ...], cameras: Rig) -> Iterator[Part]:
    both = halves(found, records)
    if not both:
        return
    refitted = [adjusted(seen, found.rig.state, found.priors, annealing=(1.0,)) for seen in both]
    which = np.flatnonzero(found.priors.found)
    own = found.priors.own
    variance = sum(
        (_own_variance(half, own, which, cameras) for half in refitted), np.zeros(len(which))
    )
    turn = turned_between(refitted[0].state, refitted[1].state, which)
    late_s = np.subtract(*(half.state.clock[which, 0] for half in refitted))
    late_s = late_s - (np.median(late_s) if len(which) > 2 else late_s[0])
    sd_s = np.hypot(*(clock_sd(half, own)[0][which] for half in refitted))
    part = _part("time", "the halves", which, turn, variance)
    yield replace(part, late_s=late_s, expected_late_s=float(sd_s.max()))


def _without_people(
    found: Found, records: tuple[CameraRecord, ...], cameras: Rig
) -> Iterator[Part]:
    people = int(found.chain.max(initial=-1)) + 1
    if people < 2:
        return
    counts = np.array([
        np.diff(found.seen.sights.point_first)[found.seen.person == k].sum() for k in range(people)
    ])  # fmt: skip
    which = np.flatnonzero(found.priors.found)
    for k in np.argsort(-counts)[:4]:
        chain = np.where(found.chain == k, -1, found.chain)
        seen = observations(found.tracks, records, chain, found.rig.state)
        if seen.count < FEWEST or len(np.unique(seen.sights.cam)) < len(which):
            continue
        part = adjusted(seen, found.rig.state, found.priors, annealing=(1.0,))
        variance = _own_variance(part, found.priors.own, which, cameras)
        turn = turned_between(found.rig.state, part.state, which)
        yield _part("person", f"person {k + 1}", which, turn, variance)


def _without_cameras(
    found: Found, records: tuple[CameraRecord, ...], cameras: Rig
) -> Iterator[Part]:
    known = np.flatnonzero(found.priors.found)
    if len(known) < 3 or len(known) > 6:
        return
    centre = found.rig.state.centre_m
    for out in known:
        which = known[known != out]
        chain = found.chain.copy()
        for k, track in enumerate(found.tracks):
            if track.camera == out:
                chain[k] = -1
        seen = observations(found.tracks, records, chain, found.rig.state)
        if seen.count < FEWEST or len(np.unique(seen.sights.cam)) < len(which):
            continue
        a, b = _furthest(centre, which)
        apart_m = float(np.linalg.norm(centre[a] - centre[b]))
        mask = found.priors.found.copy()
        mask[out] = False
        root = found.priors.root if found.priors.root != out else int(which[0])
        priors = replace(
            found.priors, found=mask, root=root,
            distances=(Distance(a, b, apart_m, 1e-4 * apart_m),),
        )  # fmt: skip
        part = adjusted(seen, found.rig.state, priors, annealing=(1.0,))
        variance = _own_variance(part, found.priors.own, which, cameras)
        turn = turned_between(found.rig.state, part.state, which)
        yield _part("camera", cameras.names[out], which, turn, variance)


def _furthest(centre: Float64[np.ndarray, "cam 3"], which: np.ndarray) -> tuple[int, int]:
    pairs = [(int(a), int(b)) for i, a in enumerate(which) for b in which[i + 1 :]]
    return max(pairs, key=lambda pair: float(np.linalg.norm(centre[pair[0]] - centre[pair[1]])))


def _own_variance(part: Adjusted, own: int, which: np.ndarray, cameras: Rig) -> np.ndarray:
    """Return the variance of each camera's turn, without the common motion [rad^2]."""
    state = part.state.copy()
    state.found[:] = False
    state.found[which] = True
    rig = rig_of(state, cameras)
    left = pose_covariance(part, own, which).without_common_motion(rig)
    return np.array([np.trace(left.rotation(i)) for i in range(len(which))])


def _part(kind: str, name: str, which: np.ndarray, turn: np.ndarray, variance: np.ndarray) -> Part:
    return Part(
        kind, name, which, np.degrees(np.linalg.norm(turn, axis=1)), np.degrees(np.sqrt(variance))
    )
