"""Figures whose colours follow the page."""

import re
import sys

import pytest

from trecsim.errors import SetupError
from trecsim.lab.plots.colours import COLOURS
from trecsim.lab.report.style import (
    ACCENT,
    INK,
    PALETTE,
    as_svg,
    colour_of,
    css_colour,
    figure,
    need_matplotlib,
    quiet,
)


def drawn(name: str = "one", text: str = "speed $v$ <b>") -> str:
    with figure(2.0) as drawing:
        axes = drawing.add_subplot()
        axes.plot([0, 1, 2.123456], [0.0, 1.0, 0.5], "o-", color=ACCENT, label="a")
        axes.set(xlabel=text, ylabel="y", title="over all")
        axes.legend()
        quiet(axes)
        return as_svg(drawing, name)


def test_every_colour_of_a_figure_is_one_of_the_page() -> None:
    svg = drawn()
    assert re.findall(r"#[0-9a-fA-F]{6}\b", svg) == []
    assert "black" not in svg
    assert "var(--ink)" in svg
    assert "var(--accent)" in svg


def test_text_stays_text_in_the_letters_of_the_page() -> None:
    svg = drawn()
    assert "speed $v$ &lt;b&gt;</text>" in svg
    assert "DejaVu" not in svg


def test_a_figure_names_nothing_outside_itself() -> None:
    svg = drawn()
    assert "://" not in svg
    names = set(re.findall(r' id="([^"]*)"', svg))
    assert names
    assert all(name.startswith("one-") for name in names)
    used = set(re.findall(r'href="#([^"]*)"', svg)) | set(re.findall(r"url\(#([^)]*)\)", svg))
    assert used <= names


def test_names_inside_two_figures_of_a_page_do_not_meet() -> None:
    one, two = (set(re.findall(r' id="([^"]*)"', drawn(name))) for name in ("one", "two"))
    assert one
    assert two
    assert not one & two


def test_no_number_is_finer_than_a_hundredth_of_a_point() -> None:
    paths = re.findall(r' d="([^"]*)"', drawn())
    assert any("." in path for path in paths)
    assert not any(re.search(r"\.\d{3}", path) for path in paths)


def test_light_colours_are_all_different_so_that_each_can_be_found_again() -> None:
    light = [pair[0] for pair in PALETTE.values()]
    assert len(set(light)) == len(light)
    assert INK in light


def test_colours_repeat_when_there_are_more_things_than_colours() -> None:
    assert colour_of(len(COLOURS) + 2) == colour_of(2) == PALETTE["c2"][0]
    assert css_colour(len(COLOURS) + 2) == "var(--c2)"


def test_without_matplotlib_the_message_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(SetupError, match=r"pip install .*\[report\]"):
        need_matplotlib()
