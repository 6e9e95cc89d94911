"""The operator page in a real Chromium, served by a real page process."""

from contextlib import ExitStack
from dataclasses import replace
from time import time

import numpy as np
import pytest

from made_browser import PATIENCE_MS, opened
from made_hall import SITE, Tracking
from made_page import running_page
from trecsim.page.address import PageAddress
from trecsim.page.bundle import STATIC

expect = pytest.importorskip("playwright.sync_api", reason="playwright is not installed").expect

pytestmark = pytest.mark.skipif(
    not (STATIC / "index.html").is_file(), reason="the page is not built; make page builds it"
)


@pytest.fixture(scope="module")
def tracking():
    with running_page(site=SITE) as page, Tracking(page).running() as told:
        told.url = page.process.url
        yield told


def people_are(page, count: int) -> None:
    expect(page.locator("#twin tbody tr")).to_have_count(count, timeout=PATIENCE_MS)


def said(page) -> str:
    return page.inner_text(".status h1")


def test_the_page_shows_who_is_there_and_that_all_is_well(chromium, tracking) -> None:
    with opened(chromium, tracking.url) as page:
        page.wait_for_selector(".status[data-row='7']")
        assert said(page) == "All clear"
        people_are(page, 2)
        assert page.inner_text("title") == "All clear - hall"
        assert page.locator("#twin tbody th").all_text_contents() == ["3", "7"]
        assert page.locator(".tile").count() == 3
        assert page.locator(".tile img").count() == 0
        page.wait_for_selector(".view[data-drawn='2']")
        calls = int(page.get_attribute(".view", "data-calls"))
        assert 5 <= calls <= 20


def test_a_camera_that_goes_silent_is_said_at_once_and_acknowledged_until_it_is_back(
    chromium, tracking
) -> None:
    with opened(chromium, f"{tracking.url}live?view=plan", dark=True) as page:
        page.wait_for_selector(".status[data-row='7']")
        assert page.get_attribute("html", "data-theme") == "dark"
        tracking.silent = "cam1"
        page.wait_for_selector(".status[data-row='5']")
        assert said(page) == "Camera Cam1 is stale"
        assert page.inner_text(".tile[data-camera='cam1'] .caption .end") == "Stale"
        tracking.event("new", time() - 6)
        expect(page.locator(".card h3")).to_have_text("Camera Cam1 sends no picture")
        page.get_by_role("button", name="Acknowledge").click()
        expect(page.locator(".card")).to_have_attribute("data-handling", "acknowledged")
        assert "Acknowledged." in page.inner_text(".toast")
        tracking.silent = None
        expect(page.locator(".card h3")).to_have_text("Camera Cam1 sends pictures again")
        page.wait_for_selector(".status[data-row='7']")
        tracking.event("end", time())
        expect(page.locator(".card")).to_have_count(0)
        expect(page.locator(".past .what")).to_have_text("Camera Cam1 sent no picture")


def test_what_is_in_doubt_is_said_in_place_of_all_clear(chromium, tracking) -> None:
    with opened(chromium, f"{tracking.url}system") as page:
        page.wait_for_selector(".status[data-row='7']")
        tracking.faults = {"cam1": "it has shown the same image for 10 s"}
        page.wait_for_selector(".status[data-row='5']")
        assert said(page) == "Camera Cam1 is in doubt"
        expect(page.locator("td.why")).to_have_text("Cam1: it has shown the same image for 10 s")
        tracking.faults, tracking.rules_fault = {}, "strip: division by zero"
        expect(page.locator(".status h1")).to_have_text("Rules fail")
        expect(page.locator("td.why")).to_have_count(0)
        tracking.rules_fault = None
        page.wait_for_selector(".status[data-row='7']")


