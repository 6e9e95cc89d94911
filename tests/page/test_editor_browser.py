"""The zone editor in a real Chromium: drawing, checks in place, the trial, and making it live."""

import hashlib
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from made_browser import PATIENCE_MS, opened
from made_hall import BODY_M, SITE, Tracking
from made_page import RunningPage, running_page
from made_rigs import ring
from made_tracks import snapshot
from trecsim.calibration import write_rig
from trecsim.page.bundle import STATIC
from trecsim.page.page_data import PageData
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recordings import tracks_recorder

expect = pytest.importorskip("playwright.sync_api", reason="playwright is not installed").expect

pytestmark = pytest.mark.skipif(
    not (STATIC / "index.html").is_file(), reason="the page is not built; make page builds it"
)

TEXT = """\
format = "trecsim.site/1"
name = "hall"
rig = "rig.toml"
poses = "a.poses.jsonl"

[zones.exit-strip]
polygon_m = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]

[[rules]]
id = "strip"     # agreed in May
kind = "zone.enter"
zone = "exit-strip"
"""


@pytest.fixture
def site(tmp_path: Path) -> Path:
    write_rig(ring(3), tmp_path / "rig.toml")
    (tmp_path / "site.toml").write_text(TEXT)
    recording = tmp_path / "recordings" / "today"
    recording.mkdir(parents=True)
    with tracks_recorder(recording, TracksInfo(rig_sha256="")) as tracks:
        for n in range(100):
            bodies_m = np.stack([BODY_M, BODY_M + np.array([0.4, 0.0, 0.0])])
            tracks.write(snapshot(0.04 * n, [3, 7], bodies_m))
    return tmp_path / "site.toml"


@pytest.fixture
def hall(site: Path) -> Iterator[RunningPage]:
    version = hashlib.sha256(TEXT.encode()).hexdigest()
    folder = site.parent
    data = PageData(folder / "recordings", folder / "ledger", site)
    with (
        running_page(data=data, site=replace(SITE, version=version)) as page,
        Tracking(page).running(),
    ):
        yield page


def press_plan(page, *places: tuple[float, float]) -> None:
    """Click on the plan, at shares of its width and height."""
    box = page.locator(".planedit").bounding_box()
    for x, y in places:
        page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_no_part_of_the_editor_breaks_a_rule_of_axe(chromium, hall, dark) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="no axe")

    def faults(page) -> list[str]:
        found = axe.Axe().run(page).response["violations"]
        return [f"{one['id']}: {node['html'][:200]}" for one in found for node in one["nodes"]]

    url = f"{hall.process.url}zones/exit-strip"
    with opened(chromium, url, width=1440, height=900, dark=dark) as page:
        page.locator(".rule summary").first.click(timeout=PATIENCE_MS)
        page.locator(".rule .more summary").first.click()
        page.get_by_text("3 corners").click()
        assert faults(page) == []
        page.get_by_label("To", exact=True).fill("2.2")
        with page.expect_response(lambda answer: answer.request.method == "PUT"):
            page.get_by_label("To", exact=True).press("Tab")
        page.get_by_role("button", name="Try on a recording").click()
        page.locator(".film button").first.wait_for()
        assert faults(page) == []
        page.locator(".film button").first.click()
        page.locator(".trial .counts").wait_for()
        assert faults(page) == []
        page.get_by_role("button", name="Make live").click()
        page.get_by_role("dialog").wait_for()
        assert faults(page) == []


def test_a_zone_is_drawn_tried_on_a_recording_and_made_live(chromium, hall, site) -> None:
    with opened(chromium, f"{hall.process.url}zones", width=1440, height=900) as page:
        page.get_by_role("group", name="Tool").get_by_role("button", name="Zone").click()
        with page.expect_response(lambda answer: answer.request.method == "PUT") as answer:
            press_plan(page, (0.3, 0.4), (0.7, 0.4), (0.7, 0.6), (0.3, 0.6), (0.3, 0.4))
        assert answer.value.status == 200, answer.value.text()
        page.wait_for_url("**/zones/zone-1")
        with page.expect_response(lambda answer: answer.request.method == "PUT"):
            page.get_by_label("Add a rule").select_option("occupancy.limit")
        page.locator(".rule summary").first.click()
        with page.expect_response(lambda answer: answer.request.method == "PUT"):
            page.get_by_label("From so many people").fill("2")
            page.keyboard.press("Tab")
        page.get_by_role("button", name="Try on a recording").click()
        page.locator(".film button").first.click()
        expect(page.locator(".counts dd")).to_have_count(3, timeout=PATIENCE_MS)
        rows = [row.split() for row in page.locator(".trial tbody tr").all_inner_texts()]
        assert rows == [["Strip", "0", "0"], ["Zone", "1", "limit", "1", "0"]]
        page.locator(".trial .segments button").first.click()
        expect(page.locator(".episodes .item").first).to_be_visible()
        page.get_by_role("button", name="Make live").click()
        page.get_by_role("dialog").get_by_role("button", name="Make live").click()
        expect(page.locator(".tagged")).to_have_text("Live version")
    found = tomllib.loads(site.read_text())
    assert set(found["zones"]) == {"exit-strip", "zone-1"}
    assert found["rules"][1] == {
        "id": "zone-1-limit", "kind": "occupancy.limit", "zone": "zone-1", "limit": 2,
    }  # fmt: skip
    assert "# agreed in May" in site.read_text()


