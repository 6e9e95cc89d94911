"""Texts in Markdown as pages of HTML that need nothing else and print well."""

import base64
import html
import re
from pathlib import Path

from latex2mathml.converter import convert
from markdown_it import MarkdownIt

from harness.machine import ROOT

_STYLE = Path(__file__).with_name("paper.css").read_text(encoding="utf-8")
_DISPLAY = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
_INLINE = re.compile(r"(?<![\\$`\w])\$(?!\s)([^$\n]+?(?:\n[^$\n]+?)?)\$(?![\w`])")
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_MANY, _LONG = 8, 60  # columns, and letters of a cell
_KINDS = {".svg": "image/svg+xml", ".png": "image/png", ".jpg": "image/jpeg"}


def report_page(text: str) -> str:
    """Return a report: title, contents, numbered figures and equations."""
    title, body = _title_of(text)
    content = _Body().html(body)
    headings = re.findall(r"<h([23]) id=\"([^\"]+)\">(.*?)</h", content)
    entries = [
        f'<li class="level{level}"><a href="#{at}">{name}</a></li>' for level, at, name in headings
    ]
    contents = f"<nav><h2>Contents</h2><ul>{''.join(entries)}</ul></nav>"
    first, mark, rest = content.partition("<h2")
    return _page(title, "report", f"<h1>{title}</h1>{first}{contents}{mark}{rest}")


def slides_page(text: str) -> str:
    """Return slides, one page each; a line ``---`` is between two of them."""
    title, body = _title_of(text)
    parts = re.split(r"^---$", f"# {title}\n{body}", flags=re.MULTILINE)
    slides = []
    for number, part in enumerate(parts, 1):
        foot = f"<footer><span>{title}</span><span>{number}</span></footer>"
        content, kind = _arranged(_Body(captions=False).html(part))
        kind = "slide title" if number == 1 else kind
        slides.append(f'<section class="{kind}">{content}{foot}</section>')
    return _page(title, "slides", "".join(slides))


def _arranged(content: str) -> tuple[str, str]:
    """Return a slide's content and class; with text and a picture, these stand side by side."""
    pictures = "".join(re.findall(r"<figure>.*?</figure>", content, re.DOTALL))
    text = re.sub(r"<figure>.*?</figure>", "", content, flags=re.DOTALL)
    heading, mark, rest = text.partition("</h2>")
    if not pictures or not rest.strip():
        return content, "slide"
    sides = f'<div class="sides"><div>{rest}</div><div>{pictures}</div></div>'
    return f"{heading}{mark}{sides}", "slide"


def _title_of(text: str) -> tuple[str, str]:
    first, _, rest = text.strip().partition("\n")
    return first.removeprefix("# ").strip(), rest


def _page(title: str, kind: str, body: str) -> str:
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}'
        f'</title><meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<style>{_STYLE}</style></head><body class="{kind}"><main>{body}</main></body></html>\n'
    )


class _Body:
    """Turns the body of a text into HTML; counts figures and equations."""

    def __init__(self, *, captions: bool = True) -> None:
        self._captions = captions
        self._equations = self._figures = 0
        self._maths: list[str] = []

    def html(self, text: str) -> str:
        """Return the HTML of a text."""
        text = _DISPLAY.sub(self._display, _COMMENT.sub("", text))
        text = _INLINE.sub(self._inline, text)
        made = MarkdownIt("commonmark", {"html": True}).enable("table").render(text)
        made = re.sub(r"@@(\d+)@@", lambda found: self._maths[int(found[1])], made)
        made = re.sub(
            r"<p>\s*<img src=\"([^\"]+)\" alt=\"([^\"]*)\"[^>]*>\s*</p>", self._figure, made
        )
        made = re.sub(r"<table>.*?</table>", _sized_table, made, flags=re.DOTALL)
        made = re.sub(r"<a href=\"(?!https?:)[^\"]*\">(.*?)</a>", r"\1", made, flags=re.DOTALL)
        return re.sub(r"<h([2-6])>(.*?)</h\1>", _with_id, made, flags=re.DOTALL)

    def _display(self, found: re.Match[str]) -> str:
        self._equations += 1
        number = f'<span class="number">({self._equations})</span>' if self._captions else ""
        made = convert(found[1].strip(), display="block")
        self._maths.append(f'<div class="equation">{made}{number}</div>')
        return f"\n\n@@{len(self._maths) - 1}@@\n\n"

    def _inline(self, found: re.Match[str]) -> str:
        self._maths.append(convert(found[1]))
        return f"@@{len(self._maths) - 1}@@"

    def _figure(self, found: re.Match[str]) -> str:
        self._figures += 1
        picture = _picture(found[1])
        caption = ""
        if self._captions:
            caption = f"<figcaption>Figure {self._figures}. {found[2]}</figcaption>"
        return f"<figure>{picture}{caption}</figure>"


def _sized_table(found: re.Match[str]) -> str:
    """Mark a table that needs the width of a page of its own: many columns, and long texts."""
    head, cells = found[0].count("<th"), re.findall(r"<td[^>]*>(.*?)</td>", found[0], re.DOTALL)
    wide = head >= _MANY and max((len(cell) for cell in cells), default=0) > _LONG
    return found[0].replace("<table>", '<table class="wide">', 1) if wide else found[0]


def _picture(name: str) -> str:
    """Return a picture of the docs as a part of the page."""
    file = ROOT / "docs" / "pictures" / name.partition("pictures/")[2]
    kind = _KINDS[file.suffix]
    code = base64.b64encode(file.read_bytes()).decode()
    return f'<img src="data:{kind};base64,{code}" alt="">'


def _with_id(found: re.Match[str]) -> str:
    text = re.sub(r"<[^>]+>", "", found[2])
    name = re.sub(r"\W+", "-", text.lower()).strip("-")
    return f'<h{found[1]} id="{name}">{found[2]}</h{found[1]}>'
