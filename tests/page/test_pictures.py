"""Pictures of cameras on the page: where the site allows them, for who looks, never an old one."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from threading import Event, Thread
from time import sleep

import pytest

from made_page import SITE, RunningPage, running_page
from trecsim.page import picture_routes
from trecsim.page.page_data import PageData
from trecsim.store.ledger import Ledger

PATH = "/api/cameras/north/picture"


@pytest.fixture
def page(tmp_path: Path) -> Iterator[RunningPage]:
    with running_page(data=PageData(ledger=tmp_path), site=replace(SITE, pictures=True)) as page:
        yield page


@contextmanager
def tracking(page: RunningPage) -> Iterator[list[str]]:
    """Answer what the page asks for, as the tracking process does; tell which cameras that were."""
    asked: list[str] = []
    ending = Event()

    def run() -> None:
        while not ending.wait(0.05):
            for request in page.process.requests():
                if request.kind == "picture":
                    asked.append(request.body["camera"])
                    page.process.picture(asked[-1], 1e9, f"picture {len(asked)}".encode())

    thread = Thread(target=run)
    thread.start()
    try:
        yield asked
    finally:
        ending.set()
        thread.join()


def test_a_picture_is_made_for_who_looks_and_kept_nowhere(page: RunningPage) -> None:
    with tracking(page) as asked:
        assert asked == []
        answer = page.client.get(PATH)
        assert (answer.status_code, answer.content) == (200, b"picture 1")
        assert answer.headers["Content-Type"] == "image/jpeg"
        assert answer.headers["Cache-Control"] == "no-store"
        assert asked == ["north"]
        again = [page.client.get(PATH).content for _ in range(4)]  # soon after: no new one is made
        assert len(asked) <= 2
        assert set(again) <= {b"picture 1", b"picture 2"}


def test_who_looks_stands_in_the_audit_log_once(page: RunningPage, tmp_path: Path) -> None:
    with tracking(page):
        for _ in range(3):
            assert page.client.get(PATH).status_code == 200
        assert page.client.get("/api/cameras/south/picture").status_code == 200
    with Ledger(tmp_path) as ledger:
        found = [(one.who, one.act, one.details["camera"]) for one in ledger.audit()]
    assert found == [("local", "look at camera", "north"), ("local", "look at camera", "south")]


def test_an_old_picture_is_never_shown(page: RunningPage) -> None:
    with tracking(page):
        assert page.client.get(PATH).status_code == 200
    sleep(picture_routes.FRESH_S)
    answer = page.client.get(PATH)
    assert answer.status_code == 503
    assert "no picture lately" in answer.json()["error"]


def test_a_camera_that_is_none_and_a_site_without_pictures_have_none(
    page: RunningPage, tmp_path: Path
) -> None:
    assert page.client.get("/api/cameras/cellar/picture").status_code == 404
    with running_page() as other:
        answer = other.client.get(PATH)
        assert (answer.status_code, other.process.requests()) == (404, [])
        assert "shows no pictures" in answer.json()["error"]
