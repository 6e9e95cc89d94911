"""What the parts of the fusion's model are measured on.

Recordings and simulated scenes that other benchmarks made, few of each, as every part is tracked on
some of them. An input is a number of runs; each gives scores by name. Seeds 1000 and up.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from ablation_scores import REGIONS, Scores, errors_of, percent, scores
from harness import regions
from harness.counted import FAR_M
from harness.kept_scenes import kept
from harness.options import REPORTING_SEEDS, Options, sample_folder, shared_data

if TYPE_CHECKING:
    from harness.beside_truth import Beside, Flags
    from trecsim.geometry import Rig
    from trecsim.lab.simulation import Simulation
    from trecsim.values import Poses2D

Run = Callable[[Mapping[str, Any], float], Scores]
"""Tracks one scene with some settings and a lag [s]; returns scores by name."""

ROOM_SECONDS = 10.0
TIMED_S = 3.0  # of each recording that is timed
ROUNDS = 4


def _of(make: "Callable[[], Simulation]", **about: Any) -> Run:
    """Return the run of a simulated scene."""

    def run(overrides: Mapping[str, Any], lag_s: float) -> Scores:
        from trecsim.store.truth import Truth

        made = make()
        truth = Truth(made.truth_t_s, made.truth_xyz_m)
        return scores(made.poses, made.rig, truth, overrides, lag_s, **about)

    return run


def _rooms(cameras: int, people: int, seeds: range) -> Iterator[tuple[str, Run]]:
    for seed in seeds:
        yield str(seed), _of(partial(_room, cameras, people, seed))


def _room(cameras: int, people: int, seed: int) -> "Simulation":
    from trecsim.lab.simulation.scene import room_scene, simulate
    from uncertainty import CLOTHED, seen_by

    scene = room_scene(people=people, cameras=cameras, seconds=ROOM_SECONDS)
    name = f"room-{cameras}-{people}-{CLOTHED}-{ROOM_SECONDS:g}-s"
    return kept(name, seed, lambda: simulate(seen_by(CLOTHED, scene), seed))


def _lagged(lag_s: float, runs: Callable[..., Iterator[tuple[str, Run]]], seeds: range) -> Any:
    """Yield runs that report so far behind the newest image, whatever is asked for."""
    for name, run in runs(seeds=seeds):
        yield name, partial(_with_lag, run, lag_s)


def _with_lag(run: Run, lag_s: float, overrides: Mapping[str, Any], _: float) -> Scores:
    return run(overrides, lag_s)


def _scenes(names: tuple[str, ...], seeds: range) -> Iterator[tuple[str, Run]]:
    for name in names:
        for seed in seeds:
            yield f"{name} {seed}", _of(partial(_built_in, name, seed), provisional=True)


def _built_in(name: str, seed: int) -> "Simulation":
    from claims import built_in

    return kept(name, seed, built_in(name, seed))


def _thesis(names: tuple[str, ...], seeds: range) -> Iterator[tuple[str, Run]]:
    for name in names:
        yield name, partial(_thesis_scores, name)


def _thesis_scores(name: str, overrides: Mapping[str, Any], lag_s: float) -> Scores:
    found = scores(*_thesis_scene(name), overrides, lag_s)
    return {score: found[score] for score in ("error", "switches", "missed", "ghosts")}


@cache
def _thesis_scene(name: str) -> "tuple[tuple[Poses2D, ...], Rig, Truth]":
    import thesis

    poses, rig, truth = thesis.read(shared_data("thesis_scenes") / f"{name}.npz")
    return tuple(poses), rig, truth


def _few_images(rate_hz: float, timing: str, seeds: range) -> Iterator[tuple[str, Run]]:
    import low_rates

    for scene, count in {**low_rates.FALLS, **low_rates.CROSSINGS}.items():
        for seed in seeds[:count]:
            name = "-".join(map(str, scene))
            yield f"{name} {seed}", _of(partial(_at_rate, scene, seed, rate_hz, timing))


def _at_rate(scene: Any, seed: int, rate_hz: float, timing: str) -> "Simulation":
    import low_rates

    name = f"{'-'.join(map(str, scene))}-{rate_hz:g}-{timing}"
    folder = shared_data("mocap")
    return kept(name, seed, lambda: low_rates.made(scene, seed, rate_hz, timing, folder))


def _disturbed(fault: str, seeds: range) -> Iterator[tuple[str, Run]]:
    import disturbed

    for seed in seeds:
        guilty = disturbed.DISTURBED[fault]
        yield str(seed), _of(partial(_disturbed_room, fault, seed), guilty=guilty)


def _disturbed_room(fault: str, seed: int) -> "Simulation":
    import disturbed
    from trecsim.lab.simulation.scene import simulate

    made = partial(disturbed.scene, fault, 4, 4)
    return kept(f"disturbed-{fault}-4-4", seed, lambda: simulate(made(), seed))


TURNS_AT_S = 8.0


def _turning(seeds: range) -> Iterator[tuple[str, Run]]:
    for seed in seeds:
        yield str(seed), _of(partial(_turning_room, seed))


def _turning_room(seed: int) -> "Simulation":
    """Return a room in which one camera is turned while people are followed."""
    from dataclasses import replace

    import disturbed
    from trecsim.lab.simulation.scene import simulate

    scene = disturbed.scene("a camera turned", 4, 4)
    knocks = tuple(replace(knock, t_s=TURNS_AT_S) for knock in scene.knocks)
    late = replace(scene, knocks=knocks)
    return kept(f"turning-at-{TURNS_AT_S:g}-s-4-4", seed, lambda: simulate(late, seed))


def _in_turn(seeds: range) -> Iterator[tuple[str, Run]]:
    import staggered

    for name in staggered.STAGGERINGS if len(seeds) > 1 else staggered.QUICK:
        if name != staggered.IN_STEP:
            yield name, partial(_staggered, name)


def _staggered(name: str, overrides: Mapping[str, Any], lag_s: float) -> Scores:
    import staggered
    from harness.options import settings_from

    scene = _recorded("MultiPerson")
    actors = staggered.tracked(scene, *staggered.STAGGERINGS[name], settings_from(overrides), lag_s)
    found = staggered.of_staggering(scene, actors)
    shares = [figure.value for score, figure in found.items() if score.endswith("found")]
    return {
        "step, median": found["step, median"].value,
        "reprojection error": found["error"].value,
        "missed": 100 * (1.0 - float(np.mean(shares))),
    }


@cache
def _recorded(scene: str) -> Any:
    from harness.demo_video import recorded

    return recorded(sample_folder(Options()), scene)


def _pairs(seeds: range) -> Iterator[tuple[str, Run]]:
    for scene, who in (("SinglePerson", "man"), ("MultiPerson", "man"), ("MultiPerson", "woman")):
        yield f"{scene}, {who}", partial(_disjoint, scene, who)


def _disjoint(name: str, who: str, overrides: Mapping[str, Any], lag_s: float) -> dict[str, float]:
    """Return how far apart disjoint pairs of cameras place somebody, and whether they know."""
    import left_out
    from harness.options import settings_from

    scene = _recorded(name)
    found, _ = left_out.tracked(scene, (2,), settings_from(overrides), lag_s)
    errors = left_out.disjoint(found, who)
    return {
        "error": float(errors.norm.mean()),
        "off more than 25 cm": percent((errors.norm > 100 * FAR_M).sum(), len(errors.norm)),
        "log-likelihood": -regions.likelihood(errors),
        REGIONS: regions.inside(errors, 0.9),
    }


def _shelf(count: int, seeds: range) -> Iterator[tuple[str, Run]]:
    from harness.shelf_recording import read_cameras

    names = read_cameras(shared_data("shelf")).names
    for chosen in combinations(names, count):
        yield " ".join(chosen), partial(_shelf_scores, chosen)


def _shelf_scores(
    cameras: tuple[str, ...], overrides: Mapping[str, Any], lag_s: float
) -> dict[str, float]:
    from harness.beside_truth import beside, said
    from harness.shelf_recording import truth_of
    from trecsim.lab.evaluation.shelf import score_shelf

    shelf = _shelf_recording(cameras)
    snapshots = list(said(shelf.poses, shelf.rig, overrides, lag_s))
    score = score_shelf(snapshots, shelf.annotation, lag_s=lag_s)
    out = {
        "average PCP": score.average,
        "switches": float(score.switches),
        "missed person-frames": float(score.missed),
    }
    if len(cameras) > 2:
        out |= errors_of(beside(snapshots, truth_of(shelf.annotation)), None)
    return out


@cache
def _shelf_recording(cameras: tuple[str, ...]) -> Any:
    from harness.shelf_recording import read_shelf

    return read_shelf(shared_data("shelf"), cameras)


def _one_view(since: str, seeds: range) -> Iterator[tuple[str, Run]]:
    import one_view

    for what in one_view.DOING:
        for seed in seeds:
            later = seed + one_view.LATER
            yield f"{what} {later}", partial(_one_view_scores, since, what, later)


def _one_view_scores(
    since: str, what: str, seed: int, overrides: Mapping[str, Any], _: float
) -> Scores:
    import one_view

    found, _ = one_view.one_view((what, since, seed, overrides))
    return {
        "off in depth": found["off in depth, median"],
        "off in depth, p95": found["off in depth, p95"],
        "log-likelihood": found["log density"] / 3.0,  # per axis
        REGIONS: found["in 90 % regions"],
        "lost": found["lost"],
        "switches": found["switches"],
    } if found else {"lost": 100.0}  # fmt: skip


def _sits_or_lies(seeds: range) -> Iterator[tuple[str, Run]]:
    for what in ("sitting", "lying"):
        for seed in seeds:
            yield f"{what} {seed}", partial(_alone, what, seed)


def _alone(what: str, seed: int, overrides: Mapping[str, Any], lag_s: float) -> Scores:
    import close

    made, poses, _ = _made_alone(what, seed)

    def judged(one: "Beside") -> "Flags":
        alone = (one.t_s >= close.KNOWN_S + 0.2) & (one.t_s < close.KNOWN_S + close.ALONE_S)
        return np.broadcast_to(alone[None, :, None], one.support.shape)

    return scores(poses, made.rig, close.truth_of(made), overrides, lag_s, judged)


@cache
def _made_alone(what: str, seed: int) -> Any:
    import close

    return close.made_alone(what, seed)


WRIST, WRIST_GONE_S = 10, ((3.0, 6.0), (8.0, 11.0), (13.0, 16.0))


def _wrist(seeds: range) -> Iterator[tuple[str, Run]]:
    for seed in seeds:
        yield str(seed), partial(_wrist_scores, seed)


def _wrist_scores(seed: int, overrides: Mapping[str, Any], lag_s: float) -> Scores:
    """Return the scores of a right wrist that one of two cameras does not find."""
    from trecsim.store.truth import Truth

    made = _built_in("one-person", seed)

    def gone(t_s: Any) -> Any:
        return sum((t_s >= a) & (t_s < b) for a, b in WRIST_GONE_S) > 0

    def judged(one: "Beside") -> "Flags":
        out = np.zeros(one.support.shape, bool)
        out[:, gone(one.t_s - 0.5), WRIST] = True
        return out

    poses = tuple(
        _without(image, WRIST) if image.camera == "cam2" and gone(image.t_s) else image
        for image in made.poses
    )
    truth = Truth(made.truth_t_s, made.truth_xyz_m)
    found = scores(poses, made.rig, truth, overrides, lag_s, judged)
    return {
        score: found[score] for score in ("error", "off more than 25 cm", "log-likelihood", REGIONS)
    }


def _without(image: "Poses2D", joint: int) -> "Poses2D":
    from dataclasses import replace

    xy_px, score = image.xy_px.copy(), image.score.copy()
    xy_px[:, joint], score[:, joint] = np.nan, 0.0
    return replace(image, xy_px=xy_px, score=score)


PHANTOM_EVERY_S, PHANTOM_LASTS_S = 0.8, 0.2
PHANTOM_PX, PHANTOM_SCORE = 3.0, 0.46


def _phantoms(seeds: range) -> Iterator[tuple[str, Run]]:
    for seed in seeds:
        yield str(seed), _of(partial(_with_phantoms, seed), provisional=True)


@cache
def _with_phantoms(seed: int) -> "Simulation":
    """Return a room in which two of four cameras, at times, show a body where nobody is."""
    from dataclasses import replace

    made, rng = _room(4, 4, seed), np.random.default_rng(seed)
    poses = list(made.poses)
    for from_s in np.arange(0.5, ROOM_SECONDS, PHANTOM_EVERY_S):
        cameras = rng.choice(made.rig.names, 2, replace=False)
        moment = int(np.searchsorted(made.truth_t_s, from_s))
        someone_m = made.truth_xyz_m[rng.integers(len(made.truth_xyz_m)), moment]
        body_m = someone_m + np.append(rng.uniform(1.0, 2.0, 2) * rng.choice([-1, 1], 2), 0.0)
        for n, image in enumerate(poses):
            if image.camera in cameras and from_s <= image.t_s < from_s + PHANTOM_LASTS_S:
                poses[n] = _with_body(image, made.rig, body_m, rng)
    return replace(made, poses=tuple(poses))


def _with_body(
    image: "Poses2D", rig: "Rig", body_m: "np.ndarray", rng: np.random.Generator
) -> "Poses2D":
    """Return an image with one more person, if the body is in it as a whole."""
    from dataclasses import replace

    xy_px = rig[image.camera].project(body_m)
    inside = ((xy_px >= 0) & (xy_px < np.array(rig[image.camera].size_px))).all()
    if not inside:  # also where nobody is to be copied
        return image
    score = np.full(len(xy_px), PHANTOM_SCORE)
    xy_px = xy_px + rng.normal(0.0, PHANTOM_PX, xy_px.shape)
    return replace(
        image,
        xy_px=np.concatenate([image.xy_px, xy_px[None]]),
        score=np.concatenate([image.score, score[None]]),
        person_score=np.append(image.person_score, PHANTOM_SCORE),
    )


FOUR, TWO, SCENES = "4 cameras", "2 cameras", "built-in scenes"
COMMON = (FOUR, TWO, SCENES)
"""What every part is tracked on."""

_MIXED = (
    "crossing-30cm", "close-entry", "sitting", "hugging", "falling", "side-entry", "gate",
    "cheap-cameras",
)  # fmt: skip

_COMING_AND_GOING = partial(_scenes, ("leaving-returning", "side-entry", "gate"))

_INPUTS: dict[str, tuple[Callable[..., Iterator[tuple[str, Run]]], int]] = {
    FOUR: (partial(_rooms, 4, 4), 5),
    TWO: (partial(_rooms, 2, 3), 5),
    SCENES: (partial(_scenes, _MIXED), 1),
    "on the floor": (partial(_scenes, ("lying-down", "falling", "crawling")), 3),
    "close together": (partial(_scenes, ("crossing-30cm", "hugging", "overtaking")), 3),
    "coming and going": (_COMING_AND_GOING, 3),
    "coming and going, 0.2 s lag": (partial(_lagged, 0.2, _COMING_AND_GOING), 2),
    "a knocked camera": (partial(_scenes, ("camera-knocked",)), 4),
    "poor cameras": (partial(_scenes, ("cheap-cameras",)), 4),
    "a crowd": (partial(_scenes, ("platform-edge", "crowded-room")), 1),
    "thesis, crossing": (partial(_thesis, ("cross_lateral_50cm_C2", "cross_X_occl_C2")), 1),
    "thesis, hard": (partial(_thesis, ("hard_J3_C2", "close_entry_J1_C2")), 1),
    "thesis, walking": (partial(_thesis, ("walk_J1_C2", "walk_J2_C2", "walk_J3_C2")), 1),
    "Shelf, 5 cameras": (partial(_shelf, 5), 1),
    "Shelf, 2 cameras": (partial(_shelf, 2), 1),
    "real video, disjoint pairs": (_pairs, 1),
    "real video, cameras in turn": (_in_turn, 2),
    "8 images a second": (partial(_few_images, 8.0, "staggered"), 5),
    "5 images a second": (partial(_few_images, 5.0, "irregular"), 5),
    "a camera turned": (partial(_disturbed, "a camera turned"), 4),
    "a camera turned at 8 s": (_turning, 4),
    "a clock late": (partial(_disturbed, "a clock late"), 4),
    "one camera, new": (partial(_one_view, "new"), 2),
    "one camera, known": (partial(_one_view, "known"), 2),
    "one camera, sitting or lying": (_sits_or_lies, 3),
    "a wrist in one view": (_wrist, 6),
    "phantoms of two cameras": (_phantoms, 4),
}
"""What makes the runs of each input, and how many seeds it takes."""

NAMES = tuple(_INPUTS)
DATA = {
    "thesis_scenes": ("thesis, crossing", "thesis, hard", "thesis, walking"),
    "shelf": ("Shelf, 5 cameras", "Shelf, 2 cameras"),
    "mocap": ("8 images a second", "5 images a second"),
}
"""Which inputs need which data beside the repository."""
SAMPLE = ("real video, disjoint pairs", "real video, cameras in turn")
"""Which need the sample recording."""


def runs_of(name: str, quick: bool) -> Iterator[tuple[str, Run]]:
    """Yield the runs of an input; one seed for each scene if it is to be quick."""
    make, seeds = _INPUTS[name]
    yield from make(seeds=REPORTING_SEEDS[: 1 if quick else seeds])


# ------------------------------------------------------------------------------------ time a step


@cache
def _timed() -> list[tuple["Rig", list[Any]]]:
    """Return the frame sets that are timed: a room, and people who come through a gate."""
    from trecsim.sync import frame_sets

    out = []
    for made in (_room(4, 4, REPORTING_SEEDS[0]), _built_in("gate", REPORTING_SEEDS[0])):
        until_s = made.poses[0].t_s + TIMED_S
        out.append((made.rig, [s for s in frame_sets(made.poses) if s.t_s < until_s]))
    return out


def step_ms(overrides: Mapping[str, Any], lag_s: float) -> float:
    """Return the processor time that one frame set takes on average [ms]."""
    import time

    from harness.options import settings_from
    from trecsim.fusion import Tracker

    spent_s, steps = 0.0, 0
    for rig, sets in _timed():
        tracker = Tracker(rig, settings_from(overrides), lag_s=lag_s, provisional=True)
        began_s = time.thread_time()
        for one in sets:
            tracker.step(one)
        spent_s += time.thread_time() - began_s
        steps += len(sets)
    return 1e3 * spent_s / steps
