"""The command `trecsim calibrate rig`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from trecsim.cli.board_options import BoardOptions
from trecsim.cli.terminal import finish, note, progress_bar
from trecsim.errors import CalibrationError, ConfigError

if TYPE_CHECKING:
    from trecsim.calibrating.board_images import BoardSource
    from trecsim.calibrating.boards import Board
    from trecsim.calibrating.rig_calibration import RigCalibration
    from trecsim.geometry.camera import Camera


def rig(
    *images: str,
    intrinsics: Path,
    out: Path,
    board: Annotated[BoardOptions, Parameter(name="*")],
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
    report
        The report to write (default: beside the rig file, `*.html`).
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.board_images import board_sources
    from trecsim.calibration import read_intrinsics, write_rig
    from trecsim.lab.report.calibration_page import write_calibration_report
    from trecsim.lab.report.rig_section import rig_sections

    wanted = board.read()
    sources = board_sources(images)
    known = read_intrinsics(intrinsics)
    cameras = [_camera(known, source, intrinsics) for source in sources]
    if len(cameras) < 2:
        raise ConfigError("give two or more cameras as NAME=IMAGES_OR_VIDEO; one alone has no rig")
    with progress_bar("images", quiet=json) as bar:
        made = _calibrate(sources, cameras, [wanted], bar)
    write_rig(made.rig, out, format="trecsim")
    page = report or out.with_suffix(".html")
    write_calibration_report(
        page,
        "Rig",
        made.result,
        rig=made.rig,
        covariance=made.covariance,
        sections=rig_sections(made, sources),
        source=str(wanted),
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


def _calibrate(
    sources: Any, cameras: list["Camera"], boards: list["Board"], progress: Any
) -> "RigCalibration":
    from trecsim.calibrating.board_faults import why_no_board
    from trecsim.calibrating.rig_calibration import calibrate_rig
    from trecsim.calibrating.rig_fit import BoardProblem
    from trecsim.calibrating.sights import sights_of_images
    from trecsim.calibrating.views import look

    views = []
    for board in boards:
        of_board = [look(source, board, progress=progress) for source in sources]
        views.append(of_board)
    for number, (source, camera) in enumerate(zip(sources, cameras, strict=True)):
        if not any(of_board[number].views for of_board in views):
            raise CalibrationError(why_no_board(source, boards[0]))
        if views[0][number].size_px != camera.size_px:
            width, height = views[0][number].size_px
            raise CalibrationError(
                f"camera {camera.name!r}: its images are {width} x {height} px, its intrinsics are "
                f"for {camera.size_px[0]} x {camera.size_px[1]}; record both in the same mode"
            )
    sights, _ = sights_of_images(cameras, views, boards)
    problem = BoardProblem(tuple(cameras), tuple(boards), tuple(sights))
    return calibrate_rig(problem)


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
    return (
        f"{quality.name}: at {x:.2f}, {y:.2f}, {z:.2f} m ± {1e3 * quality.position_sd_m:.1f} mm, "
        f"± {quality.rotation_sd_deg:.3f} degrees, error {quality.reprojection_px:.2f} px"
    )
