"""Studies defined on the command line: the tables of a study file from short options."""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from trecsim.errors import ConfigError
from trecsim.lab.study.settings_file_table import ChoiceTable
from trecsim.toml_models.toml_reading import nearest

_RANGE = re.compile(r"([^:,]+):([^:,]+)(?::(\d+))?(log)?")
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9_-]+")
_MOST_LETTERS = 10_000
_ROOM_KEYS = ChoiceTable.model_fields.keys() - {"scene", "folder"}
_OTHER_WORDS = {"person": "people", "persons": "people"}  # too far off to be found by letters


def settings_table(given: Iterable[str]) -> dict[str, Any]:
    """Return the table `settings` from options ``NAME=VALUES``.

    Parameters
    ----------
    given
        Values are listed, ``knot_s=0.1,0.15``, or a range with the number of steps,
        ``joint_sigma_m=0.01:0.04:5``, in equal factors if ``log`` follows.

    Raises
    ------
    ConfigError
        An option is invalid.

    Examples
    --------
    >>> settings_table(["knot_s=0.1,0.2", "min_joints=3:7:3", "joint_sigma_m=0.01:0.04:5log"])
    {'knot_s': [0.1, 0.2], 'min_joints': {'low': 3.0, 'high': 7.0, 'steps': 3},
     'joint_sigma_m': {'low': 0.01, 'high': 0.04, 'steps': 5, 'log': True}}
    """
    tables: dict[str, Any] = {}
    for text in given:
        name, equals, values = text[:_MOST_LETTERS].partition("=")
        name = name.strip()
        if not (name and equals and values.strip()):
            raise ConfigError(
                f"--set {text[:60]}: expected NAME=VALUES, as in knot_s=0.1,0.15 or "
                "joint_sigma_m=0.01:0.04:5log"
            )
        if name in tables:
            raise ConfigError(f"--set {name}: it is given twice; put all its values into one")
        tables[name] = _values(name, values.strip())
    return tables


def _values(name: str, text: str) -> Any:
    if ":" not in text:
        return [_value(part.strip()) for part in text.split(",")]
    match = _RANGE.fullmatch(text)
    ends = [_value(part.strip()) for part in match.groups()[:2]] if match else []
    if not match or any(isinstance(end, str | bool) for end in ends):
        raise ConfigError(
            f"--set {name}={text[:60]}: expected LOW:HIGH:STEPS with two numbers, as in "
            "0.01:0.04:5, or 0.01:0.04:5log for equal factors"
        )
    table: dict[str, Any] = {"low": float(ends[0]), "high": float(ends[1])}
    if match[3]:
        table["steps"] = int(match[3][:9])
    if match[4]:
        table["log"] = True
    return table


def _value(text: str) -> int | float | bool | str:
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def scenes_table(given: Sequence[str]) -> dict[str, Any]:
    """Return the table `scenes` from options.

    Parameters
    ----------
    given
        ``room``, or ``room:people=8,cameras=6``; the name of a built-in scene; a scene file; the
        folder of a synthetic scene. ``NAME=`` before it gives it another name.

    Raises
    ------
    ConfigError
        An option is invalid, or a name is given twice.

    Examples
    --------
    >>> scenes_table(["room:people=8", "small=room:people=1,seconds=5", "crossing"])
    {'room': {'people': 8}, 'small': {'people': 1, 'seconds': 5}, 'crossing': {'scene': 'crossing'}}
    """
    tables: dict[str, Any] = {}
    for text in given:
        label, what = _labelled(text)
        table = _scene(what)
        name = label or _NOT_IN_NAMES.sub("-", Path(what.partition(":")[0]).stem)[:64] or "scene"
        if name in tables:
            raise ConfigError(
                f"--scene {text[:80]}: there is already a scene {name!r}; name one: "
                f"--scene other={what[:80]}"
            )
        tables[name] = table
    return tables


def _labelled(text: str) -> tuple[str, str]:
    before, equals, after = text.partition("=")
    if equals and ":" not in before and "/" not in before and not Path(text).exists():
        return before, after
    return "", text


def _scene(what: str) -> dict[str, Any]:
    kind, colon, parameters = what.partition(":")
    if kind == "room":
        return _room(parameters) if colon else {"people": 4}
    if Path(what).is_dir():
        return {"folder": str(Path(what).absolute())}
    if what.endswith(".toml"):
        return {"scene": str(Path(what).absolute())}
    return {"scene": what}


def _room(parameters: str) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for part in parameters.split(","):
        name, equals, value = part.partition("=")
        if not equals:
            raise ConfigError(f"--scene room:{parameters[:60]}: expected NAME=NUMBER, as people=8")
        name = name.strip()
        if name not in _ROOM_KEYS:
            hint = nearest(_OTHER_WORDS.get(name, name), _ROOM_KEYS)
            raise ConfigError(f"--scene room: unknown key {name[:40]!r}; {hint}")
        table[name] = _value(value.strip())
    return table
