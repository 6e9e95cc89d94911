"""Trials of drafts on recordings, remarks on places, and earlier versions of the site file."""

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from made_page import SITE, RunningPage, running_page
from made_rigs import ring
from made_tracks import walk
from trecsim.calibration import write_rig
from trecsim.page.page_data import PageData
from trecsim.page.site_history import SiteHistory
from trecsim.sites.fusion_table import fusion_settings
from trecsim.sites.place_remarks import place_remarks
from trecsim.sites.recorded_site import RecordedSite
from trecsim.sites.site_file import FusionTable
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recordings import tracks_recorder

TEXT = """\
format = "trecsim.site/1"
name = "hall"
rig = "rig.toml"
poses = "a.poses.jsonl"

[zones.all]       # the whole hall
polygon_m = [[-90, -90], [90, -90], [90, 90], [-90, 90]]

[[rules]]
id = "anybody"
kind = "zone.enter"
zone = "all"
"""
ALL = {"polygon_m": [[-90, -90], [90, -90], [90, 90], [-90, 90]]}
FAR = {"polygon_m": [[30.0, -0.5], [31.0, -0.5], [31.0, 0.5]]}  # behind a camera


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("trial")
    write_rig(ring(3), folder / "rig.toml")
    recording = folder / "recordings" / "today"
    recording.mkdir(parents=True)
    with tracks_recorder(recording, TracksInfo(rig_sha256="")) as tracks:
        for snapshot in walk(200, people=3):  # 8 s
            tracks.write(snapshot)
    return folder


@pytest.fixture(scope="module")
def running(folder: Path) -> Iterator[RunningPage]:
    (folder / "site.toml").write_text(TEXT)
    version = hashlib.sha256(TEXT.encode()).hexdigest()
    data = PageData(folder / "recordings", folder / "ledger", folder / "site.toml")
    with running_page(data=data, site=replace(SITE, version=version)) as page:
        yield page


@pytest.fixture
def page(running: RunningPage, folder: Path) -> RunningPage:
    """Return the page with its site file as it was, and without a draft."""
    (folder / "site.toml").write_text(TEXT)
    running.client.delete("/api/site/draft").raise_for_status()
    return running


def parts(page: RunningPage) -> dict:
    return page.client.get("/api/site/parts").json()


def put(page: RunningPage, revision: int, **tables: object) -> dict:
    live = parts(page)
    body = {key: live[key] for key in ("zones", "lines", "edges", "rules")}
    answer = page.client.put(
        "/api/site/draft",
        json={"based_on": live["version"], "revision": revision, **body, **tables},
    )
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_a_draft_is_tried_beside_the_live_rules_and_made_live_with_its_rules(
    page: RunningPage, folder: Path
) -> None:
    live = parts(page)
    assert live["zones"] == {"all": ALL}
    many = {"id": "many", "kind": "occupancy.limit", "zone": "all", "limit": 2}
    draft = put(page, 0, zones={"all": ALL, "far": FAR}, rules=[many])
    tried = page.client.post(
        "/api/site/draft/try",
        json={"based_on": live["version"], "revision": draft["revision"], "recording": "today"},
    )
    assert tried.status_code == 200, tried.text
    found = tried.json()
    assert found["rules"] == {"anybody": {"draft": 0, "live": 3}, "many": {"draft": 1, "live": 0}}
    assert (found["moments"], found["people"]) == (200, 3)
    assert sorted((one["rule"], one["in"], len(one["people"])) for one in found["episodes"]) == [
        ("anybody", "live", 1), ("anybody", "live", 1), ("anybody", "live", 1),
        ("many", "draft", 3),
    ]  # fmt: skip
    made = page.client.post(
        "/api/site/draft/live",
        json={"based_on": live["version"], "revision": draft["revision"]},
    )
    assert made.status_code == 200, made.text
    after = parts(page)
    assert (after["version"], after["rules"]) == (made.json()["version"], [many])
    assert "# the whole hall" in (folder / "site.toml").read_text()
    versions = page.client.get("/api/site/history").json()["versions"]
    assert versions[0]["version"] == live["version"]
    before = page.client.get(f"/api/site/history/{live['version']}").json()
    assert (before["zones"], before["rules"]) == (live["zones"], live["rules"])
    assert page.client.get(f"/api/site/history/{'0' * 64}").status_code == 404


def test_only_what_is_there_is_tried(page: RunningPage) -> None:
    version = parts(page)["version"]
    for body, status in (
        ({"based_on": "old", "recording": "today"}, 409),
        ({"based_on": version, "revision": 7, "recording": "today"}, 409),
        ({"based_on": version, "recording": "../ledger"}, 404),
        ({"based_on": version}, 404),
    ):
        assert page.client.post("/api/site/draft/try", json=body).status_code == status, body


def test_a_rule_of_an_unknown_kind_is_told_in_its_place_with_the_nearest_name(
    page: RunningPage,
) -> None:
    live = parts(page)
    rules = [{"id": "a", "kind": "zone.entr", "zone": "all"}, {"id": "b", "kind": "body.fall"}]
    answer = page.client.put(
        "/api/site/draft",
        json={"based_on": live["version"], "zones": live["zones"], "rules": rules},
    )
    assert answer.status_code == 422
    (fault,) = answer.json()["faults"]
    assert fault["at"] == ["rules", 0, "kind"]
    assert "did you mean 'zone.enter'?" in fault["text"]


def test_what_no_camera_sees_and_what_is_too_small_there_is_remarked_in_its_place(
    page: RunningPage,
) -> None:
    rule = {"id": "far", "kind": "zone.enter", "zone": "far"}
    remarks = put(page, 0, zones={"all": ALL, "far": FAR}, rules=[rule])["remarks"]
    told = {tuple(one["at"]): one["text"] for one in remarks}
    assert "No camera sees any of it" in told["zones", "far"]
    assert "Two cameras or more see" in told["zones", "all"]


def site_with(side_m: float, **rule: object) -> RecordedSite:
    half = side_m / 2
    return RecordedSite.model_validate({
        "format": "trecsim.site/1", "name": "hall",
        "zones": {"spot": {"polygon_m": [[-half, -half], [half, -half], [half, half],
                                         [-half, half]]}},
        "rules": [{"id": "spot", "kind": "zone.enter", "zone": "spot", **rule}],
    })  # fmt: skip


def remarked(site: RecordedSite) -> list[tuple]:
    settings = fusion_settings(FusionTable())
    return [remark.at for remark in place_remarks(site, ring(3), settings)]


def test_a_zone_is_too_small_when_its_rule_can_never_be_certain_enough() -> None:
    both = [("zones", "spot"), ("rules", 0)]
    assert remarked(site_with(1.0)) == []
    assert remarked(site_with(0.02)) == both
    assert remarked(site_with(0.02, p_on=0.02, p_off=0.01)) == []
    widths = np.geomspace(0.01, 1.0, 12)
    told = [bool(remarked(site_with(float(width)))) for width in widths]
    assert told == sorted(told, reverse=True)  # there is one width from which on it is enough


def test_versions_of_the_site_file_are_kept_newest_first_and_not_for_ever(tmp_path: Path) -> None:
    history = SiteHistory(tmp_path)
    assert history.versions() == []
    for n in range(205):
        history.keep(f"text {n}", f"{n:064x}", 1.8e9 + n)
    kept = history.versions()
    assert len(kept) == 200
    assert kept[0] == {"version": f"{204:064x}", "until_s": 1.8e9 + 204}
    assert history.text(f"{204:064x}") == "text 204"
    assert history.text(f"{3:064x}") is None
