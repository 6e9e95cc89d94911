"""Kinds of rules that other packages bring, by the entry points of the group `trecsim.rules`."""

import re
from collections.abc import Collection, Iterable
from importlib.metadata import EntryPoint, entry_points

from trecsim.safety.rule import Kind

GROUP = "trecsim.rules"
_NAME = re.compile(r"[a-z]+\.[a-z]+(_[a-z]+)*")


def own_kinds(taken: Collection[str]) -> tuple[tuple[Kind, ...], tuple[str, ...]]:
    """Return the kinds that are installed, and what is wrong with those that cannot be used.

    Parameters
    ----------
    taken
        Names that they must not have.

    Notes
    -----
    An entry point names a `Kind`, or several in a list or tuple.
    """
    return usable(sorted(entry_points(group=GROUP), key=lambda one: one.name), taken)


def usable(
    points: Iterable[EntryPoint], taken: Collection[str]
) -> tuple[tuple[Kind, ...], tuple[str, ...]]:
    """Return the kinds of entry points; see `own_kinds`."""
    kinds: dict[str, Kind] = {}
    faults = []
    for point in points:
        try:
            found = point.load()
        except Exception as error:  # the boundary: code of others must not take all rules with it
            faults.append(f"own rules {point.name} cannot be loaded: {_said(error)}")
            continue
        for kind in found if isinstance(found, list | tuple) else [found]:
            fault = _fault(kind, {*taken, *kinds})
            if fault is None:
                kinds[kind.name] = kind
            else:
                faults.append(f"own rules {point.name}: {fault}")
    return tuple(kinds.values()), tuple(faults)


def _fault(kind: object, taken: Collection[str]) -> str | None:
    if not isinstance(kind, Kind):
        return f"expected a trecsim.own_rules.Kind, found {type(kind).__name__}"
    if not _NAME.fullmatch(kind.name):
        return f'expected a name as "area.what", found {kind.name!r}'
    return f"there is another kind {kind.name!r}" if kind.name in taken else None


def _said(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"
