"""What the page answers over HTTP, and what it refuses."""

import socket
from contextlib import ExitStack
from pathlib import Path
from time import time

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families
from websockets.exceptions import InvalidStatus

from made_page import SITE, RunningPage, running_page, until, well
from made_tracks import snapshot
from trecsim.health import CameraHealth
from trecsim.page.page_data import PageData
from trecsim.page.serving import CONNECTIONS

ALWAYS = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}


def test_every_camera_is_down_without_an_age_until_its_first_image() -> None:
    with running_page() as page:
        answer = page.client.get("/api/health")
        assert answer.status_code == 503
        assert set(answer.json()["cameras"]) == set(SITE.cameras)
        for camera in answer.json()["cameras"].values():
            assert (camera["state"], camera["age_s"], camera["dropped"]) == ("down", None, 0)


def test_health_is_200_when_all_is_well_and_503_when_a_camera_is_down(page: RunningPage) -> None:
    page.process.health(well())
    until(lambda: page.client.get("/api/health").status_code == 200)
    answer = page.client.get("/api/health").json()
    assert answer["status"] == "ok"
    assert {"status", "cameras", "fusion", "store"} <= set(answer)
    assert {"state", "fps", "age_s", "clock", "dropped"} <= set(answer["cameras"]["north"])
    page.process.health(well(north=CameraHealth("down", 0.0, 12.0, fault="no answer")))
    until(lambda: page.client.get("/api/health").status_code == 503)
    assert page.client.get("/api/health").json()["faults"] == ["camera north is down: no answer"]


def test_the_site_is_told_with_its_version(page: RunningPage) -> None:
    answer = page.client.get("/api/site").json()
    assert answer["version"] == SITE.version
    assert answer["site"]["name"] == "hall"
    assert "version" not in answer["site"]


def test_prometheus_can_read_the_figures(page: RunningPage) -> None:
    page.process.health(well(south=CameraHealth("stale", 3.0, 2.5, dropped_by={"late": 4})))
    page.process.write(snapshot(time(), [1, 2, 3]))

    def figures() -> dict[tuple[str, tuple[str, ...]], float]:
        families = text_string_to_metric_families(page.client.get("/metrics").text)
        return {
            (sample.name, tuple(sample.labels.values())): sample.value
            for family in families
            for sample in family.samples
        }

    until(lambda: figures()["trecsim_people", ()] == 3)
    found = figures()
    assert all(name.startswith("trecsim_") for name, _ in found)
    assert found["trecsim_camera_state", ("south", "stale")] == 1
    assert found["trecsim_camera_state", ("south", "live")] == 0
    assert found["trecsim_camera_age_seconds", ("south",)] == 2.5
    assert found["trecsim_camera_dropped_frames_total", ("south", "late")] == 4
    assert found["trecsim_fusion_step_seconds", ()] == 0.001


@pytest.mark.parametrize("path", ["/", "/live", "/review/3f", "/zones", "/system", "/favicon.ico"])
def test_the_page_and_its_places_answer_with_the_policy_headers(
    page: RunningPage, path: str
) -> None:
    answer = page.client.get(path)
    assert answer.status_code == 200
    assert ALWAYS.items() <= dict(answer.headers).items()
    policy = dict(rule.split(" ", 1) for rule in answer.headers[POLICY].split("; "))
    assert policy["default-src"] == policy["frame-ancestors"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == policy["connect-src"] == "'self'"
    assert "unsafe" not in answer.headers[POLICY]


POLICY = "content-security-policy"


def test_without_a_built_page_the_page_says_how_to_build_it(tmp_path: Path) -> None:
    with running_page(data=PageData(static=tmp_path / "none")) as page:
        text = page.client.get("/").text
        assert "make page" in text
        assert "<style" not in text
        assert "<script" not in text


def test_files_of_the_built_page_are_compressed_and_cached_by_their_name(tmp_path: Path) -> None:
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("<!doctype html><title>built</title>")
    script = "export const x = 1;\n" * 100
    (tmp_path / "assets" / "main-4f3a9c1b.js").write_text(script)
    (tmp_path.parent / "secret.txt").write_text("not for anybody")
    with running_page(data=PageData(static=tmp_path)) as page:
        assert "built" in page.client.get("/review/12").text
        assert page.client.get("/").headers["cache-control"] == "no-cache"
        answer = page.client.get("/assets/main-4f3a9c1b.js")
        assert answer.text == script
        assert answer.headers["content-encoding"] == "gzip"
        assert answer.headers["content-type"] == "text/javascript; charset=utf-8"
        assert "immutable" in answer.headers["cache-control"]
        plain = page.client.get("/assets/main-4f3a9c1b.js", headers={"Accept-Encoding": "identity"})
        assert plain.content == script.encode()
        for path in ("/assets/none.js", "/assets", "/%2e%2e/secret.txt", "/..%2fsecret.txt"):
            assert page.client.get(path).status_code == 404
        assert b"not for" not in raw(page, "GET /../secret.txt HTTP/1.1\r\nHost: localhost\r\n\r\n")


def raw(page: RunningPage, request: str) -> bytes:
    with socket.create_connection(("127.0.0.1", page.port), timeout=20) as connection:
        connection.sendall(request.encode())
        return connection.recv(65536)


@pytest.mark.parametrize("host", ["evil.example", "localhost.evil.example", "", "127.0.0.1.nip.io"])
def test_a_name_that_is_not_the_pages_own_is_refused(page: RunningPage, host: str) -> None:
    for path in ("/", "/api/health", "/api/site"):
        assert page.client.get(path, headers={"Host": host}).status_code == 421
    with pytest.raises(InvalidStatus) as refused, page.stream(additional_headers={"Host": host}):
        pass
    assert refused.value.response.status_code in (400, 421)


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1:9000", "[::1]:80", "LOCALHOST:1"])
def test_loopback_has_several_names(page: RunningPage, host: str) -> None:
    assert page.client.get("/api/site", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize("origin", ["https://evil.example", "null", "http://127.0.0.1:1", ""])
def test_the_stream_is_not_for_pages_of_other_sites(page: RunningPage, origin: str) -> None:
    headers = {"Origin": origin}
    with pytest.raises(InvalidStatus) as refused, page.stream(additional_headers=headers):
        pass
    assert refused.value.response.status_code == 403


def test_the_stream_is_for_the_page_itself(page: RunningPage) -> None:
    with page.stream(additional_headers={"Origin": page.process.url.rstrip("/")}) as stream:
        assert stream.recv(20)


def test_a_long_address_a_large_body_and_large_headers_are_refused(page: RunningPage) -> None:
    assert page.client.get("/" + "a" * 2000).status_code == 414
    assert page.client.get("/", params={"a": "b" * 2000}).status_code == 414
    assert page.client.post("/api/site", content=b"x" * 2_000_000).status_code in (405, 413)
    assert page.client.get("/", headers={"X-Large": "a" * 20_000}).status_code == 431


def test_idle_connections_keep_nobody_out() -> None:
    with running_page() as page, ExitStack() as idle:
        page.process.health(well())
        until(lambda: page.client.get("/api/health").status_code == 200)
        for _ in range(CONNECTIONS + 20):
            idle.enter_context(socket.create_connection(("127.0.0.1", page.port), timeout=20))
        assert httpx.get(f"http://127.0.0.1:{page.port}/api/health", timeout=20).status_code == 200
