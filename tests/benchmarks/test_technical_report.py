"""The technical report and the slides: everything in them comes from the stored results."""

import re
from pathlib import Path

import numpy as np
import pytest

from figures import results
from harness.machine import ROOT
from tables import tables
from trecsim.films.film_writer import write_film
from trecsim.lab.simulation.scene_file import read_scene

pytest.importorskip("av", reason="the extra render is not installed")
pytest.importorskip("latex2mathml", reason="the extra docs is not installed")
pytest.importorskip("markdown_it", reason="the extra docs is not installed")

import av

from paper.filling import filled, value
from paper.page import report_page, slides_page
from technical_report import CHAPTER_S, CHAPTERS, join

TEXTS = ROOT / "docs" / "report"
NAMES = ("technical-report", "slides")


@pytest.fixture(scope="module")
def texts() -> dict[str, str]:
    found = results()
    made = tables(found)
    return {
        name: filled((TEXTS / f"{name}.md").read_text(encoding="utf-8"), found, made)
        for name in NAMES
    }


def test_every_place_is_filled(texts: dict[str, str]) -> None:
    for text in texts.values():
        assert not re.search(r"\[\[|<!-- (table|include)", text)


def test_a_number_that_is_stated_is_the_stored_one(texts: dict[str, str]) -> None:
    found = results()
    path = ("4 cameras, 4 people", "newest", "mean error")
    stored = found["accuracy"].figures
    for part in path:
        stored = stored[part]
    assert value("accuracy", " / ".join(path), ".3f", found) == f"{stored.value:.3f}"
    assert f"joints are {stored.value:.1f} cm from the ground truth" in texts["technical-report"]


@pytest.mark.parametrize("name", NAMES)
def test_no_measured_number_is_typed(name: str) -> None:
    text = (TEXTS / f"{name}.md").read_text(encoding="utf-8")
    text = re.sub(r"\[\[.*?\]\]|<!--.*?-->", "", text, flags=re.DOTALL)
    assert re.findall(r"\d+(?:\.\d+)? ?(?:cm|mm|ms|fps|images per second)\b", text) == []


def test_what_is_not_there_is_an_error() -> None:
    for text in ("[[accuracy | nothing / here | .1f]]", "<!-- include: model.md | Nothing -->"):
        with pytest.raises(KeyError, match=r"Nothing|nothing"):
            filled(text, results(), {})


def test_the_report_has_the_equations_and_pictures_of_the_model(texts: dict[str, str]) -> None:
    page = report_page(texts["technical-report"])
    model = (ROOT / "docs" / "model.md").read_text(encoding="utf-8")
    equations = len(re.findall(r"\$\$.+?\$\$", model, flags=re.DOTALL))
    assert page.count('class="equation"') == equations
    assert page.count("<figure>") == model.count("](pictures/") + 1
    assert "$$" not in page
    assert re.findall(r"\$[^$\s<][^$<]*\$", re.sub(r"<code>.*?</code>", "", page)) == []
    assert 'src="pictures' not in page
    assert re.search(r'href="(?!#|https?:)', page) is None


def test_there_are_fifteen_slides_that_print_a_page_each(texts: dict[str, str]) -> None:
    page = slides_page(texts["slides"])
    assert page.count('<section class="slide') == 15
    css = (Path(ROOT) / "benchmarks" / "paper" / "paper.css").read_text(encoding="utf-8")
    assert "size: 1280px 720px" in css


def test_the_chapters_of_the_film_are_joined_without_a_gap(tmp_path: Path) -> None:
    grey = [np.full((64, 96, 3), 20 * number, np.uint8) for number in range(10)]
    write_film(tmp_path / "a.mp4", grey, 25.0, (96, 64))
    write_film(tmp_path / "b.mp4", grey[::-1], 25.0, (96, 64))
    join([tmp_path / "a.mp4", tmp_path / "b.mp4"], tmp_path / "ab.mp4")
    with av.open(str(tmp_path / "ab.mp4")) as film:
        images = [(one.time, one.to_ndarray(format="gray").mean()) for one in film.decode(video=0)]
    np.testing.assert_allclose([t_s for t_s, _ in images], np.arange(20) / 25.0, atol=1e-3)
    wanted = [20 * min(number, 19 - number) for number in range(20)]
    np.testing.assert_allclose([level for _, level in images], wanted, atol=20)


def test_the_film_takes_about_a_minute() -> None:
    assert 55 < CHAPTER_S * len(CHAPTERS) < 75
    for scene, _ in CHAPTERS:
        assert read_scene(scene).seconds >= CHAPTER_S


def test_text_and_a_picture_stand_side_by_side_on_a_slide() -> None:
    page = slides_page(
        "# Title\n\n---\n\n## A\n\n- one\n\n![p](../pictures/page/live-wide-light.png)"
    )
    left, right = page.partition('<div class="sides"><div>')[2].split("</div><div>")
    assert "one" in left
    assert "data:image/png;base64," in right


def test_a_table_of_many_columns_and_long_texts_gets_a_page_of_its_own() -> None:
    row = "|" + " a |" * 8
    short = f"# T\n\n{row}\n{'|' + '---|' * 8}\n{row}\n"
    assert 'class="wide"' not in report_page(short)
    assert 'class="wide"' in report_page(f"{short}|{'long ' * 20}|{' a |' * 7}\n")
