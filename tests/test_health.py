"""How a live site is judged from the state of its parts."""

import json

import pytest

from trecsim.health import (
    CameraHealth,
    FusionHealth,
    Health,
    StoreHealth,
    camera_state,
)

RUNNING = FusionHealth("running")
LIVE = CameraHealth("live", 20.0, 0.05)


@pytest.mark.parametrize(
    ("age_s", "state"),
    [(None, "down"), (0.0, "live"), (2.0, "live"), (2.1, "stale"), (10.0, "stale"), (10.1, "down")],
)
def test_a_camera_is_stale_after_2_s_and_down_after_10_s(age_s, state):
    assert camera_state(age_s) == state


def test_a_recording_that_has_ended_is_not_down():
    assert camera_state(60.0, ended=True) == "ended"
    ended = Health(0.0, {"north": CameraHealth("ended")}, FusionHealth("ended"))
    assert ended.is_well


@pytest.mark.parametrize(
    "health",
    [
        Health(0.0, {"north": CameraHealth(), "south": LIVE}, RUNNING),
        Health(0.0, {"north": LIVE}, FusionHealth("starting")),
        Health(0.0, {"north": LIVE}, FusionHealth("stalled")),
        Health(0.0, {"north": LIVE}, RUNNING, StoreHealth("failing", "no room on the disk")),
    ],
    ids=["camera", "starting", "stalled", "store"],
)
def test_a_camera_or_a_stage_that_is_down_is_a_fault_and_named(health):
    assert not health.is_well
    assert len(health.faults) == 1
    assert health.to_json()["status"] == "fault"


def test_the_json_holds_all_cameras_with_the_keys_that_others_rely_on():
    health = Health(
        1.0, {"north": CameraHealth("stale", 0.0, 4.0, "sender", {"late": 2, "size": 3})}, RUNNING
    )
    facts = json.loads(json.dumps(health.to_json()))
    assert set(facts) >= {"status", "cameras", "fusion", "store"}
    north = facts["cameras"]["north"]
    assert {k: north[k] for k in ("state", "fps", "age_s", "clock", "dropped")} == {
        "state": "stale", "fps": 0.0, "age_s": 4.0, "clock": "sender", "dropped": 5,
    }  # fmt: skip
    assert facts["status"] == "ok"
    assert facts["faults"] == ["camera north is stale"]
