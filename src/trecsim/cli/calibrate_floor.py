"""The command `trecsim calibrate floor`."""

from pathlib import Path

from trecsim.cli.board_options import BoardOptions
from trecsim.cli.calibration_files import report_of
from trecsim.cli.terminal import finish, note
from trecsim.errors import ConfigError


def floor(
    rig: Path,
    /,
    *images: str,
    out: Path,
    board: str | None = None,
    square_m: float | None = None,
    charuco: str | None = None,
    marker_share: float = 0.75,
    board_height_m: float = 0.0,
    point: tuple[str, ...] = (),
    points: Path | None = None,
    fix_scale: bool = False,
    report: Path | None = None,
    json: bool = False,
) -> None:
    """Put a rig on its floor, with origin and heading, by a board or known points.

    Either a board that lies on the floor, in one image of each camera that sees it; its first
    corner becomes the origin and its rows the x axis. Or points whose places are known. The whole
    rig is moved as one; how the cameras stand to each other does not change.

    Parameters
    ----------
    rig
        A rig file, in any format that is read.
    images
        NAME=IMAGE for each camera that sees the board, all of the same moment.
    out
        The rig file to write, `*.toml`; may be the same.
    board
        Inner corners of the board on the floor, COLSxROWS.
    square_m
        Side of a square [m].
    charuco
        The board is a ChArUco board with markers of this dictionary, such as 5x5_250.
    marker_share
        Side of a marker of a ChArUco board, as a share of the side of a square.
    board_height_m
        How high the printed side lies above the floor [m].
    point
        A known place, NAME:X,Y=X_M,Y_M[,Z_M]: the camera, the pixel, and the place in metres;
        z is 0 where left out. Three or more, not on one line.
    points
        Known places as a table: a CSV file with the columns camera,x_px,y_px,x_m,y_m,z_m.
    fix_scale
        Scale the rig to the distances between the points, or to the squares of the board.
    report
        The report to write (default: beside the rig file, `*.html`).
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.board_images import board_sources
    from trecsim.calibrating.floor_calibration import put_on_marks
    from trecsim.calibrating.floor_marks import marks_of_board, marks_of_points
    from trecsim.calibration import read_rig, write_rig
    from trecsim.lab.report.calibration_page import write_calibration_report

    page = report_of(out, report)
    found = read_rig(rig, remark=lambda _: None)
    if bool(images) == bool(point or points):
        raise ConfigError(
            "give either NAME=IMAGE of a board on the floor with --board and --square-m, or "
            "places with --point or --points"
        )
    if images:
        if board is None or square_m is None:
            raise ConfigError("a board on the floor needs --board COLSxROWS and --square-m")
        options = BoardOptions(
            board=board, square_m=square_m, charuco=charuco, marker_share=marker_share
        )
        marks = marks_of_board(found, board_sources(images), options.read(), board_height_m)
    else:
        marks = marks_of_points(found, point, points)
    made = put_on_marks(found, marks, fix_scale=fix_scale)
    result = made.result
    write_rig(made.rig, out, format="trecsim")
    write_calibration_report(page, "Floor", result, source=str(rig))
    summary = {
        **result.summary(),
        "tilt_sd_deg": made.tilt_sd_deg,
        "height_sd_m": made.height_sd_m,
        "scale": made.scale,
        "out": out,
        "report": page,
    }
    lines = [
        f"{camera.name}: at {x:.2f}, {y:.2f}, {z:.2f} m"
        for camera in made.rig
        for x, y, z in [camera.position_m]
    ]
    lines += [f"{result.verdict}: {result.reasons[0]}", f"{out}, and the report: {page}"]
    if result.verdict == "wrong":
        note(f"{out} is written, but do not use it: {result.reasons[0]}")
    finish(summary, json, "\n".join(lines))
