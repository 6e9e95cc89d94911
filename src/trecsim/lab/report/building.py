"""Write a report on a recording: read its files, make the sections, write one page."""

import math
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from trecsim.callbacks import Progress
from trecsim.errors import InputError
from trecsim.lab.evaluation.left_out import LeftOut, left_out_of_files
from trecsim.lab.evaluation.limbs import Given, limb_series, limb_summary, limb_table, true_lengths
from trecsim.lab.evaluation.measured import read_measured
from trecsim.lab.evaluation.person_tracks import people_of
from trecsim.lab.report import (
    against_truth,
    cameras_section,
    compute_section,
    floor_section,
    limbs_section,
    people_section,
    summary,
    uncertainty,
)
from trecsim.lab.report.coverage import facts_of
from trecsim.lab.report.page import Section, Text, page
from trecsim.lab.report.recording import Recording, read_recording
from trecsim.lab.report.recording_files import find
from trecsim.lab.report.style import need_matplotlib
from trecsim.store.atomic import atomic_write, disk_faults


@dataclass(frozen=True, slots=True)
class ReportSummary:
    """Summary of a report.

    Attributes
    ----------
    out
        The page that was written.
    bytes
        Its size.
    sections
        Its headings.
    moments, identities
        Number of frames with people, and of identities.
    length_s
        Length of the recording [s].
    warnings
        The warnings on the page.
    """

    out: Path
    bytes: int
    sections: tuple[str, ...]
    moments: int
    identities: int
    length_s: float
    warnings: tuple[str, ...]


def report(
    recording: Path | str,
    out: Path | str | None = None,
    *,
    rig: Path | None = None,
    poses: Path | None = None,
    truth: Path | None = None,
    lengths: Path | None = None,
    from_s: float = 0.0,
    to_s: float = math.inf,
    left_out: bool | None = None,
    progress: Progress | None = None,
) -> ReportSummary:
    """Write a report on a recording: one HTML page with quality checks.

    Parameters
    ----------
    recording
        A folder written by `trecsim run`, a folder with tracks, rig and poses, or a file of
        tracks.
    out
        The page to write; None is `report.html` in the folder of the recording.
    rig, poses, truth
        Files to use, if not in the folder.
    lengths
        Limb lengths measured with a tape, to compare with (TOML).
    from_s, to_s
        The part of the recording to take, counted from its start [s].
    left_out
        Whether to track once more without each camera, and to judge the stated uncertainties by it;
        None does so without ground truth, where there are 2D poses of three cameras or more, few
        enough for seconds.
    progress
        Called with the number of frames read, then with that of images tracked.

    Raises
    ------
    InputError
        A file is not right, or what `left_out` needs is missing.
    SetupError
        Matplotlib or Jinja is not installed, or the disk is full.
    """
    need_matplotlib()
    recording = Path(recording)
    folder = recording if recording.is_dir() else recording.parent
    out = Path(out) if out is not None else folder / "report.html"
    places = find(recording, rig=rig, poses=poses, truth=truth)
    with disk_faults(out):
        out.parent.stat()  # a folder that is missing is told before all the work
    measured = read_measured(lengths) if lengths is not None else None
    read = read_recording(places, from_s=from_s, to_s=to_s, progress=progress)
    sections = _sections(read, measured, _left_out(read, left_out, progress))
    now = datetime.now(UTC)
    text = page(
        f"Report on {read.name}",
        sections,
        subtitle=summary.subtitle(read),
        footer=f"Made by trecsim {version('mc3d-trecsim')} on {now:%d %B %Y} from {places.tracks}",
    )
    with atomic_write(out, private=True) as file:
        file.write(text)
    return ReportSummary(
        out=out,
        bytes=len(text.encode()),
        sections=tuple(section.title for section in sections),
        moments=read.moment_count,
        identities=len(read.stays),
        length_s=read.length_s,
        warnings=tuple(
            block.text
            for block in sections[0].blocks
            if isinstance(block, Text) and block.kind == "warning"
        ),
    )


def _left_out(
    recording: Recording, wanted: bool | None, progress: Progress | None
) -> LeftOut | None:
    rig, poses = recording.rig, recording.places.poses
    if wanted and (rig is None or poses is None):
        raise InputError(
            f"{recording.places.tracks}: leaving cameras out needs the rig and the 2D poses: give "
            "--rig and --poses"
        )
    if wanted is None and (recording.truth is not None or not recording.stays):
        return None
    return left_out_of_files(
        rig, poses, people_of(recording.sample), recording.period_s,
        wanted=wanted, lag_s=recording.lag_s, range_s=recording.range_s, progress=progress,
    )  # fmt: skip


def _sections(
    recording: Recording, measured: Given | None, left_out: LeftOut | None
) -> list[Section]:
    given, source = _given(recording, measured)
    seen = facts_of(recording)
    series = limb_series(people_of(recording.sample))
    table = limb_table(series, given)
    scores = against_truth.scores_of(recording)
    known = None if isinstance(scores, str) else scores
    sections = [summary.section(recording, seen, limb_summary(table), known, series, table, source)]
    if scores is not None:
        sections.append(against_truth.section(scores))
    return [
        *sections,
        people_section.section(recording),
        floor_section.section(recording),
        limbs_section.section(recording, given, source),
        cameras_section.section(recording, seen),
        uncertainty.section(recording, left_out),
        compute_section.section(recording),
    ]


def _given(recording: Recording, measured: Given | None) -> tuple[Given, str]:
    """Return lengths to compare with, and their source."""
    if measured is not None:
        return measured, "measured"
    if recording.truth is not None:
        return true_lengths(people_of(recording.sample), recording.truth), "true"
    return {}, ""
