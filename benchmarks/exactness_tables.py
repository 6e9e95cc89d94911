"""Tables of how exact tracks are."""

import math
from collections.abc import Mapping
from functools import partial

from harness.figures import Figure, Result, find
from harness.markdown import NOTHING, busy, fixed, number, table, value_of, with_spread
from recorded import AUTHORS_SCENES, FEWER_ON_SHELF, ON_SHELF, OnShelf

Results = Mapping[str, Result]

THESIS_SCENES = {
    "walk_J1_C2": "one person",
    "walk_J2_C2": "two people",
    "walk_J3_C2": "three people",
    "made_J4_C2": "four people",
    "made_J5_C2": "five people",
    "made_J6_C2": "six people",
    "walk_J3_occl_C2": "three people, hiding each other",
    "hard_J3_C2": "three people; misses, outliers, false people",
    "cross_lateral_50cm_C2": "two people crossing at 0.5 m",
    "cross_X_occl_C2": "two people crossing, hiding each other",
    "close_entry_J1_C2": "a person enters 1.5 m from a camera",
    "walk_J3_C4": "three people, four cameras",
}


def accuracy(results: Results, *, short: bool) -> str:
    """Return the table of simulated rooms."""
    result = results["accuracy"]
    head = ["room", "mean joint error [cm]", "with 0.2 s lag [cm]", "joints within 15 cm",
            "identity switches", "missed", "false positives"]  # fmt: skip
    head += [] if short else ["IDF1", "HOTA", "limb length sd [cm]", "truth in 90 % regions"]
    rows = []
    for room in result.figures:
        at = partial(value_of, result.figures, room, "newest")
        errors = [
            find(result.figures, (room, lag, "mean error")) for lag in ("newest", "lag 0.2 s")
        ]
        rows.append(
            [room, *(_error(error, short=short) for error in errors),
             fixed(at("joints within 15 cm"), 3), fixed(at("switches"), 0),
             f"{fixed(at('missed'), 2)} %", f"{fixed(at('ghosts'), 2)} %"]
        )  # fmt: skip
        if not short:
            rows[-1] += [fixed(at("IDF1"), 2), fixed(at("HOTA"), 1), fixed(at("limb length sd"), 2),
                         f"{fixed(at('truth in 90 % regions'), 0)} %"]  # fmt: skip
    return table(head, rows)


def _error(figure: Figure | None, *, short: bool) -> str:
    if short:
        return fixed(figure.value, 1) if figure else NOTHING
    return with_spread(figure)


def thesis(results: Results, *, short: bool) -> str:
    """Return the table of the scenes after the thesis' own."""
    result = results["thesis"]
    head = ["scene, two cameras", "mean joint error [cm]", "with 0.2 s lag [cm]",
            "joints within 15 cm", "author's program (recorded)", "switches"]  # fmt: skip
    rows = []
    for scene, text in THESIS_SCENES.items():
        if scene not in result.figures or (short and scene not in AUTHORS_SCENES):
            continue
        at = partial(value_of, result.figures, scene)
        authors = AUTHORS_SCENES.get(scene)
        rows.append(
            [text, fixed(at("newest", "mean error"), 1), fixed(at("lag 0.2 s", "mean error"), 1),
             fixed(at("newest", "joints within 15 cm"), 3),
             fixed(authors.recall, 2) if authors else NOTHING,
             fixed(at("newest", "switches"), 0)]
        )  # fmt: skip
    return table(head, rows)


def scenes(results: Results) -> str:
    """Return the table of the built-in scenes."""
    made = results["scenes"].figures["scenes"]
    assert isinstance(made, Mapping)
    rows = []
    for scene in made:
        at = partial(value_of, made, scene, "newest")
        rows.append(
            [f"`{scene}`", with_spread(find(made, (scene, "newest", "mean error")), 1),
             fixed(value_of(made, scene, "lag 0.2 s", "mean error"), 1),
             fixed(at("joints within 15 cm"), 3), fixed(at("IDF1"), 1), fixed(at("HOTA"), 1),
             fixed(at("switches"), 0), f"{fixed(at('missed'), 1)} %",
             f"{fixed(at('ghosts'), 1)} %"]
        )  # fmt: skip
    head = ["scene", "mean joint error [cm]", "with 0.2 s lag [cm]", "joints within 15 cm", "IDF1",
            "HOTA", "switches", "missed", "false positives"]  # fmt: skip
    return table(head, rows)


