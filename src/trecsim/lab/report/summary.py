"""A recording in a few figures, and warnings about what is probably wrong with it."""

import math
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime

import numpy as np

from trecsim.lab.evaluation.limbs import LimbRow, LimbSeries, LimbSummary
from trecsim.lab.evaluation.scores import Scores
from trecsim.lab.report.coverage import CameraFacts
from trecsim.lab.report.odd_limbs import odd_limbs, unlike_given
from trecsim.lab.report.page import Block, Fact, Facts, Section, Text
from trecsim.lab.report.recording import EARLIEST_UNIX_S, Recording
from trecsim.skeleton import COCO17

TITLE = "Summary"
BRIEF_S = 1.0  # an identity that lasts less was hardly a person
LONG_GAP_S = 2.0
UNSTEADY_M = 0.04  # standard deviation of a limb's length
AMISS = 0.05  # share of the person-frames
ADVICE = (
    "For limbs that are too long or unsteady: first check that no camera was moved and that the "
    "clocks of the cameras agree. If a limb is too long in single frames only, raise "
    "outlier_share, the expected share of wrong key points. If it varies all the time, raise "
    "joint_sigma_m, the expected error of a good key point. Both are settings under [fusion] in "
    "the site file."
)
GOOD = (
    "All checks passed: run and cameras, support of the joints, steadiness of limb lengths, and "
    "ankles on the floor"
)
BELOW_FLOOR_M = -0.05  # ankle joints are about 0.1 m above the floor
WEAK = 0.5  # share of joints supported by fewer than two cameras
FEET = [COCO17.index(name) for name in ("left_ankle", "right_ankle")]


def section(
    recording: Recording,
    cameras: CameraFacts | None,
    limbs: LimbSummary,
    scores: Scores | None = None,
    series: Sequence[LimbSeries] = (),
    compared: Sequence[LimbRow] = (),
    source: str = "",
) -> Section:
    """Return the figures, and warnings.

    `compared` are mean limb lengths beside those of `source`, "measured" or "true".
    """
    blocks: list[Block] = [Facts(list(_facts(recording, limbs)))]
    warnings = [*_run_warnings(recording), *_track_warnings(recording)]
    if limbs.sd_m > UNSTEADY_M:
        warnings.append(
            f"Limb lengths vary by {100 * limbs.sd_m:.1f} cm (standard deviation), more than "
            "usual. Likely causes: a noisy detector, or a camera whose calibration or clock is "
            "wrong."
        )
    limb_warnings = [*odd_limbs(series, recording.clock)]
    advised = limbs.sd_m > UNSTEADY_M or bool(limb_warnings)
    warnings += [*limb_warnings, *unlike_given(compared, source)]
    warnings += [*_camera_warnings(cameras)] if cameras is not None else []
    warnings += [*_truth_warnings(scores)] if scores is not None and recording.stays else []
    blocks += [Text(text, "warning") for text in warnings]
    blocks += [Text(ADVICE)] if advised else []
    if not warnings and recording.stays:
        against = f", and limb lengths against the {source} ones" if source else ""
        blocks.append(Text(f"{GOOD}{against}.", "good"))
    return Section(TITLE, blocks)


def subtitle(recording: Recording) -> str:
    """Return when and how long, in a line."""
    parts = [f"{_length(recording.length_s)} of tracks"] if recording.stays else ["no tracks"]
    if recording.stays and recording.start_s >= EARLIEST_UNIX_S:
        start = datetime.fromtimestamp(min(recording.start_s, 2e11), UTC)
        parts.append(f"from {start:%d %B %Y, %H:%M:%S} UTC")
    if recording.rig is not None:
        count = len(recording.rig)
        parts.append(f"{count} camera{'' if count == 1 else 's'}")
    return " · ".join(parts)


def _facts(recording: Recording, limbs: LimbSummary) -> Iterator[Fact]:
    people = _most_at_once(recording)
    count = len(recording.stays)
    identities = f"{count} identit{'y' if count == 1 else 'ies'}"
    yield Fact("people at once", str(people), f"maximum; {identities} in all")
    yield Fact(
        "length", _length(recording.length_s), f"{recording.moment_count} frames with people"
    )
    if recording.stays and math.isfinite(recording.period_s):
        rate = 1 / recording.period_s if recording.period_s > 0 else math.nan
        yield Fact("rate", f"{rate:.3g} Hz", "frames per second")
    if recording.lag_s:
        yield Fact("lag", f"{recording.lag_s:g} s", "states wait for later images")
    sigma_m = recording.sample.sigma_m
    if np.isfinite(sigma_m).any():
        yield Fact(
            "uncertainty", f"{100 * np.nanmedian(sigma_m):.1f} cm", "one sigma, median joint"
        )
    if limbs.people:
        yield Fact("limb length", f"± {100 * limbs.sd_m:.1f} cm", "standard deviation over time")


def _most_at_once(recording: Recording) -> int:
    timing = recording.timing
    counted = timing.people if timing is not None and len(timing.t_s) else recording.sample.people
    return int(counted.max()) if len(counted) else 0


def _length(length_s: float) -> str:
    if length_s < 60:
        return f"{length_s:.1f} s"
    minutes, seconds = divmod(round(length_s), 60)
    if minutes < 60:
        return f"{minutes} min {seconds:02d} s"
    hours, minutes = divmod(round(length_s / 60), 60)
    return f"{hours} h {minutes:02d} min"


