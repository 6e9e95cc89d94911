"""Early warnings against the truth, with numbers that can be checked by hand."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from trecsim.cli import main
from trecsim.lab.evaluation.event_episodes import episodes_of
from trecsim.lab.evaluation.warning_scores import Warned, warning_scores, warnings_of


def data_of(start_s: float, floor_m: tuple[float, float] = (0.0, 0.0), **more: Any) -> Any:
    return {
        "event": f"e{start_s}{floor_m}", "phase": "new", "t_start_s": start_s,
        "rule": {"id": "strip", "kind": "zone.enter"}, "t_detect_s": start_s, "t_end_s": None,
        "predicted": False, "people": [{"person": 1, "floor_m": list(floor_m)}], **more,
    }  # fmt: skip


def warning(told_s: float, *within: float, **more: Any) -> Any:
    names = ("probability_1s", "probability_2s", "probability_4s")
    measures = dict(zip(names, within, strict=True))
    return data_of(told_s + 1.0, predicted=True, measures=measures, **more) | {"t_detect_s": told_s}


def true(*starts_s: float, floor_m: tuple[float, float] = (0.0, 0.0)) -> Any:
    return episodes_of({"data": data_of(start_s, floor_m)} for start_s in starts_s)


def test_warnings_that_come_true_have_a_lead_and_those_that_do_not_cost() -> None:
    warned = warnings_of([warning(10.0, 0.5, 0.9, 1.0), warning(30.0, 0.4, 0.9, 0.9)])
    scores = warning_scores(warned, true(11.5, 90.0))
    assert (scores.given, scores.came_true, scores.leads_s) == (2, 1, (1.5,))
    one, two, four = scores.horizons
    assert (one.happened, two.happened, four.happened) == (0.0, 0.5, 0.5)
    assert one.brier == pytest.approx((0.5**2 + 0.4**2) / 2)
    assert two.brier == pytest.approx((0.1**2 + 0.9**2) / 2)
    assert one.told == pytest.approx(0.45)
    assert [(a.low, a.high, a.number, a.told, a.happened) for a in two.bins] == [
        (0.8, 1.0, 2, pytest.approx(0.9), 0.5)
    ]


def test_a_warning_belongs_to_an_episode_of_its_rule_and_of_a_person_who_can_have_been_there() -> (
    None
):
    warned = warnings_of([warning(10.0, 0.9, 0.9, 0.9)])
    assert warning_scores(warned, true(11.0, floor_m=(9.0, 0.0))).came_true == 0
    assert warning_scores(warned, true(11.0, floor_m=(4.0, 0.0))).came_true == 1
    other = [Warned("other", 10.0, (0.0, 0.0), (0.9, 0.9, 0.9))]
    assert warning_scores(other, true(11.0)).came_true == 0


def test_what_has_just_begun_was_foretold_without_a_lead_and_older_things_were_not() -> None:
    warned = warnings_of([warning(10.0, 0.9, 0.9, 0.9)])
    assert warning_scores(warned, true(9.6)).leads_s == (0.0,)
    assert warning_scores(warned, true(9.4)).came_true == 0
    assert warning_scores(warned, true(14.1)).came_true == 0


def test_what_happened_without_a_warning_is_counted_for_rules_that_warn() -> None:
    warned = warnings_of([warning(10.0, 0.9, 0.9, 0.9)])
    assert warning_scores(warned, true(11.5, 90.0)).unwarned == 1
    assert warning_scores([], true(11.5)).unwarned == 0


def test_a_warning_at_an_edge_is_of_people_beyond_it_not_near_it() -> None:
    warned = warnings_of([warning(10.0, 0.9, 0.9, 0.9)])
    near = [replace(one, kind="edge.platform") for one in true(10.5)]
    assert warning_scores(warned, near).came_true == 0
    beyond = [replace(one, worse_s=11.25) for one in near]
    assert warning_scores(warned, beyond).leads_s == (1.25,)


def test_without_warnings_there_is_nothing_to_judge() -> None:
    scores = warning_scores([], true(1.0))
    assert (scores.given, scores.horizons[0].count) == (0, 0)
    assert math.isnan(scores.horizons[0].brier)


def code_of(arguments: list[str]) -> object:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    return ended.value.code


def test_the_command_tells_reliability_and_false_alarms_per_camera_and_day(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def written(name: str, events: list[Any]) -> str:
        path = tmp_path / name
        path.write_text("".join(json.dumps({"data": one}) + "\n" for one in events))
        return str(path)

    came = data_of(11.5) | {"phase": "update", "event": warning(10.0, 0.5, 0.9, 1.0)["event"]}
    told = written("told.jsonl", [warning(10.0, 0.5, 0.9, 1.0), came, data_of(70.0)])
    truth = written("true.jsonl", [data_of(11.5)])
    arguments = ["evaluate-events", told, "--truth", truth, "--camera-days", "0.5"]
    assert code_of([*arguments, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["all"]["false_per_camera_day"] == 2.0
    assert found["early"]["lead_s"] == 1.5
    assert found["early"]["within"]["2"]["brier"] == pytest.approx(0.01)
    assert code_of(arguments) == 0
    shown = capsys.readouterr().out
    assert "false alarms: 2.00 per camera and day" in shown
    assert "early warnings: 1, of which 1 came true, 1.50 s before (median)" in shown
    assert "within 2 s: told 90 %, happened 100 %, Brier score 0.010" in shown
    assert code_of([*arguments[:-1], "0"]) == 2
    assert "--camera-days: expected more than 0, found 0" in capsys.readouterr().err
