"""Whether what the tracker says of real people is true, by the cameras that it was not given.

The sample recording (``trecsim sample``), four cameras, all sets of four, three and two of them.
There is no 3D truth, so what counts is:

- how far joints are from key points in the cameras that were left out, of key points of score 0.3
  and more, 12 limb joints, frames 0 to 87;
- whether places found by two *disjoint* pairs of cameras differ as their covariances say, and
  whether key points of left-out cameras are where the projected covariance says, with the noise of
  the detector added.

Where Pose2Sim is installed (``POSE2SIM_PYTHON``), or what it made before is kept, its errors in the
same cells stand beside: cells are key points of left-out cameras, and the same are those for which
it has an answer, raw and filtered (see `harness/pose2sim_runs.py`).

Beside it stands what ``trecsim evaluate --left-out`` says of the same recording, which has no
labels: one camera is left out at a time, and detections are matched with people by distance.

People are labelled in 2D, in each camera alone. The 2D poses are estimated once and kept
(``TRECSIM_BENCHMARK_CACHE``, or the user's cache folder).

Run: ``python benchmarks/left_out.py [--quick]``; ``--quick`` leaves out the sets of three cameras
and the scene with one person.
"""

from collections.abc import Mapping
from itertools import combinations
from pathlib import Path

import numpy as np

from harness import regions
from harness.actor_tracks import Actor, laid_beside, reprojected_px
from harness.command import alone
from harness.demo_video import CAMERAS, SCENES, Recorded, recorded
from harness.figures import Better, Figure, Figures, Skipped, once
from harness.left_out_cells import LeftOut, jitter_mm, left_out, noise_px
from harness.options import Options, sample_folder
from harness.pose2sim_runs import FILTERED, RAW, pose2sim, snapshots
from harness.scoring import LAGS_S
from trecsim.fusion import FusionSettings
from trecsim.tracking import follow

OFF_PX = 100.0  # about 20 cm
SURE_M = 0.20  # a joint is said to be known where its 90 % region reaches no further
TOO_LONG = 1.5  # a limb, by its median with four cameras

Set = tuple[str, ...]
Found = dict[Set, dict[str, Actor]]
Theirs = dict[str, Found]
"""What Pose2Sim found, raw and filtered."""


def measure(options: Options) -> Figures:
    """Measure what cameras that were left out, and other cameras, say of tracks in real video."""
    folder = sample_folder(options)
    options.input.update(data="sample recording (4 cameras, 60 fps, frames 0-87, two scenes)")
    out: dict[str, Figures] = {}
    for name in SCENES[1:] if options.quick else SCENES:
        out |= of_scene(folder, name, options)
    return out


def of_scene(folder: Path, name: str, options: Options) -> dict[str, Figures]:
    """Return the figures of one scene, by actor."""
    scene = recorded(folder, name)
    sizes = (4, 2) if options.quick else (4, 3, 2)
    out: dict[str, dict[str, Figures]] = {f"{name}, {who}": {} for who in scene.actors}
    noise = {who: noise_px(scene, who) for who in scene.actors}
    theirs = of_pose2sim(scene, sizes, options)
    for lag, lag_s in LAGS_S.items():
        found, nobody = tracked(scene, sizes, options.settings(), lag_s)
        for who in scene.actors:
            of_actor: dict[str, Figures] = {}
            for size in sizes:
                sets = [cameras for cameras in found if len(cameras) == size]
                of_actor[f"{size} cameras"] = {
                    **of_sets(scene, who, sets, found, noise[who]),
                    **beside_theirs(scene, who, sets, found, theirs),
                }
            of_actor["disjoint pairs"] = regions.figures(disjoint(found, who))
            out[f"{name}, {who}"][lag] = of_actor
        ghosts = {size: sum(n for s, n in nobody.items() if len(s) == size) for size in sizes}
        out.setdefault(f"{name}, nobody", {})[lag] = {
            f"person-moments, {size} cameras": once(n, "") for size, n in ghosts.items()
        }
        options.tell(f"{name}, {lag}")
    out[f"{name}, everybody"] = {"as the command says": as_the_command_says(scene, options)}
    for who in scene.actors:
        out[f"{name}, {who}"]["noise"] = {"of key points": once(noise[who], "px", watched=False)}
    return dict(out)


