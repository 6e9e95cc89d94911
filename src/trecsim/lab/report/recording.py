"""Read the recording that a report is about: a folder, or a file of tracks."""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.calibration import read_rig
from trecsim.callbacks import Progress
from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.lab.evaluation.moments import Moments
from trecsim.lab.plots.elapsed_time import ElapsedTime, clock_of
from trecsim.lab.report.recording_files import Places
from trecsim.lab.report.thinning import Sampler, Stay
from trecsim.skeleton import COCO17
from trecsim.store.atomic import opened_for_reading
from trecsim.store.timing_csv import Timing, read_timing
from trecsim.store.tracks import read_tracks
from trecsim.store.truth import Truth, read_truth

EARLIEST_UNIX_S = 1e9  # times from here on are dates, others count from some start
LONGEST_LAG_S = 10.0  # a longer one means that timing and tracks do not belong together
MOST_SHOWN = 8  # people in tables and curves; there are as many distinguishable colours
_LARGEST_SUMMARY_BYTES = 10_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """A recording as a report needs it: all counts, and an even sample of its frames.

    Attributes
    ----------
    name
        Of the site, the folder or the file.
    places
        Its files.
    start_s, end_s
        First and last time of all files [s]; NaN if there is none.
    range_s
        Time range of the frames that were used [s]; may be infinite.
    moment_count
        Number of frames with people.
    person_moments
        Number of person-frames.
    stays
        First and last time and number of frames of each identity, longest first.
    every
        Two consecutive frames of every `every` are in the sample; 1: all.
    period_s
        Median time between frames [s]; NaN for fewer than two.
    sample
        An even sample of the frames.
    rig, timing, truth
        Contents of their files; None if missing.
    summary
        The summary of the run; empty if missing.
    lag_s
        How far the states are behind the frame sets they came from [s].
    """

    name: str
    places: Places
    start_s: float
    end_s: float
    range_s: tuple[float, float]
    moment_count: int
    person_moments: int
    stays: tuple[Stay, ...]
    every: int
    period_s: float
    sample: Moments
    rig: Rig | None
    timing: Timing | None
    truth: Truth | None
    summary: dict[str, Any]
    lag_s: float = 0.0

    @property
    def length_s(self) -> float:
        """Length [s]; 0 if unknown."""
        length_s = self.end_s - self.start_s
        return length_s if math.isfinite(length_s) else 0.0

    @property
    def length(self) -> float:
        """Length in the unit of its clock, never 0: the end of a time axis."""
        return max(self.length_s / self.clock.unit_s, 1e-3)

    @property
    def unfinished(self) -> bool:
        """Whether the tracks are what an interrupted run left."""
        tracks = self.places.tracks
        return tracks.suffix in (".partial", ".parts") or not tracks.exists()

    @property
    def clock(self) -> ElapsedTime:
        """How to show its times."""
        return clock_of(self.start_s, self.length_s)

    @property
    def shown(self) -> tuple[Stay, ...]:
        """The people that tables and curves show: those tracked longest, by arrival."""
        return tuple(sorted(self.stays[:MOST_SHOWN], key=lambda stay: (stay.first_s, stay.person)))

    @property
    def number(self) -> dict[int, int]:
        """Number of each person, which sets the colour: the shown first, then by arrival."""
        rest = sorted(self.stays[MOST_SHOWN:], key=lambda stay: (stay.first_s, stay.person))
        return {stay.person: number for number, stay in enumerate((*self.shown, *rest))}

    @property
    def t_s(self) -> Float64[np.ndarray, " row"]:
        """Time of each person-frame of the sample [s]."""
        return np.repeat(self.sample.t_s, self.sample.people)

    @property
    def moment_s(self) -> float:
        """Time that a frame of the sample represents [s]; 0 if unknown."""
        usual_s = self.moment_count * self.period_s / max(len(self.sample.t_s), 1)
        return usual_s if math.isfinite(usual_s) else 0.0


