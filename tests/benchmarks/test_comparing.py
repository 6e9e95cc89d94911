"""What got worse beyond noise is named; what is within noise is not."""

import math

import pytest

from harness.comparing import Change, compare
from harness.figures import Figure, once, over_seeds, summed, timed
from made_results import ABOUT, result, runs


def verdict(before: Figure, now: Figure, **about: object) -> Change:
    (change,) = compare(result({"error": now}, **about), result({"error": before}))
    return change


def test_every_seed_a_little_worse_is_worse_though_seeds_differ_by_more() -> None:
    before = over_seeds(runs(2.0, 3.0, 4.0, 5.0, 6.0), "cm")
    now = over_seeds(runs(2.11, 3.1, 4.09, 5.1, 6.12), "cm")
    change = verdict(before, now)
    assert change.verdict == "worse"
    assert str(change) == f"error: 4 -> 4.104 cm (noise {change.noise:.2g})"


def test_seeds_that_move_both_ways_are_noise() -> None:
    before = over_seeds(runs(2.0, 3.0, 4.0, 5.0, 6.0), "cm")
    now = over_seeds(runs(2.5, 2.7, 4.6, 4.8, 6.3), "cm")
    assert now.value > before.value * 1.01
    assert verdict(before, now).verdict == "as before"


def test_less_than_a_hundredth_is_as_before() -> None:
    before = over_seeds(runs(2.0, 2.0, 2.0), "cm")
    assert verdict(before, over_seeds(runs(2.019, 2.019, 2.019), "cm")).verdict == "as before"
    assert verdict(before, over_seeds(runs(2.021, 2.021, 2.021), "cm")).verdict == "worse"


def test_a_smaller_error_and_a_larger_share_are_better() -> None:
    assert verdict(over_seeds(runs(2.0, 2.0), "cm"), over_seeds(runs(1.0, 1.0), "cm")).verdict == (
        "better"
    )
    share = over_seeds(runs(0.9, 0.9), "", "higher")
    assert verdict(share, over_seeds(runs(0.99, 0.99), "", "higher")).verdict == "better"
    assert verdict(share, over_seeds(runs(0.8, 0.8), "", "higher")).verdict == "worse"


def test_a_subset_is_compared_with_the_same_seeds_of_the_whole() -> None:
    whole = over_seeds(runs(2.0, 2.0, 9.0, 9.0), "cm")
    change = verdict(whole, over_seeds(runs(2.0, 2.0), "cm"))
    assert (change.before, change.now, change.verdict) == (2.0, 2.0, "as before")


def test_seeds_are_not_paired_when_the_scenes_have_changed() -> None:
    before = over_seeds(runs(2.0, 3.0, 4.0, 5.0, 6.0), "cm")
    now = over_seeds(runs(2.1, 3.1, 4.1, 5.1, 6.1), "cm")
    assert verdict(before, now).verdict == "worse"
    assert verdict(before, now, fingerprints={"room": "other"}).verdict == "as before"


def test_a_part_has_the_same_scenes_as_the_whole() -> None:
    before = over_seeds(runs(2.0, 3.0, 4.0, 5.0, 6.0), "cm")
    now = over_seeds(runs(2.1, 3.1, 4.1, 5.1, 6.1), "cm")
    whole = result({"error": before}, fingerprints={"room": "f00", "hall": "ba2"})
    (change,) = compare(result({"error": now}, fingerprints={"room": "f00"}), whole)
    assert change.verdict == "worse"


def test_a_figure_that_was_there_and_is_not_any_more_is_worse() -> None:
    before = over_seeds(runs(2.0, 2.0), "cm")
    assert verdict(before, over_seeds(runs(math.nan, math.nan), "cm")).verdict == "worse"


@pytest.mark.parametrize(
    ("before", "now", "expected"), [(0, 2, "as before"), (0, 3, "worse"), (40, 50, "as before"),
                                    (40, 60, "worse"), (9, 2, "better")]
)  # fmt: skip
def test_counts_must_move_by_more_than_chance(before: int, now: int, expected: str) -> None:
    assert verdict(summed(runs(before, 0)), summed(runs(now, 0))).verdict == expected


def test_a_count_over_fewer_seeds_is_not_taken_for_an_improvement() -> None:
    before = summed(runs(10, 10, 10, 10))
    assert verdict(before, summed(runs(10))).verdict == "as before"
    assert verdict(before, summed(runs(10)), fingerprints={"room": "other"}).before == 10


def test_what_is_measured_once_has_the_tolerance_it_states() -> None:
    assert verdict(once(1.0, "cm"), once(1.02, "cm")).verdict == "as before"
    assert verdict(once(1.0, "cm"), once(1.04, "cm")).verdict == "worse"
    switches = once(0.0, "", matters=0.0)
    assert verdict(switches, once(1.0, "", matters=0.0)).verdict == "worse"
    assert verdict(switches, once(0.0, "", matters=0.0)).verdict == "as before"


def test_a_busy_machine_does_not_make_times_worse() -> None:
    before = timed([1.0, 1.02, 0.98], [10.0, 10.2, 9.8])
    slowed = timed([2.0, 3.0, 1.0], [20.0, 30.0, 10.0])
    assert verdict(before, slowed).verdict == "as before"


def test_a_slower_program_on_a_busy_machine_is_named() -> None:
    before = timed([1.0, 1.02, 0.98], [10.0, 10.2, 9.8])
    change = verdict(before, timed([3.0, 4.5, 1.5], [20.0, 30.0, 10.0]))
    assert change.verdict == "worse"
    assert change.moved == pytest.approx(0.5)
    assert "+50 %" in str(change)


def test_times_whose_rounds_disagree_are_no_evidence() -> None:
    before = timed([1.0, 1.5, 0.8], [10.0, 10.0, 10.0])
    assert verdict(before, timed([1.1, 1.5, 1.1], [10.0, 10.0, 10.0])).verdict == "as before"
    before = timed([0.8, 1.5, 0.8], [10.0, 10.0, 10.0])
    assert verdict(before, timed([1.1, 1.5, 1.1], [10.0, 10.0, 10.0])).verdict == "worse"


def test_one_disturbed_round_does_not_hide_a_slower_program_nor_make_one() -> None:
    before = timed([1.0, 1.01, 1.02], [10.0, 10.0, 10.0])
    assert verdict(before, timed([9.0, 1.01, 1.0], [10.0, 10.0, 10.0])).verdict == "as before"
    assert verdict(before, timed([9.0, 1.5, 1.52], [10.0, 10.0, 10.0])).verdict == "worse"


def test_without_a_core_to_itself_times_are_not_compared_and_the_rest_is() -> None:
    figures = {"time": timed([1.0], [1.0]), "error": once(1.0, "cm")}
    slower = {"time": timed([9.0], [1.0]), "error": once(9.0, "cm")}
    machine = {**ABOUT["machine"], "cores_used_by_others": 1.8}
    changes = compare(result(slower, machine=machine), result(figures))
    assert [change.path for change in changes] == [("error",)]
    machine = {**ABOUT["machine"], "cores_used_by_others": 1.0}
    changes = compare(result(slower, machine=machine), result(figures))
    assert [change.verdict for change in changes] == ["worse", "worse"]


def test_what_is_not_watched_or_not_stored_is_left_out() -> None:
    now = result({"new": once(1.0, "cm"), "kept": timed([2.0], [1.0], watched=False)})
    before = result({"kept": timed([1.0], [1.0], watched=False)})
    assert compare(now, before) == []
