"""Every figure that is to be reached, and where the one that was reached is stored."""

import math
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Literal

from harness.figures import Path_, Result, leaves
from recorded import AUTHORS_CROWDED, AUTHORS_SCENES

TIMED = (
    "exporting",
    "filming",
    "page",
    "speed",
    "simulating",
    "evaluating",
    "startup",
    "pipeline_cost",
)

Relation = Literal["<=", ">="]


@dataclass(frozen=True, slots=True)
class Target:
    """A figure to reach.

    Attributes
    ----------
    group, text
        What it is about.
    where
        Name of the benchmark, then names of groups and figure, each a pattern; where several
        figures match, the worst counts.
    relation, limit, unit
        What is asked.
    peers
        Recorded figures of others.
    seeds
        Whether it is the number of seeds behind the figure that counts, not its value.
    """

    group: str
    text: str
    where: Path_
    relation: Relation
    limit: float
    unit: str = ""
    peers: str = ""
    seeds: bool = False

    @property
    def timed(self) -> bool:
        """Whether a busy machine makes it worse."""
        return self.where[0] in TIMED and self.unit in ("s", "ms", "x real time", "")

    @property
    def asked(self) -> str:
        """What is asked, as text."""
        sign = "≤" if self.relation == "<=" else "≥"
        return f"{sign} {self.limit:g} {self.unit}".strip()

    def reached(self, results: dict[str, Result]) -> float:
        """Return the figure that was reached, NaN where nothing is stored."""
        result = results.get(self.where[0])
        if result is None:
            return math.nan
        values = [
            float(len(figure.runs)) if self.seeds else figure.value
            for path, figure in leaves(result.figures)
            if len(path) == len(self.where) - 1
            and all(map(fnmatchcase, path, self.where[1:]))
            and math.isfinite(figure.value)
        ]
        if not values:
            return math.nan
        return max(values) if self.relation == "<=" else min(values)

    def verdict(self, value: float) -> str:
        """Tell whether a value meets the target, and if not, by how much it misses it."""
        if not math.isfinite(value):
            return "not measured yet"
        missing = value - self.limit if self.relation == "<=" else self.limit - value
        if missing <= 1e-9:
            return "met"
        share = f" ({100 * missing / abs(self.limit):.0f} %)" if self.limit else ""
        return f"missed by {missing:.3g}{share}"


def _shelf() -> list[Target]:
    # Over all 301 frames of the literature, as are the figures of others.
    group, five = "Shelf", ("shelf", "5 cameras")
    return [
        Target(group, "5 cameras, average PCP of actors 1-3, no lag",
               (*five, "newest", "average PCP"), ">=", 96.9, "%",
               "4D Association 96.3, Pose2Sim 86.9"),
        Target(group, "5 cameras, average PCP of actors 1-3, 0.2 s lag",
               (*five, "lag 0.2 s", "average PCP"), ">=", 97.1, "%"),
        Target(group, "PCP of actor 4", (*five, "newest", "PCP of actor 4"), ">=", 99.3, "%",
               "4D Association 92.4, Pose2Sim 80.6"),
        Target(group, "limb-joint error", (*five, "newest", "limb-joint error"), "<=", 46, "mm"),
        Target(group, "identity switches", (*five, "newest", "switches"), "<=", 0, "",
               "4D Association 0, Pose2Sim 1"),
        Target(group, "missed person-frames", (*five, "newest", "missed person-frames"), "<=", 0,
               "", "4D Association 0, Pose2Sim 15"),
        Target(group, "4 cameras, mean over all subsets",
               ("shelf", "4 cameras", "newest", "average PCP"), ">=", 96.3, "%",
               "4D Association 93.8"),
        Target(group, "3 cameras, mean over all subsets",
               ("shelf", "3 cameras", "newest", "average PCP"), ">=", 96, "%"),
        Target(group, "3 cameras, worst subset",
               ("shelf", "3 cameras", "newest", "worst average PCP"), ">=", 94, "%"),
        Target(group, "2 cameras, mean over all subsets",
               ("shelf", "2 cameras", "newest", "average PCP"), ">=", 87, "%"),
        Target(group, "2 cameras, worst subset",
               ("shelf", "2 cameras", "newest", "worst average PCP"), ">=", 75, "%"),
        *(Target(group, f"{n} cameras, switches in all subsets together",
                 ("shelf", f"{n} cameras", "newest", "switches"), "<=", 0)
          for n in (4, 3)),
        Target(group, "2 cameras, switches in all subsets together",
               ("shelf", "2 cameras", "newest", "switches"), "<=", 5),
    ]  # fmt: skip


