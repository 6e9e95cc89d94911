"""The commands `trecsim forecast` and `trecsim evaluate-forecast`."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def points(tmp_path: Path) -> Path:
    """Return a CSV of floor points of two people for 24 moments."""
    path = tmp_path / "points.csv"
    rows = [f"{0.4 * i:.1f},{p},{p + 0.5 * i},{p}" for i in range(24) for p in (1, 2)]
    path.write_text("\n".join(["t_s,person,x_m,y_m", *rows]) + "\n")
    return path


def test_one_line_per_moment_and_person(trecsim: Run, points: Path, tmp_path: Path) -> None:
    out = tmp_path / "forecast.jsonl"
    code, told, _ = trecsim("forecast", points, "--out", out, "--json")
    assert code == 0
    lines = [json.loads(line) for line in out.read_text().splitlines()]
    assert json.loads(told)["forecasts"] == len(lines) == 48
    assert [(one["t_s"], one["person"]) for one in lines[:3]] == [(0.0, 1), (0.0, 2), (0.4, 1)]
    last = lines[-1]
    np.testing.assert_allclose(last["ahead_s"], np.arange(1, 13) * 0.4)
    assert sum(mode["weight"] for mode in last["modes"]) == pytest.approx(1.0, abs=1e-9)
    for mode in last["modes"]:
        xx, xy, yy = np.array(mode["cov_m2"]).T
        assert np.array(mode["xy_m"]).shape == (12, 2)
        assert (xx * yy - xy**2 > 0).all()
    np.testing.assert_allclose(last["modes"][0]["xy_m"][0], [2 + 0.5 * 24, 2], atol=0.05)
    assert set(last["region_m2"]) == {"0.5", "0.8", "0.9", "0.95"}


def test_what_is_cut_off_later_changes_nothing_before(
    trecsim: Run, points: Path, tmp_path: Path
) -> None:
    whole, part = tmp_path / "whole.jsonl", tmp_path / "part.jsonl"
    trecsim("forecast", points, "--out", whole)
    points.write_text("\n".join(points.read_text().splitlines()[:21]) + "\n")
    trecsim("forecast", points, "--out", part)
    assert whole.read_text().startswith(part.read_text())


def test_horizons_and_rate_are_those_asked_for(trecsim: Run, points: Path, tmp_path: Path) -> None:
    out = tmp_path / "forecast.jsonl"
    code, _, _ = trecsim(
        "forecast", points, "--out", out, "--ahead-s", 1, "--step-s", 0.25, "--every-s", 0.8
    )
    lines = [json.loads(line) for line in out.read_text().splitlines()]
    assert code == 0
    assert lines[0]["ahead_s"] == [0.25, 0.5, 0.75, 1.0]
    assert sorted({one["t_s"] for one in lines})[:3] == pytest.approx([0.0, 0.8, 1.6])


def test_scores_have_the_keys_of_the_contract(trecsim: Run, points: Path) -> None:
    code, told, _ = trecsim("evaluate-forecast", points, "--json")
    scores = json.loads(told)
    assert code == 0
    assert set(scores) >= {
        "ade_m", "fde_m", "best_of_20", "coverage", "nll", "constant_velocity"
    }  # fmt: skip
    assert set(scores["coverage"]) == {"0.5", "0.8", "0.9", "0.95"}
    assert scores["constant_velocity"]["ade_m"] == pytest.approx(0.0, abs=1e-9)
    assert scores["samples"] == 2 * 5


def test_scores_are_a_table_for_people(trecsim: Run, points: Path) -> None:
    code, told, _ = trecsim("evaluate-forecast", points)
    assert code == 0
    assert told.splitlines()[1].startswith("points  10")
    assert "8 samples observed (3.2 s), 12 forecast" in told


def test_a_recording_too_short_to_judge_is_an_error(trecsim: Run, tmp_path: Path) -> None:
    path = tmp_path / "short.csv"
    path.write_text("t_s,person,x_m,y_m\n0,1,2,3\n0.4,1,2,3\n")
    code, _, err = trecsim("evaluate-forecast", path)
    assert code == 2
    assert "short" in err
    assert "8 seconds" in err


def test_horizons_that_cannot_be_are_told(trecsim: Run, points: Path, tmp_path: Path) -> None:
    code, _, err = trecsim("forecast", points, "--out", tmp_path / "a.jsonl", "--ahead-s", 100)
    assert code == 2
    assert "0 < step <= ahead <= 10 s" in err
