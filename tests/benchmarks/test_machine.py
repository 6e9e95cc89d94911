"""Where and when something was measured."""

import json
import os

import pytest

from harness.machine import Use, busy_with, describe, use, used_by_others
from made_results import ABOUT


def test_what_others_used_is_what_is_left_after_ones_own() -> None:
    assert used_by_others(Use(10.0, 100.0, 5.0), Use(20.0, 118.0, 14.0)) == pytest.approx(0.9)
    assert used_by_others(Use(10.0, 100.0, 5.0), Use(20.0, 109.9, 15.0)) == 0.0
    assert used_by_others(None, Use(20.0, 109.9, 15.0)) is None


def test_own_work_is_part_of_all_work() -> None:
    seen = use()
    assert seen is not None
    assert 0.0 < seen.own_s <= seen.all_s


def test_only_a_machine_that_others_use_is_busy() -> None:
    def about(others: float | None) -> dict[str, object]:
        return {**ABOUT, "machine": {**ABOUT["machine"], "cores_used_by_others": others}}

    assert busy_with(about(None)) is None
    assert busy_with(about(0.1)) is None
    assert busy_with(about(1.2)) == 1.2


def test_a_result_names_neither_computer_nor_place() -> None:
    told = describe()
    assert set(told) == {"date", "machine", "versions", "commit"}
    assert set(told["machine"]) == {
        "processor", "instructions", "cores", "system", "load_average"
    }  # fmt: skip
    assert os.getcwd() not in json.dumps(told)
