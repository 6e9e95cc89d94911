"""What a running site shows on its page when its file or its rig changes meanwhile."""

from functools import partial
from pathlib import Path
from typing import Any, cast

from made_page import until
from made_rigs import ring
from trecsim.calibration import write_rig
from trecsim.page.page_process import PageProcess
from trecsim.page.site_view import SiteView, cameras_of
from trecsim.service.counting import Counting
from trecsim.service.live_feeds import LiveFeeds
from trecsim.service.monitor import Monitor
from trecsim.service.rig_keeper import RigKeeper
from trecsim.service.rule_watch import RuleWatch
from trecsim.service.site_service import SiteService
from trecsim.sites.site_reading import SiteFile, read_site

SITE = 'format = "trecsim.site/1"\nname = "a"\nrig = "rig.toml"\nposes = "walk.poses.jsonl"\n'
ZONE = "[zones.press]\npolygon_m = [[0, 0], [1, 0], [1, 1]]\n"


class Page:
    """A page that keeps what it is to show."""

    def __init__(self) -> None:
        self.shown: list[SiteView] = []

    def site(self, view: SiteView) -> None:
        """Take what to show."""
        self.shown.append(view)


class Changes:
    """Takes rules, and has a new rig once."""

    def __init__(self) -> None:
        self.rigs = [ring(4)]

    def new_rig(self) -> Any:
        """Return the new rig once."""
        return self.rigs.pop() if self.rigs else None

    def change(self, *new: object) -> None:
        """Take other rules."""

    def take_rig(self, rig: object) -> None:
        """Take another rig."""


def read(folder: Path, text: str) -> SiteFile:
    (folder / "site.toml").write_text(text)
    return read_site(folder / "site.toml")


def test_a_repaired_rig_and_a_changed_file_are_shown_together_whichever_comes_first(
    tmp_path: Path,
) -> None:
    write_rig(ring(3), tmp_path / "rig.toml")
    (tmp_path / "walk.poses.jsonl").write_text("")
    for repaired_first in (True, False):
        page, changes = Page(), Changes()
        service = SiteService(cast(PageProcess, page))
        service._show(read(tmp_path, SITE), ring(3))
        steps = [
            partial(service._new_rig, cast(RigKeeper, changes), cast(Monitor, changes)),
            partial(
                service._apply, cast(RuleWatch, changes), cast(Counting, changes),
                read(tmp_path, SITE + ZONE),
            ),
        ]  # fmt: skip
        for step in steps if repaired_first else reversed(steps):
            step()
        assert list(page.shown[-1].zones) == ["press"]
        assert page.shown[-1].cameras == cameras_of(ring(4))


FEED = '[page]\n[feeds.gate]\nfile = "gate.jsonl"\n[feeds.yard]\nhttp = true\n'


def test_a_feed_that_comes_with_a_changed_file_is_followed_at_once(tmp_path: Path) -> None:
    write_rig(ring(3), tmp_path / "rig.toml")
    (tmp_path / "walk.poses.jsonl").write_text("")
    page, changes = Page(), Changes()
    service = SiteService(cast(PageProcess, page))
    service._show(read(tmp_path, SITE), ring(3))
    with LiveFeeds({}) as feeds:
        service._feeds = feeds
        service._apply(
            cast(RuleWatch, changes), cast(Counting, changes), read(tmp_path, SITE + FEED)
        )
        (tmp_path / "gate.jsonl").write_text('{"t_s": 3}\n')
        until(lambda: bool(feeds(4.0)))
    assert page.shown[-1].feeds["yard"]["source"] == "http"


def test_a_site_on_recordings_takes_no_messages_at_its_page(tmp_path: Path) -> None:
    write_rig(ring(3), tmp_path / "rig.toml")
    (tmp_path / "walk.poses.jsonl").write_text("")
    page = Page()
    SiteService(cast(PageProcess, page))._show(read(tmp_path, SITE + FEED), ring(3))
    assert page.shown[-1].feeds == {}
