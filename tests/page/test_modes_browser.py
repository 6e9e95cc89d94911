"""Modes and counts on the page, in a real Chromium."""

from collections.abc import Iterator
from dataclasses import replace
from time import time

import pytest

from made_browser import PATIENCE_MS, opened
from made_hall import SITE, Tracking
from made_page import RunningPage, running_page
from trecsim.health import CameraHealth, Counts, FusionHealth, Health, LineCount, ZoneCount
from trecsim.page.bundle import STATIC

expect = pytest.importorskip("playwright.sync_api", reason="playwright is not installed").expect

pytestmark = pytest.mark.skipif(
    not (STATIC / "index.html").is_file(), reason="the page is not built; make page builds it"
)

MODES = {"night": {"off": ["strip"], "schedule": None}, "day": {"off": [], "schedule": None}}


@pytest.fixture
def hall() -> Iterator[RunningPage]:
    site = replace(SITE, modes=MODES, rule_ids=["strip"])
    with running_page(site=site) as page:
        yield page


def test_a_mode_is_put_in_force_for_a_while_and_given_back(chromium, hall) -> None:
    with (
        Tracking(hall).running(),
        opened(chromium, f"{hall.process.url}live?view=plan", width=1440, height=900) as page,
    ):
        fact = page.locator(".fact.mode")
        expect(fact).to_contain_text("All rules", timeout=PATIENCE_MS)
        fact.click()
        axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="no axe")
        assert axe.Axe().run(page).response["violations"] == []
        page.get_by_role("button", name="Night off: Strip").click()
        page.get_by_role("button", name="4 hours").click()
        expect(page.locator(".toast")).to_contain_text("Night to")
        told = hall.client.get("/api/mode").json()
        assert told["mode"] == "night"
        assert told["chosen"]["until_s"] == pytest.approx(time() + 4 * 3600, abs=120)
        fact.click()
        page.get_by_role("button", name="Back to the schedule").click()
        expect(page.locator(".toast")).to_contain_text("By schedule again")
        assert hall.client.get("/api/mode").json()["mode"] is None


def test_a_rule_is_off_for_a_while_and_armed_again(chromium, hall) -> None:
    with (
        Tracking(hall).running(),
        opened(chromium, f"{hall.process.url}live?view=plan", width=1440, height=900) as page,
    ):
        page.locator(".fact.mode").click()
        page.get_by_label("Switch off a rule").select_option("strip")
        page.get_by_role("button", name="1 hour").click()
        expect(page.locator(".toast")).to_contain_text("Rule Strip off to")
        assert list(hall.client.get("/api/mode").json()["bypassed"]) == ["strip"]
        page.locator(".fact.mode").click()
        page.get_by_role("button", name="Arm Strip again").click()
        expect(page.locator(".toast")).to_contain_text("is armed again")
        assert hall.client.get("/api/mode").json()["bypassed"] == {}


def test_counts_stand_beside_the_plan_with_the_level_of_service(chromium, hall) -> None:
    counts = Counts(time(), {"exit-strip": ZoneCount(9, 1.31, "E")}, {"gate": LineCount(12, 10)})
    cameras = {name: CameraHealth("live", 25.0, 0.02) for name in SITE.cameras}
    hall.process.health(Health(time(), cameras, FusionHealth("running"), counts=counts))
    url = f"{hall.process.url}live?view=plan"
    with opened(chromium, url, width=1440, height=900) as page:
        rows = page.locator(".countsbox li")
        expect(rows).to_have_count(2, timeout=PATIENCE_MS)
        assert rows.nth(0).inner_text().split() == ["Exit", "strip", "1.31", "/m²,", "E", "9"]
        assert "warning" in rows.nth(0).locator(".level").get_attribute("class")
        assert rows.nth(1).inner_text().split() == ["Gate", "in", "12,", "out", "10"]
        page.get_by_role("button", name="Density").click()
        expect(page.get_by_role("button", name="Density")).to_have_attribute("aria-pressed", "true")
