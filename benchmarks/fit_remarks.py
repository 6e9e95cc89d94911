"""What is said of recordings whose poses and rig do not fit, and that nothing is said of good ones.

Every recording (synthetic scenes and, where the data is there, Shelf, the thesis' scenes and the
sample recording) is given every fault once. What is said must name the fault; of the recording as
it is nothing must be said. With two cameras some faults cannot be told: a camera that is turned by
a little, or two times that differ, may look as if people were elsewhere.

Run: ``python benchmarks/fit_remarks.py [NAME...] [--faults FAULT...] [--seeds SEED...] [--texts]``
"""

import argparse
import logging
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from harness.machine import ROOT
from harness.options import SHARED_DATA, Options, sample_folder

if TYPE_CHECKING:
    from trecsim.geometry import Rig
    from trecsim.values import Poses2D

sys.path.insert(0, str(ROOT / "tests"))

Recording = "tuple[Rig, list[Poses2D]]"
KNOCKED = "camera-knocked"  # the scene that has a fault


class Fault(NamedTuple):
    """A fault, and what a remark on it must say.

    Attributes
    ----------
    make
        Turns a good recording into one with the fault.
    said
        One of these is part of what is said.
    """

    make: Callable[["Rig", "list[Poses2D]"], "tuple[Rig, list[Poses2D]]"]
    said: tuple[str, ...]


def faults() -> dict[str, Fault]:
    """Return all faults by name; "none" is none."""
    import made_faults as made

    def every(change: "made.Change") -> Callable[..., tuple]:
        return lambda rig, poses: (rig, made.in_order(made.changed(poses, change)))

    def second(change: "made.Change") -> Callable[..., tuple]:
        return lambda rig, poses: (rig, made.in_order(made.changed(poses, change, rig.names[1])))

    def turned(*turn_deg: float, shift_m: tuple[float, ...] = (0, 0, 0)) -> Callable[..., tuple]:
        return lambda rig, poses: (made.turned(rig, rig.names[1], turn_deg, shift_m), poses)

    def knocked(*turn_deg: float) -> Callable[..., tuple]:
        return lambda rig, poses: (
            rig,
            made.knocked(poses, rig, rig.names[1], _middle_s(poses), turn_deg),
        )

    beside = ("does not look where", "does not agree", "do not agree", "no two cameras agree")
    clock = ("begin", "no time in common", "do not agree", "times are wrong")
    return {
        "none": Fault(lambda rig, poses: (rig, poses), ()),
        "half size": Fault(every(made.scaled(0.5)), ("images half the size",)),
        "double size": Fault(every(made.scaled(2.0)), ("images twice the size",)),
        "2/3 size": Fault(every(made.scaled(2 / 3)), ("images 2/3 the size",)),
        "half size, one": Fault(second(made.scaled(0.5)), ("images half the size",)),
        "0 to 1": Fault(every(made.scaled(1 / 1920, 1 / 1080)), ("0 to 1",)),
        "clocks apart": Fault(_apart, ("no two cameras have a time in common",)),
        "late by 10 s": Fault(second(made.later(10.0)), clock),
        "half the rate": Fault(
            lambda rig, poses: (rig, made.at_half_rate(poses, rig.names[1])), ("rate", *clock)
        ),
        "turned 10 deg": Fault(turned(0.0, 10.0, 0.0), beside),
        "turned 5 deg": Fault(turned(0.0, 5.0, 0.0), beside),
        "turned 2 deg": Fault(turned(0.0, 2.0, 0.0), beside),
        "moved 1 m": Fault(turned(0.0, 0.0, 0.0, shift_m=(1.0, 0.0, 0.0)), beside),
        "mirrored, one": Fault(
            lambda rig, poses: (rig, made.changed(poses, made.mirrored(rig), rig.names[1])),
            ("mirrored",),
        ),
        "exchanged": Fault(_exchanged, ("exchanged",)),
        "wrong rig": Fault(lambda rig, poses: (made.elsewhere(rig), poses), ("agree on where",)),
        "knocked 2 deg": Fault(knocked(0.0, 2.0, 0.0), ("have been moved",)),
        "knocked 5 deg": Fault(knocked(0.0, 5.0, 0.0), ("have been moved",)),
    }


def _middle_s(poses: "Sequence[Poses2D]") -> float:
    times_s = [one.t_s for one in poses]
    return 0.5 * (min(times_s) + max(times_s))


def _apart(rig: "Rig", poses: "list[Poses2D]") -> tuple:
    import made_faults as made

    shift = {name: made.later(4000.0 * n) for n, name in enumerate(rig.names)}
    return rig, made.in_order(shift[one.camera](one) for one in poses)


def _exchanged(rig: "Rig", poses: "list[Poses2D]") -> tuple:
    import made_faults as made

    one, other = rig.names[:2]
    return rig, made.changed(poses, made.renamed(**{one: other, other: one}))


def recordings(seeds: Sequence[int]) -> dict[str, Callable[[], tuple]]:
    """Return what makes or reads each recording, by name."""
    from trecsim.lab.simulation import BUILT_IN

    found: dict[str, Callable[[], tuple]] = {}
    for name in BUILT_IN:
        for seed in seeds or (None,):
            found[name if seed is None else f"{name} {seed}"] = partial(_scene, name, seed)
    if seeds:
        return found
    for path in sorted((SHARED_DATA / "thesis_scenes").glob("*.npz")):
        found[f"thesis {path.stem}"] = partial(_thesis, path)
    if (SHARED_DATA / "shelf").is_dir():
        found["Shelf"] = _shelf
    for name in ("SinglePerson", "MultiPerson"):
        if (SHARED_DATA / "pose2sim_demo" / name).is_dir():
            found[f"sample {name}"] = partial(_sample, name)
    return found


