"""Parts of the fusion can be switched off from outside, and everything is put back."""

import dataclasses
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import ablation
import ablation_inputs
import ablation_scores
import ablation_tables
from harness import figures
from harness.figures import Figures, once, over_seeds, summed
from harness.switching import NoSuchPart, replaced
from made_results import result, runs
from parts import FULL, PARTS, Part, by_name
from trecsim.fusion import FusionSettings, kernels

PREFILTER = kernels.prefilter


def everything() -> dict[tuple[str, str], int]:
    """Return what every name in every module and class of the fusion stands for."""
    found: dict[tuple[str, str], int] = {}
    for module in sorted(sys.modules):
        if module.startswith("trecsim.fusion"):
            for name, thing in vars(sys.modules[module]).items():
                found[module, name] = id(thing)
                if isinstance(thing, type):
                    found |= {(f"{module}.{name}", n): id(v) for n, v in vars(thing).items()}
    return found


@pytest.mark.parametrize("part", by_name().values(), ids=lambda part: part.name)
def test_every_part_can_be_switched_off_and_on_again(part: Part) -> None:
    before = everything()
    FusionSettings(**part.settings)
    with part.off():
        assert (everything() != before) == bool(part.model or part.changes)
    assert everything() == before


def test_every_part_switches_something_off_and_says_what_happens_instead() -> None:
    for part in by_name().values():
        something = part.settings or part.model or part.changes or part.lag_s
        assert bool(something) == bool(part.instead) == (part.name != FULL)
    assert len(by_name()) == 1 + sum(map(len, PARTS.values()))


def test_a_constant_of_a_kernel_counts_in_all_that_call_it_and_only_for_as_long() -> None:
    module = sys.modules["trecsim.fusion.kernels.prefilter"]
    usual = module.score_to_sigma_scale(0.5, 1.0)
    with replaced("steep", {"kernels.prefilter.SCORE_POWER": 0.0}):
        assert module.score_to_sigma_scale(0.5, 1.0) == 1.0
        assert kernels.prefilter is module.prefilter
        assert kernels.prefilter is not PREFILTER
    assert module.score_to_sigma_scale(0.5, 1.0) == usual > 1.0
    assert kernels.prefilter is PREFILTER


def test_kernels_compiled_anew_share_no_name_with_those_of_the_cache() -> None:
    """Code is linked by names: an old kernel of the same name would be called instead."""
    names = {PREFILTER.py_func.__qualname__}
    for which in ("one", "other"):
        with replaced(which, {"kernels.prefilter.SCORE_POWER": 0.0}):
            names.add(kernels.prefilter.py_func.__qualname__)
    assert len(names) == 3


def test_a_function_is_replaced_everywhere_or_only_where_the_path_says() -> None:
    locating, matching, mixture = (
        sys.modules[f"trecsim.fusion.kernels.{name}"]
        for name in ("locating", "matching", "mixture")
    )
    usual = mixture.project
    with replaced("here", {"kernels.locating.project": lambda *_: 0.0}):
        assert locating.project is not usual
        assert matching.project is mixture.project is usual
        assert (
            locating.locate_joint
            is sys.modules["trecsim.fusion.kernels.fitting_kernels"].locate_joint
        )
    with replaced("everywhere", {"kernels.mixture.project": lambda *_: 0.0}):
        assert locating.project is matching.project is mixture.project is not usual


@pytest.mark.parametrize("path", ["kernels.locating.gone", "gone.turned", "tracker.Tracker.gone"])
def test_what_is_no_longer_there_is_named(path: str) -> None:
    with pytest.raises(NoSuchPart, match=path), replaced("gone", {path: 1.0}):
        pass


def row(error: float, switches: float, depth: float = 10.0) -> Figures:
    values = [error - 0.01, error, error + 0.01]
    return {
        "4 cameras": {"error": over_seeds(runs(*values), "cm")},
        "2 cameras": {"switches": summed(runs(switches, 0.0))},
        "one camera, new": {"off in depth": once(depth, "cm", matters=1.0)},
        "time a step": {"of the full model's": once(100.0, "%", matters=5.0)},
    }


AIMS = [["one camera, new", "off in depth"], ["Shelf, 5 cameras", "average PCP"]]


