"""The command `trecsim calibrate rig`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from trecsim.cli.board_options import BoardOptions
from trecsim.cli.calibration_files import refuse_over_intrinsics, report_of
from trecsim.cli.terminal import finish, note, progress_bar
from trecsim.errors import CalibrationError, ConfigError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trecsim.calibrating.board_images import BoardSource
    from trecsim.calibrating.boards import Board
    from trecsim.calibrating.rig_calibration import RigCalibration
    from trecsim.calibrating.views import CameraViews
    from trecsim.cli.terminal import ProgressBar
    from trecsim.geometry.camera import Camera

MOST_LOOKED_AT = 600  # images of a video: 20 s at 30 per second


def rig(
    *images: str,
    intrinsics: Path,
    out: Path,
    board: Annotated[BoardOptions, Parameter(name="*")],
    boards: int = 1,
    fixed_together: bool = False,
    double_sided: bool = False,
    synchronised: bool = False,
    max_offset_s: float = 10.0,
    report: Path | None = None,
    json: bool = False,
) -> None:
    """Calibrate where cameras stand with a board that is carried through the room.

    Carry the board slowly through where two or more cameras see it at once, tilt it, and hold it
    still now and then: 20 moments or more for each pair of cameras. Writes a rig file and a report;
    the floor is only guessed: `trecsim calibrate floor` finds it.

    Parameters
    ----------
    images
        NAME=IMAGES_OR_VIDEO for each camera: a directory or a pattern of images, of which those
        with the same number belong to the same moment, or a video.
    intrinsics
        A rig file with the intrinsics of these cameras, in any format that is read.
    out
        The rig file to write, `*.toml`.
    boards
        Number of ChArUco boards, with markers that follow on as `calibrate board` prints them.
    fixed_together
        The boards are fixed to each other, in places that are found.
    double_sided
        One ChArUco board printed on both sides, back to back and upright: lets cameras that look
        at each other see the same board.
    synchronised
        The videos show the same moments at the same times; otherwise the offsets of their clocks
        are found from the motion of the board.
    max_offset_s
        Largest offset between two videos to look for [s].
    report
        The report to write (default: beside the rig file, `*.html`).
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.board_images import board_sources
    from trecsim.calibration import read_intrinsics, write_rig
    from trecsim.lab.report.calibration_page import write_calibration_report
    from trecsim.lab.report.rig_section import rig_sections

    page = report_of(out, report)
    refuse_over_intrinsics(out, intrinsics)
    wanted = _boards(board.read(), boards, double_sided)
    sources = board_sources(images)
    known = read_intrinsics(intrinsics)
    cameras = [_camera(known, source, intrinsics) for source in sources]
    if len(cameras) < 2:
        raise ConfigError("give two or more cameras as NAME=IMAGES_OR_VIDEO; one alone has no rig")
    most_offset_s = 0.0 if synchronised else max_offset_s
    with progress_bar("images", quiet=json) as bar:
        views = _look(sources, cameras, wanted, bar)
    together = "back" if double_sided else "found" if fixed_together else ""
    made = _calibrate(sources, cameras, wanted, views, together, most_offset_s)
    write_rig(made.rig, out, format="trecsim")
    write_calibration_report(
        page,
        "Rig",
        made.result,
        rig=made.rig,
        covariance=made.covariance,
        sections=rig_sections(made, sources),
        source=str(wanted[0]),
    )
    result = made.result
    summary = {**result.summary(), **_facts(made), "out": out, "report": page}
    lines = [_line(made, number) for number in range(len(result.cameras))]
    lines += [f"{result.verdict}: {result.reasons[0]}", f"{out}, and the report: {page}"]
    if result.verdict == "wrong":
        note(f"{out} is written, but do not use it: {result.reasons[0]}")
    note("the floor is only guessed from the cameras being upright: run trecsim calibrate floor")
    finish(summary, json, "\n".join(lines))


