"""The technical report and the slides: everything in them comes from the stored results."""

import re
from pathlib import Path

import pytest

from figures import results
from harness.machine import ROOT
from tables import tables

pytest.importorskip("latex2mathml", reason="the extra docs is not installed")
pytest.importorskip("markdown_it", reason="the extra docs is not installed")

from paper.filling import filled, value
from paper.page import report_page, slides_page

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
    assert 'src="pictures' not in page
    assert re.search(r'href="(?!#|https?:)', page) is None


def test_there_are_fifteen_slides_that_print_a_page_each(texts: dict[str, str]) -> None:
    page = slides_page(texts["slides"])
    assert page.count('<section class="slide') == 15
    css = (Path(ROOT) / "benchmarks" / "paper" / "paper.css").read_text(encoding="utf-8")
    assert "size: 1280px 720px" in css
