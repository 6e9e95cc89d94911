"""The gaps of a recording: when nothing could be stored, and why (``gaps.json``)."""

import json
import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from trecsim.store.atomic import atomic_write

NAME = "gaps.json"

_FORMAT = "trecsim.gaps/1"
_MOST = 10_000  # the oldest are left out then


@dataclass(frozen=True, slots=True)
class Gap:
    """A time of which nothing is stored.

    Attributes
    ----------
    from_s, to_s
        The last moment before and the first moment after [s].
    reason
        Why.
    """

    from_s: float
    to_s: float
    reason: str


def read_gaps(folder: Path) -> list[Gap]:
    """Return the gaps of the recording in a folder; none if the list is missing or damaged."""
    try:
        facts = json.loads((folder / NAME).read_bytes())
        if facts["format"] != _FORMAT:
            return []
        gaps = [Gap(float(g["from_s"]), float(g["to_s"]), str(g["reason"])) for g in facts["gaps"]]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return []
    return [gap for gap in gaps if math.isfinite(gap.from_s + gap.to_s)]


def add_gaps(folder: Path, gaps: Iterable[Gap]) -> None:
    """Add gaps to the list of a recording.

    Raises
    ------
    SetupError
        When the disk has no room.
    """
    everything = [*read_gaps(folder), *gaps][-_MOST:]
    with atomic_write(folder / NAME, private=True) as file:
        content = {"format": _FORMAT, "gaps": [asdict(gap) for gap in everything]}
        file.write(json.dumps(content, indent=1) + "\n")
