"""Each fault of a live site is logged once, by whoever knows most about it."""

from typing import Any

import pytest

from trecsim.health import CameraHealth, FusionHealth, Health, StoreHealth
from trecsim.service.pulse import FaultLog

LIVE = CameraHealth("live", 25.0, 0.02)
RUNNING = FusionHealth("running", 25.0, 1.0, 0.02, 2)


def health(t_s: float, camera: CameraHealth = LIVE, **parts: Any) -> Health:
    return Health(t_s, {"north": LIVE, "south": camera}, **{"fusion": RUNNING, **parts})


def silent(age_s: float, fault: str | None = None) -> CameraHealth:
    return CameraHealth("stale" if age_s < 10.0 else "down", 0.0, age_s, fault=fault)


def test_a_silent_camera_is_logged_once_however_long_it_lasts(
    caplog: pytest.LogCaptureFixture,
) -> None:
    log = FaultLog()
    log(health(0.0))
    for age_s in range(1, 60):
        log(health(20.0 + age_s, silent(float(age_s))))
    assert caplog.messages == ["camera 'south' has delivered no image for 5.0 s"]
    log(health(90.0))
    log(health(91.0))
    assert caplog.messages[1:] == ["camera 'south' delivers images again"]


def test_a_camera_whose_source_names_the_fault_is_left_to_the_source(
    caplog: pytest.LogCaptureFixture,
) -> None:
    log = FaultLog()
    log(health(0.0))
    for age_s in range(1, 60):
        fault = "nothing has come from rtsp://cam/1 for 3 s" if age_s > 3 else None
        log(health(20.0 + age_s, silent(float(age_s), fault)))
    log(health(90.0))
    assert caplog.messages == []


def test_a_store_that_fails_is_left_to_the_recorder(caplog: pytest.LogCaptureFixture) -> None:
    log = FaultLog()
    log(health(0.0))
    log(health(20.0, store=StoreHealth("failing", "the disk is full")))
    log(health(21.0))
    assert caplog.messages == []


def test_a_fusion_that_stands_still_is_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    log = FaultLog()
    log(health(0.0))
    for t_s in range(20, 25):
        log(health(float(t_s), fusion=FusionHealth("stalled", 0.0, 1.0, 4.0)))
    log(health(30.0))
    assert caplog.messages == ["the fusion has stopped", "the fusion works again"]


def test_what_has_never_worked_is_logged_ten_seconds_after_the_start(
    caplog: pytest.LogCaptureFixture,
) -> None:
    log = FaultLog()
    for t_s in range(30):
        log(health(float(t_s), CameraHealth("down", 0.0, None)))
        assert caplog.messages == (
            [] if t_s < 10 else ["camera 'south' has delivered no image yet"]
        )
