"""Style of pages and figures: colours for light and dark screens, fonts, sizes."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from typing import TYPE_CHECKING, Any, Literal

from trecsim.extras import needed
from trecsim.lab.plots.colours import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# The same hues as COLOURS, light enough for a dark page.
_ON_DARK = (
    "#4fa9e0", "#f28a45", "#2fc59b", "#e6a3c8", "#f3bd4a", "#9fd5f5", "#a99cf5", "#dd6f9e",
)  # fmt: skip
PALETTE = {
    "paper": ("#ffffff", "#12161c"),
    "card": ("#f6f8fa", "#1a2029"),
    "ink": ("#1b2430", "#e8ecf1"),
    "soft": ("#5a6675", "#a3afbd"),
    "line": ("#c3cbd4", "#414c59"),
    "faint": ("#e6eaee", "#29313b"),
    "accent": ("#0a6fb0", "#5cb3ea"),
    "warn": ("#b45309", "#f2b155"),
    "good": ("#0b8a66", "#3fcb9f"),
    **{f"c{n}": pair for n, pair in enumerate(zip(COLOURS, _ON_DARK, strict=True))},
}
"""Colours by name, light and dark; ``c0`` to ``c7`` distinguish people and cameras."""

INK, SOFT, LINE, FAINT, PAPER, ACCENT, WARN, GOOD = (
    PALETTE[name][0] for name in ("ink", "soft", "line", "faint", "paper", "accent", "warn", "good")
)
TIME_COLOURS = ("#3f6fd8", "#8f5bc7", "#c9508f", "#e2683c", "#e99a1f")
"""From early to late; neither too light for white paper nor too dark for a dark page."""

WIDE_IN = 9.4  # a figure as wide as the page
RASTER_DPI = 170

_SETTINGS: dict[str, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "trecsim",
    "text.parse_math": False,
    "text.color": INK,
    "font.size": 9.0,
    "axes.labelcolor": SOFT,
    "axes.edgecolor": LINE,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.titlecolor": INK,
    "axes.labelsize": 9.0,
    "axes.facecolor": "none",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "figure.facecolor": "none",
    "xtick.color": LINE,
    "ytick.color": LINE,
    "xtick.labelcolor": SOFT,
    "ytick.labelcolor": SOFT,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "grid.color": FAINT,
    "grid.linewidth": 0.8,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.2,
}


def colour_of(index: int) -> str:
    """Return a colour for the person, camera or curve with this number."""
    return COLOURS[index % len(COLOURS)]


def css_colour(index: int) -> str:
    """Return the colour of :func:`colour_of` as CSS that follows light and dark."""
    return f"var(--c{index % len(COLOURS)})"


def css_variables() -> str:
    """Return the palette as CSS: variables ``--ink`` and so on, which follow light and dark."""
    light = "".join(f"--{name}:{pair[0]};" for name, pair in PALETTE.items())
    both = "".join(f"--{name}:light-dark({a},{b});" for name, (a, b) in PALETTE.items())
    return f":root{{{light}}}\n@supports (color:light-dark(red,red)){{:root{{{both}}}}}"


def need_matplotlib() -> None:
    """Raise SetupError with the command that installs Matplotlib if it is missing."""
    needed("reports need Matplotlib", "report", "matplotlib")


@contextmanager
def figure(height_in: float) -> "Iterator[Figure]":
    """Offer an empty figure to draw into, in the look of the page.

    Raises
    ------
    SetupError
        Matplotlib is not installed.
    """
    need_matplotlib()
    import matplotlib
    from matplotlib.figure import Figure

    from trecsim.lab.plots.canvas import missing_glyphs_allowed

    with matplotlib.rc_context(_SETTINGS), missing_glyphs_allowed():
        yield Figure(figsize=(WIDE_IN, height_in), layout="constrained")


def quiet(axes: "Axes", *, grid: Literal["x", "y", "both"] = "y") -> None:
    """Leave of the axes what one needs to read values: a grid, a base line, no ticks."""
    axes.grid(axis=grid)
    axes.tick_params(length=0)
    axes.spines["left"].set_visible(False)


def draw_spreads(
    axes: "Axes",
    names: Sequence[str],
    spreads: Sequence[tuple[float, float, float]],
    colours: Sequence[str] = (),
) -> None:
    """Draw one row per name: a bar from the low to the high end with a dot at the median.

    `spreads` are low end, median and high end of each row, NaN for none; `colours` one per row, or
    none for the accent colour.
    """
    for row, (low, middle, high) in enumerate(spreads):
        colour = colours[row] if colours else ACCENT
        axes.plot([low, high], [row, row], color=colour, linewidth=4.5, alpha=0.3)
        axes.plot(middle, row, "o", color=colour, ms=6, mec=PAPER, mew=0.8)
    axes.set_yticks(range(len(names)), [name.replace("_", " ") for name in names])
    axes.set_ylim(max(len(names), 2) - 0.4, -0.6)
    axes.set_xlim(left=0)
    quiet(axes, grid="x")


def as_svg(drawn: "Figure", name: str) -> str:
    """Return a figure as SVG to embed in a page, with its colours as CSS variables.

    Call it inside :func:`figure`. A name of its own keeps the inner names of each figure apart.
    """
    buffer = BytesIO()
    drawn.savefig(buffer, format="svg", dpi=RASTER_DPI, transparent=True)
    text = buffer.getvalue().decode()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r' xmlns(:\w+)?="[^"]*"', "", text)
    text = re.sub(r'<svg [^>]*viewBox="([^"]*)"[^>]*>', r'<svg viewBox="\1" role="img">', text)
    text = re.sub(r' id="(?:[a-z0-9.]+_\d+)"', "", text)  # of groups, which nothing refers to
    text = re.sub(r' id="', f' id="{name}-', text)
    text = re.sub(r'href="#', f'href="#{name}-', text).replace("url(#", f"url(#{name}-")
    text = text.replace("xlink:href", "href")
    text = re.sub(r"font-family: [^;\"]*;? ?", "", text)
    text = re.sub(r"font: ([\d.]+px) [^;\"]*", r"font-size: \1", text)
    text = re.sub(r' (d|x|y|points)="[^"]*"', lambda found: _rounded(found[0]), text)
    return _with_variables(text).strip()


def _rounded(text: str) -> str:
    """Leave two decimals to every number: a hundredth of a point is less than one can see."""
    return re.sub(r"(\d\.\d\d)\d+", r"\1", text)


def _with_variables(text: str) -> str:
    names = {pair[0]: name for name, pair in PALETTE.items()}

    def named(match: "re.Match[str]") -> str:
        name = names.get(match[0].lower())
        return f"var(--{name})" if name else match[0]

    return re.sub(r"#[0-9a-fA-F]{6}\b", named, text)