def stored(**rows: tuple[Figures, str]):
    """Return a result of rows, each with its figures and the version of the code."""
    named = {name.replace("_", " "): made for name, made in rows.items()}
    return result(
        {name: figures for name, (figures, _) in named.items()},
        "ablation",
        rows={name: {"code": code, "commit": "abc"} for name, (_, code) in named.items()},
        parts={name: {"group": "some", "instead": "nothing", "aims": AIMS} for name in named},
    )


def test_rows_show_only_what_differs_beyond_noise_and_bold_what_is_worse() -> None:
    made = stored(
        the_full_model=(row(2.0, 3.0), "now"),
        worse=(row(3.0, 15.0, 20.0), "now"),
        same=(row(2.0, 3.0), "now"),
        better=(row(1.5, 3.0, 8.0), "now"),
    )
    lines = ablation_tables.ablation({"ablation": made}).splitlines()[2:]
    cells = {line.split(" | ")[0].strip("| "): line.split(" | ")[1:] for line in lines}
    assert cells[FULL][1:3] == ["2.00", "–"]
    assert cells["worse"][1:3] == ["**+1.00**", "–"]
    assert cells["worse"][-2:] == ["**+12**", "· |"]
    assert cells[FULL][-2:] == ["3", "100 |"]
    assert cells["same"][-2:] == ["·", "· |"]
    assert cells["better"][1] == "−0.50"
    assert set(cells["same"][1:]) == {"·", "–", "· |"}
    missing = "Shelf, 5 cameras, average PCP: –"
    assert cells["worse"][0] == f"one camera, new, off in depth: 10 → **20** cm<br>{missing}"
    assert cells["same"][0] == f"one camera, new, off in depth: 10 → 10 cm ·<br>{missing}"
    assert cells["better"][0] == f"one camera, new, off in depth: 10 → 8 cm<br>{missing}"


def test_switches_are_summed_over_what_every_row_is_tracked_on() -> None:
    elsewhere = {**row(2.0, 3.0), "Shelf, 5 cameras": {"switches": summed(runs(50.0))}}
    made = stored(the_full_model=(elsewhere, "now"), without=(row(2.0, 3.0), "now"))
    lines = ablation_tables.ablation({"ablation": made}).splitlines()[2:]
    assert lines[0].split(" | ")[-2] == "3"
    assert lines[-1].split(" | ")[-2] == "·"


def test_parts_without_which_nothing_is_worse_are_listed() -> None:
    made = stored(
        the_full_model=(row(2.0, 3.0), "now"),
        worse=(row(3.0, 3.0), "now"),
        same=(row(2.0, 3.0), "now"),
        better=(row(1.5, 3.0), "now"),
        older=(row(2.0, 3.0), "then"),
    )
    told = ablation_tables.idle({"ablation": made})
    assert told.splitlines() == [
        "- **same**: not one figure differs.",
        "- **better**: better without it: 4 cameras, error −0.50 cm.",
    ]
    assert "older (an older version)" in ablation_tables.ablation({"ablation": made})


def test_every_part_is_for_figures_of_inputs_that_there_are() -> None:
    for part in by_name().values():
        assert part.aims
        for name, figure in part.aims:
            assert name in ablation_inputs.NAMES
            assert figure in ablation_scores.KINDS


def test_every_input_but_the_common_ones_is_what_some_part_is_for() -> None:
    aimed = {name for part in by_name().values() for name, _ in part.aims}
    assert set(ablation_inputs.NAMES) <= aimed | set(ablation_inputs.COMMON)


def test_columns_show_figures_of_the_common_inputs() -> None:
    for column in ablation_tables.COLUMNS:
        if column.group in ablation_inputs.COMMON:
            assert column.figure in ablation_scores.KINDS
        else:
            assert (column.group, column.figure) in {
                ablation_tables.SWITCHES, (ablation.COST, ablation.STEP)
            }  # fmt: skip


