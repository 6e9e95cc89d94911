"""The command `trecsim calibrate intrinsics`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from trecsim.cli.board_options import BoardOptions
from trecsim.cli.calibration_files import report_of
from trecsim.cli.terminal import finish, note, progress_bar
from trecsim.errors import CalibrationError, ConfigError

if TYPE_CHECKING:
    from trecsim.calibrating.board_images import BoardSource
    from trecsim.calibrating.boards import Board
    from trecsim.calibrating.intrinsics import Intrinsics
    from trecsim.calibrating.intrinsics_verdict import IntrinsicsCheck

Made = tuple["BoardSource", "Intrinsics", "IntrinsicsCheck"]


def intrinsics(
    *images: str,
    out: Path,
    board: Annotated[BoardOptions, Parameter(name="*")],
    model: Literal["brown", "rational", "fisheye"] = "brown",
    most_views: int = 40,
    report: Path | None = None,
    json: bool = False,
) -> None:
    """Calibrate lenses with a board: focal length, centre and distortion.

    Hold the board so that it fills a third of the image or more, in all its parts, tilted by about
    30 degrees each way, and still: 15 views or more. Writes a rig file without positions, and a
    report.

    Parameters
    ----------
    images
        NAME=IMAGES_OR_VIDEO for each camera: a directory, a pattern such as `north=board/n*.jpg`,
        or a video, from which sharp and different images are chosen.
    out
        The rig file to write, `*.toml`.
    model
        Lens model: `brown` for usual lenses, `rational` for wide ones, `fisheye` from about 120
        degrees.
    most_views
        Largest number of views of each camera to use.
    report
        The report to write (default: beside the rig file, `*.html`).
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.board_images import board_sources
    from trecsim.calibrating.intrinsics import LEAST_VIEWS
    from trecsim.calibration import write_intrinsics
    from trecsim.geometry.rig import Rig
    from trecsim.lab.report.board_section import intrinsics_section
    from trecsim.lab.report.calibration_page import write_calibration_report

    if most_views < LEAST_VIEWS:
        raise ConfigError(f"--most-views must be {LEAST_VIEWS} or more, got {most_views}")
    page = report_of(out, report)
    wanted = board.read()
    sources = board_sources(images)
    with progress_bar("images", quiet=json) as bar:
        made = [_calibrate(source, wanted, model, most_views, bar) for source in sources]
    result = _result(made)
    write_intrinsics(Rig(tuple(found.camera for _, found, _ in made)), out)
    sections = [
        intrinsics_section(found, check, source, number)
        for number, (source, found, check) in enumerate(made)
    ]
    write_calibration_report(page, "Intrinsics", result, sections=sections, source=str(wanted))
    summary = {
        **result.summary(),
        "intrinsics": {found.camera.name: _facts(found, check) for _, found, check in made},
        "out": out,
        "report": page,
    }
    lines = [_line(found) for _, found, _ in made]
    lines += [f"{result.verdict}: {result.reasons[0]}", f"{out}, and the report: {page}"]
    if result.verdict == "wrong":
        note(f"{out} is written, but do not use it: {result.reasons[0]}")
    finish(summary, json, "\n".join(lines))


def _calibrate(
    source: "BoardSource", board: "Board", model: Any, most_views: int, progress: Any
) -> Made:
    from trecsim.calibrating.board_faults import why_no_board
    from trecsim.calibrating.intrinsics import LEAST_VIEWS, fit_intrinsics
    from trecsim.calibrating.intrinsics_verdict import check_intrinsics
    from trecsim.calibrating.views import look, sharp_views, spread_views

    seen = look(source, board, progress=progress)
    if not seen.views:
        raise CalibrationError(why_no_board(source, board))
    sharp, blurred = sharp_views(seen.views)
    if source.video is None:
        if seen.without:
            note(f"camera {source.camera!r}: no board found in {_listed(seen.without)}")
        if blurred and len(sharp) >= LEAST_VIEWS:
            labels = [f"{view.label} (edges {view.seen.edge_px:.0f} px wide)" for view in blurred]
            note(f"camera {source.camera!r}: left out because they are blurred: {_listed(labels)}")
    used = sharp if len(sharp) >= LEAST_VIEWS else list(seen.views)
    chosen = spread_views(used, board, seen.size_px, most_views)
    found = fit_intrinsics(source.camera, seen.size_px, chosen, board, model)
    return source, found, check_intrinsics(found, board)


def _result(made: list[Made]) -> Any:
    from trecsim.calibrating.result import CalibrationResult, CameraQuality, judge

    verdict, reasons = judge([finding for _, _, check in made for finding in check.findings])
    cameras = tuple(
        CameraQuality(found.camera.name, reprojection_px=found.rms_px) for _, found, _ in made
    )
    return CalibrationResult(cameras, verdict, reasons)


def _facts(found: "Intrinsics", check: "IntrinsicsCheck") -> dict[str, Any]:
    return {
        "model": found.model,
        "views": len(found.views),
        "corners": len(found.corner_px),
        "values": dict(zip(found.names, found.values.tolist(), strict=True)),
        "sd": dict(zip(found.names, found.sd.tolist(), strict=True)),
        "sigma_px": found.sigma_px,
        "reach": check.reach,
        "worst": list(check.worst),
    }


def _line(found: "Intrinsics") -> str:
    fx, fy, cx, cy = found.values[:4]
    sd = found.sd
    return (
        f"{found.camera.name}: {len(found.views)} views, f {fx:.1f} ± {sd[0]:.1f}, {fy:.1f} ± "
        f"{sd[1]:.1f} px, centre {cx:.1f} ± {sd[2]:.1f}, {cy:.1f} ± {sd[3]:.1f} px, error "
        f"{found.rms_px:.2f} px"
    )


def _listed(labels: Any, most: int = 6) -> str:
    shown = ", ".join(list(labels)[:most])
    return f"{shown} and {len(labels) - most} more" if len(labels) > most else shown
