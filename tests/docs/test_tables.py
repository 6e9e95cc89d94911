"""Tables in README and documentation are those of the stored results, and none is typed."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

import settings_table
import tables
from harness import pages
from harness.figures import once, over_seeds
from harness.markdown import NOTHING, table, value_of, with_spread
from made_results import result, runs
from targets import ABOUT, FUSION, OTHERS, Target
from trecsim.fusion import FusionSettings


@pytest.mark.parametrize("page", pages.PAGES, ids=lambda page: page.name)
def test_tables_are_those_of_the_stored_results(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    made = pages.filled(text, tables.tables(tables.all_figures.results()))
    assert text == made, "run: make tables"
    assert "<!-- table:" in text


def test_what_stands_between_the_markers_is_made_anew_and_nothing_else() -> None:
    page = "before\n<!-- table: a -->\nold\n<!-- end -->\nafter\n"
    filled = pages.filled(page, {"a": lambda: "new"})
    assert filled == "before\n<!-- table: a -->\n\nnew\n\n<!-- end -->\nafter\n"
    assert pages.filled(filled, {"a": lambda: "new"}) == filled


def test_unknown_tables_and_markers_without_end_are_refused() -> None:
    with pytest.raises(ValueError, match="no table is called b"):
        pages.filled("<!-- table: b -->\n<!-- end -->\n", {"a": str})
    with pytest.raises(ValueError, match="no end"):
        pages.filled("<!-- table: a -->\n", {"a": str})


def test_a_table_without_its_result_says_so() -> None:
    assert {make() for make in tables.tables({}).values()} == {tables.NOT_YET}


def test_a_table_shows_the_figures_of_the_result() -> None:
    scores = {
        "newest": {"mean error": over_seeds(runs(3.0, 3.2), "cm"), "missed": once(0.5, "%")},
        "lag 0.2 s": {"mean error": over_seeds(runs(2.0, 2.0), "cm")},
    }
    made = {"accuracy": result({"4 cameras, 4 people": scores}, "accuracy")}
    row = tables.tables(made)["accuracy-short"]().splitlines()[-1]
    assert row.startswith("| 4 cameras, 4 people | 3.1 | 2.0 |")
    assert "| 0.50 % |" in row
    assert f"| {NOTHING} |" in row


def test_a_spread_stands_beside_a_mean_where_there_is_one() -> None:
    assert with_spread(over_seeds(runs(2.0, 3.0, 4.0), "cm")) == "3.00 ± 1.00"
    assert with_spread(once(2.0, "cm")) == "2.00"
    assert with_spread(None) == NOTHING
    assert table(["a"], [["b"]]) == "| a |\n|---|\n| b |"
    assert str(value_of({}, "nothing")) == "nan"


def test_the_worst_of_several_figures_must_meet_the_target() -> None:
    scenes = {"walk_1": {"error": once(1.0, "cm")}, "walk_2": {"error": once(1.5, "cm")}}
    results = {"thesis": result(scenes, "thesis")}
    target = Target("walking", "error", ("thesis", "walk_?", "error"), "<=", 1.25, "cm")
    assert target.asked == "≤ 1.25 cm"
    assert target.reached(results) == 1.5
    assert target.verdict(1.5) == "missed by 0.25 (20 %)"
    assert target.verdict(1.25) == "met"
    assert target.verdict(target.reached({})) == "not measured yet"


def test_more_must_be_reached_where_more_is_better() -> None:
    target = Target("walking", "share", ("thesis", "*", "share"), ">=", 0.98)
    scenes = {"a": {"share": once(0.99, "")}, "b": {"share": once(0.5, "")}}
    assert target.reached({"thesis": result(scenes)}) == 0.5
    assert target.verdict(0.99) == "met"
    assert target.verdict(0.5).startswith("missed by 0.48")


def test_a_target_of_nothing_is_missed_by_a_number_without_a_share() -> None:
    target = Target("identities", "switches", ("thesis", "switches"), "<=", 0)
    assert target.verdict(2.0) == "missed by 2"


@pytest.mark.parametrize("target", [*FUSION, *OTHERS], ids=lambda target: target.text)
def test_every_target_looks_into_a_benchmark_that_is_stored_under_this_name(
    target: Target,
) -> None:
    results = tables.all_figures.results()
    if target.where[0] not in results:
        pytest.skip(f"{target.where[0]} has no stored result yet")
    assert target.verdict(target.reached(results)) != "not measured yet"


def test_the_table_of_settings_has_every_setting_with_its_default_and_advice() -> None:
    names = [field.name for field in fields(FusionSettings)]
    rows = [line.split(" | ") for line in settings_table.settings().splitlines()[2:]]
    assert [row[0] for row in rows] == [f"| `{name}`" for name in names]
    for name, row in zip(names, rows, strict=True):
        default = getattr(FusionSettings(), name)
        low, high = (float(limit) for limit in row[4].split(" to "))
        assert float(row[3]) == default, name
        assert low < default < high, name
        FusionSettings(**{name: type(default)(low)})
        FusionSettings(**{name: type(default)(high)})
        assert len(row[1]) > 10, name
        assert len(row[6]) > 10, name
        assert re.search(r"_(s|m|m2|px)$", name) is None or row[2], name


def test_what_a_setting_was_in_the_thesis_is_told_apart_from_its_meaning() -> None:
    assert settings_table.taken_apart("Distance of knots [s] (in the thesis: knot delta).") == (
        "Distance of knots", "s", "knot delta",
    )  # fmt: skip
    assert settings_table.taken_apart("How long (usually): two words.")[2] == NOTHING


def test_the_number_of_seeds_can_be_asked_for() -> None:
    made = {"accuracy": result({"room": {"error": over_seeds(runs(1.0, 2.0, 3.0), "cm")}})}
    target = Target("rooms", "seeds", ("accuracy", "room", "error"), ">=", 20, seeds=True)
    assert target.reached(made) == 3
    assert target.verdict(3).startswith("missed by 17")


def test_on_the_terminal_what_is_missed_is_marked_and_says_by_how_much() -> None:
    made = {
        "thesis": result({"walk": {"error": once(1.5, "cm"), "share": once(1.0, "")}}, "thesis")
    }
    targets = (
        Target("Shelf", "error", ("thesis", "walk", "error"), "<=", 1.25, "cm", "others 19"),
        Target("Shelf", "share", ("thesis", "walk", "share"), ">=", 0.98),
        Target("Shelf", "gone", ("speed", "walk", "gone"), ">=", 0.98),
    )
    about, *lines = tables.all_figures.printed(targets, made).strip().splitlines()
    assert about == f"Shelf: {ABOUT['Shelf']}"
    assert [line[0] for line in lines] == ["X", " ", "?"]
    assert "1.50 cm" in lines[0]
    assert "missed by 0.25 (20 %)   (others 19, recorded)" in lines[0]


def test_every_group_that_is_explained_exists() -> None:
    assert set(ABOUT) <= {target.group for target in (*FUSION, *OTHERS)}
