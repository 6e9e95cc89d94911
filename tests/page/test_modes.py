"""`/api/mode`: who may change it, what is kept of it, and what the tracking process is told."""

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from made_page import SITE, RunningPage, running_page, until
from trecsim.page.page_data import PageData
from trecsim.safety.modes import LONGEST_S, Overrides
from trecsim.store.ledger import Ledger
from trecsim.store.names import OVERRIDES

VIEW = replace(
    SITE,
    rule_ids=["strip", "gate"],
    modes={"repair": {"off": ["strip"], "schedule": None}},
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("modes")


@pytest.fixture(scope="module")
def page(folder: Path) -> Iterator[RunningPage]:
    """Run a page for tests that leave all rules armed and no mode in force."""
    with running_page(data=PageData(folder / "recordings", folder / "ledger"), site=VIEW) as one:
        yield one


def test_a_mode_is_kept_entered_in_the_audit_log_and_told_to_the_tracking_process(
    page: RunningPage, folder: Path
) -> None:
    page.process.requests()
    assert page.client.get("/api/mode").json()["mode"] is None
    answer = page.client.put("/api/mode", json={"mode": "repair"})
    assert answer.status_code == 200
    body = answer.json()
    assert (body["mode"], body["off"]) == ("repair", ["strip"])
    assert body["chosen"]["until_s"] == pytest.approx(time.time() + LONGEST_S, abs=60.0)
    assert page.client.get("/api/mode").json() == body
    with Ledger(folder / "ledger") as ledger:
        kept, entry = ledger.setting(OVERRIDES), ledger.audit()[-1]
    asked = []

    def is_told() -> bool:
        asked.extend(page.process.requests())
        return kept in [Overrides.of(one.body).to_json() for one in asked]

    until(is_told)
    assert {one.kind for one in asked} == {"mode"}
    assert (entry.act, entry.details) == (OVERRIDES, {"mode": "repair"})
    assert page.client.put("/api/mode", json={"mode": None}).json()["chosen"] is None


def test_a_rule_is_bypassed_until_a_time_and_armed_again(page: RunningPage) -> None:
    until_s = time.time() + 60.0
    asked = {"bypass": {"rule": "gate", "until_s": until_s, "note": "cleaning"}}
    body = page.client.put("/api/mode", json=asked).json()
    assert body["off"] == ["gate"]
    assert body["bypassed"]["gate"]["until_s"] == until_s
    assert body["bypassed"]["gate"]["note"] == "cleaning"
    again = page.client.put("/api/mode", json={"bypass": {"rule": "gate"}}).json()
    assert (again["off"], again["bypassed"]) == ([], {})


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({}, "neither"),
        ({"mode": "night"}, "there is no mode 'night' in the site file; it has repair"),
        ({"bypass": {"rule": "door"}}, "there is no rule 'door'"),
        ({"mode": "repair", "until_s": 5.0}, "one that has passed"),
        ({"mode": 5}, "not as expected"),
        ({"mood": "repair"}, "not as expected"),
    ],
)
def test_what_cannot_be_is_refused_and_changes_nothing(
    page: RunningPage, asked: dict, told: str
) -> None:
    answer = page.client.put("/api/mode", json=asked)
    assert answer.status_code == 400
    assert told in answer.json()["error"]
    assert page.client.get("/api/mode").json()["off"] == []


def test_a_recording_has_no_mode(tmp_path: Path) -> None:
    view = replace(VIEW, kind="recording")
    with running_page(data=PageData(tmp_path, None), site=view) as page:
        assert page.client.put("/api/mode", json={"mode": "repair"}).status_code == 409
