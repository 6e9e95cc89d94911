"""A rig repaired: the cameras as they stand at the end of a recording of people."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from trecsim.calibrating.people.agreeing import dense, displaced_deg
from trecsim.calibrating.people.checking import Check, check_rig
from trecsim.calibrating.people.kernels.residuals import residuals
from trecsim.calibrating.people.pose_uncertainty import pose_covariance
from trecsim.calibrating.people.refitting import Refit, refit
from trecsim.calibrating.people.tuning import AGREE_DEG, DRIFT_PPM
from trecsim.calibrating.result import CalibrationResult, CameraQuality, Finding, judge
from trecsim.geometry import Camera, Rig
from trecsim.values import Poses2D

SHORT_S = 10.0
APART_DEG = 0.5  # halves of a recording that differ by more contradict each other


@dataclass(frozen=True, slots=True, eq=False)
class Repair:
    """A repaired rig.

    Attributes
    ----------
    rig
        All cameras of the given one, those that nobody was seen in as they were.
    result
        How far it can be trusted.
    check
        What was wrong.
    """

    rig: Rig
    result: CalibrationResult
    check: Check


def repair_rig(poses: Iterable[Poses2D], rig: Rig) -> Repair:
    """Return a rig as it is at the end of a recording of people.

    Cameras that agree with each other hardly change; the others are fitted to what they see. The
    frame and the scale stay those of the given rig.

    Parameters
    ----------
    poses
        2D poses of a recording, in any order.
    rig
        The cameras as they were.

    Raises
    ------
    CalibrationError
        Too few people are seen by two cameras; the message says how to record.
    """
    check = check_rig(poses, rig)
    end = check.end
    known = np.isin(np.arange(len(rig)), end.seen.sights.cam)
    cameras = tuple(
        _repaired(camera, end, c) if known[c] else camera for c, camera in enumerate(rig)
    )
    qualities = tuple(_qualities(rig, end, known))
    ref_s = float(np.median(end.seen.t_s))
    verdict, reasons = judge(list(_findings(check, known, rig)))
    return Repair(Rig(cameras), CalibrationResult(qualities, verdict, reasons, ref_s), check)


def _repaired(camera: Camera, end: Refit, c: int) -> Camera:
    """Return a camera as it is now; its clock keeps the drift that the rig states."""
    return replace(
        camera,
        T_cam_world=end.rig.state.T[c],
        time_offset_s=camera.time_offset_s + float(end.late_s[c]),
    )


def _qualities(rig: Rig, end: Refit, known: np.ndarray) -> Iterator[CameraQuality]:
    which = np.flatnonzero(known)
    covariance = pose_covariance(end.rig, end.own, which)
    sights = end.seen.sights
    n = len(sights.cam)
    off_m, depth_m, weight = np.zeros((n, 2)), np.ones(n), np.zeros(n)
    residuals(sights, end.rig.unknowns, off_m, depth_m, weight)
    for c, camera in enumerate(rig):
        if not known[c]:
            yield CameraQuality(camera.name)
            continue
        place = int(np.flatnonzero(which == c)[0])
        own = (sights.cam == c) & (weight > 0.1)
        px = np.linalg.norm(off_m[own], axis=1) / depth_m[own] * sights.focal_px[c]
        yield CameraQuality(
            camera.name,
            float(np.degrees(np.sqrt(np.trace(covariance.rotation(place)) / 3.0))),
            float(np.sqrt(np.trace(covariance.position(place)) / 3.0)),
            camera.time_offset_s + float(end.late_s[c]),
            camera.time_drift_ppm,
            float(np.sqrt((px**2).mean())) if len(px) else float("nan"),
        )


def _findings(check: Check, known: np.ndarray, rig: Rig) -> Iterator[Finding]:
    end = check.end
    for one in check.cameras:
        if one.ok is False:
            yield Finding(
                "good",
                f"{one.name!r} was off by {one.rotation_deg:.2f} degrees, "
                f"{100 * one.shift_m:.1f} cm and {1e3 * one.time_offset_s:.0f} ms",
            )
    if not check.off:
        yield Finding("good", "no camera was off")
    lost = [name for name, there in zip(rig.names, known, strict=True) if not there]
    if lost:
        yield Finding(
            "usable", f"{', '.join(map(repr, lost))} stayed as it was: nobody was seen there"
        )
    left = displaced_deg(
        dense(end.seen, len(rig)), end.rig.state.T, tuple(map(int, np.flatnonzero(known)))
    )
    if np.isfinite(left).all() and left.max() > AGREE_DEG:
        yield Finding(
            "wrong",
            f"after the repair cameras still disagree by {left.max():.2f} degrees: calibrate again",
        )
    seconds = float(np.ptp(end.seen.t_s))
    if seconds < SHORT_S:
        yield Finding(
            "usable",
            f"the repair rests on {seconds:.1f} s of people: record 30 s of people who walk over "
            "the whole floor",
        )
    else:
        yield from _halves(check)
    disagree = int((~end.agrees & known).sum())
    if disagree >= known.sum() - 1 and disagree:
        yield Finding(
            "usable",
            "fewer than two cameras agree as the rig has them: which are right cannot be told, the "
            "frame is their mean",
        )
    if any(abs(camera.time_drift_ppm) > 10 * DRIFT_PPM for camera in rig):
        yield Finding("good", "drifts of clocks were kept")


def _halves(check: Check) -> Iterator[Finding]:
    middle_s = float(np.median(check.end.seen.t_s))
    first = refit(check.scene, (check.from_s, middle_s))
    second = refit(check.scene, (middle_s, np.inf))
    if first is None or second is None:
        return
    both = first.rig.state.found & second.rig.state.found
    R = np.einsum("cij,ckj->cik", first.rig.state.T[both, :3, :3], second.rig.state.T[both, :3, :3])
    cosine = np.clip((np.trace(R, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0)
    apart_deg = float(np.degrees(np.arccos(cosine)).max())
    if apart_deg > APART_DEG:
        yield Finding(
            "wrong" if apart_deg > 2 * APART_DEG else "usable",
            f"halves of the recording give rigs that differ by {apart_deg:.2f} degrees",
        )
    else:
        yield Finding("good", f"halves of the recording agree within {apart_deg:.2f} degrees")
