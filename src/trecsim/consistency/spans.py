"""When each camera delivered, and whether cameras have a time in common."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from trecsim.consistency.wording import cameras, listed, seconds


@dataclass(slots=True)
class Span:
    """What one camera has delivered.

    Attributes
    ----------
    first_s, last_s
        Earliest and latest time of its images [s].
    images, with_people
        How many images, and in how many of them somebody was found.
    """

    first_s: float = math.inf
    last_s: float = -math.inf
    images: int = 0
    with_people: int = 0

    def add(self, t_s: float, people: int) -> None:
        """Count one image."""
        self.first_s = min(self.first_s, t_s)
        self.last_s = max(self.last_s, t_s)
        self.images += 1
        self.with_people += people > 0

    def told(self) -> str:
        """Return from when to when it delivered, in words."""
        return f"{seconds(self.first_s)} to {seconds(self.last_s)} s"


def groups(spans: Mapping[str, Span]) -> list[list[str]]:
    """Return the cameras in groups that have no time in common, the largest group first.

    Examples
    --------
    >>> groups({"a": Span(0, 5, 9), "b": Span(4, 9, 9), "c": Span(50, 55, 9)})
    [['a', 'b'], ['c']]
    """
    found: list[list[str]] = []
    end_s = -math.inf
    for name in sorted(spans, key=lambda name: spans[name].first_s):
        if not found or spans[name].first_s > end_s:
            found.append([])
        found[-1].append(name)
        end_s = max(end_s, spans[name].last_s)
    return sorted(found, key=len, reverse=True)


def apart(spans: Mapping[str, Span], fewest: int) -> str | None:
    """Return a remark on cameras that have no time in common with the others, if there are any.

    Parameters
    ----------
    spans
        Of the cameras that delivered.
    fewest
        Cameras with fewer images are left out.
    """
    known = {name: span for name, span in spans.items() if span.images >= fewest}
    found = groups(known)
    if len(found) < 2:
        return None
    lonely = len(found[0]) == 1
    odd = list(known) if lonely else [name for group in found[1:] for name in group]
    when = [f"{name!r} from {known[name].told()}" for name in odd]
    if lonely:
        text = f"no two cameras have a time in common: {listed(when)}"
    else:
        others = Span(
            min(known[name].first_s for name in found[0]),
            max(known[name].last_s for name in found[0]),
        )
        verb = "has" if len(odd) == 1 else "have"
        text = (
            f"{cameras(odd, len(known))} {verb} no time in common with the others: "
            f"{listed(when)}, the others from {others.told()}"
        )
    return (
        f"{text}. Only images of the same time are combined: give time_offset_s in the rig or, "
        "where frames are numbered, number those of each camera from the same moment"
    )
