"""Events against the truth, with numbers that can be checked by hand."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from trecsim.cli import main
from trecsim.errors import InputError
from trecsim.lab.evaluation.event_episodes import read_episodes
from trecsim.lab.evaluation.event_scores import compared, evaluate_events


def event(
    start_s: float, phase: str = "new", name: str | None = None, **changes: Any
) -> dict[str, Any]:
    rule = {"id": "strip", "kind": "zone.enter", "config": ""}
    return {
        "id": "x", "type": "trecsim.zone.enter.v1",
        "data": {
            "event": name or f"e{start_s}", "phase": phase, "rule": rule, "t_start_s": start_s,
            "t_detect_s": start_s + 0.2, "t_end_s": None, "predicted": False,
            "people": [{"person": 1, "floor_m": [0.0, 0.0]}], **changes,
        },
    }  # fmt: skip


def write(path: Path, events: list[dict[str, Any]]) -> Path:
    path.write_text("".join(json.dumps(one) + "\n" for one in events))
    return path


def evaluated(folder: Path, told: list[dict[str, Any]], true: list[dict[str, Any]]) -> Any:
    return evaluate_events(write(folder / "told.jsonl", told), write(folder / "true.jsonl", true))


def test_the_same_events_are_all_right_and_late_by_their_delay_only(tmp_path: Path) -> None:
    events = [event(1.0), event(1.0, "end", t_end_s=4.0), event(7.0)]
    result = evaluated(tmp_path, events, events)
    scores = result.kinds["zone.enter"]
    assert (scores.precision, scores.recall, scores.f1, result.macro_f1) == (1.0, 1.0, 1.0, 1.0)
    assert scores.onset_errors_s == (0.0, 0.0)
    assert scores.end_errors_s == (0.0,)
    assert scores.latencies_s == pytest.approx((0.2, 0.2))


def test_what_was_invented_costs_precision_and_what_was_missed_recall(tmp_path: Path) -> None:
    result = evaluated(tmp_path, [event(1.0), event(50.0)], [event(0.5), event(20.0), event(30.0)])
    scores = result.kinds["zone.enter"]
    assert (scores.told, scores.true, scores.right) == (2, 3, 1)
    assert (scores.precision, scores.recall, scores.f1) == (0.5, pytest.approx(1 / 3), 0.4)
    assert scores.onset_errors_s == (0.5,)


@pytest.mark.parametrize(("late_s", "right"), [(-2.1, 0), (-1.9, 1), (0.0, 1), (9.9, 1), (10.1, 0)])
def test_an_episode_may_begin_two_seconds_early_or_ten_late(
    tmp_path: Path, late_s: float, right: int
) -> None:
    assert evaluated(tmp_path, [event(20.0 + late_s)], [event(20.0)]).total.right == right


def test_each_episode_counts_once_and_those_at_the_same_place_belong_together(
    tmp_path: Path,
) -> None:
    here, there = [{"person": 1, "floor_m": [0, 0]}], [{"person": 2, "floor_m": [4, 0]}]
    told = [event(1.0, name="a", people=there), event(1.1, name="b", people=here)]
    true = [event(1.0, name="c", people=here), event(1.1, name="d", people=there)]
    scores = evaluated(tmp_path, told, true).total
    assert sorted(scores.onset_errors_s) == pytest.approx([-0.1, 0.1])
    twice = evaluated(tmp_path, [event(1.0, name="a"), event(1.2, name="b")], [event(1.0)])
    assert (twice.total.right, twice.total.precision) == (1, 0.5)


def test_rules_and_directions_are_told_apart(tmp_path: Path) -> None:
    other = {"id": "gate", "kind": "line.cross", "config": ""}
    true = [event(1.0), event(1.0, name="g", rule=other, direction="in")]
    told = [event(1.0), event(1.0, name="g", rule=other, direction="out")]
    result = evaluated(tmp_path, told, true)
    assert result.kinds["zone.enter"].f1 == 1.0
    assert result.kinds["line.cross"].f1 == 0.0
    assert result.macro_f1 == 0.5


def test_a_warning_that_came_true_counts_from_when_it_did_and_another_is_counted_apart(
    tmp_path: Path,
) -> None:
    told = [
        event(5.0, name="w", predicted=True),
        event(5.4, "update", name="w"),
        event(9.0, name="v", predicted=True),
        event(9.0, "end", name="v", predicted=True, t_end_s=10.0),
    ]
    result = evaluated(tmp_path, told, [event(5.4)])
    assert (result.total.told, result.total.right, result.warnings) == (1, 1, 1)
    assert result.total.onset_errors_s == (0.0,)


def test_what_people_did_and_empty_lines_are_left_out(tmp_path: Path) -> None:
    path = write(tmp_path / "a.jsonl", [event(1.0), event(1.0, "ack", by="kim")])
    path.write_text(path.read_text() + "\n")
    (episode,) = read_episodes(path)
    assert (episode.start_s, episode.end_s) == (1.0, None)


def test_nothing_told_and_nothing_true_has_no_scores(tmp_path: Path) -> None:
    result = compared([], [])
    assert math.isnan(result.macro_f1)
    assert math.isnan(result.total.f1)


EVENT = (
    '{"data": {"event": "e", "phase": "new", "rule": {"id": "r", "kind": "line.cross"}, '
    '"t_start_s": 1.5, "direction": "in", "people": []}}'
)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "line 1: expected one JSON object"),
        ('{"data": 3}', "line 1: expected an event with data"),
        ('{"data": {"phase": "new"}}', "line 1: expected the event of a rule"),
        ("[" * 100_000, "line 1: expected one JSON object"),
        (
            EVENT.replace("1.5", "NaN"),
            "line 1: .*expected t_start_s as a time in seconds, found nan",
        ),
        (EVENT.replace("1.5", "9" * 400), "line 1: .*expected t_start_s as a time in seconds"),
        (EVENT.replace("1.5", "null"), "line 1: .*expected t_start_s as a time in seconds"),
        (EVENT.replace('"in"', "[1]"), "line 1: .*expected direction as text"),
        (EVENT.replace("[]", "[5]"), "line 1: expected the event of a rule"),
        (EVENT.replace("[]", '[{"floor_m": [1]}]'), "line 1: expected the event of a rule"),
    ],
)
def test_a_line_that_is_no_event_is_told_with_its_number(
    tmp_path: Path, text: str, said: str
) -> None:
    (tmp_path / "a.jsonl").write_text(text)
    with pytest.raises(InputError, match=said):
        read_episodes(tmp_path / "a.jsonl")


def test_the_command_prints_a_table_or_one_object(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told, true = write(tmp_path / "a", [event(1.0)]), write(tmp_path / "b", [event(1.0)])
    for options in ([], ["--json"]):
        with pytest.raises(SystemExit) as ended:
            main(["evaluate-events", str(told), "--truth", str(true), *options])
        assert ended.value.code == 0
    *table, summary = capsys.readouterr().out.splitlines()
    assert table[1].split() == [
        "zone.enter", "1", "1", "1", "1.000", "1.000", "1.000", "+0.00", "+0.20",
    ]  # fmt: skip
    assert json.loads(summary)["all"]["macro_f1"] == 1.0
    assert json.loads(summary)["kinds"]["zone.enter"]["end_error_s"]["median"] is None
