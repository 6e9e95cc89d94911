"""What is asked of the truth of the claims, beside what an older commit reached."""

import pytest

import truth
from harness.figures import once
from low_rates import clocks_of
from made_results import result
from targets import Target
from truth_targets import TRUTH

TARGET = Target("group", "error", ("some", "error"), "<=", 1.0, "cm", "others 3")


def test_a_row_has_what_is_asked_what_was_and_what_is_reached() -> None:
    then = {"some": result({"error": once(2.0, "cm")}, "some")}
    now = {"some": result({"error": once(0.5, "cm")}, "some")}
    assert truth.rows_of((TARGET,), then, now) == [
        ["group", "error", "≤ 1 cm", "2", "0.500", "met", "others 3"]
    ]


def test_in_a_terminal_a_figure_that_is_missed_is_marked() -> None:
    now = {"some": result({"error": once(3.0, "cm")}, "some")}
    lines = truth.printed(truth.rows_of((TARGET,), {}, now)).splitlines()
    assert lines[1] == "group"
    assert lines[2].startswith("X error")
    assert lines[2].endswith("missed by 2 (200 %)   (others 3)")


@pytest.mark.parametrize("target", TRUTH, ids=lambda target: f"{target.group}: {target.text}")
def test_every_figure_was_measured_on_the_older_commit(target: Target) -> None:
    then = truth.before()
    assert target.verdict(target.reached(then)) != "not measured yet"


def test_staggered_cameras_share_a_period_evenly_and_mixed_ones_differ_in_rate() -> None:
    assert [clock.start_s for clock in clocks_of(4, 8.0, "staggered")] == [
        0.0, 0.03125, 0.0625, 0.09375,
    ]  # fmt: skip
    assert {clock.fps for clock in clocks_of(4, 0.0, "mixed")} == {5.0, 8.0, 15.0, 30.0}
    assert all(clock.start_s == 0.0 for clock in clocks_of(2, 5.0, "in step"))
    assert all(clock.dropped > 0.1 for clock in clocks_of(2, 5.0, "irregular"))
