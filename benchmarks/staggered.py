"""How stable the fusion is in whatever order the images of several cameras come.

The scene with two people of the sample recording (``trecsim sample``), its calibration as
delivered, which does not fit quite. Each camera gives every second, third or fourth image, and not
all cameras at the same moments; the images of one moment are a frame set, given to
`trecsim.Tracker` as such. A woman stands there: how far do her joints step from one frame set to
the next, how far are they from what all four cameras show at that moment, and is either actor lost?

Run: ``python benchmarks/staggered.py [--quick]``; ``--quick`` takes three of the staggerings.
"""

from collections.abc import Mapping

import numpy as np

from harness.actor_tracks import Actor, laid_beside, reprojected_px
from harness.command import alone
from harness.demo_video import CAMERAS, Recorded, recorded
from harness.figures import Figure, Figures, once
from harness.options import Options, sample_folder
from harness.scoring import LAGS_S
from trecsim.fusion import FusionSettings, Tracker
from trecsim.values import FrameSet, Snapshot

IN_STEP = "all in step, every 3rd image"
STAGGERINGS: Mapping[str, tuple[int, tuple[int, ...]]] = {
    IN_STEP: (3, (0, 0, 0, 0)),
    "0, 1, 2, 0 of 3 images": (3, (0, 1, 2, 0)),
    "0, 1, 2, 3 of 4 images": (4, (0, 1, 2, 3)),
    "cameras 1 and 2, 3 and 4 in turn": (2, (0, 0, 1, 1)),
    "cameras 1 and 3, 2 and 4 in turn": (2, (0, 1, 0, 1)),
    "cameras 1 and 4, 2 and 3 in turn": (2, (0, 1, 1, 0)),
}
"""Every so manieth image of each camera, and which of them, by camera."""
QUICK = (IN_STEP, "0, 1, 2, 0 of 3 images", "cameras 1 and 2, 3 and 4 in turn")
FIRST_FRAME = 15  # everybody is followed by then
STANDS = "woman"


def measure(options: Options) -> Figures:
    """Measure steps, errors and coverage of people before cameras that take turns."""
    scene = recorded(sample_folder(options), "MultiPerson")
    options.input.update(data="sample recording, MultiPerson, frames 15-87")
    out: dict[str, dict[str, Figures]] = {}
    for lag, lag_s in LAGS_S.items():
        in_step_px = float("nan")
        for name in QUICK if options.quick else STAGGERINGS:
            actors = tracked(scene, *STAGGERINGS[name], options.settings(), lag_s)
            figures = of_staggering(scene, actors)
            if name == IN_STEP:
                in_step_px = figures["error"].value
            share = figures["error"].value / in_step_px
            figures["error / in step"] = once(share, "", matters=0.03)
            out.setdefault(name, {})[lag] = figures
        options.tell(lag)
    return out


def frame_sets(scene: Recorded, period: int, phases: tuple[int, ...]) -> list[FrameSet]:
    """Return a frame set for each moment at which any camera gives an image."""
    frames = range(len(scene.images[CAMERAS[0]]))
    sets = []
    for frame in frames:
        views = tuple(
            scene.images[name][frame]
            for name, phase in zip(CAMERAS, phases, strict=True)
            if frame % period == phase
        )
        if views:
            sets.append(FrameSet(views[-1].t_s, views))
    return sets


def tracked(
    scene: Recorded,
    period: int,
    phases: tuple[int, ...],
    settings: FusionSettings,
    lag_s: float,
) -> dict[str, Actor]:
    """Return what is said of each actor."""
    tracker = Tracker(scene.rig, settings, lag_s=lag_s)
    snapshots: list[Snapshot] = [
        tracker.step(one).confirmed() for one in frame_sets(scene, period, phases)
    ]
    actors, _ = laid_beside(snapshots, scene, FIRST_FRAME)
    return actors


def of_staggering(scene: Recorded, actors: Mapping[str, Actor]) -> dict[str, Figure]:
    """Return steps and errors of who stands, and the share of moments each actor is found."""
    one = actors[STANDS]
    step_cm = 100 * np.linalg.norm(np.diff(one.xyz_m, axis=0), axis=-1)
    step_cm = step_cm[np.isfinite(step_cm)]
    off_px = np.concatenate(
        [
            reprojected_px(scene, name, STANDS, frame, xyz_m)
            for frame, xyz_m in zip(one.frames.tolist(), one.xyz_m, strict=True)
            for name in CAMERAS
        ]
    )
    off_px = off_px[np.isfinite(off_px)]
    return {
        "step, median": once(_quantile(step_cm, 0.5), "cm", matters=0.05),
        "step, p95": once(_quantile(step_cm, 0.95), "cm", matters=0.3),
        "error": once(_quantile(off_px, 0.5), "px", matters=0.3),
        "error, p90": once(_quantile(off_px, 0.9), "px", matters=1.0),
        **{
            f"{who} found": once(actor.found, "", "higher", matters=0.005)
            for who, actor in actors.items()
        },
    }


def _quantile(values: np.ndarray, share: float) -> float:
    return float(np.quantile(values, share)) if len(values) else float("nan")


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
