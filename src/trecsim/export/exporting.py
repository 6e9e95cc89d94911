"""Export recorded tracks to the format that the ending of a file name chooses."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path

import numpy as np

from trecsim.errors import InputError
from trecsim.export.base import About, Format, Part, Writer
from trecsim.export.fixed_rate import filled, resampled, usual_rate_hz
from trecsim.export.formats import NATIVE, format_of
from trecsim.export.motions import Motion, collect
from trecsim.export.opensim_setup import setup_files
from trecsim.export.placing import placed
from trecsim.export.smoothing import NO_SMOOTHING, Smoothing, smoothed
from trecsim.extras import needed
from trecsim.skeleton import COCO17
from trecsim.store.tracks import export_tracks as export_native
from trecsim.store.tracks import read_tracks

Progress = Callable[[int, int | None], None]


@dataclass(frozen=True, slots=True)
class ExportSettings:
    """What is done to tracks before they are written; by default nothing.

    Attributes
    ----------
    rate_hz
        Frames per second, on the spline through the tracks. None keeps the recorded times, or, for
        formats with a fixed rate, takes the usual rate of the tracks.
    person
        Only this person.
    fill_s
        Gaps up to this length are filled by the spline [s].
    smoothing
        A filter; it makes the rate fixed.
    provisional
        Whether provisional people are exported.
    opensim
        Whether TRC gets a marker set and setups for OpenSim's scaling and inverse kinematics.
    """

    rate_hz: float | None = None
    person: int | None = None
    fill_s: float = 0.0
    smoothing: Smoothing = NO_SMOOTHING
    provisional: bool = False
    opensim: bool = False

    def __post_init__(self) -> None:
        if self.rate_hz is not None and not _LOWEST_HZ <= self.rate_hz <= _HIGHEST_HZ:
            raise InputError(
                f"--rate-hz {self.rate_hz:g}: expected {_LOWEST_HZ:g} to {_HIGHEST_HZ:g}"
            )
        if not 0.0 <= self.fill_s < math.inf:
            raise InputError(f"--fill-s {self.fill_s:g}: expected seconds, 0 or more")

    @property
    def changes(self) -> bool:
        """Whether anything is done to the tracks."""
        return self != replace(ExportSettings(), provisional=self.provisional)

    @property
    def smooths(self) -> bool:
        """Whether there is a filter."""
        return self.smoothing != NO_SMOOTHING


_PACKAGES = {".usdc": "usd-core"}  # named otherwise than the module
_LOWEST_HZ, _HIGHEST_HZ = 0.01, 10_000.0


@dataclass(frozen=True, slots=True)
class Exported:
    """What was written.

    Attributes
    ----------
    files
        The files, in order of people and time.
    format
        The format in words.
    moments
        Number of times with at least one person.
    people
        Number of identities.
    rows
        Number of joints over all times and people; missing ones count.
    first_s, last_s
        The first and last time [s]; NaN without people.
    rate_hz
        Frames per second where it is fixed; None for the recorded times.
    missing
        Number of frames, over all people, between their first and last in which they are missing.
    held
        How many of these show the last pose, because the format cannot leave them out.
    smoothing
        The filter, in words, with its phase.
    left_out
        Identities with no frame at this rate.
    """

    files: tuple[Path, ...]
    format: str
    moments: int
    people: int
    rows: int
    first_s: float
    last_s: float
    rate_hz: float | None = None
    missing: int = 0
    held: int = 0
    smoothing: str = "none"
    left_out: tuple[int, ...] = ()


def export_tracks(
    path: Path | str,
    out: Path | str,
    progress: Progress | None = None,
    *,
    settings: ExportSettings | None = None,
    provisional: bool = False,
) -> Exported:
    """Write recorded tracks in the format that the ending of `out` chooses.

    Formats that hold one person get one file per person, ``walk_0.trc`` for person 0 of
    ``walk.trc``. All files appear together when the last one is complete; after an error there is
    none. CSV to Parquet and back gives the same file; metadata and details of Parquet files are
    kept only in Parquet.

    Parameters
    ----------
    path
        What :func:`trecsim.read_tracks` reads: CSV, Parquet, or the folder of a recording.
    out
        The file to write.
    progress
        Called with the number of times read.
    settings
        What is done to the tracks first.
    provisional
        Whether provisional people are exported; Parquet always gets them, with their state.

    Raises
    ------
    InputError
        When the tracks, the ending or a setting is wrong, or there is nobody to export.
    SetupError
        When an optional package is missing or the disk has no room.
    """
    path, out = Path(path), Path(out)
    kind = format_of(out)
    settings = settings or ExportSettings()
    settings = replace(settings, provisional=settings.provisional or provisional)
    if settings.opensim and kind.ending != ".trc":
        raise InputError(f"--opensim belongs to TRC files; {out} is to be {kind.title}")
    if kind.ending in NATIVE and not settings.changes:
        extent = export_native(path, out, progress, provisional=settings.provisional)
        return Exported(
            (out,), kind.title, extent.moments, extent.people, extent.rows, extent.first_s,
            extent.last_s,
        )  # fmt: skip
    write = _writer_of(kind)
    recorded = _recorded(path, settings, progress)
    motion = _prepared(recorded, settings, kind)
    parts = list(_parts(motion, kind))
    files = [_file_name(out, kind.ending, part.label) for part in parts]
    beside: dict[Path, str] = {}
    if settings.opensim:
        people = [(part.only, file) for part, file in zip(parts, files, strict=True)]
        beside = setup_files(out, people)
    with placed([*files, *beside]) as places:
        for part, place, file in zip(parts, places, files, strict=False):
            write(part.motion, place, About(file.name, COCO17))
        for place, text in zip(places[len(files) :], beside.values(), strict=True):
            place.write_text(text, encoding="utf-8")
    return _told(motion, recorded, [*files, *beside], kind, settings)


def _writer_of(kind: Format) -> Writer:
    """Import a writer and the optional packages that it uses."""
    if kind.needs:
        extra, *modules = kind.needs
        package = _PACKAGES.get(kind.ending, modules[0].split(".")[0])
        needed(f"{kind.title} needs {package}", extra, *modules)
    module, _, function = kind.writer.partition(":")
    writer: Writer = getattr(import_module(f"trecsim.export.{module}"), function)
    return writer


def _recorded(path: Path, settings: ExportSettings, progress: Progress | None) -> Motion:
    snapshots = read_tracks(path, provisional=settings.provisional)
    motion = collect(snapshots, settings.person, progress)
    if not motion.people and settings.person is not None:
        there = sorted({int(one) for s in read_tracks(path) for one in s.id})
        listed = ", ".join(map(str, there[:20])) + (", ..." if len(there) > 20 else "")
        raise InputError(
            f"{path}: there is no person {settings.person}; there are {listed or 'none'}"
        )
    if not motion.people:
        raise InputError(f"{path}: nobody is in these tracks, so there is nothing to export")
    return motion


def _prepared(recorded: Motion, settings: ExportSettings, kind: Format) -> Motion:
    """Resample, fill and smooth as the settings and the format want it."""
    fixed = kind.fixed_rate or settings.rate_hz is not None or settings.smooths
    if not fixed:
        return filled(recorded, settings.fill_s) if settings.fill_s else recorded
    rate_hz = settings.rate_hz
    if rate_hz is None:
        if not math.isfinite(recorded.step_s):
            raise InputError(
                "the tracks hold a single time, which has no rate; give one with --rate-hz"
            )
        rate_hz = usual_rate_hz(recorded)
    smoothing = settings.smoothing.checked(rate_hz)
    motion = resampled(recorded, rate_hz, settings.fill_s)
    if not motion.people:
        raise InputError(
            f"nobody is seen at two frames in a row at {rate_hz:g} frames per second; give a "
            "higher --rate-hz"
        )
    return smoothed(motion, smoothing)


def _parts(motion: Motion, kind: Format) -> Iterator[Part]:
    if not kind.one_person:
        yield Part("", motion)
        return
    for one in motion.people:
        most = kind.most_frames or len(one.t_s)
        for number, start in enumerate(range(0, len(one.t_s), most), 1):
            label = f"_{one.person}" + (f"_part{number}" if number > 1 else "")
            yield Part(label, replace(motion, people=(one.part(slice(start, start + most)),)))


def _file_name(out: Path, ending: str, label: str) -> Path:
    return out.with_name(out.name[: -len(ending)] + label + out.name[-len(ending) :])


def _told(
    motion: Motion, recorded: Motion, files: list[Path], kind: Format, settings: ExportSettings
) -> Exported:
    there = [one.present for one in motion.people]
    times = np.unique(
        np.concatenate([one.t_s[kept] for one, kept in zip(motion.people, there, strict=True)])
    )
    missing = sum(int((~kept).sum()) for kept in there)
    shown = {one.person for one in motion.people}
    return Exported(
        tuple(files),
        kind.title,
        len(times),
        len(motion.people),
        sum(int(kept.sum()) for kept in there) * len(COCO17.joints),
        float(times[0]),
        float(times[-1]),
        motion.rate_hz,
        missing,
        missing if kind.holds_pose else 0,
        str(settings.smoothing),
        tuple(one.person for one in recorded.people if one.person not in shown),
    )