def _thesis() -> list[Target]:
    group, newest = "thesis scenes", "newest"
    found, error = "joints within 15 cm", "mean error"
    scenes = {
        **{f"{n} {'person' if n == 1 else 'people'}": f"walk_J{n}_C2" for n in (1, 2, 3)},
        **{f"{n} people (made here)": f"made_J{n}_C2" for n in (4, 5, 6)},
        "crossing, worst scene": "cross_*_C2",
        "hiding each other": "*_occl_C2",
        "a person enters 1.5 m from a camera": "close_entry_*_C2",
        "misses, outliers, false people": "hard_*_C2",
    }
    return [
        *(Target(group, f"2 cameras, joints within 15 cm: {text}", ("thesis", scene, newest, found),
                 ">=", 0.98, "", _authors(scene))
          for text, scene in scenes.items()),
        Target(group, "2 cameras, error of people walking, worst of 1 to 3 people",
               ("thesis", "walk_J?_C2", newest, error), "<=", 1.25, "cm", "author's program 19"),
        Target(group, "2 cameras, error of people walking, worst of 4 to 6 people (made here)",
               ("thesis", "made_*_C2", newest, error), "<=", 1.25, "cm"),
        Target(group, "2 cameras, error crossing, worst scene",
               ("thesis", "cross_*_C2", newest, error), "<=", 1.5, "cm"),
        Target(group, "4 cameras, error", ("thesis", "*_C4", newest, error), "<=", 0.9, "cm"),
        Target(group, "identity switches in crossings, worst scene",
               ("thesis", "cross_*", newest, "switches"), "<=", 0, "", "author's program 8"),
        Target(group, "people who left are gone after, latest",
               ("thesis", "*", newest, "gone after, latest"), "<=", 0.5, "s"),
    ]  # fmt: skip


def _authors(scene: str) -> str:
    """Return the joints within 15 cm of the author's program in a scene, or in scenes like it."""
    if scene.startswith("made_J"):
        recall = AUTHORS_CROWDED.get(int(scene[6]))
        return f"author's program {recall:.2f} (another scene)" if recall is not None else ""
    some = [one.recall for name, one in AUTHORS_SCENES.items() if fnmatchcase(name, scene)]
    return f"author's program {min(some):.2f}" if some else ""


def _rooms() -> list[Target]:
    group, where = "simulated rooms, 4 cameras", ("accuracy", "4 cameras, *", "newest")
    regions = "in 90 % regions"
    within: tuple[tuple[str, Relation, float], ...] = (
        ("at least", ">=", 85),
        ("at most", "<=", 95),
    )
    return [
        Target(group, "seeds", (*where, "mean error"), ">=", 20, seeds=True),
        Target(group, "IDF1, up to 10 people", (*where, "IDF1"), ">=", 99.5, "%"),
        Target(group, "identity switches in 10 person-minutes",
               (*where, "switches in 10 person-minutes"), "<=", 1),
        Target(group, "people missed", (*where, "missed"), "<=", 0.5, "%"),
        Target(group, "false positives", (*where, "ghosts"), "<=", 1, "%"),
        Target(group, "limb lengths, standard deviation", (*where, "limb length sd"), "<=", 0.8,
               "cm"),
        *(Target("honest uncertainty", f"90 % regions contain the truth, {text}, {which}",
                 ("uncertainty", "Shelf, 301 frames", lag, "all", regions), relation, limit, "%")
          for lag, text in (("newest", "no lag"), ("lag 0.2 s", "0.2 s lag"))
          for which, relation, limit in within),
        *_on_the_floor(),
    ]  # fmt: skip


