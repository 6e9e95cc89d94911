"""The doctor looks at the cameras of a site, and says what to do about each."""

import json
import socket
from collections.abc import Mapping
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from threading import Thread

import pytest

from made_cameras import MadeCamera
from made_rigs import ring
from rtsp_servers import SIZE_PX, rtsp_camera
from trecsim import cli, site_doctor
from trecsim.calibration import write_rig
from trecsim.doctor import Finding
from trecsim.geometry import Rig
from trecsim.site_doctor import examine_site
from trecsim.sites.check import check_site


def site(folder: Path, text: str, size_px: tuple[int, int] = (64, 48)) -> Path:
    rig = Rig(tuple(replace(camera, size_px=size_px) for camera in ring(3)))
    write_rig(rig, folder / "rig.toml")
    path = folder / "site.toml"
    path.write_text('format = "trecsim.site/1"\nname = "live"\nrig = "rig.toml"\n' + text)
    return path


def found(path: Path, look_s: float = 4.0) -> Mapping[str, Finding]:
    return {one.name: one for one in examine_site(check_site(path), look_s)}


def test_each_camera_is_told_with_what_to_do_about_it(tmp_path: Path) -> None:
    with closing(MadeCamera()) as north, closing(MadeCamera((96, 64))) as south:
        text = (
            f'[sources.cam0]\nurl = "{north.url}"\n[sources.cam1]\nurl = "{south.url}"\n'
            '[sources.cam2]\nurl = "rtsp://127.0.0.1:9/1"\ncredentials = "nobody-has-these"\n'
        )
        findings = found(site(tmp_path, text))
    good = findings["camera cam0"]
    assert good.state == "ok"
    assert "h264, 64 x 48 px" in good.text
    assert findings["clock of camera cam0"].state == "missing"
    assert "NTP" in findings["clock of camera cam0"].remedy
    assert findings["camera cam1"].state == "broken"
    assert "its images are 96 x 64 px" in findings["camera cam1"].text
    assert "TRECSIM_CREDENTIALS_NOBODY_HAS_THESE" in findings["camera cam2"].remedy
    assert all(one.remedy for one in findings.values() if one.state != "ok")


def test_the_clock_of_a_camera_is_told(tmp_path: Path) -> None:
    with rtsp_camera() as camera:
        text = f'[sources.cam0]\nurl = "{camera.url()}"\n'
        findings = found(site(tmp_path, text, SIZE_PX), look_s=60.0)  # ends when it has seen enough
    assert findings["camera cam0"].state == "ok"
    clock = findings["clock of camera cam0"]
    assert clock.state == "ok"
    assert "images arrive after" in clock.text


def test_a_port_in_use_and_a_camera_that_is_off_make_the_command_fail(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(site_doctor, "examine_site", partial(examine_site, look_s=2.0))
    with closing(socket.create_server(("127.0.0.1", 0))) as taken:
        port = taken.getsockname()[1]
        path = site(tmp_path, f'[sources.cam0]\ndevice = "/dev/none"\n[page]\nport = {port}\n')
        with pytest.raises(SystemExit) as end:
            cli.main(["doctor", str(path), "--json"])
    assert end.value.code == 1
    output = capsys.readouterr()
    told = {one["name"]: one for one in json.loads(output.out)["findings"]}
    assert told["port of the page"]["state"] == "broken"
    assert "there is no camera /dev/none" in told["camera cam0"]["text"]
    assert told["disk of the site"]["text"].endswith(str(tmp_path))
    assert "camera cam0, port of the page" in output.err


@pytest.mark.parametrize(
    ("table", "state", "text"),
    [
        ("", "ok", "everybody on this machine"),
        ('host = "0.0.0.0"\n', "broken", "expected users or token_env"),
        ('host = "0.0.0.0"\nusers = "users.toml"\n', "broken", "there is no such file"),
        ('host = "0.0.0.0"\ntoken_env = "MADE_TOKEN"\n', "missing", "passwords need TLS"),
        ('token_env = "MADE_TOKEN"\n', "ok", "who signs in"),
    ],
)
def test_who_may_use_the_page_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, table: str, state: str, text: str
) -> None:
    monkeypatch.setenv("MADE_TOKEN", "made-up-" * 8)
    (tmp_path / "poses.jsonl").write_text('{"format": "trecsim.poses2d/1", "skeleton": "coco17"}\n')
    access = found(site(tmp_path, f'poses = "poses.jsonl"\n[page]\nport = 0\n{table}'))[
        "access to the page"
    ]
    assert access.state == state
    assert text in access.text
    assert (access.remedy == "") == (state == "ok")


def test_a_site_without_live_cameras_has_none_to_look_at(tmp_path: Path) -> None:
    from made_site import make_site

    assert list(found(make_site(tmp_path, 2))) == ["disk of the site"]


def test_the_broker_of_a_feed_is_looked_at(tmp_path: Path) -> None:
    from made_site import make_site
    from receivers import Broker

    broker = Broker(tmp_path)
    feed = f'[feeds.gate]\nmqtt = "gates"\nbroker = "{broker.url}"\n'
    with broker:
        assert found(make_site(tmp_path, 2, feed))["broker of feed gate"].state == "ok"
    gone = found(make_site(tmp_path, 2, feed))["broker of feed gate"]
    assert (gone.state, gone.text) == (
        "broken", f"the broker 127.0.0.1:{broker.port}: Connection refused",
    )  # fmt: skip


def test_a_broker_that_speaks_an_older_mqtt_is_none_for_feeds(tmp_path: Path) -> None:
    from made_site import make_site

    def answer_one(listening: socket.socket) -> None:
        """Answer as MQTT 3.1.1 does, which refuses a later version with 1."""
        link, _ = listening.accept()
        with link:
            is_known = link.recv(1000)[8] <= 4
            link.sendall(bytes([0x20, 2, 0, 0 if is_known else 1]))
            link.recv(1000)

    with socket.create_server(("127.0.0.1", 0)) as listening:
        Thread(target=answer_one, args=(listening,), daemon=True).start()
        broker = f"mqtt://127.0.0.1:{listening.getsockname()[1]}"
        feed = f'[feeds.gate]\nmqtt = "gates"\nbroker = "{broker}"\n'
        finding = found(make_site(tmp_path, 2, feed))["broker of feed gate"]
    assert finding.state == "broken"
    assert "refuses the connection: Unsupported protocol version" in finding.text
