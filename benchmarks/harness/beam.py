"""Corners of the beam in the sample recording's scene, clicked by hand: what no fit ever saw."""

import numpy as np

from trecsim.geometry import Rig, triangulate

# Two corners at each end of the beam, in the pictures of SinglePerson/extrinsics, to about 2 px.
CORNERS_PX: tuple[dict[str, tuple[float, float]], ...] = (
    {"cam01": (718.0, 1461.0), "cam02": (462.6, 1334.0), "cam04": (731.0, 962.4)},
    {
        "cam01": (727.0, 1457.0), "cam02": (475.0, 1334.0),
        "cam03": (221.0, 1073.6), "cam04": (722.0, 961.0),
    },
    {
        "cam01": (226.3, 952.4), "cam02": (616.0, 980.0),
        "cam03": (923.0, 1381.6), "cam04": (534.6, 1585.0),
    },
    {
        "cam01": (233.0, 950.8), "cam02": (623.0, 980.0),
        "cam03": (920.0, 1385.8), "cam04": (522.6, 1583.0),
    },
)  # fmt: skip


def beam_px(rig: Rig) -> dict[str, float]:
    """Return how far the corners are from where the other cameras place them, by camera [px]."""
    off: dict[str, list[float]] = {name: [] for name in rig.names}
    for corner in CORNERS_PX:
        for name, clicked in corner.items():
            used = [other for other in corner if other != name]
            ideal = np.array([rig[other].undistort(np.array([corner[other]])) for other in used])
            P = np.array([rig.P[rig.index(other)] for other in used])
            xyz_m, _ = triangulate(P, ideal)
            shown = rig[name].project(xyz_m)[0]
            off[name].append(float(np.linalg.norm(shown - np.array(clicked))))
    return {name: float(np.mean(each)) for name, each in off.items()}