def _on_the_floor() -> list[Target]:
    group, acts = "on the floor", ("movement", "* cameras", "on the floor")
    movements = ("lying down", "lying", "falling", "lying after it", "rolling", "getting up",
                 "crawling")  # fmt: skip
    return [
        *(Target(group, f"error {act}, of that walking, worst of 4 and 2 cameras",
                 (*acts, act, "error / walking"), "<=", 1.5, "x")
          for act in movements),
        Target(group, "error of that walking, worst posture in built-in scenes",
               ("scenes", "postures", "*", "error / walking"), "<=", 1.5, "x"),
        Target(group, "identities lost on the floor, worst of all",
               (*acts, "*", "lost"), "<=", 0),
        Target(group, "identities lost on the floor, in built-in scenes",
               ("scenes", "postures", "*", "switches"), "<=", 0),
    ]  # fmt: skip


def _speed() -> list[Target]:
    asked = ((2, 3, 0.15), (4, 4, 0.3), (4, 10, 1.0), (12, 10, 2.0), (12, 50, 10.0))
    peers = {(2, 3): "author's program 4.6-8.5"}
    targets = [
        Target("fusion per frame set", f"{c} cameras x {p} people, median",
               ("speed", "per frame set", f"{c} cameras, {p} people", "median"), "<=", limit,
               "ms", peers.get((c, p), ""))
        for c, p, limit in asked
    ]  # fmt: skip
    targets += [
        Target("fusion per frame set", f"{c} cameras x {p} people, p95 / median",
               ("speed", "per frame set", f"{c} cameras, {p} people", "p95 / median"), "<=", 2.5)
        for c, p, _ in asked
    ]  # fmt: skip
    fit = ("speed", "growth", "from 4 people and cameras")
    return [
        *targets,
        Target("fusion per frame set", "grows with this power of the people", (*fit, "people"),
               "<=", 1.2, "", "author's program 1.75"),
        Target("fusion per frame set", "grows with this power of the cameras", (*fit, "cameras"),
               "<=", 1.1),
    ]  # fmt: skip


ABOUT = {
    "Shelf": "real detections, 4 people, known places; PCP: limbs that are where they should be",
    "thesis scenes": "the thesis' room with two cameras, Gaussian noise of 3 px",
    "simulated rooms, 4 cameras": "people come and go; errors of a real detector; worst room",
    "honest uncertainty": "on Shelf, all frames: how often the truth is in the stated region",
    "on the floor": "recorded motion before the same detector, against recorded walking",
    "fusion per frame set": "from 2D key points to people in 3D, one thread, warm",
    "real video": "the sample recording of Pose2Sim",
    "pipeline": "videos in, people in 3D out",
    "live site": "RTSP cameras in, people on the page out; all of it on two cores",
    "live page": "the operator page and its process",
    "storing": "what a live site writes",
}
"""What the groups are, in a line."""

FUSION: tuple[Target, ...] = (*_shelf(), *_thesis(), *_rooms(), *_speed())
"""What the fusion is to reach."""

_VIDEO, _COST, _LONG = "real video", "pipeline", "an hour of failing cameras"
_LIVE, _PAGE, _STORE = "live site", "live page", "storing"
_AHEAD = "forecasts on ETH/UCY, table of the other scenes"
_RULES = "rules on people, made scenes"
_LOOKING = "looking at real video"
_EXPORT = "exports and films"