def read_recording(
    places: Places,
    *,
    from_s: float = 0.0,
    to_s: float = math.inf,
    progress: Progress | None = None,
) -> Recording:
    """Read a recording frame by frame, in little memory.

    The part to take counts from its start.

    Raises
    ------
    InputError
        A piece is not right, or there is nothing in that part of time.
    """
    if not 0.0 <= from_s < to_s:
        raise InputError(f"the part to take must have a length, got from {from_s:g} to {to_s:g} s")
    rig = read_rig(places.rig) if places.rig is not None else None
    truth = read_truth(places.truth) if places.truth is not None else None
    timing = read_timing(places.timing) if places.timing is not None else None
    summary = _read_summary(places.summary) if places.summary is not None else {}
    start_s = float(timing.t_s[0]) if timing is not None and len(timing.t_s) else None
    sampler = Sampler(start_s, from_s, to_s)
    first_s = math.nan
    for number, snapshot in enumerate(read_tracks(places.tracks), start=1):
        first_s = snapshot.t_s if number == 1 else first_s
        if snapshot.xyz_m.shape[1] != len(COCO17.joints):
            raise InputError(
                f"{places.tracks}: expected the {len(COCO17.joints)} joints of {COCO17.name}"
            )
        sampler.add(snapshot)
        if progress is not None:
            progress(number, None)
    if (from_s > 0 or math.isfinite(to_s)) and not sampler.moments:
        raise InputError(
            f"{places.tracks}: there are no people from {from_s:g} s to {to_s:g} s after the start"
        )
    lag_s = _lag_s(timing, first_s)
    timing = _part(timing, sampler)
    seen_s = [*sampler.span_s, *(timing.t_s[[0, -1]] if timing and len(timing.t_s) else ())]
    known_s = [t_s for t_s in seen_s if math.isfinite(t_s)] or [math.nan]
    return Recording(
        name=_name(places, summary),
        places=places,
        start_s=float(min(known_s)),
        end_s=float(max(known_s)),
        range_s=sampler.range_s,
        moment_count=sampler.moments,
        person_moments=sampler.person_moments,
        stays=sampler.stays(),
        every=sampler.every,
        period_s=sampler.period_s,
        sample=sampler.sample(),
        rig=rig,
        timing=timing,
        truth=truth,
        summary=summary,
        lag_s=lag_s,
    )


def _lag_s(timing: Timing | None, first_s: float) -> float:
    """Return how far states are behind their frame sets [s].

    The first frame set that reports people has the first state; their times differ by the lag.
    """
    if timing is None or not timing.people.any() or not math.isfinite(first_s):
        return 0.0
    lag_s = float(timing.t_s[int(np.argmax(timing.people > 0))]) - first_s
    return round(lag_s, 6) if 1e-5 < lag_s <= LONGEST_LAG_S else 0.0


def _part(timing: Timing | None, sampler: Sampler) -> Timing | None:
    if timing is None or not len(timing.t_s):
        return timing
    low_s, high_s = sampler.range_s
    chosen = (timing.t_s >= low_s) & (timing.t_s <= high_s)
    columns = (timing.t_s, timing.images, timing.people, timing.fusion_ms)
    return Timing(*(column[chosen] for column in columns))


def _name(places: Places, summary: dict[str, Any]) -> str:
    site = summary.get("site")
    if isinstance(site, str) and site:
        return site[:100]
    tracks = places.tracks.resolve()
    return tracks.parent.name if tracks.name.startswith("tracks.") else tracks.stem


def _read_summary(path: Path) -> dict[str, Any]:
    with opened_for_reading(path) as file:
        text = file.read(_LARGEST_SUMMARY_BYTES + 1)
    try:
        summary = json.loads(text) if len(text) <= _LARGEST_SUMMARY_BYTES else None
    except (ValueError, RecursionError):
        summary = None
    if not isinstance(summary, dict):
        raise InputError(f"{path} is not a summary of a run: expected one JSON object")
    return summary
