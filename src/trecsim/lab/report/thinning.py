"""An even sample of the frames of a recording of any length, in little memory."""

import math
from dataclasses import dataclass, field

import numpy as np

from trecsim.lab.evaluation.moments import Frame, Moments, frame_of, joined_frames
from trecsim.values import Snapshot

MOST_ROWS = 60_000  # person-frames that are kept; beyond, half of the frames are dropped


@dataclass(slots=True)
class Stay:
    """Time in which one identity was tracked."""

    person: int
    first_s: float
    last_s: float
    moments: int = 0


@dataclass(slots=True)
class Sampler:
    """Counts all snapshots and keeps an even sample of them.

    Attributes
    ----------
    start_s
        From when `from_s` and `to_s` count [s]; None: from the first snapshot.
    from_s, to_s
        The part of the recording to take [s].
    most_rows
        Largest number of person-frames to keep.
    every
        Two consecutive frames of every `every` are kept; 1 keeps all.
    moments, person_moments
        Number of all frames and person-frames.
    """

    start_s: float | None = None
    from_s: float = 0.0
    to_s: float = math.inf
    most_rows: int = MOST_ROWS
    every: int = 1
    moments: int = 0
    person_moments: int = 0
    _kept: list[tuple[int, Frame]] = field(default_factory=list)
    _rows: int = 0
    _stays: dict[int, Stay] = field(default_factory=dict)

    def add(self, snapshot: Snapshot) -> None:
        """Add one frame."""
        if self.start_s is None:
            self.start_s = snapshot.t_s
        low_s, high_s = self.range_s
        if not low_s <= snapshot.t_s <= high_s:
            return
        if self._chosen(self.moments):
            self._keep(snapshot)
        self.moments += 1
        self.person_moments += len(snapshot.id)
        for person in snapshot.id.tolist():
            stay = self._stays.setdefault(person, Stay(person, snapshot.t_s, snapshot.t_s))
            stay.last_s = snapshot.t_s
            stay.moments += 1

    @property
    def range_s(self) -> tuple[float, float]:
        """Time range of the frames that count [s]."""
        start_s = self.start_s if self.start_s is not None else 0.0
        # The first snapshot may be a lag older than the first frame set.
        return (start_s + self.from_s if self.from_s > 0 else -math.inf), start_s + self.to_s

    @property
    def span_s(self) -> tuple[float, float]:
        """First and last time with people [s]; NaN without people."""
        stays = self._stays.values()
        nobody = (math.nan, math.nan)
        return (min(s.first_s for s in stays), max(s.last_s for s in stays)) if stays else nobody

    def stays(self) -> tuple[Stay, ...]:
        """Return the time of each identity, longest first."""
        return tuple(sorted(self._stays.values(), key=lambda stay: (-stay.moments, stay.person)))

    def sample(self) -> Moments:
        """Return the kept frames."""
        return joined_frames([frame for _, frame in self._kept], np.float32)

    @property
    def period_s(self) -> float:
        """Median time between frames [s]; NaN for fewer than two."""
        number = np.array([number for number, _ in self._kept])
        t_s = np.array([t_s for _, (t_s, _) in self._kept])
        steps_s = np.diff(t_s)[np.diff(number) == 1]
        return float(np.median(steps_s)) if len(steps_s) else math.nan

    def _chosen(self, number: int) -> bool:
        return number % self.every < 2

    def _keep(self, snapshot: Snapshot) -> None:
        self._kept.append((self.moments, frame_of(snapshot, np.float32)))
        self._rows += len(snapshot.id)
        while self._rows > self.most_rows and len(self._kept) > 2:
            self.every = max(2 * self.every, 4)
            self._kept = [kept for kept in self._kept if self._chosen(kept[0])]
            self._rows = sum(len(rows[0]) for _, (_, rows) in self._kept)
