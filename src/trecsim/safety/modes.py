"""Modes of a site: which rules are off by day, by night, or while somebody works on the machine.

A mode can have a schedule. Somebody can put another mode in its place for a while, and switch off
single rules for a while; both end by themselves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from trecsim.safety.schedules import LocalTime, Schedule, armed

LONGEST_S = 8.0 * 3600.0
"""What people put in place of a mode, or switch off, ends after so long: within a shift [s]."""


class Mode(NamedTuple):
    """One mode.

    Attributes
    ----------
    name
        What it is called.
    schedule
        When it is in force; None where only people put it in force.
    off
        Rules that are off in it.
    """

    name: str
    schedule: Schedule
    off: frozenset[str]


class Bypass(NamedTuple):
    """That a rule is off for a while.

    Attributes
    ----------
    since_s, until_s
        From when to when, Unix times [s].
    by, note
        Who did it, and why.
    """

    since_s: float
    until_s: float
    by: str
    note: str = ""


class Chosen(NamedTuple):
    """That somebody has put a mode in force.

    Attributes
    ----------
    mode
        Which; None for all rules.
    since_s, until_s
        From when to when, Unix times [s].
    by
        Who did it.
    """

    mode: str | None
    since_s: float
    until_s: float
    by: str


@dataclass(frozen=True, slots=True)
class Overrides:
    """What people have put in place of the modes of the site file.

    Attributes
    ----------
    chosen
        The mode that somebody has put in force.
    bypassed
        Rules that are off, by their `id`.
    """

    chosen: Chosen | None = None
    bypassed: Mapping[str, Bypass] = field(default_factory=dict)

    @staticmethod
    def of(body: Mapping[str, Any] | None) -> "Overrides":
        """Return what was kept; nothing where it is damaged."""
        try:
            given = body or {}
            chosen = Chosen(**given["chosen"]) if given.get("chosen") else None
            bypassed = {rule: Bypass(**one) for rule, one in given.get("bypassed", {}).items()}
        except (TypeError, AttributeError):
            return Overrides()
        return Overrides(chosen, bypassed)

    def to_json(self) -> dict[str, Any]:
        """Return what is kept."""
        return {
            "chosen": None if self.chosen is None else self.chosen._asdict(),
            "bypassed": {rule: one._asdict() for rule, one in sorted(self.bypassed.items())},
        }

    def at(self, t_s: float) -> "Overrides":
        """Return what of it has not ended at a time [s].

        Examples
        --------
        >>> one = Overrides(Chosen("night", 0.0, 10.0, "kim"))
        >>> one.at(9.0).chosen is None, one.at(10.0).chosen is None
        (False, True)
        """
        return Overrides(
            self.chosen if self.chosen is not None and t_s < self.chosen.until_s else None,
            {rule: one for rule, one in self.bypassed.items() if t_s < one.until_s},
        )

    def choose(
        self, mode: str | None, until_s: float | None, by: str, now_s: float, *, ends: bool = False
    ) -> "Overrides":
        """Return it with another mode in force, for a while; `ends` goes back to the schedules."""
        if ends:
            return replace(self, chosen=None)
        return replace(self, chosen=Chosen(mode, now_s, _until_s(until_s, now_s), by))

    def bypass(
        self, rule: str, until_s: float | None, by: str, note: str, now_s: float
    ) -> "Overrides":
        """Return it with a rule off until a time, `LONGEST_S` at most; None arms the rule again."""
        bypassed = {one: bypass for one, bypass in self.bypassed.items() if one != rule}
        if until_s is not None:
            bypassed[rule] = Bypass(now_s, _until_s(until_s, now_s), by, note)
        return replace(self, bypassed=bypassed)


def _until_s(until_s: float | None, now_s: float) -> float:
    return min(now_s + LONGEST_S, until_s if until_s is not None else now_s + LONGEST_S)


def scheduled(modes: Sequence[Mode], now: LocalTime | None) -> Mode | None:
    """Return the first mode whose schedule holds; None where the local time is not known."""
    if now is None:
        return None
    return next((m for m in modes if m.schedule is not None and armed(m.schedule, now)), None)


def in_force(modes: Sequence[Mode], overrides: Overrides, now: LocalTime | None) -> Mode | None:
    """Return the mode that is in force; None where all rules are on.

    Parameters
    ----------
    modes
        Of the site.
    overrides
        What people have put in place, without what has ended.
    now
        The local time.
    """
    if overrides.chosen is None:
        return scheduled(modes, now)
    return next((mode for mode in modes if mode.name == overrides.chosen.mode), None)


def rules_off(modes: Sequence[Mode], overrides: Overrides, now: LocalTime | None) -> frozenset[str]:
    """Return the rules that are off, by mode or by hand; see `in_force`."""
    mode = in_force(modes, overrides, now)
    return frozenset(overrides.bypassed) | (mode.off if mode is not None else frozenset())
