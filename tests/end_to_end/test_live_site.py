"""`trecsim run` on live sources, as an operator and the service manager see it from outside."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from threading import Thread
from time import monotonic, sleep, time

import httpx
import pytest
from websockets.sync.client import connect

import trecsim
from made_recording import make_recording
from made_site import make_site
from receivers import Receiver, free_port, receiving
from trecsim.cloud_events import event_text
from trecsim.store.ledger import Ledger
from trecsim.store.tracks import export_tracks, read_tracks
from trecsim.values import Snapshot

PAGE = "[page]\nport = 0\n"
ZONE = "[zones.door]\npolygon_m = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]\n"
WAIT_S = 240.0


@dataclass
class Running:
    """A run in a process of its own, what it has written to stderr, and its page."""

    process: subprocess.Popen[str]
    said: list[str]
    url: str

    def get(self, path: str) -> httpx.Response:
        return httpx.get(self.url + path, timeout=WAIT_S)

    def until(self, what: Callable[[], bool]) -> None:
        deadline_s = monotonic() + WAIT_S
        while not what():
            assert self.process.poll() is None, self.said
            assert monotonic() < deadline_s, self.said
            sleep(0.1)

    def is_well(self) -> bool:
        return self.get("api/health").status_code == 200


def running(site: Path, *options: str) -> AbstractContextManager[Running]:
    """Run a site on its recordings, as if they were live."""
    return serving("run", str(site), "--as-live", *options)


@contextmanager
def serving(*arguments: str) -> Iterator[Running]:
    command = [sys.executable, "-c", "from trecsim.cli import main; main()", *arguments]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    said: list[str] = []
    assert process.stdout is not None
    assert process.stderr is not None
    reader = Thread(target=said.extend, args=(process.stderr,), daemon=True)
    reader.start()
    try:
        line = process.stdout.readline()
        assert line.startswith("page: http://127.0.0.1:"), said
        yield Running(process, said, line.removeprefix("page: ").strip())
    finally:
        process.kill()
        process.wait()
        reader.join()
        process.stdout.close()
        process.stderr.close()


@pytest.fixture(scope="module")
def long_site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_site(tmp_path_factory.mktemp("live"), moments=5000, more=PAGE)


def test_people_reach_a_program_and_sigterm_ends_in_order_with_all_kept(
    long_site: Path, tmp_path: Path
) -> None:
    with running(long_site, "--out", str(tmp_path / "out")) as site:
        first = site.get("api/health").json()
        assert set(first["cameras"]) == {"cam0", "cam1", "cam2"}
        site.until(site.is_well)
        told = (one for one in trecsim.connect(site.url) if isinstance(one, Snapshot))
        seen = list(islice((one for one in told if len(one.id)), 31))  # a busy machine loses some
        assert {len(one.id) for one in seen} == {1}
        site.process.send_signal(signal.SIGTERM)
        assert site.process.wait(WAIT_S) == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["ended"] == "stopped"
    kept = {one.t_s: one for one in read_tracks(tmp_path / "out")}
    for one in seen:  # the same numbers on the stream and in the recording
        assert kept[one.t_s].xyz_m.tolist() == one.xyz_m.tolist()
    with serving("replay", str(tmp_path / "out"), "--port", "0") as replayed:
        again = next(one for one in trecsim.connect(replayed.url) if isinstance(one, Snapshot))
        assert again.xyz_m.tolist() == kept[again.t_s].xyz_m.tolist()
        assert replayed.get("api/site").json()["site"]["kind"] == "recording"
        replayed.process.send_signal(signal.SIGINT)
        assert replayed.process.wait(WAIT_S) == 0


@pytest.mark.parametrize(
    ("command", "ending"),
    [("run", signal.SIGINT), ("replay", signal.SIGINT), ("replay", signal.SIGTERM)],
)
def test_a_signal_to_all_processes_right_after_the_line_of_the_page_ends_in_order(
    long_site: Path, tmp_path: Path, command: str, ending: signal.Signals
) -> None:
    if command == "run":
        given = ["run", str(long_site), "--as-live", "--out", str(tmp_path / "out")]
    else:
        folder = make_recording(tmp_path / "recorded")
        export_tracks(folder / "tracks.csv", folder / "tracks.parquet")
        given = ["replay", str(folder), "--port", "0"]
    with serving(*given) as site:
        os.killpg(site.process.pid, ending)
        assert site.process.wait(WAIT_S) == 0
    assert any("stopping; once more to stop at once" in line for line in site.said)
    assert not any("Traceback" in line for line in site.said)


def test_sighup_takes_over_what_may_change_and_keeps_the_old_where_the_new_is_wrong(
    long_site: Path,
) -> None:
    good = long_site.read_text()
    try:
        with running(long_site, "--out", str(long_site.parent / "hup")) as site:
            site.until(site.is_well)
            long_site.write_text(good + ZONE)
            site.process.send_signal(signal.SIGHUP)
            site.until(lambda: "door" in site.get("api/site").json()["site"]["zones"])
            long_site.write_text(good + ZONE.replace("polygon_m", "polygon"))
            site.process.send_signal(signal.SIGHUP)
            site.until(lambda: any("goes on as it was" in line for line in site.said))
            assert "door" in site.get("api/site").json()["site"]["zones"]
            assert any("polygon: unknown key" in line for line in site.said)
    finally:
        long_site.write_text(good)


RULES = """
[zones.ahead]
polygon_m = [[-1.0, 0.2], [1.0, 0.2], [1.0, 3.0], [-1.0, 3.0]]
[[rules]]
id = "ahead"
kind = "zone.enter"
zone = "ahead"
"""


FED = """
[feeds.yard]
http = true
[volumes.truck]
size_m = [4.0, 2.0, 2.0]
feed = "yard"
"""


def test_a_vehicle_that_is_posted_is_shown_to_viewers_and_kept_in_the_recording(
    tmp_path: Path,
) -> None:
    out = tmp_path / "out"
    path = make_site(tmp_path, moments=3000, more=PAGE + FED)
    with running(path, "--out", str(out)) as site:
        site.until(site.is_well)
        with connect(site.url.replace("http", "ws", 1) + "api/stream") as stream:

            def shown() -> bool:
                where = {"t_s": time(), "volume": "truck", "id": "7", "xy_m": [3.0, 1.0]}
                posted = httpx.post(f"{site.url}api/feeds/yard", json=where, timeout=WAIT_S)
                assert posted.status_code == 202, posted.text
                vehicles: list[str] = []
                for _ in range(20):
                    message = json.loads(stream.recv(WAIT_S))
                    vehicles += [one["id"] for one in message.get("volumes", ())]
                return vehicles[-1:] == ["7"]

            site.until(shown)
        site.process.send_signal(signal.SIGTERM)
        assert site.process.wait(WAIT_S) == 0
    (kept,) = out.glob("**/signals-*.jsonl")
    first = json.loads(kept.read_text().splitlines()[0])
    assert (first["feed"], first["volume"], first["id"]) == ("yard", "truck", "7")


def test_events_of_rules_reach_the_page_and_the_recording_gives_them_again_to_the_byte(
    tmp_path: Path,
) -> None:
    out = tmp_path / "out"
    path = make_site(tmp_path, moments=3000, more=PAGE + RULES)
    with running(path, "--out", str(out)) as site:
        site.until(lambda: len(site.get("api/events").json()["events"]) >= 3)
        rules = site.get("api/health").json()["rules"]
        assert rules == {"armed": 1, "total": 1, "fault": None, "mode": None}
        site.process.send_signal(signal.SIGTERM)
        assert site.process.wait(WAIT_S) == 0
    with Ledger(out) as ledger:
        kept = [one.event for one in ledger.events() if one.event["subject"] == "rule/ahead"]
    trecsim.assess(out, path, tmp_path / "events.jsonl")
    lines = (tmp_path / "events.jsonl").read_text().splitlines()
    assert lines == [event_text(event) for event in kept]
    assert [event["data"]["phase"] for event in kept[:2]] == ["new", "end"]
    assert kept[0]["data"]["evidence"]["cameras"] == ["cam0", "cam1", "cam2"]


def test_it_ends_by_itself_after_the_seconds_that_it_is_given(long_site: Path) -> None:
    with running(long_site, "--out", str(long_site.parent / "short"), "--seconds", "4") as site:
        assert site.process.wait(WAIT_S) == 0
    recorded = list(read_tracks(long_site.parent / "short"))
    assert 1.0 < recorded[-1].t_s - recorded[0].t_s < 10.0
    assert (
        json.loads((long_site.parent / "short" / "summary.json").read_text())["ended"] == "complete"
    )


def test_a_killed_page_comes_back_at_the_same_address_and_tracking_goes_on(long_site: Path) -> None:
    with running(long_site, "--out", str(long_site.parent / "killed")) as site:
        site.until(site.is_well)
        found = subprocess.run(
            ["pgrep", "-P", str(site.process.pid), "-f", "trecsim.page"],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        subprocess.run(["kill", "-9", *found.stdout.split()], check=True)

        def restarted() -> bool:
            with suppress(httpx.HTTPError):
                return site.get("api/health").json()["restarts"].get("page") == 1
            return False

        site.until(restarted)
        assert site.is_well()


def test_events_reach_a_web_service_that_was_away_though_the_site_was_killed_meanwhile(
    tmp_path: Path,
) -> None:
    receiver = Receiver(free_port())
    outputs = (
        '[lines.gate]\npoints_m = [[-5.0, 0.2], [5.0, 0.2]]\n'
        '[[rules]]\nid = "gate"\nkind = "line.cross"\nline = "gate"\n'
        f'[[outputs]]\nkind = "webhook"\nurl = "{receiver.url}"\ncredentials = "desk"\n'
        '[[outputs]]\nkind = "jsonl"\nfile = "events.jsonl"\nrules = ["gate"]\n'
    )  # fmt: skip
    site_file = make_site(tmp_path, moments=5000, more=f"{PAGE}{outputs}")
    (tmp_path / "secrets.toml").write_text('desk = "a key"\n')
    (tmp_path / "secrets.toml").chmod(0o600)
    text = site_file.read_text().replace("poses =", 'secrets = "secrets.toml"\nposes =')
    site_file.write_text(text)
    lines = tmp_path / "events.jsonl"
    with running(site_file) as site:  # nobody takes events
        site.until(lambda: lines.exists() and len(lines.read_text().splitlines()) >= 2)
        site.until(lambda: site.get("api/health").json()["outputs"]["webhook"]["queue"] >= 2)
        site.process.kill()
    assert not receiver.taken
    with receiving(receiver), running(site_file) as site:
        site.until(lambda: len(receiver.taken) >= 2)
        site.until(lambda: len(lines.read_text().splitlines()) >= 4)
        site.process.send_signal(signal.SIGTERM)
        assert site.process.wait(WAIT_S) == 0
    with Ledger(tmp_path / "recordings" / "made") as ledger:
        kept = [one.event for one in ledger.events()]
    sent = [json.loads(body) for _, body in receiver.taken]
    assert list({one["id"]: one for one in sent}.values()) == kept
    of_rule = [event_text(one) for one in kept if one["data"]["rule"]["id"] == "gate"]
    assert lines.read_text().splitlines() == of_rule