def _scene(name: str, seed: int | None) -> tuple:
    from trecsim.lab.simulation import read_scene, simulate

    made = simulate(read_scene(name), seed)
    return made.rig, list(made.poses)


def _thesis(path: Path) -> tuple:
    from thesis import read

    poses, rig, _ = read(path)
    return rig, poses


def _shelf() -> tuple:
    from harness.shelf_recording import read_shelf

    shelf = read_shelf(SHARED_DATA / "shelf")
    return shelf.rig, list(shelf.poses)


def _sample(name: str) -> tuple:
    from trecsim.calibration import read_rig
    from trecsim.estimators.pool import estimate

    folder = sample_folder(Options()) / name
    rig = read_rig(folder / "Calib.qca.txt")
    videos = dict(zip(rig.names, sorted((folder / "videos").glob("*.mp4")), strict=True))
    return rig, list(estimate(videos))


def followed(rig: "Rig", poses: "Sequence[Poses2D]") -> tuple[list[str], float, float]:
    """Return what is said, and the processor time of the fusion and of the watching [s]."""
    from trecsim.consistency import Consistency
    from trecsim.fusion import Tracker
    from trecsim.sync import frame_sets

    tracker, watch, said = Tracker(rig), Consistency(rig), []
    fusion_s = watch_s = 0.0
    offsets_s = {camera.name: camera.time_offset_s for camera in rig}
    for frame_set in frame_sets(iter(poses), offsets_s=offsets_s):
        began_s = time.process_time()
        snapshot = tracker.step(frame_set)
        between_s = time.process_time()
        said += watch.observe(frame_set, snapshot)
        fusion_s += between_s - began_s
        watch_s += time.process_time() - between_s
    began_s = time.process_time()
    said += watch.end()
    return said, fusion_s, watch_s + time.process_time() - began_s


class Row(NamedTuple):
    """What is said of one recording."""

    cameras: int
    said: dict[str, list[str]]
    cost: float


def row(make: Callable[[], tuple], wanted: Sequence[str]) -> Row:
    """Give one recording every fault."""
    logging.disable(logging.WARNING)
    rig, poses = make()
    said, cost = {}, float("nan")
    for name, fault in faults().items():
        if name in wanted:
            said[name], fusion_s, watch_s = followed(*fault.make(rig, poses))
            if name == "none":
                cost = watch_s / fusion_s
    return Row(len(rig), said, cost)


def mark(fault: Fault, said: Sequence[str]) -> str:
    """Return "yes" where the fault is named, "no" where another cause is, "-" where nothing is."""
    if not said:
        return "-"
    return "yes" if any(part in text for part in fault.said for text in said) else "no"


def heading(wanted: Sequence[str]) -> str:
    """Return the first two lines of the table."""
    return (
        f"| recording | cameras | watching / fusion | {' | '.join(wanted)} |\n"
        + "|---" * (len(wanted) + 3)
        + "|"
    )


def line(name: str, one: Row, wanted: Sequence[str]) -> str:
    """Return the line of a recording: which faults are named."""
    every = faults()
    if KNOCKED in name:  # its own fault is to be named where no other is made
        every["none"] = every["none"]._replace(said=("have been moved",))
    marks = [mark(every[fault], one.said[fault]) for fault in wanted]
    return f"| {name} | {one.cameras} | {one.cost:.1%} | {' | '.join(marks)} |"


def totals(rows: Iterable[Row], wanted: Sequence[str]) -> Iterator[str]:
    """Yield lines with the number of recordings in which each fault is named."""
    every = faults()
    for least, most, which in ((2, 2, "two cameras"), (3, 99, "three cameras and more")):
        some = [one for one in rows if least <= one.cameras <= most]
        named = (sum(mark(every[f], one.said[f]) == "yes" for one in some) for f in wanted)
        yield f"| **named, {which}** | {len(some)} | | {' | '.join(map(str, named))} |"


def main() -> None:
    """Print the table; fail where something is said of a good recording."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="recordings; all without")
    parser.add_argument("--faults", nargs="+", choices=list(faults()), default=list(faults()))
    parser.add_argument("--seeds", nargs="+", type=int, default=(), help="of the built-in scenes")
    parser.add_argument("--texts", action="store_true", help="also print what is said")
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    known = recordings(given.seeds)
    wanted = {n: known[n] for n in given.names or known}
    rows: dict[str, Row] = {}
    print(heading(given.faults), flush=True)
    with ProcessPoolExecutor(given.jobs) as pool:
        found = pool.map(partial(row, wanted=given.faults), wanted.values())
        for name, one in zip(wanted, found, strict=True):
            rows[name] = one
            print(line(name, one, given.faults), flush=True)
    print(*totals(list(rows.values()), given.faults), sep="\n")
    if given.texts:
        for name, one in rows.items():
            for fault, said in one.said.items():
                print(f"\n{name}, {fault}:", *(said or ["nothing"]), sep="\n  ")
    false = [n for n, one in rows.items() if one.said.get("none") and KNOCKED not in n]
    if false:
        raise SystemExit(f"said of good recordings: {', '.join(false)}")


if __name__ == "__main__":
    main()
