"""The tables `[modes.NAME]` of a site file: which rules are off, and when."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from trecsim.safety.modes import Mode
from trecsim.safety.schedules import read_hours
from trecsim.toml_models import Table
from trecsim.toml_models.toml_reading import Fault, nearest


def _hours(text: str) -> str:
    read_hours(text)
    return text


_Rule = Annotated[str, Field(min_length=1, max_length=64)]


class ModeTable(Table):
    """A mode: rules that are off in it, and when it is in force."""

    off: Annotated[list[_Rule], Field(max_length=1000)] = Field(default_factory=list)
    """Rules that are off in this mode, by their `id`."""
    schedule: (
        Annotated[list[Annotated[str, AfterValidator(_hours)]], Field(min_length=1, max_length=100)]
        | None
    ) = None
    """When it is in force, in the local time of the site; only when people choose it, if not given.
    Where schedules overlap, the first mode counts."""


def mode_faults(modes: Mapping[str, ModeTable], rules: Sequence[Any]) -> Iterator[Fault]:
    """Yield what is wrong with modes together with the rules that they name."""
    known = {rule.id: None for rule in rules}
    for name, mode in modes.items():
        for rule in mode.off:
            if rule not in known:
                hint = nearest(rule, known) if known else "the site file has no [[rules]]"
                yield ("modes", name, "off"), f"there is no rule {rule!r}; {hint}"


def modes_of(tables: Mapping[str, ModeTable]) -> tuple[Mode, ...]:
    """Return modes as they are judged."""
    return tuple(
        Mode(
            name,
            None if one.schedule is None else tuple(map(read_hours, one.schedule)),
            frozenset(one.off),
        )
        for name, one in tables.items()
    )
