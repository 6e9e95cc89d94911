"""Tables of people who do other things than walk, come close to a camera, or have only one."""

from collections.abc import Mapping
from functools import partial

from harness.figures import Result, find
from harness.markdown import fixed, table, value_of, with_spread

Results = Mapping[str, Result]


def movement(results: Results) -> str:
    """Return the errors of every act with four and two cameras, and relative to walking."""
    made = results["movement"].figures
    head = ["somebody who is"]
    for cameras in ("4", "2"):
        head += [f"{cameras} cameras: mean / p95 error [cm]", "of that walking", "missed",
                 "lost"]  # fmt: skip
    head.append("acceleration of the hips [m/s²]")
    first = made["4 cameras"]
    assert isinstance(first, Mapping)
    rows = []
    for group, acts in first.items():
        assert isinstance(acts, Mapping)
        for act in acts:
            row = [act]
            for cameras in ("4 cameras", "2 cameras"):
                at = partial(value_of, made, cameras, group, act)
                relative = find(made, (cameras, group, act, "error / walking"))
                row += [f"{fixed(at('mean error'), 1)} / {fixed(at('p95 error'), 1)}",
                        with_spread(relative), f"{fixed(at('missed'), 1)} %",
                        fixed(at("lost"), 0)]  # fmt: skip
            row.append(fixed(at("acceleration of the hips"), 0))
            rows.append(row)
    return table(head, rows)


def several(results: Results) -> str:
    """Return the errors in the scenes composed of recorded motion."""
    made = results["movement"].figures["several people"]
    assert isinstance(made, Mapping)
    rows = []
    for scene in made:
        at = partial(value_of, made, scene)
        rows.append(
            [scene.replace("_", " "), with_spread(find(made, (scene, "mean error")), 1),
             fixed(at("p95 error"), 1), fixed(at("joints within 15 cm"), 3),
             f"{fixed(at('missed'), 1)} %", fixed(at("switches"), 0)]
        )  # fmt: skip
    return table(
        ["scene", "mean joint error [cm]", "p95 [cm]", "joints within 15 cm", "missed", "switches"],
        rows,
    )


def close_entry(results: Results) -> str:
    """Return the errors of people who appear close to one of two cameras."""
    made = results["close"].figures["close entry"]
    assert isinstance(made, Mapping)
    texts = {"rooms": "{}", "since entry": "{} after they appear", "joint": "joints {}"}
    rows = []
    for group, text in texts.items():
        parts = made[group]
        assert isinstance(parts, Mapping)
        for part in parts:
            at = partial(value_of, parts, part)
            rows.append(
                [text.format(part), with_spread(find(parts, (part, "mean error")), 1),
                 fixed(at("p95 error"), 1), fixed(at("joints within 15 cm"), 3),
                 f"{fixed(at('missed'), 1)} %" if group == "rooms" else "",
                 fixed(at("switches"), 0) if group == "rooms" else ""]
            )  # fmt: skip
    return table(
        ["people 1.5 m from one of two cameras", "mean joint error [cm]", "p95 [cm]",
         "joints within 15 cm", "missed", "switches"],
        rows,
    )  # fmt: skip


def one_camera(results: Results) -> str:
    """Return how far people are off in depth whom two cameras knew and one camera sees."""
    made = results["close"].figures["one camera"]
    assert isinstance(made, Mapping)
    rows = []
    for what in made:
        at = partial(value_of, made, what)
        name = "depth off after {} s, {}"
        off = [
            f"{fixed(at(name.format(after, 'p50')), 0)} / {fixed(at(name.format(after, 'p95')), 0)}"
            for after in (1, 2, 5)
        ]
        rows.append(
            [what, *off, fixed(at("joint error after 5 s"), 0), f"{fixed(at('lost'), 1)} %",
             fixed(at("switches"), 0)]
        )  # fmt: skip
    head = ["somebody who is", "off in depth after 1 s, p50 / p95 [cm]", "2 s", "5 s",
            "mean joint error after 5 s [cm]", "lost meanwhile", "switches"]  # fmt: skip
    return table(head, rows)


def one_view(results: Results) -> str:
    """Return where people are whom one camera sees for half a minute, and what is said of that."""
    made = results["one_view"].figures
    rows = []
    for what in made:
        at = partial(value_of, made, what)
        off = f"{fixed(at('off in depth, median'), 0)} / {fixed(at('off in depth, p95'), 0)}"
        rows.append(
            [what, off, fixed(at("stated sigma of the depth, median"), 0),
             f"{fixed(at('in 50 % regions'), 0)} %", f"{fixed(at('in 90 % regions'), 0)} %",
             fixed(at("log density"), 1), f"{fixed(at('lost'), 1)} %", fixed(at("switches"), 1)]
        )  # fmt: skip
    head = ["somebody", "off in depth, p50 / p95 [cm]", "stated sigma [cm]", "in 50 % regions",
            "in 90 % regions", "log density", "lost", "switches"]  # fmt: skip
    return table(head, rows)
