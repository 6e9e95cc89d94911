"""A camera that falls silent, as an operator meets it: an event, acknowledged, once, for good."""

import signal
from pathlib import Path
from typing import Any

import httpx
import pytest

import trecsim
from end_to_end.test_live_site import PAGE, WAIT_S, Running, running
from made_rigs import ring
from made_site import make_site, walking
from trecsim.page.client import LiveEvent
from trecsim.store.ledger import Ledger
from trecsim.store.poses_writer import PosesWriter

SILENT_S = (3.0, 7.0)  # from the beginning of the recording, that is played as live


@pytest.fixture
def site_with_gap(tmp_path: Path) -> Path:
    """Make a site whose second camera delivers nothing for some seconds."""
    site = make_site(tmp_path, moments=1, more=PAGE)
    (tmp_path / "walk.poses.jsonl").unlink()
    with PosesWriter(tmp_path / "walk.poses.jsonl") as writer:
        for poses in walking(ring(3), 3000):
            if poses.camera != "cam1" or not SILENT_S[0] < poses.t_s < SILENT_S[1]:
                writer.write(poses)
    return site


def events(site: Running) -> list[dict[str, Any]]:
    return site.get("api/events").json()["events"]


def phases(site: Running) -> list[str]:
    return [one["data"]["phase"] for one in events(site)]


def test_a_silent_camera_is_one_event_acknowledged_before_a_crash_and_ended_after_it(
    site_with_gap: Path,
) -> None:
    with running(site_with_gap) as site:
        told = next(one for one in trecsim.connect(site.url) if isinstance(one, LiveEvent))
        assert (told.kind, told.data["phase"]) == ("camera.health", "new")
        assert told.data["camera"] == "cam1"
        assert [one["id"] for one in events(site)] == [told.id]
        acked = post(site, f"api/events/{told.data['event']}", {"phase": "ack"})
        assert acked["event"]["data"]["by"] == "local"
        site.process.send_signal(signal.SIGKILL)
        site.process.wait(WAIT_S)
    with running(site_with_gap) as site:
        assert phases(site) == ["new", "ack"]
        site.until(lambda: "end" in phases(site))
        found = [one["data"] for one in events(site)]
        assert [one["phase"] for one in found] == ["new", "ack", "end"]
        assert [one["seq"] for one in found] == [0, 1, 2]
        assert {one["event"] for one in found} == {told.data["event"]}
        assert found[-1]["t_end_s"] > found[0]["t_start_s"]
        site.process.send_signal(signal.SIGTERM)
        assert site.process.wait(WAIT_S) == 0
    with Ledger(site_with_gap.parent / "recordings" / "made") as ledger:
        assert [one.event["data"]["phase"] for one in ledger.events()] == ["new", "ack", "end"]
        assert [entry.act for entry in ledger.audit()] == ["ack"]


def post(site: Running, path: str, body: dict[str, Any]) -> dict[str, Any]:
    answer = httpx.post(site.url + path, json=body, timeout=WAIT_S)
    assert answer.status_code == 200, answer.text
    return answer.json()
