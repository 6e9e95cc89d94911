"""The cameras of one site, in one world frame."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera


@dataclass(frozen=True, slots=True, eq=False)
class Rig:
    """Cameras that share one world frame: metres, z up, floor at z = 0.

    Attributes
    ----------
    cameras
        At least one, each with its own name.
    P
        Their projections ``K [R | t]`` for undistorted pixels, derived.

    Raises
    ------
    CalibrationError
        There is no camera, or two share a name.

    Examples
    --------
    >>> K = np.array([[500.0, 0, 320], [0, 500, 240], [0, 0, 1]])
    >>> rig = Rig((Camera("north", (640, 480), K, np.eye(4)),))
    >>> rig.names, len(rig), rig["north"].size_px
    (('north',), 1, (640, 480))
    """

    cameras: tuple[Camera, ...]
    P: Float64[np.ndarray, "cam 3 4"] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "cameras", tuple(self.cameras))
        if not self.cameras:
            raise CalibrationError("the rig has no camera; it needs at least one")
        twice = [name for name, count in Counter(self.names).items() if count > 1]
        if twice:
            raise CalibrationError(
                f"camera names must differ within a rig, but these stand more than once: "
                f"{', '.join(map(repr, twice))}"
            )
        P = np.stack([camera.P for camera in self.cameras])
        P.setflags(write=False)
        object.__setattr__(self, "P", P)

    def __repr__(self) -> str:
        return f"<Rig of {len(self)} {'camera' if len(self) == 1 else 'cameras'}: " + (
            f"{', '.join(self.names)}>"
        )

    @property
    def names(self) -> tuple[str, ...]:
        """The cameras' names, in order."""
        return tuple(camera.name for camera in self.cameras)

    def index(self, name: str) -> int:
        """Return the place of the camera called `name`.

        Raises
        ------
        CalibrationError
            There is no such camera.
        """
        if name not in self.names:
            known = ", ".join(self.names)
            raise CalibrationError(f"the rig has no camera {name!r}; it has: {known}")
        return self.names.index(name)

    def __getitem__(self, name: str) -> Camera:
        return self.cameras[self.index(name)]

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __iter__(self) -> Iterator[Camera]:
        return iter(self.cameras)

    def __len__(self) -> int:
        return len(self.cameras)
