"""What the pages of the documentation say is so."""

import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from trecsim.calibration import read_rig
from trecsim.lab.true_events.scene_sites import site_of
from trecsim.sites.site_reading import read_site

DOCS = Path(__file__).parents[2] / "docs"
THESIS = (DOCS / "thesis-to-code.md").read_text()
SECTIONS = """
    2.1.1 2.1.2 2.1.3 2.2 2.3 2.4 2.5 3.1.1 3.1.2 3.1.3 3.1.4 3.2 3.3 3.4 3.5.1 3.5.2 3.5.3 3.5.4
    3.5.5 3.6.1 3.6.2 3.6.3 3.6.4 3.6.5 3.6.6 3.6.7 3.7.1 3.7.2 3.7.3 3.7.4 4.1 4.2 4.2.1 4.3.1
    4.3.2 4.3.3 4.4.1 4.4.2
"""
ROOMS = (
    "calibration|estimators|fusion|geometry|lab|pipeline|sites|skeleton|sources|store|sync|toml_models|"
    "tracking|values"
)


def code_names() -> list[str]:
    return sorted(set(re.findall(rf"`((?:{ROOMS})(?:\.[A-Za-z_]+)*)`", THESIS)))


@pytest.mark.parametrize("section", SECTIONS.split())
def test_every_section_of_the_thesis_has_its_row(section: str) -> None:
    assert re.search(rf"^\| {re.escape(section)}[ ,|]", THESIS, re.MULTILINE)


def test_every_equation_of_the_thesis_has_its_place() -> None:
    cells = re.findall(r"^\|[^|]*\| ([0-9, -]+?)(?: \([^)]*\))? \|", THESIS, re.MULTILINE)
    found: set[int] = set()
    for cell in cells:
        for part in re.findall(r"\d+(?:-\d+)?", cell):
            first, _, last = part.partition("-")
            found.update(range(int(first), int(last or first) + 1))
    assert set(range(1, 59)) <= found


@pytest.mark.parametrize("name", code_names())
def test_every_place_in_the_code_that_is_named_exists(name: str) -> None:
    thing: object = import_module("trecsim")
    path = "trecsim"
    for part in name.split("."):
        path += f".{part}"
        try:
            thing = import_module(path)
        except ModuleNotFoundError:
            thing = getattr(thing, part)


def test_the_rig_of_the_conventions_can_be_read(tmp_path: Path) -> None:
    text = (DOCS / "conventions.md").read_text().partition("```toml\n")[2].partition("```")[0]
    (tmp_path / "rig.toml").write_text(text)
    rig = read_rig(tmp_path / "rig.toml")
    assert rig.names == ("north",)
    np.testing.assert_allclose(rig["north"].position_m, [0.0, -3.0, 1.5])


def test_the_site_of_the_how_to_has_live_cameras_and_a_page(tmp_path: Path) -> None:
    text = (DOCS / "how-to.md").read_text().partition("### Write the site file")[2]
    (tmp_path / "site.toml").write_text(text.partition("```toml\n")[2].partition("```")[0])
    site = read_site(tmp_path / "site.toml").site
    assert site.is_live
    assert site.page is not None


def test_the_site_without_cameras_gets_its_page_from_one_more_line(tmp_path: Path) -> None:
    text = (DOCS / "run-a-site.md").read_text().partition("## Without cameras")[2]
    (scene,) = re.findall(r"\$ trecsim simulate (\S+) .*--out hall ", text)
    (more,) = re.findall(r'\$ echo "(.*)" >> hall/site\.toml', text)
    (tmp_path / "site.toml").write_text(f"{site_of(scene)}{more}\n")
    site = read_site(tmp_path / "site.toml").site
    assert site.page is not None
    assert site.rules


@pytest.mark.parametrize("page", sorted(DOCS.glob("**/*.md")), ids=lambda page: page.name)
def test_links_between_pages_lead_somewhere(page: Path) -> None:
    if "_build" in page.parts or "generated" in page.parts:
        pytest.skip("made by a build")
    for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text()):
        assert (page.parent / target).exists(), target
