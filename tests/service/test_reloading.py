"""A site file is read again while the site runs: what counts at once, and what does not."""

from pathlib import Path

import pytest

from trecsim.service.reloading import Reloading
from trecsim.sites import read_site
from trecsim.sites.site_reading import SiteFile

TEXT = 'format = "trecsim.site/1"\nname = "yard"\nrig = "rig.toml"\nposes = "a.poses.jsonl"\n'
ZONE = "[zones.strip]\npolygon_m = [[0, 0], [1, 0], [1, 1]]\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "site.toml").write_text(TEXT)
    return tmp_path / "site.toml"


def reloaded(path: Path, *texts: str) -> list[SiteFile]:
    """Return what is applied while the file gets one text after the other."""
    applied: list[SiteFile] = []
    reloading = Reloading(read_site(path), applied.append)
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


def test_a_wrong_file_changes_nothing(path: Path, caplog: pytest.LogCaptureFixture) -> None:
    assert reloaded(path, TEXT + "[zones.strip]\npolygon_m = 3\n") == []
    assert "the site goes on as it was" in caplog.text


def test_nothing_is_read_before_somebody_asks(path: Path) -> None:
    applied: list[SiteFile] = []
    reloading = Reloading(read_site(path), applied.append)
    path.write_text(TEXT + ZONE)
    reloading()
    assert applied == []