def tracked(
    scene: Recorded, sizes: tuple[int, ...], settings: FusionSettings, lag_s: float
) -> tuple[Found, dict[Set, int]]:
    """Follow everybody with every set of so many cameras."""
    found: Found = {}
    nobody: dict[Set, int] = {}
    for cameras in (chosen for size in sizes for chosen in combinations(CAMERAS, size)):
        rig, images = scene.of(cameras)
        snapshots = follow(images, rig, settings, lag_s=lag_s)
        found[cameras], nobody[cameras] = laid_beside(snapshots, scene)
    return found, nobody


def of_pose2sim(scene: Recorded, sizes: tuple[int, ...], options: Options) -> Theirs:
    """Return what Pose2Sim finds with every set of fewer cameras; nothing where it is not there."""
    sets = [
        chosen for size in sizes if size < len(CAMERAS) for chosen in combinations(CAMERAS, size)
    ]
    try:
        places = pose2sim(scene, sets)
    except Skipped as reason:
        options.skipped["Pose2Sim"] = str(reason)
        return {}
    return {
        kind: {cameras: laid_beside(snapshots(one[kind]), scene)[0]
               for cameras, one in places.items()}
        for kind in (RAW, FILTERED)
    }  # fmt: skip


def beside_theirs(
    scene: Recorded, who: str, sets: list[Set], found: Found, theirs: Theirs
) -> Figures:
    """Return errors in the cells for which all have an answer, those of all sets together."""
    if not theirs or len(sets[0]) == len(CAMERAS):
        return {}
    by = {"trecsim": found, **{f"Pose2Sim {kind}": one for kind, one in theirs.items()}}
    px = {
        name: np.concatenate(
            [left_out(scene, who, cameras, one[cameras][who]).px.ravel() for cameras in sets]
        )
        for name, one in by.items()
    }
    same = np.all([np.isfinite(one) for one in px.values()], axis=0)
    out: dict[str, Figure] = {}
    for share, text in ((0.5, "median"), (0.9, "p90")):
        at = {name: float(np.quantile(one[same], share)) for name, one in px.items()}
        out[f"trecsim, {text}"] = once(at["trecsim"], "px")
        for name in (f"Pose2Sim {kind}" for kind in (RAW, FILTERED)):
            out[f"{name}, {text}"] = once(at[name], "px", watched=False)
            out[f"of {name}, {text}"] = once(at["trecsim"] / at[name], "x", matters=0.01)
    for name, one in px.items():
        ours, known = name == "trecsim", np.isfinite(one)
        far = 100 * float((one[same] > OFF_PX).mean())
        out[f"{name}, far off"] = once(far, "%", watched=ours)
        far_of_all = 100 * float((one[known] > OFF_PX).mean())
        out[f"{name}, far off, all answers"] = once(far_of_all, "%", watched=ours)
        out[f"{name}, answers"] = once(int(known.sum()), "", "higher", watched=False)
    return {"same cells": out}


def of_sets(scene: Recorded, who: str, sets: list[Set], found: Found, noise: float) -> Figures:
    """Return figures over all sets of so many cameras."""
    usual_m = np.nanmedian(found[CAMERAS][who].limbs_m, axis=0)
    actors = {cameras: found[cameras][who] for cameras in sets}
    figures: dict[str, Figure | Figures] = {
        "found": _mean(actors, lambda one: one.found, "", "higher"),
        "switches": _sum(actors, lambda one: one.switches),
        "jitter, median": _mean(actors, lambda one: float(np.median(jitter_mm(one))), "mm"),
        "jitter, p95": _mean(actors, lambda one: float(np.quantile(jitter_mm(one), 0.95)), "mm"),
        "limbs too long": _mean(actors, lambda one: _too_long(one, usual_m), "%"),
        "used, median": _mean(
            {s: used_px(scene, who, s, one) for s, one in actors.items()}, np.median, "px"
        ),
    }
    if len(sets[0]) == len(CAMERAS):
        return figures
    cells = {s: left_out(scene, who, s, one) for s, one in actors.items()}
    figures |= {
        "left-out, median": _mean(cells, lambda one: float(np.nanmedian(one.px)), "px"),
        "left-out, p90": _mean(cells, lambda one: float(np.nanquantile(one.px, 0.9)), "px"),
        "left-out, within 30 px": _mean(
            cells, lambda one: 100 * float((one.px[one.known] <= 30).mean()), "%", "higher"
        ),
        "far off": _mean(cells, lambda one: _far(one, one.known), "%"),
        "far off, of the sure": _mean(
            cells, lambda one: _far(one, one.known & (one.sure_m <= SURE_M)), "%"
        ),
        "sure": _mean(
            cells, lambda one: 100 * float((one.sure_m[one.known] <= SURE_M).mean()), "%", "higher"
        ),
        "regions": regions.figures(
            regions.joined([one.errors(noise) for one in cells.values()]), "px"
        ),
    }
    return figures


