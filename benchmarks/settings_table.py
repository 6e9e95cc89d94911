"""The table of all settings of the fusion, from `FusionSettings` itself."""

import re

from harness.markdown import NOTHING, table

_UNIT = re.compile(r" ?\[([^\]]+)\]")
_THESIS = re.compile(r" ?\(in the thesis(?:: |, )([^()]*)\)")


def settings() -> str:
    """Return every setting: meaning, unit, default, sensible range, counterpart, when to touch."""
    from dataclasses import fields

    from trecsim.fusion import FusionSettings
    from trecsim.toml_models.described import descriptions

    about = descriptions(FusionSettings)
    rows, above = [], {"": ""}
    for field in fields(FusionSettings):
        meaning, unit, thesis = taken_apart(about[field.name])
        if meaning in above:
            meaning = f"as `{above[meaning]}`"
        above.setdefault(meaning, field.name)
        low, high = field.metadata["sensible"]
        rows.append(
            [f"`{field.name}`", meaning, unit, f"{field.default:g}", f"{low:g} to {high:g}",
             thesis, field.metadata["touch"]]
        )  # fmt: skip
    head = ["setting", "meaning", "unit", "default", "sensible", "in the thesis",
            "when to touch it"]  # fmt: skip
    return table(head, rows)


def taken_apart(description: str) -> tuple[str, str, str]:
    """Return meaning, unit, and counterpart in the thesis, as the docstring has them.

    Examples
    --------
    >>> taken_apart("Distance of knots [s] (in the thesis: the knot delta).")
    ('Distance of knots', 's', 'the knot delta')
    >>> taken_apart("Degrees of freedom (Student's t).")
    ("Degrees of freedom (Student's t)", '', '–')
    """
    unit, thesis = _UNIT.search(description), _THESIS.search(description)
    meaning = _UNIT.sub("", _THESIS.sub("", description)).rstrip(".")
    return meaning, unit[1] if unit else "", thesis[1] if thesis else NOTHING
