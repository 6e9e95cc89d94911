"""What the tracker has learnt of the cameras' errors, told once it is clear and lasts."""

import math
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from jaxtyping import Float64

# From here on a turn of the camera [rad] or a delay of its clock [s] is told, if it is as many
# standard deviations large; up to here, as larger turns are told for other reasons.
_TOLD_RAD, _MOST_RAD, _TOLD_S, _SIGMAS = math.radians(0.2), 0.03, 0.012, 5.0
_LASTS_S, _EVERY_S = 6.0, 0.5
_KNOWN_S, _CLEAR = 0.0045, 3.0  # a delay is known to so much, or as many standard deviations large


class CameraErrors(Protocol):
    """Errors of the cameras as the tracker learns them.

    Attributes
    ----------
    found, variance
        Turn as a rotation vector [rad] and delay of the clock [s] of each camera, and their
        variances.
    """

    found: Float64[np.ndarray, "cam 4"]
    variance: Float64[np.ndarray, "cam 4"]


@dataclass(slots=True)
class LearntErrors:
    """Watch what is learnt of turns and clocks; tell once per camera and kind.

    Attributes
    ----------
    names
        The cameras' names.
    """

    names: tuple[str, ...]
    _since_s: dict[tuple[str, str], float] = field(default_factory=dict, init=False)
    _said: set[tuple[str, str]] = field(default_factory=set, init=False)
    _looked_s: float = field(default=-math.inf, init=False)

    def observe(self, t_s: float, errors: CameraErrors) -> list[str]:
        """Return what is to be said at `t_s`: errors that have been clear for so long."""
        if 0.0 <= t_s - self._looked_s < _EVERY_S:
            return []
        self._looked_s = t_s
        found = dict(self._clear(errors))
        self._since_s = {key: min(self._since_s.get(key, t_s), t_s) for key in found}
        return self._told({k: v for k, v in found.items() if t_s - self._since_s[k] >= _LASTS_S})

    def end(self, errors: CameraErrors) -> list[str]:
        """Return what remains to be said at the end of a run: what is clear by then."""
        return self._told(dict(self._clear(errors)))

    def _told(self, found: dict[tuple[str, str], str]) -> list[str]:
        new = {key: text for key, text in found.items() if key not in self._said}
        self._said.update(new)
        return list(new.values())

    def _clear(self, errors: CameraErrors) -> list[tuple[tuple[str, str], str]]:
        turn_rad = np.hypot(errors.found[:, 0], errors.found[:, 1])
        turn_sigma = np.sqrt(errors.variance[:, :2].max(axis=1))
        delay_s, delay_sigma = errors.found[:, 3], np.sqrt(errors.variance[:, 3])
        found = []
        for c, name in enumerate(self.names):
            if _is_clear(turn_rad[c], turn_sigma[c], _TOLD_RAD) and turn_rad[c] < _MOST_RAD:
                found.append(((name, "turn"), _turned(name, float(turn_rad[c]))))
            if _is_clear(abs(delay_s[c]), delay_sigma[c], _TOLD_S):
                found.append(((name, "clock"), _late(name, float(delay_s[c]))))
        return found


def clock_delays_s(names: tuple[str, ...], errors: CameraErrors) -> dict[str, float]:
    """Return by how much the clock of each camera is late [s], of those for which it is known.

    Over time they tell a clock that drifts.
    """
    sigma_s = np.sqrt(errors.variance[:, 3])
    known = (sigma_s <= _KNOWN_S) | (np.abs(errors.found[:, 3]) >= _CLEAR * sigma_s)
    return {name: float(errors.found[c, 3]) for c, name in enumerate(names) if known[c]}


def _is_clear(size: float, sigma: float, least: float) -> bool:
    return bool(size >= least and size >= _SIGMAS * sigma)


def _turned(name: str, turn_rad: float) -> str:
    return (
        f"camera {name!r} seems to be turned by {math.degrees(turn_rad):.2g} degrees from where "
        "the rig says: the tracking takes that out, and states more uncertainty; calibrate it again"
    )


def _late(name: str, delay_s: float) -> str:
    late_ms = 1e3 * delay_s
    which = "late" if late_ms > 0 else "early"
    return (
        f"the clock of camera {name!r} seems to be {abs(late_ms):.0f} ms {which}: the tracking "
        f"takes that out; time_offset_s = {-1e-3 * late_ms:.3f} in its entry of the rig does so "
        "from the start"
    )
