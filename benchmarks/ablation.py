"""What each part of the fusion's model is worth: it is switched off, one part after the other.

The parts and how each is switched off stand in ``parts.py``. Every row is stored as soon as it is
done; after Ctrl-C the same command goes on, and rows of an older version of the code are done anew.

Run: ``python benchmarks/ablation.py``; ``--only "sharp turns" --quick`` while working on a part.
"""

import argparse
import hashlib
import os
import pickle
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import ablation_tables as pages
from harness import machine, scoring
from harness.command import ONE_THREAD, add_options, fail
from harness.figures import RESULTS, Figures, Result, Skipped, once, store, stored
from harness.options import REPORTING_SEEDS, Options, shared_data

# Columns of the table: of what kind their scenes are, and which.
GROUPS: dict[str, tuple[str, tuple[Any, ...]]] = {
    "4 cameras": ("room", ((4, 10),)),  # cameras, people
    "2 cameras": ("room", ((2, 3),)),
    "on the floor": ("scene", ("lying-down", "falling", "crawling")),
    "close together": ("scene", ("crossing-30cm", "hugging", "overtaking")),
    "coming and going": ("scene", ("leaving-returning", "side-entry")),
    "trouble": ("scene", ("camera-knocked", "cheap-cameras", "platform-edge")),
    "thesis, walking": ("thesis", ("walk_J1_C2", "walk_J2_C2", "walk_J3_C2", "walk_J3_occl_C2")),
    "thesis, crossing": ("thesis", ("cross_lateral_50cm_C2", "cross_X_occl_C2")),
    "thesis, hard": ("thesis", ("hard_J3_C2", "close_entry_J1_C2")),
    "Shelf, 5 cameras": ("shelf", (5,)),  # all choices of so many cameras
    "Shelf, 2 cameras": ("shelf", (2,)),
}
DATA = {"thesis": "thesis_scenes", "shelf": "shelf"}
SECONDS = 20.0
SEEDS = {"room": 8, "scene": 4}
QUICK_SEEDS = 2
KEPT = ("mean error", "limb length sd", "IDF1", "switches", "missed", "ghosts", "away from 90 %")


@dataclass(frozen=True, slots=True)
class Task:
    """One part switched off in one scene.

    Attributes
    ----------
    part
        Name.
    group, kind, name, seed
        Column group; `room`, `scene`, `thesis` or `shelf`; which one; its seed.
    cache
        Folder for scenes that are made or converted once.
    overrides
        Settings of the fusion that differ from their defaults in every row.
    """

    part: str
    group: str
    kind: str
    name: Any
    seed: int
    cache: Path
    overrides: Mapping[str, Any]

    @property
    def run(self) -> str:
        """What the run is called in the results."""
        if self.kind == "room":
            return str(self.seed)
        name = self.name if isinstance(self.name, str) else " ".join(self.name)
        return f"{name} {self.seed}" if self.kind == "scene" else name


def scores(task: Task) -> dict[str, float]:
    """Return the scores of one part switched off in one scene."""
    import shelf
    from parts import by_name

    part = by_name()[task.part]
    overrides = {**task.overrides, **part.settings}
    with part.off():
        if task.kind == "shelf":
            return shelf.scores((shared_data("shelf"), task.name, part.lag_s, overrides))
        poses, rig, truth = _made(task)
        return scoring.scores(poses, rig, truth, part.lag_s, overrides)


def _made(task: Task) -> Any:
    """Return key points, cameras and truth of a scene, which is made once."""
    kept = task.cache / f"{task.group} {task.run}.pickle"
    if kept.exists():
        return pickle.loads(kept.read_bytes())
    made = _make(task)
    beside = kept.with_suffix(f".{os.getpid()}")
    beside.write_bytes(pickle.dumps(made, pickle.HIGHEST_PROTOCOL))
    beside.replace(kept)
    return made


def _make(task: Task) -> Any:
    import thesis
    from trecsim.lab.simulation import read_scene, simulate
    from trecsim.lab.simulation.scene import room_scene
    from trecsim.store.truth import Truth

    if task.kind == "thesis":
        return thesis.read(shared_data("thesis_scenes") / f"{task.name}.npz")
    if task.kind == "room":
        cameras, people = task.name
        scene = room_scene(people=people, cameras=cameras, seconds=SECONDS)
    else:
        scene = read_scene(task.name)
    made = simulate(scene, task.seed)
    return list(made.poses), made.rig, Truth(made.truth_t_s, made.truth_xyz_m)


def tasks(part: str, options: Options, cache: Path) -> Iterator[Task]:
    """Yield all that is to be run for one row."""
    for group, (kind, names) in GROUPS.items():
        if kind in options.skipped:
            continue
        seeds = options.seeds(SEEDS[kind], QUICK_SEEDS) if kind in SEEDS else [0]
        for name in names if kind != "shelf" else _choices(*names):
            for seed in seeds:
                yield Task(part, group, kind, name, seed, cache, options.overrides)


def _choices(count: int) -> list[tuple[str, ...]]:
    from harness.shelf_recording import read_cameras

    return list(combinations(read_cameras(shared_data("shelf")).names, count))


def row(done: Sequence[tuple[Task, Mapping[str, float]]]) -> Figures:
    """Return the figures of one row, in groups."""
    groups: dict[str, dict[str, Mapping[str, float]]] = {}
    for task, found in done:
        groups.setdefault(task.group, {})[task.run] = found
    out: dict[str, Figures] = {}
    for group, runs in groups.items():
        if GROUPS[group][0] == "shelf":
            out[group] = _on_shelf(runs)
        elif GROUPS[group][0] == "thesis":
            out[group] = _of_thesis(runs)
        else:
            kept = {run: {name: found[name] for name in KEPT} for run, found in runs.items()}
            out[group] = scoring.of_seeds(kept)
    return out