def test_scores_are_a_mean_of_many_runs_a_sum_of_counts_and_else_one_figure() -> None:
    found = ablation_scores.figures_of(
        {str(n): {"error": float(n), "switches": 1.0, "in 90 % regions": 80.0 + n}
         for n in range(4)}
    )  # fmt: skip
    assert [found[name].kind for name in ("error", "switches")] == ["mean", "sum"]
    assert [found[name].value for name in ("error", "switches")] == [1.5, 4.0]
    assert found["90 % regions, off by"].value == 8.5
    assert ablation_scores.figures_of({"a": {"error": 1.0}, "b": {"error": 4.0}})["error"] == once(
        2.5, "cm"
    )


def test_a_row_is_tracked_without_its_part_on_the_common_inputs_and_on_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[str, bool]] = []

    def runs_of(name: str, quick: bool):
        asked.append((name, quick))
        yield "one", lambda overrides, lag_s: {"error": overrides.get("reidentify_s", 5.0)}

    monkeypatch.setattr(ablation_inputs, "runs_of", runs_of)
    monkeypatch.setattr(
        ablation_inputs, "step_ms", lambda overrides, _: 3.0 if "reidentify_s" in overrides else 2.0
    )
    without = frozenset({"2 cameras"})
    found = ablation.row(ablation.Task("re-identification", without, {}, True))
    inputs = ("4 cameras", "built-in scenes", "coming and going", "5 images a second")
    assert asked == [(name, True) for name in inputs]
    assert (
        found["4 cameras"]["error"].value == by_name()["re-identification"].settings["reidentify_s"]
    )
    assert found[ablation.COST][ablation.STEP].value == 150.0
    full = ablation.row(ablation.Task(FULL, without, {}, True))
    assert full["4 cameras"]["error"].value == 5.0
    assert full[ablation.COST][ablation.STEP].value == 100.0


def test_a_row_is_outdated_once_its_part_is_switched_off_in_another_way(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    names = list(by_name())[1:3]
    about = {"code": "now", "commit": "abc", "date": "today"}
    before = ablation.merged(None, {name: row(2.0, 0.0) for name in names}, about)
    assert ablation.outdated(before, names, "now") == []
    changed = dataclasses.replace(by_name()[names[0]], settings={"flip_share": 0.5})
    parts = {**by_name(), names[0]: changed}
    monkeypatch.setattr("parts.by_name", lambda: parts)
    assert ablation.outdated(before, names, "now") == names[:1]


def test_after_an_interrupt_the_rows_that_are_done_are_kept_and_not_done_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[list[str]] = []

    def interrupted(names: list[str], _: object) -> Iterator[tuple[str, Figures]]:
        asked.append(names)
        yield from ((name, row(2.0, 3.0)) for name in names[:2])
        raise KeyboardInterrupt

    monkeypatch.setattr(ablation, "RESULTS", tmp_path)
    monkeypatch.setattr(ablation, "_run", interrupted)
    assert [ablation.main([]), ablation.main([])] == [130, 130]
    assert asked == [list(by_name()), list(by_name())[2:]]
    kept = figures.stored("ablation", tmp_path)
    assert kept is not None
    assert list(kept.figures) == list(by_name())[:4]
    assert ablation.main(["--only", "re-identification", "--quick"]) == 130
    assert asked[-1] == [FULL, "re-identification"]
    assert figures.stored("ablation", tmp_path) == kept
    capsys.readouterr()
    assert ablation.main(["--only", "wings"]) == 2
    assert "no part is called wings" in capsys.readouterr().err


def test_rows_of_another_version_of_the_code_are_done_anew_and_new_rows_join_in_order() -> None:
    names = list(by_name())
    about = {**result({}, "ablation").about, "code": "now", "commit": "abc"}
    before = ablation.merged(None, {names[2]: row(2.0, 0.0)}, about)
    after = ablation.merged(before, {FULL: row(1.0, 0.0)}, {**about, "code": "later"})
    assert list(after.figures) == [FULL, names[2]]
    assert after.about["missing"] == [name for name in names if name not in (FULL, names[2])]
    told = ablation_tables.ablation({"ablation": after}).splitlines()[-1]
    assert told == f"Not measured yet: {', '.join(after.about['missing'])}."
    assert ablation.outdated(after, names[:3], "later") == names[1:3]
    assert ablation.outdated(None, names[:3], "now") == names[:3]
    assert after.about["parts"][names[2]]["instead"] == by_name()[names[2]].instead