OTHERS: tuple[Target, ...] = (
    Target(_RULES, "F1 of each kind, worst", ("rules", "episodes", "*", "F1"), ">=", 0.97),
    Target(_RULES, "F1, mean of all kinds", ("rules", "episodes", "all", "macro F1"), ">=", 0.98),
    Target(_RULES, "episodes", ("rules", "episodes", "all", "episodes"), ">=", 2000),
    Target(_RULES, "falls told, worst of 4 and 2 cameras, 25 and 8 images/s",
           ("rules", "falls", "*", "recall"), ">=", 0.99),
    Target(_RULES, "falls, with each number of cameras and images/s",
           ("rules", "falls", "*", "falls"), ">=", 50),
    Target(_RULES, "normal days: false alarms per camera-day",
           ("normal_days", "false alarms per camera-day"), "<=", 0.3),
    Target(_RULES, "normal days: false alarms per camera-day, surely below",
           ("normal_days", "surely below, per camera-day"), "<=", 0.3),
    Target(_RULES, "episodes: median lead of early warnings",
           ("rules", "episodes", "early warnings", "median lead"), ">=", 1.0, "s"),
    Target(_AHEAD, "ADE, published protocol",
           ("forecast", "mean, published protocol", "ADE"), "<=", 0.515, "m"),
    Target(_AHEAD, "FDE, published protocol",
           ("forecast", "mean, published protocol", "FDE"), "<=", 1.09, "m"),
    Target(_AHEAD, "ADE, true time", ("forecast", "mean, true time", "ADE"), "<=", 0.445, "m"),
    Target(_AHEAD, "FDE, true time", ("forecast", "mean, true time", "FDE"), "<=", 0.93, "m"),
    Target(_AHEAD, "largest error of coverage of a level and horizon, true time",
           ("forecast", "mean, true time", "largest coverage error*", "*"), "<=", 0.02),
    Target(_AHEAD, "4.8 s for 50 people, thread time, least",
           ("forecast", "cost, 50 people", "thread time, least"), "<=", 2, "ms"),
    Target(_LOOKING, "an eighth of the looks, lag 0.1 s or more: processor time / full",
           ("looking", "*Person", "budget 1/8", "*", "processor time / full"), "<=", 0.125),
    Target(_LOOKING, "the same: error at left-out cameras / full",
           ("looking", "*Person", "budget 1/8", "*", "median / full"), "<=", 1.03, "x"),
    Target(_LOOKING, "the same: p90 / full",
           ("looking", "*Person", "budget 1/8", "*", "p90 / full"), "<=", 1.05, "x"),
    Target(_LOOKING, "the same: joints faster than 2 m/s / full",
           ("looking", "*Person", "budget 1/8", "*", "fast joints / full"), "<=", 1.10, "x"),
    Target(_LOOKING, "people who lie, found in turned pictures",
           ("looking", "lying", "found", "looks by need"), ">=", 90, "%"),
    Target("simulating", "4 cameras x 4 people",
           ("simulating", "4 cameras, 4 people", "times real time"), ">=", 50, "x real time"),
    Target("simulating", "12 cameras x 50 people",
           ("simulating", "12 cameras, 50 people", "times real time"), ">=", 2, "x real time"),
    Target("simulated detector", "figures off those of the real one, worst",
           ("detector_figures", "*", "off by"), "<=", 10, "%"),
    Target("reading 2D poses", "an image of Shelf (2.9 people), processor time",
           ("reading", "Shelf", "processor time, least"), "<=", 60, "us"),
    Target("evaluating", "an hour of 4 people, time",
           ("evaluating", "an hour of 4 people", "time"), "<=", 60, "s"),
    Target("evaluating", "an hour of 4 people, peak memory",
           ("evaluating", "an hour of 4 people", "peak memory"), "<=", 2000, "MB"),
    Target(_LONG, "memory, growth after the first tenth",
           ("soak", "memory", "growth since a tenth"), "<=", 5, "MB"),
    Target(_LONG, "time per frame set, last tenth / first, by the calibration",
           ("soak", "time per frame set", "last / first, median*"), "<=", 1.15),
    Target(_LONG, "exceptions, and snapshots that are not finite", ("soak", "faults", "*"),
           "<=", 0),
    Target(_LONG, "identities of somebody who stands throughout",
           ("soak", "somebody who stands*", "identities"), "<=", 1),
    Target("images one by one", "joints from those of frame sets, median",
           ("arrival", "*", "joints apart, median"), "<=", 6, "mm"),
    Target(_VIDEO, "two actors tracked, share of frame sets",
           ("real_video", "two actors", "tracked*"), ">=", 0.95),
    Target(_VIDEO, "reprojection error of limb joints, median",
           ("real_video", "two actors", "median reprojection error"), "<=", 12, "px"),
    Target(_VIDEO, "other people than the two actors (the bystander is one)",
           ("real_video", "others", "people"), "<=", 1),
    Target(_VIDEO, "the same man in both scenes apart, median",
           ("real_video", "two actors", "same man*"), "<=", 5, "cm"),
    Target(_COST, "whole pipeline / estimation alone, wall time",
           ("pipeline_cost", "whole pipeline / estimation alone", "wall time"), "<=", 1.15),
    Target(_COST, "peak memory, four videos of 1920 x 1080",
           ("pipeline_cost", "peak memory", "*"), "<=", 1500, "MB"),
    Target(_LIVE, "rate of the estimator alone that is fused, 4 x 720p at 20 images/s",
           ("live", "of the estimator alone"), ">=", 85, "%"),
    Target(_LIVE, "image to program beyond the estimate, median",
           ("live", "beyond the estimate, median"), "<=", 250, "ms"),
    Target(_LIVE, "image to program beyond the estimate, p95",
           ("live", "beyond the estimate, 95th percentile"), "<=", 500, "ms"),
    Target(_LIVE, "hours of video at full load, memory, growth",
           ("soak_live", "memory, *", "growth"), "<=", 3, "%"),
    Target(_PAGE, "tracking time with 20 viewers and one that reads nothing, change",
           ("page", "tracking", "change with viewers"), "<=", 5, "%"),
    Target(_PAGE, "12 cameras, 50 people at 25 Hz, newest image to the page, p99",
           ("page", "image to page", "p99"), "<=", 100, "ms"),
    Target(_PAGE, "first paint in Chromium", ("page_start", "first paint"), "<=", 1000, "ms"),
    Target(_PAGE, "size, compressed", ("page_start", "size"), "<=", 250, "kB"),
    Target(_PAGE, "draw calls with 50 people", ("page_start", "draw calls*"), "<=", 20),
    Target(_STORE, "an hour of 20 people at 25 Hz, with state, velocity, covariance",
           ("storing", "live", "an hour of 20 people"), "<=", 250, "MB"),
    Target(_STORE, "an hour of 20 people at 25 Hz, without them",
           ("storing", "live", "an hour, without*"), "<=", 120, "MB"),
    Target(_STORE, "tracks.parquet, a second of a person at 25 Hz, with all covariances",
           ("storing", "tracks.parquet", "per person and second"), "<=", 3472, "bytes"),
    Target(_STORE, "error of a standard deviation by rounding, worst",
           ("storing", "rounding", "standard deviation*"), "<=", 1, "%"),
    Target(_STORE, "writing, share of one core", ("storing", "live", "writing, share*"), "<=", 2,
           "%"),
    Target(_STORE, "lost by kill -9, worst", ("storing", "live", "lost by a kill*"), "<=", 2, "s"),
    Target(_EXPORT, "an hour of 4 people, slowest format, wall time",
           ("exporting", "*", "wall time"), "<=", 60, "s"),
    Target(_EXPORT, "an hour of 4 people, format with the most memory, peak",
           ("exporting", "*", "peak memory"), "<=", 2000, "MB"),
    Target(_EXPORT, "a film over 4 videos of 1280 x 720 px, wall time",
           ("filming", "over 4 videos", "wall time"), ">=", 2, "x real time"),
    Target("start", "`trecsim --help`", ("startup", "wall time", "trecsim --help"), "<=", 0.4,
           "s"),
    Target("start", "`trecsim demo`, kernels compiled on the way, until people are on its page",
           ("startup", "wall time", "trecsim demo, kernels*: people*"), "<=", 30, "s"),
    Target("start", "`trecsim demo` again, until people are on its page",
           ("startup", "wall time", "trecsim demo, again: people*"), "<=", 10, "s"),
)  # fmt: skip
"""What everything else is to reach."""
