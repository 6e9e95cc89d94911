"""What is estimated of each camera: pose, clock, and corrections of its intrinsics."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64


@dataclass(frozen=True, slots=True, eq=False)
class RigState:
    """Poses, clocks and lenses of all cameras.

    Attributes
    ----------
    T
        `T_cam_world` of each camera [m].
    clock
        What is added to a camera's stamps [s], and by how much its clock is slow.
    lens
        Change of the focal length, as a share of it, and of the principal point, over it.
    ref_s
        The stamp from which on the clock's drift counts [s].
    found
        Which cameras are known.
    """

    T: Float64[np.ndarray, "cam 4 4"]
    clock: Float64[np.ndarray, "cam 2"]
    lens: Float64[np.ndarray, "cam 3"]
    ref_s: Float64[np.ndarray, " cam"]
    found: Bool[np.ndarray, " cam"]

    @classmethod
    def empty(cls, cameras: int) -> "RigState":
        """Return a state of which nothing is known."""
        return cls(
            np.tile(np.eye(4), (cameras, 1, 1)),
            np.zeros((cameras, 2)),
            np.zeros((cameras, 3)),
            np.zeros(cameras),
            np.zeros(cameras, dtype=bool),
        )

    def copy(self) -> "RigState":
        """Return a state that shares no array with this one."""
        return replace(
            self, T=self.T.copy(), clock=self.clock.copy(), lens=self.lens.copy(),
            ref_s=self.ref_s.copy(), found=self.found.copy(),
        )  # fmt: skip

    @property
    def centre_m(self) -> Float64[np.ndarray, "cam 3"]:
        """Where each camera stands [m]."""
        centre: Float64[np.ndarray, "cam 3"] = -np.einsum(
            "cji,cj->ci", self.T[:, :3, :3], self.T[:, :3, 3]
        )
        return centre

    def time_s(self, camera: int, stamp_s: Float64[np.ndarray, "*n"]) -> Float64[np.ndarray, "*n"]:
        """Return the common time at stamps of a camera [s]."""
        offset, drift = self.clock[camera]
        return np.asarray(stamp_s + offset + drift * (stamp_s - self.ref_s[camera]))

    def stamp_s(self, camera: int, time_s: Float64[np.ndarray, "*n"]) -> Float64[np.ndarray, "*n"]:
        """Return the stamps of a camera at common times [s]."""
        offset, drift = self.clock[camera]
        return np.asarray((time_s - offset + drift * self.ref_s[camera]) / (1.0 + drift))

    def referred(self, ref_s: Float64[np.ndarray, " cam"]) -> "RigState":
        """Return the same clocks with the drift counted from other stamps."""
        moved = self.copy()
        moved.clock[:, 0] += self.clock[:, 1] * (ref_s - self.ref_s)
        return replace(moved, ref_s=ref_s.copy())
