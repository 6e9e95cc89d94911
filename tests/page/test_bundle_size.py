"""The built page keeps to its budget, and what a phone loads to its own."""

import gzip
import re

import pytest

from trecsim.page.bundle import STATIC

MOST_KB, MOST_ON_A_PHONE_KB = 250, 60

pytestmark = pytest.mark.skipif(
    not (STATIC / "index.html").is_file(), reason="the page is not built; make page builds it"
)


def compressed_kb(names) -> float:
    return sum(len(gzip.compress((STATIC / name).read_bytes())) for name in names) / 1000


def loaded_at_once() -> set[str]:
    """Return what the first page loads: its own files, and those that they import at once."""
    text = (STATIC / "index.html").read_text()
    names = {name for name in re.findall(r'(?:src|href)="/([^"]+)"', text)}
    for name in [name for name in names if name.endswith(".js")]:
        script = (STATIC / name).read_text()
        names |= {f"assets/{one}" for one in re.findall(r'\bfrom"\./([^"]+)"', script)}
    return {*names, "index.html"}


def test_the_page_keeps_to_its_budget() -> None:
    every = [path.relative_to(STATIC) for path in STATIC.rglob("*") if path.is_file()]
    assert compressed_kb(every) <= MOST_KB


def test_a_phone_loads_no_three_dimensions_and_keeps_to_its_budget() -> None:
    names = loaded_at_once()
    assert len(names) >= 4
    assert not [name for name in names if "scene" in name]
    assert compressed_kb(names) <= MOST_ON_A_PHONE_KB


def test_the_page_needs_nothing_that_the_policy_refuses() -> None:
    text = (STATIC / "index.html").read_text()
    assert "style=" not in text
    assert re.findall(r"<script(?![^>]*\bsrc=)[^>]*>", text) == []
    for path in STATIC.rglob("*.js"):
        script = path.read_text()
        assert "data:text" not in script
        assert not re.search(
            r"https?://(?!(www\.w3\.org|github\.com|threejs\.org|jcgt\.org))", script
        )
