"""One self-contained HTML page: no outside request, light and dark, good on paper."""

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Literal

from trecsim.extras import needed
from trecsim.lab.report.style import css_variables

Alignment = Literal["left", "right"]


@dataclass(frozen=True, slots=True)
class Text:
    """A paragraph.

    Attributes
    ----------
    text
        The text.
    kind
        ``"warning"``, ``"missing"`` (which input a part needs) or ``"good"`` (checks passed).
    """

    text: str
    kind: Literal["plain", "warning", "missing", "good"] = "plain"


@dataclass(frozen=True, slots=True)
class Fact:
    """One number with its unit, shown large; what it is, and what helps to judge it."""

    label: str
    value: str
    detail: str = ""


@dataclass(frozen=True, slots=True)
class Facts:
    """Some facts, side by side."""

    facts: Sequence[Fact]


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text under column names.

    Attributes
    ----------
    columns
        Their names.
    rows
        The texts of each row, one per column; numbers are formatted already.
    caption
        What one sees.
    align
        Of each column; by default the first is left aligned, the others right.
    groups
        Texts over several columns each, with how many; none if empty.
    swatches
        A colour per row, drawn before its first text, as `css_colour` returns it.
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""
    align: Sequence[Alignment] = ()
    groups: Sequence[tuple[str, int]] = ()
    swatches: Sequence[str] = ()

    def __post_init__(self) -> None:
        if any(len(row) != len(self.columns) for row in self.rows):
            raise ValueError(f"every row needs {len(self.columns)} texts")

    @property
    def classes(self) -> Sequence[str]:
        """Alignment of each column as the style sheet calls it."""
        return self.align or ("left", *["right"] * (len(self.columns) - 1))


@dataclass(frozen=True, slots=True)
class Figure:
    """A drawing with what one sees in it.

    The SVG goes into the page as it is, so it must never be a file of a user.
    """

    svg: str
    caption: str
    title: str = ""


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture of pixels, as JPEG, with what one sees in it.

    Attributes
    ----------
    jpeg
        The bytes of the file.
    caption
        What one sees.
    title
        A heading above it.
    """

    jpeg: bytes
    caption: str
    title: str = ""

    @property
    def address(self) -> str:
        """The picture itself as an address, so that the page stays one file."""
        return f"data:image/jpeg;base64,{b64encode(self.jpeg).decode()}"


@dataclass(frozen=True, slots=True)
class Pictures:
    """Some pictures, side by side."""

    pictures: Sequence[Picture]


Block = Text | Facts | Table | Figure | Pictures


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the page under a heading, with a sentence that leads in."""

    title: str
    blocks: Sequence[Block] = field(default_factory=tuple)
    lead: str = ""


def page(
    title: str, sections: Sequence[Section], *, subtitle: str = "", footer: str = "made by trecsim"
) -> str:
    """Return a whole HTML page.

    Raises
    ------
    SetupError
        Jinja is not installed.

    Examples
    --------
    >>> text = page("Trial <1>", [Section("Result", [Text("All went well.")])])
    >>> "<h1>Trial &lt;1&gt;</h1>" in text, "://" in text
    (True, False)
    """
    needed("reports need Jinja", "report", "jinja2")
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("trecsim.lab.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["kind_of"] = lambda block: type(block).__name__
    style = css_variables() + "\n" + files("trecsim.lab.report").joinpath("page.css").read_text()
    return environment.get_template("page.html").render(
        title=title,
        subtitle=subtitle,
        sections=sections,
        footer=footer,
        style=Markup(style),  # ours: nothing of the input is in it
        drawing=Markup,
    )
