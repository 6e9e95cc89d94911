"""Pictures of figures."""

from collections.abc import Mapping, Sequence
from pathlib import Path

Points = Sequence[tuple[float, float]]


def log_log(path: Path, lines: Mapping[str, Points], recorded: Mapping[str, Points]) -> None:
    """Draw times over people on logarithmic axes.

    Parameters
    ----------
    path
        Of the picture, an SVG that is the same for the same figures.
    lines
        Measured here: people and time [ms].
    recorded
        The same of others; drawn dashed.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure
    from matplotlib.ticker import FuncFormatter, NullFormatter

    people = sorted({x for points in (*lines.values(), *recorded.values()) for x, _ in points})
    with mpl.rc_context({"svg.hashsalt": "trecsim", "font.size": 10}):
        figure = Figure(figsize=(7.2, 4.4), layout="constrained")
        axes = figure.add_subplot()
        for number, (name, points) in enumerate(lines.items()):
            colour = mpl.colormaps["viridis"](number / max(len(lines), 1))
            axes.plot(*zip(*points, strict=True), "o-", color=colour, label=name)
        for name, points in recorded.items():
            axes.plot(*zip(*points, strict=True), "s--", color="tab:red", label=name)
        axes.set(xscale="log", yscale="log", xlabel="people", ylabel="median per frame set [ms]")
        axes.set_xticks(people, [f"{x:g}" for x in people])
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
        axes.grid(which="both", color="0.9", linewidth=0.6)
        figure.legend(loc="outside upper left", ncols=3, frameon=False)
        figure.savefig(path, format="svg", metadata={"Date": None}, facecolor="white")
