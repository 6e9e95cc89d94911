"""False alarms of 25 kinds of rules on normal days of a small station with four cameras.

People come and go by a profile over the 24 hours: nearly nobody at night, four or five at a time in
the morning and evening; `ruled/station.py` says what they do. The detector has the errors of a real
one, all rules have their defaults. A false alarm is an episode that a naive reading of the
definitions does not find on the exact joints (`trecsim.lab.true_events`); zones entered, left and
dwelt in, and lines crossed, are counted apart, and so are early warnings.

A day is made in quarters of an hour, the first of each hour first: ``--days 0.25`` are those, and
``--days 0.125`` those of every other hour. Each is kept as soon as it is done, in the cache folder,
by the code that made it: the same command goes on after Ctrl-C, and with a larger ``--days``. Days
from seed 1000; the rules were tuned on those below.

Run: ``python benchmarks/normal_days.py [--days N]``; ``--quick`` for two hours
"""

import argparse
import hashlib
import math
import pickle
import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.command import alone
from harness.demo_video import cache_folder
from harness.figures import Figures, once
from harness.machine import ROOT
from harness.options import Options
from ruled import judging, station
from ruled.alarm_figures import DAY_S, alarm_figures, warning_figures
from ruled.warnings_told import Warned, warnings_of

if TYPE_CHECKING:
    from trecsim.lab.evaluation.event_episodes import EpisodeTold
    from trecsim.lab.evaluation.event_scores import EventScores
    from trecsim.values import Snapshot

DAYS, QUICK_HOURS = 10, (6, 7)
PER_HOUR = round(3600.0 / station.PIECE_S)
HOURS = (8, 20, 14, 2, 17, 5, 11, 23, 0, 12, 6, 18, 3, 15, 9, 21, 7, 19, 1, 13, 4, 16, 10, 22)
"""The order of the hours, so that a few of them are spread over the day."""
HAS_A_SAY = (
    "assessing.py", "cloud_events.py", "compiler.py", "floor_points.py", "kernel_entries.py",
    "skeleton.py", "tracking.py", "values.py", "consistency", "forecasting", "fusion", "geometry",
    "lab/evaluation", "lab/simulation", "lab/true_events", "safety", "sites", "sync",
)  # fmt: skip
"""What is told and what is true depends on these sources: who changes one begins anew."""
TRUTH_EVERY = 5
"""Of the exact joints, 50 times a second, every fifth moment is enough for spans of a second."""
NOBODY_S = 1.0
"""While nobody is tracked, rules look so often [s]."""
NEAR_S = (2.0, 10.0)
"""A true episode explains one that is told so long before or after its beginning [s]."""


@dataclass(frozen=True, slots=True)
class Piece:
    """What came of a quarter of an hour.

    Attributes
    ----------
    kinds
        Scores by kind of rule.
    warned
        Early warnings.
    remarks
        Alarms that no true episode explains, a line each.
    seconds, people_s
        Length, and the sum of everybody's stay [s].
    processor_s
        What it took [s].
    """

    kinds: "Mapping[str, EventScores]"
    warned: tuple[Warned, ...]
    remarks: tuple[str, ...]
    seconds: float
    people_s: float
    processor_s: float


def measure(options: Options, days: float) -> Figures:
    """Measure false alarms of all rules on normal days, early warnings apart."""
    hours = QUICK_HOURS if options.quick else HOURS
    seeds = options.seeds(math.ceil(days), 1)
    tasks = [
        (seed, hour * PER_HOUR + quarter, options.overrides)
        for seed in seeds
        for quarter in range(PER_HOUR)
        for hour in hours
    ]
    if not (options.quick or options.only_seeds):
        tasks = tasks[: round(days * 24 * PER_HOUR)]
    options.input.update(data="made scenes", seeds_from=1000, pieces=len(tasks))
    pieces = []
    for one in options.over(kept, tasks, "quarters of an hour"):
        pieces.append(one)
        for remark in one.remarks:
            options.tell(remark)
    return _figures(pieces)


def _figures(pieces: list[Piece]) -> Figures:
    names = sorted({kind for one in pieces for kind in one.kinds})
    kinds = {
        kind: judging.together([one.kinds[kind] for one in pieces if kind in one.kinds])
        for kind in names
    }
    seconds = sum(one.seconds for one in pieces)
    camera_days = station.CAMERAS * seconds / DAY_S
    people_s = sum(one.people_s for one in pieces)
    processor_s = sum(one.processor_s for one in pieces)
    return {
        "camera-days": once(camera_days, "", watched=False),
        "hours of people": once(people_s / 3600.0, "h", watched=False),
        **alarm_figures(kinds, camera_days),
        "early warnings": warning_figures(
            [one for piece in pieces for one in piece.warned], camera_days
        ),
        "processor time of a day": once(
            processor_s / seconds * DAY_S / 60.0, "min", watched=False
        ),
    }  # fmt: skip