def _on_shelf(runs: Mapping[str, Mapping[str, float]]) -> Figures:
    import shelf

    return {**shelf.subsets(runs), "PCP of actor 4": _mean(runs, "PCP of actor 4", "%", "higher")}


def _of_thesis(runs: Mapping[str, Mapping[str, float]]) -> Figures:
    return {
        "mean error": _mean(runs, "mean error", "cm"),
        "joints within 15 cm": _mean(runs, "joints within 15 cm", "", "higher", 0.003),
        "switches": once(sum(found["switches"] for found in runs.values()), "", matters=0.0),
    }


def _mean(runs: Mapping[str, Mapping[str, float]], name: str, *about: Any) -> Any:
    return once(sum(found[name] for found in runs.values()) / len(runs), *about)


def measure(names: Iterable[str], options: Options, cache: Path) -> Iterator[tuple[str, Figures]]:
    """Yield the figures of each row as soon as it is done."""
    todo = [task for name in names for task in tasks(name, options, cache)]
    last = {task.part: number for number, task in enumerate(todo)}
    done: list[tuple[Task, Mapping[str, float]]] = []
    for number, found in enumerate(options.over(scores, todo, "runs of all rows")):
        done.append((todo[number], found))
        part = todo[number].part
        if number == last[part]:
            options.tell(f"{len([n for n in last.values() if n <= number])} of {len(last)}: {part}")
            yield part, row(done)
            done.clear()


def outdated(before: Result | None, names: Iterable[str], code: str) -> list[str]:
    """Return those of the rows that are not stored, or of another version of the code."""
    made_with = before.about["rows"] if before else {}
    return [name for name in names if made_with.get(name, {}).get("code") != code]


def merged(before: Result | None, new: Mapping[str, Figures], about: Mapping[str, Any]) -> Result:
    """Return all rows in the order of the parts: those stored, and over them the new ones."""
    from parts import PARTS, by_name

    figures = {**(before.figures if before else {}), **new}
    rows = dict(before.about["rows"]) if before else {}
    rows.update({name: {"code": about["code"], "commit": about["commit"]} for name in new})
    known = [name for name in by_name() if name in figures]
    groups = {part.name: group for group, parts in PARTS.items() for part in parts}
    whole = {
        **about,
        "rows": {name: rows[name] for name in known},
        "parts": {
            name: {"group": groups.get(name, ""), "instead": by_name()[name].instead}
            for name in known
        },
    }
    skipped = {**(before.skipped if before else {}), **about.get("skipped", {})}
    return Result("ablation", {name: figures[name] for name in known}, whole, skipped)


def main(arguments: Sequence[str] | None = None) -> int:
    """Switch off what is asked for; return the exit status."""
    given = _parser().parse_args(arguments)
    os.environ.update(ONE_THREAD)
    from parts import by_name

    if unknown := sorted(set(given.only) - set(by_name())):
        return fail(f"no part is called {', '.join(unknown)}; see --list")
    if given.list:
        for part in by_name().values():
            print(f"{part.name}: {part.instead or 'nothing is switched off'}")
        return 0
    options = Options(given.quick, dict(given.set), given.jobs)
    keep = not (given.quick or given.set)
    result = stored("ablation", RESULTS) if keep else None
    about, status = _about(options), 0
    try:
        for name, figures in _run(wanted(result, given.only, about["code"]), options):
            result = merged(result, {name: figures}, {**about, "skipped": dict(options.skipped)})
            if keep:
                store(result, RESULTS / "ablation.json")
    except KeyboardInterrupt:
        kept = "; the rows that were done are kept, and the same command goes on" if keep else ""
        print(f"interrupted{kept}", file=sys.stderr)
        status = 130
    if result is not None:
        print(pages.ablation({"ablation": result}))
        print(f"\nNothing is worse without these:\n{pages.idle({'ablation': result})}")
    return status


def wanted(before: Result | None, only: Sequence[str], code: str) -> list[str]:
    """Return which rows are to be done: what is asked for, and what is missing or outdated."""
    from parts import FULL, by_name

    todo = outdated(before, by_name(), code)
    if only:
        return [n for n in by_name() if n in only or (n == FULL and n in todo)]
    return todo


def _run(names: list[str], options: Options) -> Iterator[tuple[str, Figures]]:
    for kind, folder in DATA.items():
        try:
            shared_data(folder)
        except Skipped as reason:
            options.skipped[kind] = str(reason)
            print(f"skipped {kind}: {reason}", file=sys.stderr)
    with tempfile.TemporaryDirectory() as cache:
        yield from measure(names, options, Path(cache))


def _about(options: Options) -> dict[str, Any]:
    from trecsim.lab.study.code_digest import code_digest

    measured = repr((GROUPS, SEEDS, SECONDS, KEPT)).encode()
    return {
        **machine.describe(),
        "code": f"{code_digest()} {hashlib.sha256(measured).hexdigest()[:6]}",
        "quick": options.quick,
        "input": {"seeds_from": REPORTING_SEEDS[0], "seeds": SEEDS, "seconds": SECONDS},
        "settings": dict(options.overrides),
    }


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add_options(parser)
    parser.add_argument(
        "--only", action="append", default=[], metavar="PART",
        help="only this part (and the full model, if that is not stored); may be given several "
        "times",
    )  # fmt: skip
    parser.add_argument("--list", action="store_true", help="only say which parts there are")
    return parser


if __name__ == "__main__":
    sys.exit(main())
