"""`trecsim run` on RTSP cameras of a real server: one dies and comes back, no password is shown."""

import json
import signal
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from end_to_end.test_live_site import WAIT_S, Running, serving
from made_onnx import write_onnx
from made_rigs import ring
from rtsp_servers import SIZE_PX, RtspCamera, rtsp_camera
from trecsim.calibration import write_rig
from trecsim.geometry import Rig

SECRET = "s3cret-of-the-cameras"
SITE = """\
format = "trecsim.site/1"
name = "live"
rig = "rig.toml"
[estimator]
name = "onnx:{network}"
[page]
port = 0
pictures = true
"""


def make_site(folder: Path, cameras: dict[str, RtspCamera]) -> Path:
    """Write a site with a network that finds nobody."""
    write_rig(Rig(tuple(replace(one, size_px=SIZE_PX) for one in ring(2))), folder / "rig.toml")
    rows = np.zeros((1, 56, 84), np.float32)
    network = write_onnx(folder / "nobody.onnx", (1, 3, 64, 64), {"output0": rows})
    sources = [
        f'[sources.{name}]\nurl = "{camera.url()}"\ncredentials = "hall"\n'
        for name, camera in cameras.items()
    ]
    path = folder / "site.toml"
    path.write_text(SITE.format(network=network) + "".join(sources))
    return path


def states(site: Running) -> dict[str, str]:
    cameras = site.get("api/health").json()["cameras"]
    return {name: camera["state"] for name, camera in cameras.items()}


def test_a_camera_that_dies_is_told_comes_back_and_no_password_is_shown_anywhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TRECSIM_CREDENTIALS_HALL", f"viewer:{SECRET}")
    with ExitStack() as stack:
        login = f"viewer:{SECRET}"
        cameras = {name: stack.enter_context(rtsp_camera(login=login)) for name in ("cam0", "cam1")}
        path = make_site(tmp_path, cameras)
        site = stack.enter_context(serving("run", str(path), "--out", str(tmp_path / "out")))
        assert states(site) == {"cam0": "down", "cam1": "down"}
        site.until(lambda: set(states(site).values()) == {"live"})
        told = site.get("api/health").json()["cameras"]
        assert {one["clock"] for one in told.values()} <= {"sender", "arrival"}
        picture = site.get("api/cameras/cam1/picture")
        assert (picture.status_code, picture.content[:3]) == (200, b"\xff\xd8\xff"), picture.text
        assert site.get("api/site").json()["site"]["pictures"] is True
        cameras["cam0"].switch_off()
        site.until(lambda: states(site) in ({"cam0": lost, "cam1": "live"} for lost in LOST))
        site.until(lambda: "nothing answers" in site.get("api/health").text)
        assert site.get("api/cameras/cam0/picture").status_code == 503
        told = [one["data"] for one in site.get("api/events").json()["events"]]
        assert {(one["camera"], one["phase"]) for one in told} >= {("cam0", "new")}
        cameras["cam0"].switch_on()
        site.until(lambda: set(states(site).values()) == {"live"})
        texts = [site.get(place).text for place in ("api/health", "api/site", "metrics", "")]
        texts.append(Path(f"/proc/{site.process.pid}/cmdline").read_text())
        site.process.send_signal(signal.SIGTERM)
        assert site.process.wait(WAIT_S) == 0
    kept = [one for one in tmp_path.rglob("*") if one.is_file()]
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["ended"] == "stopped"
    assert not any(SECRET in text for text in [*texts, *site.said])
    assert not any(SECRET.encode() in one.read_bytes() for one in kept)


LOST = ("stale", "down")
