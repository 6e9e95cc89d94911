"""The pictures of the model: drawn by the code, shown on the page, and with settings as stated."""

import re
from importlib import import_module
from pathlib import Path

import pytest

import pictures
from pictured.runs import SEED
from pictured.sheet import rounded
from trecsim.fusion import FusionSettings

DOCS = Path(__file__).parents[2] / "docs"
MODEL = (DOCS / "model.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", pictures.NAMES)
def test_a_picture_is_drawn_and_its_numbers_are_some(name: str, tmp_path: Path) -> None:
    drawn = pictures.draw(name, tmp_path).read_text(encoding="utf-8")
    assert drawn.count("<path") > 100
    assert "nan" not in "".join(re.findall(r' d="[^"]*"', drawn))
    if name == "beginning":  # the same picture has the same bytes
        assert pictures.draw(name, tmp_path).read_text(encoding="utf-8") == drawn


def test_the_page_shows_every_picture_of_the_model_and_no_other() -> None:
    shown = re.findall(r"!\[[^\]]+\]\((pictures/[^)]+)\)", MODEL)
    assert sorted(shown) == sorted(f"pictures/model-{name}.svg" for name in pictures.NAMES)
    assert all((DOCS / path).is_file() for path in shown)


@pytest.mark.parametrize("name", pictures.NAMES)
def test_the_page_tells_how_to_make_the_scene_of_a_picture(name: str) -> None:
    drawn = import_module(f"pictured.{name}")
    command = f"trecsim simulate {drawn.SCENE} --seed {SEED} --seconds {drawn.SECONDS:g}`"
    assert command in re.sub(r"\s+(> )?", " ", MODEL)


def test_settings_that_the_page_states_are_the_defaults() -> None:
    stated = re.findall(r"`(\w+)` = (\d[\d.]*\d|\d)", MODEL)
    assert len(stated) >= 5
    usual = FusionSettings()
    assert [(name, float(value)) for name, value in stated] == [
        (name, getattr(usual, name)) for name, _ in stated
    ]


def test_points_are_rounded_and_scales_are_not() -> None:
    svg = '<path d="M 1.23456 2 L 3.5 -0.001"/><g transform="scale(0.015625)"/>'
    assert rounded(svg) == '<path d="M 1.23 2 L 3.5 0"/><g transform="scale(0.015625)"/>'
