"""Sections on a rig from boards: pairs of cameras, cameras left out, pictures."""

from collections.abc import Sequence

import numpy as np

from trecsim.calibrating.board_images import BoardSource
from trecsim.calibrating.corners import SeenBoard
from trecsim.calibrating.rig_calibration import RigCalibration
from trecsim.calibrating.views import View
from trecsim.lab.report.board_section import corner_pictures
from trecsim.lab.report.page import Block, Pictures, Section, Table

PICTURES = 3  # of each camera


def rig_sections(made: RigCalibration, sources: Sequence[BoardSource]) -> list[Section]:
    """Return what belongs to a rig from boards, beyond what all calibrations have."""
    return [_left_out(made), _pairs(made), _pictures(made, sources)]


def _left_out(made: RigCalibration) -> Section:
    rows = [
        (name, f"{one.error_px:.2f}", f"{one.times:.1f}")
        for name, one in zip(made.rig.names, made.check.left_out, strict=True)
    ]
    caption = (
        "Where a board appears in a camera when only the others place it: root mean square "
        "distance, and how many times what the noise of corners explains."
    )
    lead = "Each camera left out in turn."
    table = Table(("camera", "error px", "times the noise"), rows, caption)
    return Section("Cameras left out", [table], lead)


def _pairs(made: RigCalibration) -> Section:
    names = [camera.name for camera in made.problem.cameras]
    rows = [
        (names[link.first], names[link.second], str(link.moments), str(link.agreeing))
        for link in made.links.links
    ]
    caption = (
        "Moments in which both saw a board, and how many of them agree on how the cameras stand "
        "to each other."
    )
    table = Table(("camera", "camera", "moments", "agreeing"), rows, caption,
                  ("left", "left", "right", "right"))  # fmt: skip
    return Section("Pairs of cameras", [table])


def _pictures(made: RigCalibration, sources: Sequence[BoardSource]) -> Section:
    errors = made.sight_errors_px()
    blocks: list[Block] = []
    for number, source in enumerate(sources):
        own = [n for n, sight in enumerate(made.fit.sights) if sight.camera == number]
        order = sorted(own, key=lambda n: -errors[n])
        wanted = []
        for n in [*order[:1], *order[1 :: max(len(order) // PICTURES, 1)]][:PICTURES]:
            sight = made.fit.sights[n]
            seen = SeenBoard(sight.ids, sight.xy_px, float("nan"))
            view = View(sight.label, sight.moment, float("nan"), seen)
            wanted.append((view, f"{source.camera}, error {errors[n]:.2f} px"))
        blocks.append(Pictures(corner_pictures(source, wanted)))
    worst = made.worst_sights()
    if worst:
        rows = [(camera, label, f"{error:.1f}") for camera, label, error in worst[:20]]
        caption = "Pictures that fit far worse than the others; they counted less."
        blocks.insert(0, Table(("camera", "picture", "error px"), rows, caption,
                               ("left", "left", "right")))  # fmt: skip
    typical = float(np.median(errors)) if len(errors) else float("nan")
    return Section("Pictures", blocks, f"The typical error of a picture is {typical:.2f} px.")
