"""Whether a rig can be trusted: covariance, halves against each other, cameras left out.

A small distant board fits as well as a large near one, and tells much less. So the size of the
residuals alone never makes a rig good.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trecsim.calibrating.held_out import HeldOut, held_out
from trecsim.calibrating.linking import Link, Links
from trecsim.calibrating.result import (
    GOOD_DEG,
    GOOD_SHARE,
    NINETY,
    USABLE_DEG,
    USABLE_SHARE,
    Finding,
    rms_sd,
)
from trecsim.calibrating.rig_faults import mirrored_hint, swapped_hint
from trecsim.calibrating.rig_fit import BoardProblem, RigFit, fit_rig
from trecsim.calibrating.rig_halves import LEAST_MOMENTS, halves, turns_deg
from trecsim.calibrating.room_error import PoseCovariance, expected_error_m
from trecsim.geometry.rig import Rig

GOOD_PX, USABLE_PX = 1.0, 3.0  # noise of corners, at 1920 px
APART_GOOD, APART_USABLE = 3.0, 8.0  # difference of the halves beside what they state: about 1
LEAST_APART_DEG, LEAST_APART_SHARE = 0.05, 1e-3  # smaller differences of halves do not matter
HELD_OUT_GOOD, HELD_OUT_USABLE = 4.0, 12.0  # times what noise explains, in a camera left out
FEW_COMMON = 5
LENS_DEG = 0.1  # change of a rotation with free lenses that matters
LENS_SD = 4.0
LENS_GAIN = 5.0  # per freed number, twice the gain in log-likelihood: 1 where none is needed
GOOD_OFFSET_S, USABLE_OFFSET_S = 0.004, 0.02


@dataclass(frozen=True, slots=True, eq=False)
class RigCheck:
    """What was looked at.

    Attributes
    ----------
    findings
        What was found.
    error_m
        Expected error where the board was seen, root mean square [m].
    left_out
        How boards fit in each camera that the other cameras place without it.
    halves_deg, halves_m
        Largest difference of rotations and positions between the halves of the recording; NaN
        where they could not be compared.
    """

    findings: tuple[Finding, ...]
    error_m: float
    left_out: tuple[HeldOut, ...]
    halves_deg: float
    halves_m: float


def check_rig(
    problem: BoardProblem, links: Links, fit: RigFit, rig: Rig, covariance: PoseCovariance
) -> RigCheck:
    """Return what speaks for and against the poses of cameras.

    Parameters
    ----------
    problem, links
        What the fit was made from.
    fit
        The estimate.
    rig, covariance
        The cameras in the frame of the fit, and what is unknown about them.
    """
    size_m = _size_m(fit)
    error_m = _error_m(rig, covariance, fit)
    left_out = held_out(fit)
    halves_deg, halves_m, apart = halves(problem, links, fit, rig)
    findings = [
        *_of_missing(problem, links),
        _of_rotations(rig, covariance),
        _of_error(error_m, size_m),
        *_of_halves(halves_deg, halves_m, apart, size_m),
        _of_held_out(rig, left_out),
        _of_noise(rig, fit),
        *_of_moments(problem, links, fit),
        *_of_times(problem, fit, rig),
        *_of_lenses(problem, links, fit, rig),
        _of_scale(problem),
    ]
    return RigCheck(tuple(findings), error_m, tuple(left_out), halves_deg, halves_m)


def _of_missing(problem: BoardProblem, links: Links) -> list[Finding]:
    names = [c.name for n, c in enumerate(problem.cameras) if links.T_cam_root[n] is None]
    if not names:
        return []
    listed = ", ".join(map(repr, names))
    hint = mirrored_hint(problem) or swapped_hint(problem)
    advice = hint or (
        "no board was seen by it and a placed camera in the same moment, or not often enough: "
        "carry the board through where both see it"
    )
    return [Finding("usable", f"not placed: {listed}; {advice}")]


def _of_rotations(rig: Rig, covariance: PoseCovariance) -> Finding:
    each = [float(np.rad2deg(rms_sd(covariance.rotation(n)))) for n in range(len(rig))]
    worst = int(np.argmax(each))
    text = (
        f"rotations are known to {each[worst]:.3f} degrees (one standard deviation, camera "
        f"{rig.names[worst]!r})"
    )
    if NINETY * each[worst] <= GOOD_DEG:
        return Finding("good", text)
    advice = "; carry the board nearer, tilt it more, and let more cameras see it at once"
    return Finding("usable" if NINETY * each[worst] <= USABLE_DEG else "wrong", text + advice)


def _of_error(error_m: float, size_m: float) -> Finding:
    text = (
        f"points where the board was are expected to be off by {1e3 * error_m:.1f} mm because of "
        "the calibration"
    )
    share = error_m / size_m
    if share <= GOOD_SHARE:
        return Finding("good", text)
    advice = "; use a larger board, or carry it nearer to the cameras and through the whole room"
    return Finding("usable" if share <= USABLE_SHARE else "wrong", text + advice)


def _of_halves(degrees: float, metres: float, apart: float, size_m: float) -> list[Finding]:
    if not np.isfinite(apart):
        return [
            Finding(
                "usable",
                "the recording is too short to compare its halves with each other, so nothing "
                "shows that no camera moved; take more pictures",
            )
        ]
    text = (
        f"the first and the second half of the recording, calibrated alone, differ by "
        f"{degrees:.2f} degrees and {1e3 * metres:.1f} mm"
    )
    small = degrees <= LEAST_APART_DEG and metres <= LEAST_APART_SHARE * size_m
    if small or apart <= APART_GOOD:
        return [Finding("good", text)]
    advice = (
        f", {apart:.0f} times what the scatter explains: a camera was moved, or its images are not "
        "of the same moments as the others'"
    )
    usable = apart <= APART_USABLE and degrees <= USABLE_DEG
    return [Finding("usable" if usable else "wrong", text + advice)]


def _of_held_out(rig: Rig, left_out: Sequence[HeldOut]) -> Finding:
    known = [n for n, one in enumerate(left_out) if not np.isnan(one.times)]
    if not known:
        return Finding("usable", "no board could be placed by the other cameras alone")
    worst = max(known, key=lambda n: left_out[n].times)
    found = left_out[worst]
    text = (
        f"a board that the other cameras place alone appears {found.error_px:.2f} px off in camera "
        f"{rig.names[worst]!r}, {found.times:.1f} times what noise explains"
    )
    if found.times <= HELD_OUT_GOOD:
        return Finding("good", text)
    advice = (
        "; look at its pictures in the report: are they of the same moments as those of the others?"
    )
    off_deg = float(np.degrees(found.error_px / rig.cameras[worst].K[0, 0]))
    usable = found.times <= HELD_OUT_USABLE and off_deg <= USABLE_DEG / NINETY
    return Finding("usable" if usable else "wrong", text + advice)


def _of_noise(rig: Rig, fit: RigFit) -> Finding:
    scale = max(max(camera.size_px) for camera in rig) / 1920
    sigma = fit.adjusted.sigma_px
    text = f"corners scatter by {sigma:.2f} px about the model"
    if sigma <= GOOD_PX * scale:
        return Finding("good", text)
    advice = "; the intrinsics do not fit, the board is not flat, or images are blurred"
    return Finding("usable" if sigma <= USABLE_PX * scale else "wrong", text + advice)


def _of_moments(problem: BoardProblem, links: Links, fit: RigFit) -> list[Finding]:
    findings = []
    moments = len({sight.moment for sight in fit.sights})
    if moments < LEAST_MOMENTS:
        findings.append(
            Finding("usable", f"only {moments} moments were used; take {LEAST_MOMENTS} or more")
        )
    seen = {n: 0 for n in fit.numbers}
    for sight in fit.sights:
        seen[sight.camera] += 1
    findings += [
        Finding(
            "usable",
            f"camera {problem.cameras[n].name!r} saw the board together with another in only "
            f"{count} moments; carry it more often through where it looks",
        )
        for n, count in seen.items()
        if count < FEW_COMMON
    ]
    odd = [link for link in links.links if not link.fits and link.moments >= FEW_COMMON]
    return findings + [_of_link(problem, link) for link in odd[:2]]


def _of_times(problem: BoardProblem, fit: RigFit, rig: Rig) -> list[Finding]:
    if not problem.timed:
        return []
    sd_s = fit.offset_sd_s()
    worst = int(np.argmax(sd_s))
    text = (
        f"time offsets are known to {1e3 * sd_s[worst]:.1f} ms (one standard deviation, camera "
        f"{rig.names[worst]!r})"
    )
    if sd_s[worst] <= GOOD_OFFSET_S:
        return [Finding("good", text)]
    advice = "; keep the board moving more of the time"
    return [Finding("usable" if sd_s[worst] <= USABLE_OFFSET_S else "wrong", text + advice)]


def _of_link(problem: BoardProblem, link: Link) -> Finding:
    first, second = (problem.cameras[n].name for n in (link.first, link.second))
    return Finding(
        "usable",
        f"only {link.agreeing} of {link.moments} moments of {first!r} and {second!r} agree on how "
        "they stand to each other: are their pictures of the same moments?",
    )


def _of_lenses(problem: BoardProblem, links: Links, fit: RigFit, rig: Rig) -> list[Finding]:
    """Return whether other intrinsics would fit much better and turn the cameras."""
    freed = fit_rig(problem, links, free_lens=True)
    other = freed.rig(problem)
    turns = turns_deg(rig, other)
    change = freed.adjusted.state.lens_px - fit.adjusted.state.lens_px
    stated = freed.lens_sd_px()
    with np.errstate(divide="ignore", invalid="ignore"):
        surprise = np.abs(change) / stated
    worst = int(np.argmax(np.nan_to_num(surprise).max(axis=1)))
    better = _lens_gain(fit, freed) > LENS_GAIN
    if not better or turns.max() <= LENS_DEG or np.nan_to_num(surprise).max() <= LENS_SD:
        return [Finding("good", "the intrinsics fit: freed, they stay where they are")]
    fx, fy, cx, cy = change[worst]
    return [
        Finding(
            "usable",
            f"the intrinsics of camera {rig.names[worst]!r} do not fit: freed, its focal length "
            f"changes by {(fx + fy) / 2:+.1f} px and its centre by {cx:+.1f}, {cy:+.1f} px, and "
            f"cameras turn by up to {turns.max():.2f} degrees; calibrate the intrinsics again",
        )
    ]


def _lens_gain(fit: RigFit, freed: RigFit) -> float:
    """Return twice the gain in log-likelihood by free lenses, per freed number.

    One wrong lens of many lowers the noise of all corners together by a percent only, which is
    much for as many corners.
    """
    ratio = freed.adjusted.sigma_px / max(fit.adjusted.sigma_px, 1e-12)
    coordinates = 2 * len(fit.corners.camera)
    return -2.0 * coordinates * float(np.log(max(ratio, 1e-12))) / (4 * len(fit.numbers))


def _of_scale(problem: BoardProblem) -> Finding:
    square_mm = 1e3 * problem.boards[0].square_m
    return Finding(
        "good",
        f"all lengths rest on the squares being {square_mm:g} mm: measure ten of them, or the "
        "distance between two cameras",
    )


def _size_m(fit: RigFit) -> float:
    """Return the typical distance from a camera to the board [m]."""
    state = fit.adjusted.state
    T = state.T_cam_world[fit.corners.camera] @ state.T_world_placement[fit.corners.placement]
    return max(float(np.median(T[:, 2, 3])), 1e-3)


def _error_m(rig: Rig, covariance: PoseCovariance, fit: RigFit) -> float:
    placed = fit.adjusted.state.T_world_placement[:, :3, 3]
    each = expected_error_m(rig, covariance, placed)
    known = each[np.isfinite(each)]
    return float(np.sqrt((known**2).mean())) if len(known) else float("inf")
