"""Pages: nothing from outside, nothing of the input as markup, light and dark."""

import re
import sys
from html.parser import HTMLParser

import pytest

from trecsim.errors import SetupError
from trecsim.lab.report.page import Fact, Facts, Figure, Section, Table, Text, page

EVIL = "<script>alert('x')</script>&\"'"


class Parsed(HTMLParser):
    """Collects the tags, attributes and text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.links: list[str] = []
        self.seen: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "action")]
        assert not any(name.startswith("on") for name, _ in attrs)

    def handle_data(self, data: str) -> None:
        self.seen.append(data)


def full_page() -> str:
    blocks = [
        Text(EVIL),
        Text(EVIL, "warning"),
        Facts([Fact(EVIL, EVIL, EVIL)]),
        Table([EVIL, "b"], [[EVIL, "2"]], EVIL, groups=[(EVIL, 2)], swatches=["var(--c0)"]),
        Figure("<svg></svg>", EVIL, EVIL),
    ]
    return page(EVIL, [Section(EVIL, blocks, EVIL)] * 3, subtitle=EVIL, footer=EVIL)


def test_texts_are_never_markup() -> None:
    parsed = Parsed(full_page())
    assert "script" not in parsed.tags
    assert sum(EVIL in text for text in parsed.seen) > 20


def test_nothing_is_fetched_from_elsewhere() -> None:
    text = full_page()
    assert [link for link in Parsed(text).links if not link.startswith("#section-")] == []
    assert "://" not in text
    assert not re.search(r"@import|url\(", text)


def test_the_page_forbids_everything_but_its_own_styles_and_pictures() -> None:
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', full_page())
    assert policy is not None
    assert policy[1].split("; ")[:3] == [
        "default-src 'none'",
        "style-src 'unsafe-inline'",
        "img-src data:",
    ]


def test_figures_go_into_the_page_as_they_are() -> None:
    assert "<svg></svg>" in full_page()


def test_warnings_can_be_told_from_other_paragraphs() -> None:
    text = page("t", [Section("s", [Text("one"), Text("two", "warning")])])
    assert '<p class="plain">one</p>' in text
    assert '<p class="warning"><b>Warning</b> two</p>' in text


def test_numbers_stand_right_unless_told_otherwise() -> None:
    table = Table(["who", "how many"], [["a", "1"]])
    assert list(table.classes) == ["left", "right"]
    assert list(Table(["a", "b"], [], align=["right", "left"]).classes) == ["right", "left"]


def test_rows_of_another_length_than_the_head_are_refused() -> None:
    with pytest.raises(ValueError, match="needs 2 texts"):
        Table(["a", "b"], [["1"]])


def test_colours_can_be_chosen_and_follow_the_system_otherwise() -> None:
    text = page("t", [])
    assert text.count('type="radio"') == 3
    assert "light-dark(#ffffff,#12161c)" in text
    assert ":root:has(#theme-dark:checked) { color-scheme: dark; }" in text


def test_without_jinja_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "jinja2", None)
    with pytest.raises(SetupError, match=r"pip install .*\[report\]"):
        page("t", [])
