"""What is known of the cameras beside what they see: distances, clocks, lenses, old poses."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.calibrating.people.kernels.unknowns import Unknowns
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tuning import DRIFT_LOOSE, OFFSET_LOOSE_S
from trecsim.geometry.rigid import rotation_vector

TIGHT_M, TIGHT_RAD = 1e-5, 1e-6
WITHOUT_LENS, WITH_LENS = 8, 11


@dataclass(frozen=True, slots=True, eq=False)
class Distance:
    """The distance of two cameras, and how well it is known [m]."""

    a: int
    b: int
    metres: float
    sd_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Upright:
    """The vertical in the root camera, and how well it is known [rad]."""

    up: Float64[np.ndarray, " 3"]
    sd_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Priors:
    """What is known of the cameras.

    Attributes
    ----------
    root
        The camera whose position, heading and clock fix the frame.
    distances
        Known distances of cameras; one of them fixes the scale.
    found
        Which cameras are adjusted; the others stay.
    lens_sd
        Standard deviation of the focal length, as a share, and of the principal point, over it;
        None keeps all intrinsics.
    pose
        `T_cam_world` of each camera as it was, with `pose_sd`: of its turn [rad] and shift [m].
    firm
        Which cameras are drawn to their old pose the more, the further off they are; the others by
        a constant force.
    clock_sd
        Standard deviations of offset [s] and drift.
    upright
        The vertical, where the heights of joints do not determine it.
    """

    root: int
    distances: tuple[Distance, ...]
    found: Bool[np.ndarray, " cam"]
    lens_sd: Float64[np.ndarray, "cam 3"] | None = None
    pose: Float64[np.ndarray, "cam 4 4"] | None = None
    pose_sd: Float64[np.ndarray, "cam 2"] | None = None
    firm: Bool[np.ndarray, " cam"] | None = None
    clock_sd: tuple[float, float] = (OFFSET_LOOSE_S, DRIFT_LOOSE)
    upright: Upright | None = None

    @property
    def own(self) -> int:
        """How many unknowns each camera has."""
        return WITHOUT_LENS if self.lens_sd is None else WITH_LENS

    def cost(self, now: Unknowns, state: RigState) -> float:
        """Return the cost of a state."""
        total = sum(float(((off / sd) ** 2).sum()) for off, sd, _ in self._terms(now, state))
        if self.pose is None:
            return total
        for c in np.flatnonzero(self._loose):  # of what `_as_before` weighs down
            square = self._strayed(now, int(c))
            total += 2.0 * (np.sqrt(1.0 + square) - 1.0) - square / np.sqrt(1.0 + square)
        return total

    def add(
        self,
        now: Unknowns,
        state: RigState,
        normal: Float64[np.ndarray, "all all"],
        right: Float64[np.ndarray, " all"],
    ) -> None:
        """Add the equations, in place."""
        for off, sd, J in self._terms(now, state):
            weighed = J / sd[:, None] ** 2
            normal += weighed.T @ J
            right += weighed.T @ off

    def _terms(
        self, now: Unknowns, state: RigState
    ) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Return residuals, their standard deviations and their derivatives."""
        n = len(now.T)
        terms = []
        for c in range(n):
            if not self.found[c]:
                terms.append(self._selected(n, c, np.zeros(self.own), slice(0, self.own), 1e-6))
                continue
            drift = state.clock[c, 1] + now.clock[c, 1]
            sd = (1e-6, 1e-9) if c == self.root else self.clock_sd
            offset = now.clock[c, 0] if c == self.root else 0.0
            terms.append(self._selected(n, c, np.array([-offset]), slice(6, 7), sd[0]))
            terms.append(self._selected(n, c, np.array([-drift]), slice(7, 8), sd[1]))
            if self.lens_sd is not None:
                off, _, J = self._selected(n, c, -now.lens[c], slice(8, 11), 1.0)
                terms.append((off, self.lens_sd[c], J))
        terms += self._gauge(now) if self.pose is None else self._as_before(now)
        terms += [self._apart(now, one) for one in self.distances]
        if self.upright is not None:
            terms.append(self._stood(now, self.upright))
        return terms

    def _selected(
        self, n: int, c: int, off: np.ndarray, which: slice, sd: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        J = np.zeros((len(off), n * self.own))
        J[np.arange(len(off)), c * self.own + np.arange(which.start, which.stop)] = 1.0
        return off, np.full(len(off), sd), J

    def _gauge(self, now: Unknowns) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Keep the root where it is, and its heading."""
        n, at = len(now.T), self.root * self.own
        J = np.zeros((4, n * self.own))
        J[:3, at + 3 : at + 6] = np.eye(3)
        J[3, at : at + 3] = now.T[self.root, :3, 2]  # turn about the vertical
        return [(np.zeros(4), np.array([TIGHT_M] * 3 + [TIGHT_RAD]), J)]

    def _as_before(self, now: Unknowns) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Draw each camera towards its old pose, far off by a constant force; keep the scale.

        Notes
        -----
        As under an L1 norm, one camera that was moved is preferred to small moves of all others.
        The scale is that of the old rig: errors are measured in metres, and would shrink with it.
        """
        assert self.pose_sd is not None
        terms = [self._spread(now)]
        for c in np.flatnonzero(self.found):
            off, sd = self._off(now, int(c))
            _, _, J = self._selected(len(now.T), int(c), off, slice(0, 6), 1.0)
            far = (1.0 + self._strayed(now, int(c))) ** 0.25 if self._loose[c] else 1.0
            terms.append((off, sd * far, J))
        return terms

    @property
    def _loose(self) -> Bool[np.ndarray, " cam"]:
        """Which cameras are drawn to their old pose by a constant force."""
        return self.found if self.firm is None else self.found & ~self.firm

    def _off(self, now: Unknowns, c: int) -> tuple[np.ndarray, np.ndarray]:
        """Return how far a camera is to go to be at its old pose, and standard deviations."""
        assert self.pose is not None
        assert self.pose_sd is not None
        turn, shift = pose_change(self.pose[c], now.T[c])
        return -np.concatenate((turn, shift)), np.repeat(self.pose_sd[c], 3)

    def _strayed(self, now: Unknowns, c: int) -> float:
        """Return the square of how far a camera is from its old pose, in standard deviations."""
        off, sd = self._off(now, c)
        return float(((off / sd) ** 2).sum())

    def _spread(self, now: Unknowns) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Keep the size of the rig: the root mean square distance of cameras from their middle."""
        assert self.pose is not None
        which = np.flatnonzero(self.found)
        R, t = now.T[which, :3, :3], now.T[which, :3, 3]
        centre = -np.einsum("cji,cj->ci", R, t)
        before = -np.einsum("cji,cj->ci", self.pose[which, :3, :3], self.pose[which, :3, 3])
        out, out_before = centre - centre.mean(axis=0), before - before.mean(axis=0)
        size, size_before = np.linalg.norm(out), np.linalg.norm(out_before)
        J = np.zeros((1, len(now.T) * self.own))
        for i, c in enumerate(which):
            J[0, c * self.own + 3 : c * self.own + 6] = -R[i] @ out[i] / size
        return np.array([size_before - size]), np.array([1e-4 * size_before]), J

    def _apart(self, now: Unknowns, one: Distance) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Pin the distance of two cameras."""
        R_a, R_b = now.T[one.a, :3, :3], now.T[one.b, :3, :3]
        apart = -R_a.T @ now.T[one.a, :3, 3] + R_b.T @ now.T[one.b, :3, 3]
        length = float(np.linalg.norm(apart))
        J = np.zeros((1, len(now.T) * self.own))
        J[0, one.a * self.own + 3 : one.a * self.own + 6] = -R_a @ apart / length
        J[0, one.b * self.own + 3 : one.b * self.own + 6] = R_b @ apart / length
        return np.array([one.metres - length]), np.array([one.sd_m]), J

    def _stood(self, now: Unknowns, known: Upright) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return residual, standard deviation and derivatives of the vertical."""
        at, up = self.root * self.own, now.T[self.root, :3, 2]
        J = np.zeros((3, len(now.T) * self.own))
        J[:, at : at + 3] = -np.cross(np.eye(3), up)  # a turn w moves the vertical by w x up
        return known.up - up, np.full(3, known.sd_rad), J

    def with_distance(self, one: Distance) -> "Priors":
        """Return the priors with one known distance only."""
        return replace(self, distances=(one,))


def pose_change(
    before: Float64[np.ndarray, "4 4"], after: Float64[np.ndarray, "4 4"]
) -> tuple[Float64[np.ndarray, " 3"], Float64[np.ndarray, " 3"]]:
    """Return turn [rad] and shift [m], in the camera's axes, that lead from a pose to another."""
    turn = after[:3, :3] @ before[:3, :3].T
    return rotation_vector(turn), after[:3, 3] - turn @ before[:3, 3]