def as_the_command_says(scene: Recorded, options: Options) -> Figures:
    """Return what `trecsim evaluate --left-out` says, which knows no labels; older ones do not."""
    try:
        from trecsim.lab.evaluation.left_out import left_out as judged
    except ImportError:  # this measures older versions, too
        return {}
    from trecsim.lab.evaluation.moments import gather, interval_s
    from trecsim.lab.evaluation.person_tracks import people_of

    rig, images = scene.of(CAMERAS)
    moments = gather(follow(images, rig, options.settings()))
    said = judged(
        lambda: images, rig, people_of(moments), interval_s(moments), settings=options.settings()
    )
    row = said.overall
    shares = {"50": row.within_50, "90": row.within_90, "99": row.within_99}
    return {
        **{
            f"in {share} % regions": once(100 * found, "%", "higher", matters=1.0, watched=False)
            for share, found in shares.items()
        },
        "key points": once(row.key_points, "", watched=False),
        "median error": once(row.median_px, "px"),
        "noise of the detector": once(1e3 * said.noise.median_m, "mm", watched=False),
        "its share of the variance": once(100 * row.noise_share, "%", watched=False),
    }


def disjoint(found: Found, who: str) -> regions.Errors:
    """Return the differences of disjoint pairs of cameras and their covariances [cm]."""
    parts = []
    for pair in combinations(CAMERAS, 2):
        other = tuple(name for name in CAMERAS if name not in pair)
        if pair < other:
            one, two = found[pair][who], found[other][who]
            both = (one.identity >= 0) & (two.identity >= 0)
            off_cm = 100 * (one.xyz_m - two.xyz_m)[both]
            cov_cm2 = 1e4 * (one.cov_m2 + two.cov_m2)[both]
            parts.append(regions.Errors(off_cm.reshape(-1, 3), cov_cm2.reshape(-1, 3, 3)))
    return regions.joined(parts)


def used_px(scene: Recorded, who: str, cameras: Set, one: Actor) -> np.ndarray:
    """Return how far joints are from the labels in the cameras that were used [px]."""
    off = [
        reprojected_px(scene, name, who, frame, xyz_m)
        for frame, xyz_m in zip(one.frames.tolist(), one.xyz_m, strict=True)
        for name in cameras
    ]
    flat = np.concatenate(off)
    return flat[np.isfinite(flat)]


def _far(one: LeftOut, chosen: np.ndarray) -> float:
    return 100 * float((one.px[chosen] > OFF_PX).mean()) if chosen.any() else float("nan")


def _too_long(one: Actor, usual_m: np.ndarray) -> float:
    known = one.limbs_m[one.identity >= 0]
    return 100 * float((known > TOO_LONG * usual_m).mean())


def _mean(by_set: Mapping[Set, object], of, unit: str, better: Better = "lower") -> Figure:
    runs = {_short(cameras): float(of(one)) for cameras, one in by_set.items()}
    return Figure(float(np.nanmean(list(runs.values()))), unit, better, "mean", runs)


def _sum(by_set: Mapping[Set, Actor], of) -> Figure:
    runs = {_short(cameras): float(of(one)) for cameras, one in by_set.items()}
    return Figure(sum(runs.values()), "", "lower", "sum", runs)


def _short(cameras: Set) -> str:
    return "".join(name.removeprefix("cam0") for name in cameras)


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