def test_tiles_show_pictures_where_the_site_allows_them_and_ask_for_no_others(chromium) -> None:
    jpeg = pytest.importorskip("trecsim.sources.jpeg", reason="PyAV is not installed")
    picture = jpeg.jpeg_of(np.full((48, 64, 3), 90, np.uint8), (640, 640))
    with running_page(site=replace(SITE, pictures=True)) as process:
        tracking = Tracking(process)
        tracking.pictures = {"cam0": picture}
        with (
            tracking.running(),
            opened(chromium, f"{process.process.url}live?view=plan", expected=("503",)) as page,
        ):
            image = page.locator(".tile[data-camera='cam0'] img")
            first = image.get_attribute("src")
            assert first.startswith("blob:")
            assert image.evaluate("one => one.decode().then(() => one.naturalWidth)") == 64
            expect(image).not_to_have_attribute("src", first, timeout=PATIENCE_MS)  # a newer one
            assert page.locator(".tile[data-camera='cam1'] img").count() == 0
            assert page.inner_text(".tile[data-camera='cam1'] .drawn") == "drawn"


def test_the_address_holds_what_is_shown(chromium, tracking) -> None:
    with opened(chromium, f"{tracking.url}live?view=plan") as page:
        people_are(page, 2)
        page.get_by_role("button", name="7", exact=True).evaluate("button => button.click()")
        page.wait_for_url("**/live?p=7&view=plan")
        assert "Confirmed" in page.inner_text(".selection .head")
        page.keyboard.press("Escape")
        page.wait_for_url("**/live?view=plan")
        page.keyboard.press("Alt+4")
        page.wait_for_url("**/system")
        expect(page.locator(".grid tbody tr")).to_have_count(3, timeout=PATIENCE_MS)


def test_a_phone_gets_the_page_without_three_dimensions(chromium, tracking) -> None:
    with opened(chromium, tracking.url, width=390, height=844) as page:
        scripts: list[str] = []
        page.on("request", lambda request: scripts.append(request.url))
        page.wait_for_selector(".status[data-row='7']")
        assert page.locator(".phone .tile").count() == 1
        assert "2 people here" in page.inner_text(".about")
        page.reload()
        page.wait_for_selector(".status[data-row='7']")
        assert not [url for url in scripts if "scene" in url]


def test_a_pause_replays_the_past_and_the_status_stays_live(chromium, tracking) -> None:
    with opened(chromium, f"{tracking.url}live?view=plan", width=1200) as page:
        page.wait_for_selector(".status[data-row='7']")
        people_are(page, 2)
        page.locator(".stage").click()
        page.keyboard.press(" ")
        page.wait_for_selector(".stage.replay .pill")
        page.wait_for_url("**t=*")
        assert said(page) == "All clear"
        page.keyboard.press("l")
        page.wait_for_selector(".stage:not(.replay)")


def test_a_tracking_process_that_falls_silent_is_said_to_have_stopped(chromium) -> None:
    with (
        running_page(site=SITE) as process,
        opened(chromium, f"{process.process.url}live?view=plan") as page,
    ):
        with Tracking(process).running():
            page.wait_for_selector(".status[data-row='7']")
        page.wait_for_selector(".status[data-row='2']")
        assert said(page) == "Watching has stopped"


def test_a_page_that_loses_its_server_says_so_and_comes_back(chromium) -> None:
    lost = ("WebSocket connection to", "Failed to load resource")
    with ExitStack() as stack:
        server = stack.enter_context(running_page(site=SITE))
        url = f"{server.process.url}live?view=plan"
        with opened(chromium, url, expected=lost) as page:
            with Tracking(server).running():
                page.wait_for_selector(".status[data-row='7']")
            stack.close()
            page.wait_for_selector(".status[data-row='1']")
            assert said(page) == "No connection"
            assert page.inner_text(".alerts .none strong") == "Alerts unknown"
            assert page.locator(".tile.old").count() == 3
            page.wait_for_timeout(3100)
            again = stack.enter_context(running_page(PageAddress(port=server.port), site=SITE))
            with Tracking(again).running():
                page.wait_for_selector(".status[data-row='7']")
                assert "Connected again." in page.inner_text(".toast")
