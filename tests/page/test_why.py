"""Why an event of a rule fired: the curve of its probability, from the recording."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from made_browser import PATIENCE_MS, opened
from made_hall import BODY_M
from made_page import RunningPage, running_page, until
from made_rigs import ring
from made_tracks import snapshot
from trecsim.assessing import RuleEvents, rule_set
from trecsim.calibration import write_rig
from trecsim.page.bundle import STATIC
from trecsim.page.page_data import PageData
from trecsim.sites.recorded_site import read_recorded_site
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.playback import snapshots
from trecsim.store.recordings import tracks_recorder

RATE_HZ, BEGINS_S, ENDS_S = 25.0, 12.0, 14.0
TEXT = """\
format = "trecsim.site/1"
name = "hall"
rig = "rig.toml"
poses = "a.poses.jsonl"

[zones.strip]
polygon_m = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]

[[rules]]
id = "strip"
kind = "zone.enter"
zone = "strip"
"""


def place_m(t_s: float) -> np.ndarray:
    """Somebody steps into the strip for two seconds."""
    return np.array([0.0 if BEGINS_S <= t_s < ENDS_S else 3.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("why")
    write_rig(ring(3), folder / "rig.toml")
    (folder / "site.toml").write_text(TEXT)
    recording = folder / "recordings" / "today"
    recording.mkdir(parents=True)
    with tracks_recorder(recording, TracksInfo(rig_sha256="")) as tracks:
        for t_s in np.arange(0.0, 20.0, 1 / RATE_HZ).round(3).tolist():
            tracks.write(snapshot(t_s, [5], (BODY_M + place_m(t_s))[None]))
    return folder


@pytest.fixture(scope="module")
def page(folder: Path) -> Iterator[RunningPage]:
    data = PageData(folder / "recordings", None, folder / "site.toml")
    with running_page(data=data) as page:
        yield page


def happened(page: RunningPage, folder: Path) -> str:
    """Let the events of the recording happen, once; return their episode."""
    site, rig = read_recorded_site(folder / "site.toml")
    events = RuleEvents(rule_set(site.name, site, rig))
    for moment in snapshots(folder / "recordings" / "today"):
        for event in events.step(moment):
            page.process.event(event)
            episode = event["data"]["event"]
    until(lambda: len(page.client.get("/api/events").json()["events"]) >= 2)
    return episode


def test_the_curve_of_an_event_rises_above_its_limit_where_the_event_says(
    page: RunningPage, folder: Path
) -> None:
    episode = happened(page, folder)
    answer = page.client.get(f"/api/events/{episode}/why")
    assert answer.status_code == 200, answer.text
    curve = answer.json()
    assert (curve["rule"], curve["kind"], curve["person"]) == ("strip", "zone.enter", 5)
    assert (curve["p_on"], curve["p_off"], curve["on_delay_s"]) == (0.9, 0.5, 0.2)
    held = [t for t, p in zip(curve["t_s"], curve["probability"], strict=True) if p >= 0.9]
    assert held[0] == pytest.approx(BEGINS_S)
    assert held[-1] == pytest.approx(ENDS_S - 1 / RATE_HZ)
    assert curve["t_s"][0] == pytest.approx(BEGINS_S - 10.0)
    assert curve["t_s"][-1] == pytest.approx(ENDS_S + 5.0)
    assert max(one for one in curve["measures"]["inside_m"] if one is not None) == 0.812
    assert len(curve["measures"]["inside_m"]) == len(curve["t_s"])


def test_a_rule_that_has_changed_since_and_an_event_of_nobody_are_told(
    page: RunningPage, folder: Path
) -> None:
    episode = happened(page, folder)
    assert page.client.get("/api/events/none/why").status_code == 404
    try:
        (folder / "site.toml").write_text(TEXT.replace("[1.0, 1.0]", "[1.0, 2.0]"))
        changed = page.client.get(f"/api/events/{episode}/why")
    finally:
        (folder / "site.toml").write_text(TEXT)
    assert changed.status_code == 404
    assert "rule strip has changed since" in changed.json()["error"]


def test_a_recording_knows_its_rules_without_a_site_file(folder: Path, tmp_path: Path) -> None:
    import tomllib

    summary = folder / "recordings" / "today" / "summary.json"
    summary.write_text(json.dumps({"configuration": tomllib.loads(TEXT)}))
    try:
        with running_page(data=PageData(folder / "recordings" / "today")) as page:
            episode = happened(page, folder)
            assert page.client.get(f"/api/events/{episode}/why").status_code == 200
    finally:
        summary.unlink()


@pytest.mark.skipif(not (STATIC / "index.html").is_file(), reason="the page is not built")
def test_the_page_draws_the_curve_and_its_limits_and_closes_with_a_reason(
    chromium, page: RunningPage, folder: Path
) -> None:
    expect = pytest.importorskip("playwright.sync_api").expect
    episode = happened(page, folder)
    url = f"{page.process.url}review/{episode}?view=plan"
    with opened(chromium, url, width=1440, height=900) as shown:
        curve = shown.locator(".curve")
        expect(curve.locator(".limit")).to_have_count(2, timeout=PATIENCE_MS)
        expect(curve.locator(".line")).to_have_count(1)
        assert "from 90 % on, over below 50 %" in curve.get_attribute("aria-label")
        assert "The floor point is inside the zone" in shown.inner_text(".why")
        axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="no axe")
        assert axe.Axe().run(shown).response["violations"] == []
        shown.get_by_role("button", name="False alarm").click()
        expect(shown.get_by_role("button", name="Close alert")).to_be_disabled()
        shown.get_by_label("Note", exact=True).fill("a trolley")
        shown.get_by_role("button", name="Close alert").click()
        expect(shown.locator(".why")).to_contain_text("a trolley")
        shown.get_by_role("button", name="Reopen").click()
        expect(shown.get_by_role("button", name="Close alert")).to_be_visible()
    said = page.client.get("/api/events", params={"event": episode}).json()["events"]
    closed = next(one["data"] for one in said if one["data"]["phase"] == "close")
    assert (closed["reason"], closed["note"]) == ("false", "a trolley")
    assert said[-1]["data"]["phase"] == "reopen"
