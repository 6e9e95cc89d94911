"""Camera failures: outages, and cameras that are moved or do not look where the rig says."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.errors import InputError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import rotation_matrix

GOLDEN = 0.6180339887498949  # its multiples are spread evenly, whatever their number


@dataclass(frozen=True, slots=True)
class Outage:
    """Outage of a camera, for a while or for good."""

    camera: str
    from_s: float
    to_s: float = np.inf

    def __post_init__(self) -> None:
        if not 0 <= self.from_s < self.to_s:
            raise InputError(
                f"camera {self.camera!r}: an outage must end after it starts: "
                f"from {self.from_s:g} s, to {self.to_s:g} s"
            )

    def silent(self, t_s: Float64[np.ndarray, " time"]) -> Bool[np.ndarray, " time"]:
        """Return at which times nothing is delivered."""
        return (t_s >= self.from_s) & (t_s < self.to_s)


@dataclass(frozen=True, slots=True)
class Knock:
    """A camera is moved while the rig file stays as it was.

    Attributes
    ----------
    camera
        Its name.
    t_s
        Time of the move [s].
    turn_deg
        Rotation vector in the camera's frame: about x it looks up, about y to the right, about z
        its image turns counter-clockwise [degrees].
    shift_m
        Shift in the world [m].
    """

    camera: str
    t_s: float
    turn_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        values = np.array([self.t_s, *self.turn_deg, *self.shift_m])
        if not np.isfinite(values).all() or self.t_s < 0:
            raise InputError(f"a knock needs finite numbers and a time from 0, got {self}")

    def moved(self, camera: Camera) -> Camera:
        """Return the camera with its true pose after the move.

        Examples
        --------
        >>> from trecsim.lab.simulation.room import corner_rig
        >>> camera = corner_rig(8.0, 6.0, 2.7)["cam1"]
        >>> right = Knock("cam1", 5.0, turn_deg=(0.0, 10.0, 0.0)).moved(camera)
        >>> middle_m = np.array([0.0, 0.0, 1.0])
        >>> bool(right.project(middle_m)[0] < camera.project(middle_m)[0])
        True
        """
        turn = rotation_matrix(np.radians(np.array(self.turn_deg)))
        T_cam_world = camera.T_cam_world.copy()
        R = turn.T @ camera.T_cam_world[:3, :3]
        T_cam_world[:3, :3] = R
        T_cam_world[:3, 3] = -R @ (camera.position_m + self.shift_m)
        return replace(camera, T_cam_world=T_cam_world)


def turned(rig: Rig, angle_deg: float) -> tuple[Knock, ...]:
    """Return an error of the calibration: each camera is turned from where the rig has it.

    The angle is the same for all cameras [degrees], the axis differs: axes are spread evenly over
    all directions, so that the cameras contradict each other.

    Examples
    --------
    >>> from trecsim.lab.simulation.room import corner_rig
    >>> knocks = turned(corner_rig(8.0, 6.0, 2.7), 0.5)
    >>> [round(float(np.linalg.norm(knock.turn_deg)), 6) for knock in knocks]
    [0.5, 0.5, 0.5, 0.5]
    """
    if angle_deg == 0:
        return ()
    return tuple(
        Knock(camera.name, 0.0, turn_deg=_turn_deg(number, angle_deg))
        for number, camera in enumerate(rig)
    )


def _turn_deg(number: int, angle_deg: float) -> tuple[float, float, float]:
    along = 2.0 * ((number + 0.5) * GOLDEN % 1.0) - 1.0
    around = 2.0 * np.pi * (number * GOLDEN**2 % 1.0)
    across = np.sqrt(1.0 - along**2)
    x, y, z = angle_deg * np.array([across * np.cos(around), across * np.sin(around), along])
    return float(x), float(y), float(z)
