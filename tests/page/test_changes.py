"""What people do at the page: acts on events, drafts of the site, replay of recordings."""

import hashlib
import json
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from made_page import SITE, RunningPage, event, next_of, running_page, until
from made_tracks import walk
from trecsim.errors import InputError
from trecsim.page.page_data import PageData
from trecsim.page.site_draft import DraftDesk, version_of
from trecsim.page.site_text import parts_of, with_parts
from trecsim.store.ledger import Ledger
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recordings import tracks_recorder

ZONE = {"polygon_m": [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0]], "z_m": [0.0, 2.5]}
TEXT = """\
# The hall.
format = "trecsim.site/1"
name = "hall"
rig = "rig.toml"          # measured in May
poses = "a.poses.jsonl"

[zones.old]
polygon_m = [[0, 0], [1, 0], [1, 1]]

# How people are followed.
[fusion]
death_s = 2.0
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("changes")
    (folder / "site.toml").write_text(TEXT)
    recording = folder / "recordings" / "2026-11-30"
    recording.mkdir(parents=True)
    with tracks_recorder(recording, TracksInfo(rig_sha256="")) as tracks:
        for snapshot in walk(200, people=3):  # 8 s
            tracks.write(snapshot)
    (folder / "recordings" / "empty").mkdir()
    return folder


@pytest.fixture(scope="module", params=["ledger", "memory"])
def changing(folder: Path, request: pytest.FixtureRequest) -> Iterator[RunningPage]:
    """Run a page with and without a ledger."""
    ledger = folder / "ledger" if request.param == "ledger" else None
    data = PageData(folder / "recordings", ledger, folder / "site.toml")
    with running_page(data=data, site=replace(SITE, version=version(folder))) as page:
        yield page


def version(folder: Path) -> str:
    return hashlib.sha256((folder / "site.toml").read_bytes()).hexdigest()


def happened(page: RunningPage, identity: str) -> None:
    """Let an event happen, as the tracking process tells it."""
    page.process.event(event(identity))
    until(lambda: identity in [one["id"] for one in listed(page)])


def listed(page: RunningPage, **query: object) -> list[dict]:
    answer = page.client.get("/api/events", params=query)
    assert answer.status_code == 200
    return answer.json()["events"]


def test_an_act_reaches_the_list_every_viewer_and_the_tracking_process(
    changing: RunningPage, folder: Path
) -> None:
    happened(changing, "alarm")
    changing.process.requests()
    with changing.stream() as stream:
        next_of(stream, "health")
        answer = changing.client.post("/api/events/alarm", json={"phase": "ack"})
        assert answer.status_code == 200
        made = answer.json()["event"]
        assert (made["data"]["phase"], made["data"]["by"]) == ("ack", "local")
        assert made["data"]["seq"] == 1
        assert next_of(stream, "event")["event"] == made
    assert listed(changing, event="alarm")[-1] == made
    requests: list = []
    until(lambda: bool(requests.extend(changing.process.requests()) or requests))
    assert (requests[0].kind, requests[0].by, requests[0].body["event"]) == ("event", "local", made)


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ({"phase": "close", "reason": "false", "note": "a bag"}, 200),
        ({"phase": "reopen"}, 200),
        ({"phase": "shelve", "until_s": 2e9}, 200),
        ({"phase": "close"}, 409),
        ({"phase": "close", "reason": "bored"}, 400),
        ({"phase": "shelve"}, 409),
        ({"phase": "end"}, 400),
        ({"phase": "ack", "note": "x" * 3000}, 400),
        ({}, 400),
        ([], 400),
        ("ack", 400),
    ],
)
def test_only_complete_acts_are_taken(
    changing: RunningPage, folder: Path, body: object, status: int
) -> None:
    happened(changing, "acts")
    before = len(listed(changing, event="acts"))
    answer = changing.client.post("/api/events/acts", json=body)
    assert answer.status_code == status, answer.text
    assert len(listed(changing, event="acts")) == before + (status == 200)


def test_an_act_on_an_event_that_is_not_there_is_told(changing: RunningPage) -> None:
    answer = changing.client.post("/api/events", json={"phase": "ack", "event": "never"})
    assert (answer.status_code, answer.json()["error"]) == (409, "there is no event 'never'")


def test_events_are_listed_after_one_and_at_most_so_many(
    changing: RunningPage, folder: Path
) -> None:
    for number in range(5):
        happened(changing, f"listed{number}")
    assert [one["id"] for one in listed(changing, limit=2)] == ["listed3", "listed4"]
    assert [one["id"] for one in listed(changing, after="listed1", limit=2)] == [
        "listed2", "listed3",
    ]  # fmt: skip
    for query in ({"limit": "x"}, {"limit": 0}, {"from_s": "nan"}, {"after": "a" * 500}):
        assert changing.client.get("/api/events", params=query).status_code == 400


def test_an_event_that_the_ledger_has_later_is_listed_once_and_can_be_acted_upon(
    tmp_path: Path,
) -> None:
    with running_page(data=PageData(ledger=tmp_path)) as page, Ledger(tmp_path) as ledger:
        happened(page, "first")
        happened(page, "second")
        assert ledger.events() == []  # the tracking process writes them, once it can
        ledger.append_event(event("first"))
        assert [one["id"] for one in listed(page)] == ["first", "second"]
        assert [one["id"] for one in listed(page, after="first")] == ["second"]
        assert [one["id"] for one in listed(page, event="second")] == ["second"]
        assert page.client.post("/api/events/second", json={"phase": "ack"}).status_code == 200
        ledger.append_event(event("second"))
        rows = [(one.event["data"]["event"], one.event["data"]["phase"]) for one in ledger.events()]
        assert rows == [("first", "new"), ("second", "new"), ("second", "ack")]
        assert [one["id"] for one in listed(page)] == [one.event["id"] for one in ledger.events()]


def test_an_event_that_the_ledger_has_is_written_by_nobody_else(tmp_path: Path) -> None:
    with running_page(data=PageData(ledger=tmp_path)) as page, Ledger(tmp_path) as ledger:
        with page.stream() as stream:
            next_of(stream, "health")
            ledger.append_event(event("kept"))
            page.process.event(event("kept"), kept=True)
            assert next_of(stream, "event")["event"]["id"] == "kept"
        assert [one["id"] for one in listed(page)] == ["kept"]


def test_what_a_user_has_reviewed_is_kept(changing: RunningPage) -> None:
    path = "/api/users/me/reviewed"
    assert changing.client.post(path, json={"events": ["a", "b"]}).json() == {"events": ["a", "b"]}
    undone = changing.client.post(path, json={"events": ["a"], "reviewed": False})
    assert undone.json() == changing.client.get(path).json() == {"events": ["b"]}


def test_recordings_are_listed_and_replayed_in_part(changing: RunningPage) -> None:
    assert changing.client.get("/api/recordings").json() == [
        {"id": "2026-11-30", "from_s": 0.0, "to_s": 7.96, "people": 3, "gaps": []}
    ]
    answer = changing.client.get(
        "/api/recordings/2026-11-30/snapshots", params={"from_s": 2.0, "to_s": 4.0}
    )
    assert answer.status_code == 200
    lines = [json.loads(line) for line in answer.text.splitlines()]
    assert len(lines) == 51
    assert (lines[0]["t_s"], lines[-1]["t_s"]) == (2.0, 4.0)
    assert [person["person"] for person in lines[0]["people"]] == [0, 1, 2]


def test_a_part_of_a_recording_has_the_vehicles_that_a_feed_told(
    changing: RunningPage, folder: Path
) -> None:
    told = {"feed": "yard", "volume": "truck", "id": "7"}
    lines = [
        json.dumps({**told, "taken_s": t_s, "t_s": t_s, "xy_m": [t_s, 0.0]}) for t_s in (1.0, 2.0)
    ]
    kept = folder / "recordings" / "2026-11-30" / "signals-0000000000.jsonl"
    truck = {"size_m": [4.0, 2.0, 2.0], "feed": "yard"}
    before = replace(SITE, version=version(folder))
    changing.process.site(replace(before, volumes={"truck": truck}))
    until(lambda: bool(changing.client.get("/api/site").json()["site"]["volumes"]))

    def shown() -> list[float | None]:
        answer = changing.client.get(
            "/api/recordings/2026-11-30/snapshots", params={"from_s": 1.9, "to_s": 2.1}
        )
        moments = [json.loads(line) for line in answer.text.splitlines()]
        assert len(moments) == 5
        return [one["volumes"][0]["xy_m"][0] if "volumes" in one else None for one in moments]

    try:
        kept.write_text("\n".join(lines) + "\n")
        assert shown() == [1.0, 1.0, 2.0, 2.04, 2.08]  # known to move from its second message on
        kept.write_text(f"{lines[0]}\ndamaged\n{lines[1]}\n")
        assert shown() == [1.0] * 5
        kept.unlink()
        assert shown() == [None] * 5
    finally:
        kept.unlink(missing_ok=True)
        changing.process.site(before)


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("2026-11-30/snapshots", 400),
        ("2026-11-30/snapshots?from_s=4&to_s=2", 400),
        ("2026-11-30/snapshots?from_s=0&to_s=9999", 400),
        ("empty/snapshots?from_s=0&to_s=1", 404),
        ("none/snapshots?from_s=0&to_s=1", 404),
        ("..%2fledger/snapshots?from_s=0&to_s=1", 404),
        ("%2e%2e/snapshots?from_s=0&to_s=1", 404),
        (".%00/snapshots?from_s=0&to_s=1", 404),
    ],
)
def test_what_is_no_part_of_a_recording_is_refused(
    changing: RunningPage, path: str, status: int
) -> None:
    assert changing.client.get(f"/api/recordings/{path}").status_code == status


def test_a_draft_is_checked_kept_and_made_live_once(changing: RunningPage, folder: Path) -> None:
    client, live = changing.client, version(folder)
    (folder / "site.toml").write_text(TEXT)
    live = version(folder)
    draft = {"based_on": live, "zones": {"strip": ZONE}}
    crossed = {"polygon_m": [[0, 0], [2, 2], [2, 0], [0, 2]]}
    wrong = client.put("/api/site/draft", json={**draft, "zones": {"strip": crossed}})
    assert wrong.status_code == 422
    assert "sides 1 and 3 cross" in wrong.json()["error"]
    assert [one["at"] for one in wrong.json()["faults"]] == [["zones", "strip"]]
    nothing = client.put("/api/site/draft", json={**draft, "zones": {"a b": {"z_m": None}}})
    assert {tuple(one["at"]) for one in nothing.json()["faults"]} == {
        ("zones", "a b"), ("zones", "a b", "polygon_m"), ("zones", "a b", "z_m"),
    }  # fmt: skip
    assert client.put("/api/site/draft", json={**draft, "based_on": "old"}).status_code == 409
    first = client.put("/api/site/draft", json=draft)
    assert (first.status_code, first.json()["revision"]) == (200, 1)
    again = client.put("/api/site/draft", json=draft)
    assert again.status_code == 409
    assert "changed by local meanwhile" in again.json()["error"]
    assert client.get("/api/site/draft").json()["zones"] == {"strip": ZONE}
    changing.process.requests()
    made = client.post("/api/site/draft/live", json={"based_on": live, "revision": 1})
    assert made.status_code == 200, made.text
    assert made.json()["version"] == version(folder)
    text = (folder / "site.toml").read_text()
    assert tomllib.loads(text)["zones"] == {"strip": ZONE}
    for comment in ("# The hall.", "# measured in May", "# How people are followed."):
        assert comment in text
    requests: list = []
    until(lambda: bool(requests.extend(changing.process.requests()) or requests))
    assert requests[0].kind == "reload"
    assert client.get("/api/site/draft").json() is None
    gone = client.post("/api/site/draft/live", json={"based_on": live, "revision": 1})
    assert gone.status_code == 409


def test_beds_and_portals_are_drawn_as_zones_are_and_kept_in_the_history(
    changing: RunningPage, folder: Path
) -> None:
    bed, door = {"polygon_m": ZONE["polygon_m"], "z_m": [0, 0.9]}, {"points_m": [[0, 4], [2, 4]]}
    (folder / "site.toml").write_text(f"{TEXT}\n[exclusions.old]\n{_toml(bed)}")
    before, client = version(folder), changing.client
    client.delete("/api/site/draft")
    parts = client.get("/api/site/parts").json()
    assert (parts["exclusions"], parts["portals"]) == ({"old": bed}, {})
    places = {"exclusions": {"bed": bed}, "portals": {"north": door}}
    crossed = {"polygon_m": [[0, 0], [2, 2], [2, 0], [0, 2]]}
    body = {"based_on": before, "zones": parts["zones"]}
    wrong = client.put("/api/site/draft", json={**body, "exclusions": {"bed": crossed}})
    assert [one["at"] for one in wrong.json()["faults"]] == [["exclusions", "bed"]]
    first = client.put("/api/site/draft", json={**body, **places})
    assert first.status_code == 200, first.text
    asked = {"based_on": before, "revision": first.json()["revision"]}
    assert client.post("/api/site/draft/live", json=asked).status_code == 200
    made = tomllib.loads((folder / "site.toml").read_text())
    assert (made["exclusions"], made["portals"]) == ({"bed": bed}, {"north": door})
    kept = client.get(f"/api/site/history/{before}")
    if kept.status_code == 200:  # with a ledger there is a folder for it
        assert kept.json()["exclusions"] == {"old": bed}
    # A draft of who knows neither leaves both as they are.
    body["based_on"] = version(folder)
    second = client.put("/api/site/draft", json=body)
    asked = {"based_on": version(folder), "revision": second.json()["revision"]}
    assert client.post("/api/site/draft/live", json=asked).status_code == 200
    assert tomllib.loads((folder / "site.toml").read_text())["portals"] == {"north": door}


def _toml(table: dict) -> str:
    return "".join(f"{key} = {value}\n" for key, value in table.items())


def test_a_site_without_pictures_has_none(changing: RunningPage) -> None:
    assert changing.client.get("/api/cameras/north/picture").status_code == 404


@pytest.mark.parametrize(
    "text",
    [
        TEXT.replace("[zones.old]", "zones.old"),
        "zones = { old = { polygon_m = [[0, 0], [1, 0], [1, 1]] } }\n"
        + TEXT.replace("[zones", "[x"),
        TEXT + '[output]\nnote = """\n[zones.x]\n"""\n',
    ],
)
def test_a_site_file_that_cannot_be_changed_without_harm_is_left_alone(text: str) -> None:
    with pytest.raises(InputError, match="change the file by hand"):
        with_parts(text, {"zones": {"strip": ZONE}})


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
def test_the_version_of_a_site_file_is_that_of_its_text(tmp_path: Path, encoding: str) -> None:
    (tmp_path / "site.toml").write_text(TEXT, encoding=encoding)
    assert DraftDesk(tmp_path / "site.toml", None).version() == version_of(TEXT)


RULES = """
# Nobody at night.
[[rules]]
id = "night"        # agreed with the union
kind = "zone.enter"
zone = "old"
schedule = ["Mo-Su 22:00-06:00"]

