"""Calibrate cameras from people who walk: extrinsics and clocks, with a verdict."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from trecsim.calibrating.people.camera_records import CameraRecord, records
from trecsim.calibrating.people.finding import find
from trecsim.calibrating.people.found import Found
from trecsim.calibrating.people.holding_out import parts
from trecsim.calibrating.people.judging import Evidence, findings, inflation
from trecsim.calibrating.people.kernels.residuals import residuals
from trecsim.calibrating.people.pose_uncertainty import clock_sd, pose_covariance, rig_of
from trecsim.calibrating.people.priors import Distance
from trecsim.calibrating.people.scale import Scale, from_distance, from_stature
from trecsim.calibrating.people.shortcomings import refuse, unrelated
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.steadiness import steps
from trecsim.calibrating.people.tuning import ANKLE, DRIFT_PPM, STATURE_M
from trecsim.calibrating.people.world import Bodies, bodies, by_clock_of, in_the_room
from trecsim.calibrating.result import CalibrationResult, CameraQuality, judge
from trecsim.calibrating.room_error import PoseCovariance
from trecsim.errors import CalibrationError
from trecsim.geometry import Rig
from trecsim.values import Poses2D

EXACT_M = 0.002  # a tape measure


@dataclass(frozen=True, slots=True, eq=False)
class PeopleCalibration:
    """A rig calibrated from people.

    Attributes
    ----------
    rig
        The cameras that were found.
    result
        Of all cameras, with the verdict.
    covariance
        Of the poses of `rig`, inflated by what parts of the recording say against each other.
    found
        How it was found.
    """

    rig: Rig
    result: CalibrationResult
    covariance: PoseCovariance
    found: Found


def calibrate_people(
    poses: Iterable[Poses2D],
    cameras: Rig,
    *,
    distance: tuple[str, str, float] | None = None,
    stature_m: float | None = None,
) -> PeopleCalibration:
    """Return poses and clocks of cameras from the people who walk before them.

    Nobody needs to be known by name: people are matched between the cameras by their ways.

    Parameters
    ----------
    poses
        2D poses of a recording, in any order.
    cameras
        The intrinsics; poses in it are ignored.
    distance
        Two cameras and how far they stand apart [m].
    stature_m
        Mean stature of the people [m].

    Raises
    ------
    CalibrationError
        No rig can be computed; the message says what the recording lacks.
    """
    known = _distance(cameras, distance, stature_m)
    recorded = records(poses, cameras)
    refuse(recorded)
    found = find(recorded, distance=known)
    if found is None:
        raise _wrong_distance(recorded, cameras, known) or unrelated(recorded)
    return told(found, recorded, cameras, distance, stature_m)


def told(
    found: Found,
    recorded: tuple[CameraRecord, ...],
    cameras: Rig,
    distance: tuple[str, str, float] | None,
    stature_m: float | None,
) -> PeopleCalibration:
    """Return what was found in the frame of the room, with its verdict."""
    seen_bodies = bodies(found.seen, found.rig.unknowns)
    scale = _scale(found, cameras, seen_bodies, distance, stature_m)
    stature = scale.factor * seen_bodies.mean_stature_m
    floor_m = ANKLE * (stature if np.isfinite(stature) else STATURE_M)
    state = in_the_room(found.rig.state, seen_bodies, scale.factor, floor_m)
    ref_s = _middle_s(recorded)
    which = np.flatnonzero(state.found)
    state = by_clock_of(_steadied(state, found), int(which[0]), ref_s)
    rig = rig_of(state, cameras)
    compared = parts(found, recorded, cameras)
    factor = inflation(compared)
    raw = pose_covariance(found.rig, found.priors.own, which)
    covariance = _in_metres(raw, rig, scale, factor)
    sd_deg = np.degrees(
        [np.sqrt(np.trace(covariance.rotation(i)) / 3.0) for i in range(len(which))]
    )
    evidence = Evidence(
        cameras.names, found, compared, steps(found), sd_deg, scale, recall_of(found)
    )  # fmt: skip
    verdict, reasons = judge(list(findings(evidence)))
    qualities = _qualities(found, state, cameras, covariance)
    return PeopleCalibration(
        rig, CalibrationResult(qualities, verdict, reasons, ref_s), covariance, found
    )


def _distance(
    cameras: Rig, distance: tuple[str, str, float] | None, stature_m: float | None
) -> Distance | None:
    if stature_m is not None and not 0.5 <= stature_m <= 2.5:
        raise CalibrationError(
            f"the mean stature must be from 0.5 to 2.5 m, got {stature_m:g} m; give metres"
        )
    if distance is None:
        return None
    a, b, metres = distance
    first, second = cameras.index(a), cameras.index(b)
    if first == second or not 0.01 <= metres <= 1000.0:
        raise CalibrationError(
            "the distance needs two different cameras and 0.01 to 1000 m, got "
            f"{a!r}, {b!r}, {metres:g} m"
        )
    return Distance(first, second, metres, EXACT_M)


def _wrong_distance(
    recorded: tuple[CameraRecord, ...], cameras: Rig, given: Distance | None
) -> CalibrationError | None:
    """Return that the given distance fits nobody's size, if a rig is found without it."""
    found = find(recorded) if given is not None else None
    if given is None or found is None or not found.rig.state.found[[given.a, given.b]].all():
        return None
    scale = from_stature(bodies(found.seen, found.rig.unknowns), None)
    centre_m = scale.factor * found.rig.state.centre_m
    apart_m = float(np.linalg.norm(centre_m[given.a] - centre_m[given.b]))
    a, b = (cameras.names[n] for n in (given.a, given.b))
    return CalibrationError(
        f"with {a!r} and {b!r} {given.metres:g} m apart nobody is of a usual size; by the people's "
        f"stature they are about {apart_m:.1f} m apart: is the distance in metres, and between "
        "these two cameras?"
    )


