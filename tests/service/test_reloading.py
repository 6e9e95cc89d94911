"""A site file is read again while the site runs: what counts at once, and what does not."""

from pathlib import Path

import pytest

from trecsim.service.reloading import WHILE_RUNNING, Reloading
from trecsim.sites import read_site
from trecsim.sites.site_reading import SiteFile

TEXT = 'format = "trecsim.site/1"\nname = "yard"\nrig = "rig.toml"\nposes = "a.poses.jsonl"\n'
ZONE = "[zones.strip]\npolygon_m = [[0, 0], [1, 0], [1, 1]]\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "site.toml").write_text(TEXT)
    return tmp_path / "site.toml"


FEED = '[feeds.gate]\nfile = "gate.jsonl"\n'


def reloaded(path: Path, *texts: str, tables: frozenset[str] = WHILE_RUNNING) -> list[SiteFile]:
    """Return what is applied while the file gets one text after the other."""
    applied: list[SiteFile] = []
    reloading = Reloading(read_site(path), applied.append, tables)
    for text in texts:
        path.write_text(text)
        reloading.ask()
        reloading()
    return applied


def test_zones_count_at_once(path: Path) -> None:
    (applied,) = reloaded(path, TEXT + ZONE)
    assert list(applied.site.zones) == ["strip"]


def test_a_changed_comment_gives_the_site_another_version(path: Path) -> None:
    (applied,) = reloaded(path, "# The yard.\n" + TEXT)
    assert applied.text == "# The yard.\n" + TEXT


def test_what_needs_a_new_start_is_told_each_time_and_stays(
    path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    renamed = TEXT.replace("yard", "hall")
    first, second = reloaded(path, renamed, renamed + ZONE)
    assert first.site.name == second.site.name == "yard"
    assert list(second.site.zones) == ["strip"]
    assert [line for line in caplog.messages if "name can only change with a new start" in line]


def test_feeds_and_their_limits_count_at_once_and_a_wrong_one_changes_nothing(path: Path) -> None:
    first, second = reloaded(
        path, TEXT + FEED, f"{TEXT}{FEED}silent_s = -1\n", f"{TEXT}{FEED}silent_s = 5\n"
    )
    assert first.site.feeds["gate"].file == path.parent / "gate.jsonl"
    assert (first.site.feeds["gate"].silent_s, second.site.feeds["gate"].silent_s) == (30.0, 5.0)


def test_what_this_site_cannot_change_while_it_runs_waits_for_a_new_start(
    path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (applied,) = reloaded(path, TEXT + ZONE + FEED, tables=WHILE_RUNNING - {"feeds"})
    assert (list(applied.site.zones), applied.site.feeds) == (["strip"], {})
    assert "feeds can only change with a new start" in caplog.text


def test_a_wrong_file_changes_nothing(path: Path, caplog: pytest.LogCaptureFixture) -> None:
    assert reloaded(path, TEXT + "[zones.strip]\npolygon_m = 3\n") == []
    assert "the site goes on as it was" in caplog.text


def test_nothing_is_read_before_somebody_asks(path: Path) -> None:
    applied: list[SiteFile] = []
    reloading = Reloading(read_site(path), applied.append)
    path.write_text(TEXT + ZONE)
    reloading()
    assert applied == []
