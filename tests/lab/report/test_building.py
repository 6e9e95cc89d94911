"""Whole reports: every part is there, and what is missing is said."""

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from made_recording import make_recording, named
from made_rigs import ring
from trecsim.errors import InputError
from trecsim.lab.report.building import report
from trecsim.store.tracks import tracks_writer
from trecsim.store.truth import write_truth

EVIL = "<script>alert(1)</script>"
SECTIONS = (
    "Summary",
    "Against ground truth",
    "People",
    "Paths",
    "Limb lengths",
    "Cameras",
    "Uncertainty",
    "Compute time",
)
LENGTHS = """
format = "trecsim.limbs/1"
[subjects.one]
people = [7]
lengths_cm = { "shoulder line" = 36.5, "right thigh" = 41 }
"""


class Page(HTMLParser):
    """What a browser makes of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.outside: list[str] = []
        self.text: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name in ("src", "href", "srcset", "action", "data", "xlink:href"):
                value = value or ""
                if not value.startswith(("#", "data:image/png;base64,")):
                    self.outside.append(value)

    def handle_data(self, data: str) -> None:
        self.text.append(data)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("report")
    rig = named(ring(3), EVIL, "a $b$ & \"c\" 'd'", "雪 камера")
    make_recording(folder / "walk", rig=rig)
    (folder / "lengths.toml").write_text(LENGTHS)
    summary = report(
        folder / "walk", folder / "r.html", lengths=folder / "lengths.toml", left_out=True
    )
    assert summary.sections == SECTIONS
    assert (summary.moments, summary.identities) == (56, 1)
    assert len(summary.warnings) == 1
    assert summary.warnings[0].startswith(
        "7 % of the person-frames of the ground truth were missed"
    )
    text = (folder / "r.html").read_text()
    assert summary.bytes == len(text.encode())
    return text


def test_the_page_has_every_part_with_its_figures(made: str) -> None:
    page = Page(made)
    assert page.tags.count("section") == len(SECTIONS)
    assert page.tags.count("svg") >= 10
    assert "missing" not in re.findall(r'<p class="(\w+)"', made)
    for title in (
        "Skeletons",
        "Fit time",
        "Paths and time spent",
        "Reprojection error",
        "Judged by a left-out camera",
    ):
        assert title in page.text


def test_the_page_asks_nobody_for_anything(made: str) -> None:
    page = Page(made)
    assert page.outside == []
    assert "://" not in re.sub(r"base64,[^\"]*", "", made)
    assert not {"script", "link", "iframe", "object", "img"} & set(page.tags)


def test_names_of_cameras_are_text_and_nothing_else(made: str) -> None:
    page = Page(made)
    assert sum(EVIL in text for text in page.text) >= 4  # plans, table, errors
    assert any("a $b$ & \"c\" 'd'" in text for text in page.text)
    assert any("雪 камера" in text for text in page.text)


def test_figures_have_no_colour_that_a_dark_page_would_hide(made: str) -> None:
    body = made.partition("</head>")[2]
    colours = set(re.findall(r"#[0-9a-fA-F]{6}\b", body))
    levels = [[int(c[i : i + 2], 16) / 255 for i in (1, 3, 5)] for c in colours]
    light = [0.299 * red + 0.587 * green + 0.114 * blue for red, green, blue in levels]
    assert all(0.35 < one < 0.75 for one in light), colours  # those of time stand on both
    assert "var(--ink)" in body


def test_lengths_are_compared_with_the_tape(made: str) -> None:
    page = Page(made)
    assert "measured" in page.text
    assert "36.5" in page.text


@pytest.mark.usefixtures("blank_figures")
def test_left_out_cameras_judge_the_uncertainty_where_there_is_no_truth(tmp_path: Path) -> None:
    walk = make_recording(tmp_path / "walk", 12)
    title = "Judged by a left-out camera"
    for left_out, there in ((None, False), (True, True)):
        report(walk, tmp_path / "r.html", left_out=left_out)
        assert (title in (tmp_path / "r.html").read_text()) is there
    (walk / "truth.npz").unlink()
    for left_out, there in ((None, True), (False, False)):
        report(walk, tmp_path / "r.html", left_out=left_out)
        assert (title in (tmp_path / "r.html").read_text()) is there
    assert "with --left-out" in (tmp_path / "r.html").read_text()


def test_leaving_cameras_out_needs_rig_and_poses(tmp_path: Path) -> None:
    walk = make_recording(tmp_path / "walk", 12)
    (walk / "poses.jsonl").unlink()
    with pytest.raises(InputError, match="leaving cameras out needs the rig and the 2D poses"):
        report(walk, tmp_path / "r.html", left_out=True)


@pytest.mark.usefixtures("blank_figures")
def test_what_is_missing_is_said_and_leaves_no_empty_figure(made: str, tmp_path: Path) -> None:
    walk = make_recording(tmp_path / "walk", 20)
    summary = report(walk / "tracks.csv", tmp_path / "r.html")
    text = (tmp_path / "r.html").read_text()
    assert summary.sections == tuple(name for name in SECTIONS if name != "Against ground truth")
    said = " ".join(re.findall(r'<p class="missing">(.*?)</p>', text))
    for needed in ("timing.csv", "--rig", "--lengths"):
        assert needed in said
    assert text.count("<svg") < made.count("<svg")


def test_a_recording_of_nobody_is_told_as_such(tmp_path: Path) -> None:
    walk = make_recording(tmp_path / "walk", 20)
    with tracks_writer(walk / "tracks.csv"):
        pass
    summary = report(walk, tmp_path / "r.html")
    assert summary.warnings == ("Nobody was tracked in this recording.",)
    text = (tmp_path / "r.html").read_text()
    assert "Nobody was tracked: there are no paths." in text
    assert "100.0 %" in text  # missed


def test_a_single_moment_is_enough(tmp_path: Path) -> None:
    walk = make_recording(tmp_path / "walk", 5)
    (walk / "truth.npz").unlink()
    assert report(walk, tmp_path / "r.html").moments == 1


def test_joints_that_nobody_knows_do_no_harm(tmp_path: Path) -> None:
    walk = make_recording(tmp_path / "walk", 12)
    rows = (walk / "tracks.csv").read_text().splitlines()
    blank = [
        re.sub(r"^([^,]*,7,(?:nose|left_\w+)),.*", r"\1,nan,nan,nan,nan,0", row) for row in rows
    ]
    (walk / "tracks.csv").write_text("\n".join(blank) + "\n")
    assert report(walk, tmp_path / "r.html").moments == 8


def test_a_truth_of_another_time_is_refused_and_no_page_written(tmp_path: Path) -> None:
    walk = make_recording(tmp_path / "walk", 20)
    write_truth(walk / "truth.npz", np.arange(5) + 900.0, np.zeros((1, 5, 17, 3)))
    with pytest.raises(InputError, match="no time in common"):
        report(walk, tmp_path / "r.html")
    assert not (tmp_path / "r.html").exists()
