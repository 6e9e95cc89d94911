"""The queries of the page on recordings run, and give what the recording holds."""

import re
import sqlite3
from contextlib import closing
from pathlib import Path

import duckdb
import numpy as np
import pytest

from made_live import live_moments
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recorder import Recorder
from trecsim.store.site_store import SiteStore

PAGE = Path(__file__).parents[2] / "docs" / "recordings.md"
INFO = TracksInfo()
QUERIES = re.findall(r"```sql\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a site with a recording that has ended and one that is still written."""
    monkeypatch.chdir(tmp_path)
    site = tmp_path / "recordings" / "hall"
    for name, first in (("one", 0), ("two", 1000)):
        (site / name).mkdir(parents=True)
        writer = Recorder(site / name / "tracks.parquet", INFO, segment_s=2.0)
        for moment in live_moments(150, first=first):
            writer.write(moment)
        writer.close() if name == "one" else writer.abandon()
    with SiteStore(site) as store:
        data = {"event": "e", "phase": "new", "rule": {"id": "strip"}}
        store.ledger.append_event({"id": "a", "data": data})
    return site


def answer(number: int) -> list[tuple[object, ...]]:
    return duckdb.execute(QUERIES[number]).fetchall()


@pytest.mark.usefixtures("site")
def test_people_are_counted_each_minute() -> None:
    moments = [*live_moments(150), *live_moments(150, first=1000)]
    seen = {
        (int(one.t_s // 60), person)
        for one in moments
        for person, state in zip(one.id.tolist(), one.state.tolist(), strict=True)
        if state != "provisional"
    }
    minutes = sorted({minute for minute, _ in seen})

    assert [people for _, people in answer(0)] == [
        sum(minute == one for one, _ in seen) for minute in minutes
    ]


@pytest.mark.usefixtures("site")
def test_people_in_a_place_are_found() -> None:
    moments = [*live_moments(150), *live_moments(150, first=1000)]
    found = {
        person
        for one in moments
        for n, person in enumerate(one.id.tolist())
        if ((one.support[n, 15:] >= 2) & (one.xyz_m[n, 15:, 0] < 2.0)).any()
    }

    assert {person for person, *_ in answer(1)} == found


@pytest.mark.usefixtures("site")
def test_speeds_are_those_of_the_snapshots() -> None:
    speeds: dict[int, list[float]] = {}
    for one in [*live_moments(150), *live_moments(150, first=1000)]:
        for n, person in enumerate(one.id.tolist()):
            if one.state[n] == "confirmed":
                speeds.setdefault(person, []).extend(
                    np.hypot(*one.velocity_mps[n, 11:13, :2].T).tolist()
                )

    found = {person: speed for person, speed in answer(2)}
    assert found == pytest.approx({person: np.median(s) for person, s in speeds.items()})


@pytest.mark.usefixtures("site")
def test_empty_moments_are_counted() -> None:
    moments = [*live_moments(150), *live_moments(150, first=1000)]
    empty = sum(len(one.id) == 0 for one in moments)

    assert answer(3) == [(pytest.approx(empty / len(moments)),)]


def test_events_are_counted_by_rule(site: Path) -> None:
    with closing(sqlite3.connect(site / "ledger.sqlite")) as ledger:
        assert ledger.execute(QUERIES[4]).fetchall() == [("strip", 1)]


def test_every_query_of_the_page_is_tested() -> None:
    assert len(QUERIES) == 5


def test_the_example_in_python_runs(site: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    exec(compile(example, str(PAGE), "exec"), {"folder": site})

    assert len(capsys.readouterr().out.splitlines()) == 300
