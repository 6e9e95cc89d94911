"""Standing, walking, running and turning, one after the other, feet side by side at both ends."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation.actions import Run, Stand, Turn, Walk
from trecsim.lab.simulation.body_shape import Body
from trecsim.lab.simulation.frame_times import even
from trecsim.lab.simulation.locomotion import (
    Segment,
    end_of,
    path_along,
    segments_along,
    shortest,
    stay,
    turned,
)
from trecsim.lab.simulation.paths import STEP_S
from trecsim.lab.simulation.rotations import Place
from trecsim.lab.simulation.walkers import MID_STANCE, Walker, cadence_hz, stepping

OnFoot = Stand | Turn | Walk | Run

SETTLE_S = 0.4  # rest at both ends, before the next action
NEUTRAL = 0.02  # phase at which both feet stand, and half a stride later
TREAD_VIGOUR = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """Motion on foot over a while, and the place at its end."""

    walker: Walker
    seconds: float
    end: Place


def on_foot(
    body: Body,
    place: Place,
    actions: Sequence[OnFoot],
    start_s: float,
    style: float,
    *,
    comes: bool = False,
    goes: bool = False,
) -> Stretch:
    """Return the motion of these actions on foot; consecutive paths have no stop between them.

    `comes` and `goes` say whether the person is already walking at the start, still at the end.
    """
    segments = [] if comes else [stay(place, _rest_s(actions))]
    groups = _groups(actions)
    for number, group in enumerate(groups):
        first, last = number == 0, number == len(groups) - 1
        segments += _segments(place, group, comes and first, goes and last)
        place = end_of(segments, place)
    if not goes:
        segments.append(stay(place, _rest_s(actions[::-1])))
    path = path_along(segments, start_s, comes, goes)
    rate_hz = cadence_hz(body, path)
    phase, treading = strides(rate_hz, segments, MID_STANCE, comes=comes, goes=goes)
    seconds = path.leave_s - path.enter_s
    return Stretch(stepping(body, path, phase, style, treading), seconds, place)


def standing(body: Body, place: Place, style: float, start_s: float, seconds: float) -> Walker:
    """Return the motion of standing at a place, feet side by side."""
    path = path_along([stay(place, max(seconds, 0.1))], start_s, False, False)
    return stepping(body, path, np.full(len(path.t_s), NEUTRAL), style)


def _rest_s(actions: Sequence[OnFoot]) -> float:
    """Return the rest before these actions [s]; standing needs none."""
    first = actions[0]
    return max(SETTLE_S - first.seconds, 0.0) if isinstance(first, Stand) else SETTLE_S


def _groups(actions: Sequence[OnFoot]) -> list[list[OnFoot]]:
    """Return the actions with consecutive paths grouped."""
    groups: list[list[OnFoot]] = []
    for action in actions:
        goes_on = isinstance(action, Walk | Run)
        if goes_on and groups and isinstance(groups[-1][-1], Walk | Run):
            groups[-1].append(action)
        else:
            groups.append([action])
    return groups


def _segments(place: Place, group: list[OnFoot], comes: bool, goes: bool) -> list[Segment]:
    """Return the segments of a group of actions from this place on."""
    first = group[0]
    if isinstance(first, Stand):
        return [stay(place, first.seconds)]
    if isinstance(first, Turn):
        return [turned(place, turn_rad(first, place), radians(first.speed_degps))]
    legs = [(action.to_m, action.speed_mps) for action in group if isinstance(action, Walk | Run)]
    return segments_along(place, legs, comes=comes, goes=goes)


def turn_rad(turn: Turn, place: Place) -> float:
    """Return the angle of a turn at this place, counter-clockwise [rad]."""
    if turn.by_deg is not None:
        return radians(turn.by_deg)
    return shortest(radians(turn.to_deg or 0.0) - place.heading_rad)


def strides(
    rate_hz: Float64[np.ndarray, " step"],
    segments: Sequence[Segment],
    mid_stance: float,
    *,
    comes: bool = False,
    goes: bool = False,
) -> tuple[Float64[np.ndarray, " step"], Float64[np.ndarray, " step"]]:
    """Return the phase over time, and the vigour of steps made while the body rests.

    Parameters
    ----------
    rate_hz
        Strides per second along the path, one entry per time.
    segments
        Segments of the path.
    mid_stance
        Share of a stride at which the body passes over a foot.
    comes, goes
        Whether the person is already moving at the start, still moving at the end.

    Notes
    -----
    A foot is planted where the body will pass over it. So the first step must begin before the
    body moves, and after it stopped the phase must go on until both feet were planted anew; both
    together take half a stride. What the way itself takes is rounded to half strides.
    """
    rate_hz, treading = rate_hz.copy(), np.zeros(len(rate_hz))
    lead = mid_stance - NEUTRAL
    at = (len(rate_hz) - sum(len(segment.xy_m) for segment in segments)) // 2
    rate_hz[: 0 if comes else at] = 0.0
    for number, segment in enumerate(segments):
        first, last = number == 0, number == len(segments) - 1
        end = at + len(segment.xy_m)
        rate_hz[at:end] *= (np.arange(at, end) >= at + segment.lead) * (
            np.arange(at, end) < at + segment.close
        )
        if segment.close and not (comes and first) and not (goes and last):
            made = float(rate_hz[at:end].sum()) * STEP_S
            rate_hz[at:end] *= max(round(2 * made), 1) / 2 / made
        steps = [(at, at + segment.lead, lead), (at + segment.close, end, 0.5 - lead)]
        for begin, stop, more in steps:
            if segment.close and stop > begin + 1:
                share = np.linspace(0.0, 1.0, stop - begin + 1)
                rate_hz[begin:stop] += more * np.diff(even(share)) / STEP_S
                treading[begin:stop] = TREAD_VIGOUR
        at = end
    rate_hz[len(rate_hz) if goes else at :] = 0.0
    phase = np.cumsum(rate_hz) * STEP_S
    return phase + NEUTRAL - (phase[-1] % 0.5 if comes and not goes else 0.0), treading