def _scale(
    found: Found,
    cameras: Rig,
    seen_bodies: Bodies,
    distance: tuple[str, str, float] | None,
    stature_m: float | None,
) -> Scale:
    """Return the scale by the given distance if both its cameras were found, else by the people."""
    if distance is not None:
        pair = {cameras.index(distance[0]), cameras.index(distance[1])}
        if any({one.a, one.b} == pair for one in found.priors.distances):
            return from_distance(distance[2])
    return from_stature(seen_bodies, stature_m)


def _middle_s(recorded: tuple[CameraRecord, ...]) -> float:
    stamps = [t for record in recorded if len(record.t_s) for t in record.t_s[[0, -1]]]
    return 0.5 * float(min(stamps) + max(stamps))


def _steadied(state: RigState, found: Found) -> RigState:
    """Return the state with drifts drawn to nothing as far as the recording does not show them."""
    _, sd = clock_sd(found.rig, found.priors.own)
    steady = state.copy()
    usual = 1e-6 * DRIFT_PPM
    for c in np.flatnonzero(state.found):
        drift = state.clock[c, 1]
        spread = max(usual, abs(drift)) if abs(drift) > 4.0 * max(sd[c], usual) else usual
        steady.clock[c, 1] = drift * spread**2 / (spread**2 + sd[c] ** 2)
    return steady


def _in_metres(raw: PoseCovariance, rig: Rig, scale: Scale, factor: float) -> PoseCovariance:
    """Return the covariance in metres, without the common motion, inflated, with the scale's."""
    n = len(rig)
    unit = np.tile([1.0] * 3 + [scale.factor] * 3, n)
    grown = PoseCovariance(factor**2 * raw.matrix * unit[:, None] * unit[None, :])
    left = grown.without_common_motion(rig).matrix
    centre = np.array([camera.position_m for camera in rig])
    spread = np.zeros((n, 6))
    spread[:, 3:] = scale.sd * (centre - centre.mean(axis=0))
    return PoseCovariance(left + np.outer(spread.ravel(), spread.ravel()))


def recall_of(found: Found) -> float:
    """Return the share of what cameras saw of people that is matched between them."""
    seconds = np.array([np.ptp(one.t_s) for one in found.tracks])
    of_found = np.array([found.priors.found[one.camera] for one in found.tracks])
    total = float(seconds[of_found].sum())
    return float(seconds[found.chain >= 0].sum()) / total if total else 0.0


def _qualities(
    found: Found, state: RigState, cameras: Rig, covariance: PoseCovariance
) -> tuple[CameraQuality, ...]:
    sights = found.seen.sights
    n = len(sights.cam)
    off_m, depth_m, weight = np.zeros((n, 2)), np.ones(n), np.zeros(n)
    residuals(sights, found.rig.unknowns, off_m, depth_m, weight)
    qualities = []
    place = 0
    for c, camera in enumerate(cameras):
        if not state.found[c]:
            qualities.append(CameraQuality(camera.name))
            continue
        own = (sights.cam == c) & (weight > 0.1)
        px = np.linalg.norm(off_m[own], axis=1) / depth_m[own] * sights.focal_px[c]
        qualities.append(
            CameraQuality(
                camera.name,
                float(np.degrees(np.sqrt(np.trace(covariance.rotation(place)) / 3.0))),
                float(np.sqrt(np.trace(covariance.position(place)) / 3.0)),
                float(state.clock[c, 0]),
                float(1e6 * state.clock[c, 1]),
                float(np.sqrt((px**2).mean())) if len(px) else float("nan"),
            )
        )
        place += 1
    return tuple(qualities)