def kept(task: tuple[int, int, Mapping[str, Any]]) -> Piece:
    """Return what came of a piece of a day, judged only if it was not yet by this code."""
    day, number, overrides = task
    settings = hashlib.sha256(repr(sorted(overrides.items())).encode()).hexdigest()[:6]
    path = cache_folder() / f"normal-days-{_code()}-{settings}" / f"{day}-{number}.pickle"
    if path.exists():
        found: Piece = pickle.loads(path.read_bytes())
        return found
    made = judged(day, number, overrides)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_bytes(pickle.dumps(made))
    part.replace(path)
    return made


@cache
def _code() -> str:
    """Return a digest of all code that has a say."""
    files = [Path(__file__), *(ROOT / "benchmarks/ruled").glob("*.py")]
    for name in HAS_A_SAY:
        place = ROOT / "src/trecsim" / name
        files += place.rglob("*.py") if place.is_dir() else [place]
    digest = hashlib.sha256()
    for file in sorted(files):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:10]


def judged(day: int, number: int, overrides: Mapping[str, Any]) -> Piece:
    """Return what the rules tell of a piece of a day, beside what is true."""
    import numpy as np

    from trecsim.assessing import RuleEvents
    from trecsim.lab.evaluation.event_episodes import episodes_of
    from trecsim.lab.evaluation.event_scores import compared
    from trecsim.lab.simulation import simulate
    from trecsim.lab.true_events.truth_events import truth_events

    began_s, seed = time.process_time(), 100 * day + number
    who = station.piece(number // PER_HOUR, seed)
    made = simulate(station.scene(who.roles), seed)
    rules = judging.rules_of_site(station.SITE)
    engine = RuleEvents(rules, signals=judging.signals_in(who.messages, station.FEED_NAME))
    snapshots = with_people(judging.tracked(made, overrides))
    events = [event for one in snapshots for event in engine.step(one)]
    told = [one for one in episodes_of(events) if not one.is_warning]
    xyz_m = station.one_by_one(made.truth_xyz_m[:, ::TRUTH_EVERY])
    t_s = made.truth_t_s[::TRUTH_EVERY]
    true = episodes_of(truth_events(station.SITE, t_s, xyz_m, {station.FEED: who.messages}))
    people_s = float(np.isfinite(xyz_m[:, :, 0, 0]).sum() * (t_s[1] - t_s[0]))
    return Piece(
        compared(told, true).kinds,
        tuple(warnings_of(events)),
        tuple(f"day {day}, piece {number}: {one}" for one in unexplained(told, true)),
        station.PIECE_S,
        people_s,
        time.process_time() - began_s,
    )


def with_people(snapshots: "Iterable[Snapshot]") -> "Iterator[Snapshot]":
    """Yield the snapshots, of those without people in a row only one a second."""
    last_s = -NOBODY_S
    for one in snapshots:
        if len(one.id) or one.t_s - last_s >= NOBODY_S:
            last_s = one.t_s
            yield one


def unexplained(told: "list[EpisodeTold]", true: "list[EpisodeTold]") -> Iterator[str]:
    """Yield a line on each alarm near which there is no true episode of its rule."""
    from ruled.alarm_figures import BORDERS

    for one in told:
        around_s = [one.start_s - other.start_s for other in true if other.rule == one.rule]
        if one.kind in BORDERS or any(-NEAR_S[0] <= late_s <= NEAR_S[1] for late_s in around_s):
            continue
        near = min(around_s, key=abs, default=None)
        truth = "no true one" if near is None else f"the nearest true one {near:+.1f} s earlier"
        where = "nowhere" if one.floor_m is None else "({:.2f}, {:.2f}) m".format(*one.floor_m)
        yield f"{one.kind} at {one.start_s:.2f} s, told at {one.detect_s:.2f} s, {where}; {truth}"


def _days(text: str) -> float:
    try:
        days = float(text)
    except ValueError:
        days = math.nan
    if not 0.01 <= days <= 900.0:
        raise argparse.ArgumentTypeError(f"expected 0.01 to 900 days, got {text}")
    return days


def main() -> int:
    """Run it for as many days as asked."""
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--days", type=_days, default=DAYS, metavar="N")
    given, others = parser.parse_known_args()

    def measured(options: Options) -> Figures:
        """Measure false alarms of all rules on normal days, early warnings apart."""
        return measure(options, given.days)

    if "--help" in others:
        print("normal_days.py takes --days N besides what all benchmarks take:\n")
    return alone(__file__, measured, others)


if __name__ == "__main__":
    sys.exit(main())