def test_sides_that_cross_are_told_in_place_and_cannot_be_made_live(chromium, hall, site) -> None:
    refused = ("422",)
    url = f"{hall.process.url}zones"
    with opened(chromium, url, width=1440, height=900, expected=refused) as page:
        page.get_by_role("group", name="Tool").get_by_role("button", name="Zone").click()
        with page.expect_response(lambda answer: answer.request.method == "PUT") as answer:
            press_plan(page, (0.4, 0.4), (0.6, 0.6), (0.6, 0.4), (0.4, 0.6), (0.4, 0.4))
        assert answer.value.status == 422
        expect(page.locator(".sketch .wrong .label")).to_contain_text("Two sides cross")
        expect(page.locator(".form .remark.wrong")).to_contain_text("sides 1 and 3 cross")
        expect(page.get_by_role("button", name="Make live")).to_be_disabled()
        page.keyboard.press("Control+z")
        expect(page.locator(".tagged")).to_have_text("Live version")
    assert site.read_text() == TEXT


def test_a_corner_moves_by_keys_and_back_by_undo(chromium, hall) -> None:
    with opened(chromium, f"{hall.process.url}zones/exit-strip", width=1440, height=900) as page:
        corner = page.get_by_role("button", name="Corner 3 at 2.00, 1.00 m")
        corner.focus()
        page.keyboard.press("ArrowRight")
        page.keyboard.press("Shift+ArrowUp")
        expect(page.locator(".sketch .corner").nth(2)).to_have_attribute(
            "aria-label", "Corner 3 at 2.10, 2.00 m"
        )
        page.keyboard.press("Control+z")
        expect(page.locator(".sketch .corner").nth(2)).to_have_attribute(
            "aria-label", "Corner 3 at 2.00, 1.00 m"
        )


def test_what_two_people_change_at_once_is_told_and_neither_is_lost(chromium, hall) -> None:
    url = f"{hall.process.url}zones/exit-strip"
    with opened(chromium, url, width=1440, height=900, expected=("409",)) as page:
        page.get_by_label("To", exact=True).wait_for()
        live = hall.client.get("/api/site/parts").json()
        body = {key: live[key] for key in ("zones", "lines", "edges", "rules")}
        theirs = {**body, "lines": {"gate": {"points_m": [[0, 0], [1, 0]]}}}
        put = hall.client.put("/api/site/draft", json={"based_on": live["version"], **theirs})
        assert put.status_code == 200
        page.get_by_label("To", exact=True).fill("2.2")
        page.get_by_label("To", exact=True).press("Tab")
        expect(page.locator(".bar .wrong")).to_contain_text("was changed by local meanwhile")
        with page.expect_response(lambda answer: answer.request.method == "PUT"):
            page.get_by_role("button", name="Keep mine").click()
        expect(page.locator(".bar .wrong")).to_have_count(0)
        kept = hall.client.get("/api/site/draft").json()
        assert kept["zones"]["exit-strip"]["z_m"] == [0, 2.2]
        assert kept["lines"] == {}


def test_a_bed_and_a_portal_are_drawn_and_told_among_the_changes(chromium, hall) -> None:
    with opened(chromium, f"{hall.process.url}zones", width=1440, height=900) as page:
        page.get_by_role("group", name="Tool").get_by_role("button", name="Bed").click()
        with page.expect_response(lambda answer: answer.request.method == "PUT") as answer:
            press_plan(page, (0.3, 0.4), (0.5, 0.4), (0.5, 0.5), (0.3, 0.5), (0.3, 0.4))
        assert answer.value.status == 200, answer.value.text()
        assert page.get_by_label("To", exact=True).input_value() == "2.5"
        page.get_by_role("group", name="Tool").get_by_role("button", name="Portal").click()
        with page.expect_response(lambda answer: answer.request.method == "PUT") as answer:
            press_plan(page, (0.6, 0.7), (0.8, 0.7))
        assert answer.value.status == 200, answer.value.text()
        expect(page.locator(".bar p")).to_contain_text("Exclusion 1 added and Portal 1 added")
        draft = hall.client.get("/api/site/draft").json()
        assert len(draft["exclusions"]["exclusion-1"]["polygon_m"]) == 4
        assert len(draft["portals"]["portal-1"]["points_m"]) == 2