# How many.
[[rules]]
id = "many"
kind = "occupancy.limit"
zone = "old"
limit = 3  # fire code
"""


def test_rules_change_with_their_comments_and_the_others_stay_to_the_letter() -> None:
    night, many = parts_of(TEXT + RULES)["rules"]
    places = {"zones": parts_of(TEXT)["zones"]}
    changed = with_parts(TEXT + RULES, places, [night, {**many, "limit": 5}])
    assert changed == (TEXT + RULES).replace("limit = 3  # fire code", "limit = 5  # fire code")
    swapped = with_parts(TEXT + RULES, places, [many, night])
    assert [rule["id"] for rule in tomllib.loads(swapped)["rules"]] == ["many", "night"]
    assert swapped.index("# How many.") < swapped.index("# Nobody at night.")
    running = {"id": "running", "kind": "speed.running", "speed_mps": 3.0}
    added = with_parts(TEXT + RULES, places, [night, running])
    assert [rule["id"] for rule in tomllib.loads(added)["rules"]] == ["night", "running"]
    assert "# agreed with the union" in added
    assert "How many" not in added
    assert with_parts(TEXT + RULES, places) == TEXT + RULES


def test_a_zone_that_does_not_change_stays_to_the_letter() -> None:
    text = TEXT.replace("[1, 1]]", "[1, 1]]   # to the pillar")
    zones = {**parts_of(text)["zones"], "strip": ZONE}
    changed = with_parts(text, {"zones": zones})
    assert "polygon_m = [[0, 0], [1, 0], [1, 1]]   # to the pillar" in changed
    assert tomllib.loads(changed)["zones"] == zones
    higher = with_parts(text, {"zones": {"old": {**zones["old"], "z_m": [0.5, 2.0]}}})
    assert "# to the pillar" in higher
    assert tomllib.loads(higher)["zones"]["old"]["z_m"] == [0.5, 2.0]


def test_numbers_may_come_without_their_decimals_as_browsers_write_them() -> None:
    text = TEXT.replace("[[0, 0], [1, 0], [1, 1]]", "[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]")
    zones = {"old": {"polygon_m": [[0, 0], [1, 0], [1, 1]]}, "strip": ZONE}
    assert "[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]" in with_parts(text, {"zones": zones})


def test_a_zone_with_its_corners_on_lines_of_their_own_is_replaced() -> None:
    lines = "polygon_m = [\n  [0, 0],\n  [1, 0],  # the door\n  [1, 1]\n]"
    text = TEXT.replace("polygon_m = [[0, 0], [1, 0], [1, 1]]", lines)
    found = tomllib.loads(with_parts(text, {"zones": {"new": ZONE}}))
    assert found["zones"] == {"new": ZONE}
    assert found["fusion"] == {"death_s": 2.0}


def test_places_can_be_added_replaced_and_removed() -> None:
    added = with_parts(
        TEXT, {"zones": {"a": ZONE}, "lines": {"gate": {"points_m": [[0, 0], [1, 0]]}}}
    )
    found = tomllib.loads(added)
    assert (set(found["zones"]), set(found["lines"])) == ({"a"}, {"gate"})
    assert with_parts(added, {}) == added  # what is not given stays
    removed = with_parts(added, {"zones": {}, "lines": {}})
    assert "zones" not in tomllib.loads(removed)
    assert tomllib.loads(removed)["fusion"] == {"death_s": 2.0}
    assert removed.startswith("# The hall.")