def postures(results: Results) -> str:
    """Return the errors of people who do not walk relative to those who do."""
    made = results["scenes"].figures["postures"]
    assert isinstance(made, Mapping)
    rows = [
        [posture, with_spread(find(made, (posture, "error / walking"))),
         fixed(value_of(made, posture, "switches"), 0)]
        for posture in made
    ]  # fmt: skip
    return table(["somebody who is", "joint error of that walking", "switches"], rows)


def detector(results: Results) -> str:
    """Return the simulated detector beside the real one."""
    made = results["detector_figures"].figures
    rows = []
    for name in made:
        at = partial(value_of, made, name)
        three = [f"{value:.3g}" if math.isfinite(value := at(column)) else ""
                 for column in ("recorded", "here", "annotated")]  # fmt: skip
        off_by = 100 * (at("annotated") / at("recorded") - 1)
        rows.append([name, *three, f"{off_by:+.0f} %", f"{at('real'):.3g}"])
    return table(["figure", "recorded", "here", "`annotated`", "off by", "`real`"], rows)


def shared(results: Results) -> str:
    """Return what all cameras share of the errors of key points, recorded and simulated."""
    made = results["shared_errors"].figures
    columns = ("recorded", "annotated", "clothed", "real")
    rows = []
    for name in made:
        values = (value_of(made, name, column) for column in columns)
        rows.append([name, *(fixed(v, 2) if math.isfinite(v) else "" for v in values)])
    return table(["figure", "recorded", *(f"`{column}`" for column in columns[1:])], rows)


def noise(results: Results) -> str:
    """Return errors of key points over the noise that the tracker states."""
    made = results["noise"].figures
    columns: dict[str, None] = {}
    for of_name in made.values():
        assert isinstance(of_name, Mapping)
        columns |= dict.fromkeys(of_name)
    rows = []
    for name in made:
        values = [value_of(made, name, column) for column in columns]
        rows.append([name, *(fixed(v, 2) if math.isfinite(v) else "" for v in values)])
    return table(["error / stated noise", *columns], rows)


def shelf(results: Results, *, short: bool) -> str:
    """Return ours on Shelf, five cameras, among recorded figures of others."""
    result = results["shelf"]
    rows = []
    for lag, text in (
        ("newest", "trecsim, no lag"),
        ("lag 0.2 s", "trecsim, 0.2 s lag (296 frames)"),
    ):
        at = partial(value_of, result.figures, "5 cameras", lag)
        actors = " / ".join(fixed(at(f"PCP of actor {n}"), 1) for n in (1, 2, 3))
        rows.append(
            [f"**{text}**", actors, fixed(at("average PCP"), 1), fixed(at("PCP of actor 4"), 1),
             f"{fixed(at('switches'), 0)} / {fixed(at('missed person-frames'), 0)}",
             number(at("fusion per frame set"))]
        )  # fmt: skip
    rows += [_other_on_shelf(o) for o in ON_SHELF if not short or o.switches is not None]
    head = ["", "actors 1 / 2 / 3", "average PCP", "actor 4",
            "switches / missed person-frames", "2D to 3D per frame set [ms]"]  # fmt: skip
    return table(head, rows) + busy(result)


def shelf_fewer(results: Results) -> str:
    """Return ours on Shelf with fewer cameras, over all choices of them."""
    result = results["shelf"]
    rows = []
    for cameras in (4, 3, 2):
        at = partial(value_of, result.figures, f"{cameras} cameras", "newest")
        rows.append(
            [str(cameras), fixed(at("average PCP"), 1), fixed(at("worst average PCP"), 1),
             fixed(at("switches"), 0), fixed(at("missed person-frames"), 0),
             FEWER_ON_SHELF.get(cameras, NOTHING)]
        )  # fmt: skip
    head = ["cameras", "average PCP, mean over all choices", "worst choice",
            "switches, all together", "missed person-frames",
            "4D Association, mean (recorded)"]  # fmt: skip
    return table(head, rows)


def _other_on_shelf(other: OnShelf) -> list[str]:
    told = "published, other detections" if other.published else "recorded"
    return [
        f"{other.name} ({told})",
        " / ".join(fixed(value, 1) for value in other.actors) if other.actors else NOTHING,
        fixed(other.average, 1),
        fixed(other.actor4, 1) if other.actor4 is not None else NOTHING,
        f"{other.switches} / {other.missed}" if other.switches is not None else NOTHING,
        other.ms or NOTHING,
    ]
