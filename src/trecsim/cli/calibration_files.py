"""The files that a calibration writes: a rig file and a report, checked before the work begins."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from trecsim.cli.terminal import note
from trecsim.errors import InputError
from trecsim.extras import has_extra, install_command

if TYPE_CHECKING:
    from trecsim.calibrating.result import CalibrationResult


def report_of(out: Path, report: Path | None) -> Path:
    """Return where the report of a rig file goes, beside it by default.

    Parameters
    ----------
    out
        The rig file to write.
    report
        The report that was asked for.

    Raises
    ------
    InputError
        One of the two cannot be written, or both are the same file.
    """
    from trecsim.store.atomic import refuse_unwritable

    if out.suffix.lower() != ".toml":
        raise InputError(f"--out: expected a rig file that ends in .toml, got {out}")
    page = report or out.with_suffix(".html")
    if page.resolve() == out.resolve():
        raise InputError(f"--report: {page} is the rig file to write; give another name")
    refuse_unwritable(out)
    refuse_unwritable(page)
    return page


def refuse_over_intrinsics(out: Path, intrinsics: Path) -> None:
    """Refuse a rig file that takes the place of the intrinsics it is computed from.

    Raises
    ------
    InputError
        Both are the same file.
    """
    if out.exists() and intrinsics.exists() and out.samefile(intrinsics):
        raise InputError(
            f"--out: {out} is the file of the intrinsics, whose poses, and cameras that are not "
            "found, would be lost; give another name"
        )


def write_report(
    page: Path, title: str, result: "CalibrationResult", *, asked: bool, **shown: Any
) -> None:
    """Write the report of a calibration that needs no extra of the package by itself.

    Parameters
    ----------
    page
        The file.
    title
        Its heading.
    result
        Verdict and figures.
    asked
        Whether it was asked for; otherwise a report that cannot be drawn is a remark.
    shown
        What else `write_calibration_report` shows.
    """
    if not asked and not has_extra("report"):
        note(f"no report {page}: it needs Jinja and Matplotlib: {install_command('report')}")
        return
    from trecsim.lab.report.calibration_page import write_calibration_report

    write_calibration_report(page, title, result, **shown)