def _camera(known: Any, source: "BoardSource", path: Path) -> "Camera":
    from trecsim.sources.camera_names import unknown_camera

    if source.camera not in known:
        where = f"the file of intrinsics {path}"
        raise CalibrationError(unknown_camera(source.camera, known.names, where))
    camera: Camera = known[source.camera]
    return camera


def _boards(board: "Board", count: int, double_sided: bool) -> "list[Board]":
    count = 2 if double_sided else count
    if count > 1 and board.charuco is None:
        raise ConfigError(
            "several boards, or two sides, must be told apart: use ChArUco boards and --charuco"
        )
    if count < 1:
        raise ConfigError(f"--boards must be 1 or more, got {count}")
    return [board.on_side(number) for number in range(count)]


def _look(
    sources: "Sequence[BoardSource]",
    cameras: "list[Camera]",
    boards: "list[Board]",
    progress: "ProgressBar",
) -> "list[list[CameraViews]]":
    from trecsim.calibrating.board_faults import why_no_board
    from trecsim.calibrating.views import look

    if len({source.video is None for source in sources}) > 1:
        raise ConfigError("give images of all cameras, or videos of all: moments must be matched")
    views = [
        [look(source, board, most=MOST_LOOKED_AT, progress=progress) for source in sources]
        for board in boards
    ]
    for number, (source, camera) in enumerate(zip(sources, cameras, strict=True)):
        if not any(of_board[number].views for of_board in views):
            raise CalibrationError(why_no_board(source, boards[0]))
        if views[0][number].size_px != camera.size_px:
            width, height = views[0][number].size_px
            raise CalibrationError(
                f"camera {camera.name!r}: its images are {width} x {height} px, its intrinsics are "
                f"for {camera.size_px[0]} x {camera.size_px[1]}; record both in the same mode"
            )
    return views


def _calibrate(
    sources: "Sequence[BoardSource]",
    cameras: "list[Camera]",
    boards: "list[Board]",
    views: "list[list[CameraViews]]",
    together: str,
    most_offset_s: float,
) -> "RigCalibration":
    from trecsim.calibrating.assembly import back_to_back, fixed_together
    from trecsim.calibrating.corner_sights import sights_of_images
    from trecsim.calibrating.rig_calibration import calibrate_rig, calibrate_timed_rig
    from trecsim.calibrating.rig_fit import BoardProblem

    fixed = back_to_back(boards[0]) if together == "back" else None
    sights, _ = sights_of_images(cameras, views, boards)
    if together == "found":
        fixed = fixed_together(boards, sights)
    if sources[0].video is None:
        return calibrate_rig(BoardProblem(tuple(cameras), tuple(boards), tuple(sights), fixed))
    return calibrate_timed_rig(
        cameras, boards, views, most_offset_s=most_offset_s, T_assembly_board=fixed
    )


def _facts(made: "RigCalibration") -> dict[str, Any]:
    check = made.check
    return {
        "moments": len({sight.moment for sight in made.fit.sights}),
        "sigma_px": made.fit.adjusted.sigma_px,
        "expected_error_m": check.error_m,
        "halves": {"rotation_deg": check.halves_deg, "position_m": check.halves_m},
        "held_out_px": {
            name: one.error_px for name, one in zip(made.rig.names, check.left_out, strict=True)
        },
        "worst": [
            {"camera": camera, "image": label, "error_px": error}
            for camera, label, error in made.worst_sights()
        ],
    }


def _line(made: "RigCalibration", number: int) -> str:
    quality = made.result.cameras[number]
    if quality.name not in made.rig:
        return f"{quality.name}: not placed"
    x, y, z = made.rig[quality.name].position_m
    late = f", clock {quality.time_offset_s:+.4f} s" if made.problem.timed else ""
    return (
        f"{quality.name}: at {x:.2f}, {y:.2f}, {z:.2f} m ± {1e3 * quality.position_sd_m:.1f} mm, "
        f"± {quality.rotation_sd_deg:.3f} degrees, error {quality.reprojection_px:.2f} px{late}"
    )
