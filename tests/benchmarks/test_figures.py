"""Figures and results: what is stored is what was measured."""

import json
import math
from pathlib import Path

import pytest

from harness import figures
from harness.figures import Figure, find, leaves, once, over_seeds, summed, timed
from made_results import result, runs

FIGURES = {
    "room": {
        "newest": {
            "error": over_seeds(runs(2.0, 3.0, 4.0), "cm"),
            "lost": over_seeds(runs(math.nan, math.nan), "cm"),
            "switches": summed(runs(1, 0, 2)),
        }
    },
    "speed": timed([2.0, 4.0, 3.0], [10.0, 10.0, 10.0], watched=False),
    "share": once(0.98, "", "higher", matters=0.003),
}


def test_seeds_give_mean_and_standard_deviation() -> None:
    figure = over_seeds(runs(2.0, 3.0, 4.0), "cm")
    assert (figure.value, figure.spread, figure.better) == (3.0, 1.0, "lower")
    assert figure.runs == {"1000": 2.0, "1001": 3.0, "1002": 4.0}


def test_a_seed_without_a_figure_does_not_spoil_the_mean() -> None:
    assert over_seeds(runs(2.0, math.nan, 4.0), "cm").value == 3.0


def test_a_time_is_the_median_of_its_rounds() -> None:
    figure = timed([2.0, 9.0, 3.0], [1.0, 3.0, 1.0])
    assert figure.value == 3.0
    assert figure.relative == (2.0, 3.0, 3.0)


def test_what_is_stored_is_read_again(tmp_path: Path) -> None:
    figures.store(result(FIGURES), tmp_path / "made.json")
    again = figures.stored("made", tmp_path)
    assert again is not None
    assert dict(leaves(again.figures)).keys() == dict(leaves(FIGURES)).keys()
    for path, figure in leaves(FIGURES):
        other = find(again.figures, path)
        assert other is not None
        assert repr(other) == repr(figure), path


def test_stored_json_has_unit_direction_and_spread_and_no_nan() -> None:
    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    whole = json.loads(figures.to_json(result(FIGURES)), parse_constant=refuse)
    leaf = whole["figures"]["room"]["newest"]["error"]
    assert {"value": 3.0, "unit": "cm", "better": "lower", "spread": 1.0}.items() <= leaf.items()
    assert whole["figures"]["room"]["newest"]["lost"]["value"] is None
    assert whole["about"]["commit"] == "abc"


def test_another_format_is_refused() -> None:
    with pytest.raises(ValueError, match=r"trecsim\.benchmark/1"):
        figures.from_json('{"format": "other/1"}')


def test_nothing_is_found_beside_or_below_a_figure() -> None:
    assert find(FIGURES, ("share", "deeper")) is None
    assert find(FIGURES, ("room", "elsewhere")) is None
    assert find(FIGURES, ("room",)) is None
    assert isinstance(find(FIGURES, ("room", "newest", "error")), Figure)


@pytest.mark.parametrize("path", sorted(figures.RESULTS.glob("*.json")), ids=lambda path: path.stem)
def test_results_in_the_repository_are_whole_and_name_no_place(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    stored = figures.from_json(text)
    assert stored.name == path.stem
    assert list(leaves(stored.figures))
    assert {"date", "machine", "versions", "commit", "input", "settings"} <= stored.about.keys()
    assert not stored.about["settings"], "results with overridden settings are not stored"
    assert not stored.about["quick"], "parts are not stored"
    assert "/home" not in text
    assert "/work" not in text
    assert "/tmp" not in text
