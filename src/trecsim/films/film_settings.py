"""How a film looks, and what it shows besides the tracks."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.sources.masks import Polygon

_FASTEST_HZ = 60.0


@dataclass(frozen=True, slots=True)
class FilmSettings:
    """How a film looks.

    Attributes
    ----------
    width, height
        Size of the image [px]; made even.
    rate_hz
        Frames per second; None takes the rate of the tracks, at most 30.
    from_s, to_s
        Part of the tracks [s], from their first time; None for the beginning and the end.
    at_s
        Moment of a picture [s], from the first time; None for one with the most people.
    trail_s
        Length of the paths behind people [s].
    title
        Text above the 3D view.
    """

    width: int = 1280
    height: int = 720
    rate_hz: float | None = None
    from_s: float | None = None
    to_s: float | None = None
    at_s: float | None = None
    trail_s: float = 10.0
    title: str = ""

    def __post_init__(self) -> None:
        for name, value in (("width", self.width), ("height", self.height)):
            if not 240 <= value <= 7680:
                raise InputError(f"--{name} {value}: expected 240 to 7680 pixels")
        if self.rate_hz is not None and not 0.1 <= self.rate_hz <= _FASTEST_HZ:
            raise InputError(f"--rate-hz {self.rate_hz:g}: expected 0.1 to {_FASTEST_HZ:g}")
        moments = (("from-s", self.from_s), ("to-s", self.to_s), ("at-s", self.at_s))
        for name, moment_s in moments:
            if moment_s is not None and math.isnan(moment_s):
                raise InputError(f"--{name} nan: expected seconds")
        if not 0.0 <= self.trail_s < math.inf:
            raise InputError(f"--trail-s {self.trail_s:g}: expected seconds, 0 or more")


@dataclass(frozen=True, slots=True)
class FilmInput:
    """What a film shows besides the tracks; each part may be missing.

    Attributes
    ----------
    rig
        The cameras.
    videos
        Video of each camera, by its name in the rig.
    masks_px
        Polygons that are blanked in the images of each camera [px].
    zones, lines
        Areas and lines on the floor, by name [m].
    events
        `events.jsonl`.
    forecasts
        `forecast.jsonl`.
    """

    rig: Rig | None = None
    videos: Mapping[str, Path] = field(default_factory=dict)
    masks_px: Mapping[str, Sequence[Polygon]] = field(default_factory=dict)
    zones: Mapping[str, np.ndarray] = field(default_factory=dict)
    lines: Mapping[str, np.ndarray] = field(default_factory=dict)
    events: Path | None = None
    forecasts: Path | None = None