def _run_warnings(recording: Recording) -> Iterator[str]:
    ended, fault = recording.summary.get("ended"), recording.summary.get("fault")
    if ended == "stopped":
        yield "The run was stopped before its end; the part until then is complete."
    if ended == "failed":
        yield f"The run ended early: {str(fault)[:300]}"
    if recording.unfinished:
        yield "The recording was cut off: its last seconds may be missing."
    timing = recording.timing
    if timing is None or len(timing.t_s) < 3:
        return
    steps_s = np.diff(timing.t_s)
    usual_ms = 1e3 * float(np.median(steps_s))
    mean_ms = timing.fusion_ms[1:].mean()  # the first may wait for kernels to compile or load
    if mean_ms > usual_ms > 0:
        yield (
            f"The fit was slower than the cameras: a frame set came every {usual_ms:.0f} ms, and "
            f"its fit took {mean_ms:.0f} ms on average (wall-clock time, without the first). Live, "
            "this machine would fall behind."
        )
    gaps = steps_s[steps_s > LONG_GAP_S]
    if len(gaps):
        times = "once" if len(gaps) == 1 else f"{len(gaps)} times"
        yield f"No camera delivered an image for up to {gaps.max():.1f} s ({times})."


def _track_warnings(recording: Recording) -> Iterator[str]:
    if not recording.stays:
        yield "Nobody was tracked in this recording."
        return
    yield from _identity_warnings(recording)
    sample = recording.sample
    feet_m = sample.xyz_m[:, FEET, 2]
    feet_m = feet_m[np.isfinite(feet_m)]
    height_m = float(np.median(feet_m)) if len(feet_m) else 0.1
    if not BELOW_FLOOR_M < height_m < 0.4:
        yield (
            f"The median height of all ankles is {height_m:.2f} m; about 0.1 m is expected. The "
            "floor (z = 0) of the rig is not the one that people walk on."
        )
        return
    for stay in recording.shown:
        ankles_m = sample.xyz_m[sample.id == stay.person][:, FEET, 2]
        ankles_m = ankles_m[np.isfinite(ankles_m)]
        if len(ankles_m) and np.median(ankles_m) < BELOW_FLOOR_M:
            yield (
                f"Person {stay.person}: the ankles are {-100 * np.median(ankles_m):.0f} cm below "
                "the floor (z = 0) on the median. Either the position of this person is off, or "
                "the floor of the rig is tilted."
            )


def _identity_warnings(recording: Recording) -> Iterator[str]:
    brief = [stay for stay in recording.stays if stay.last_s - stay.first_s < BRIEF_S]
    if len(brief) > 0.2 * len(recording.stays) and recording.length_s > 2 * BRIEF_S:
        yield (
            f"{len(brief)} of {len(recording.stays)} identities lasted less than a second: tracks "
            "that were lost and found again, or false positives."
        )
    sample = recording.sample
    known = np.isfinite(sample.xyz_m[..., 0])
    single = float((sample.support[known] < 2).mean()) if known.any() else 0.0
    if single > 0.3:
        yield (
            f"{100 * single:.0f} % of the joints were supported by fewer than two cameras: their "
            "positions come from limb lengths, the floor and the motion before."
        )
    for stay in recording.shown if single <= 0.3 else ():
        rows = sample.id == stay.person
        weak = float((sample.support[rows][known[rows]] < 2).mean()) if known[rows].any() else 0.0
        if weak > WEAK:
            yield (
                f"Person {stay.person}: {100 * weak:.0f} % of the joints were supported by fewer "
                "than two cameras. This may be a false positive."
            )


def _truth_warnings(scores: Scores) -> Iterator[str]:
    if scores.elsewhere:
        yield (
            "Hardly any track is near a person of the ground truth: does it belong to this "
            "recording?"
        )
        return
    if scores.missed_share > AMISS:
        yield (
            f"{100 * scores.missed_share:.0f} % of the person-frames of the ground truth were "
            "missed."
        )
    if scores.false_positives_share > AMISS:
        yield (
            f"False positives: tracks without a person in the ground truth, "
            f"{100 * scores.false_positives_share:.0f} % of the person-frames."
        )
    switches = scores.identity.switches
    if switches:
        yield f"{switches} identity switch{'' if switches == 1 else 'es'} against the ground truth."


def _camera_warnings(cameras: CameraFacts) -> Iterator[str]:
    most = max(cameras.images.values(), default=0)
    for camera in cameras.rig:
        count = cameras.images.get(camera.name, 0)
        if most and count < 0.8 * most:
            share = f"{100 * count / most:.0f} % as many images as other cameras"
            yield f"Camera {camera.name} delivered {share if count else 'no image'}."
    yield from _stray_cameras(cameras)
    few = float(cameras.by_count[:2].sum())
    if few > 0.1:
        yield (
            f"In {100 * few:.0f} % of the person-frames fewer than two cameras had the person in "
            "view: distances are uncertain there."
        )


def _stray_cameras(cameras: CameraFacts) -> Iterator[str]:
    if cameras.found is None:
        return
    medians = {
        row.camera: row.median_px
        for row in cameras.found.rows
        if row.joint == "all joints" and row.n and row.camera in cameras.rig.names
    }
    for name, median_px in medians.items():
        others = [other for key, other in medians.items() if key != name]
        if len(others) >= 2 and median_px > max(2.5 * float(np.median(others)), 3.0):
            yield (
                f"Camera {name} disagrees with the others: its median reprojection error is "
                f"{median_px:.0f} px, that of the others {np.median(others):.0f} px. Check whether "
                "it was moved, whether its clock is off, whether names of cameras are swapped, "
                "and whether its images have the size given in the rig."
            )
