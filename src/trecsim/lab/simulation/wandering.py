"""People who wander about a room, stop, avoid each other, come and go."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation.paths import FloorPath, through

TICK_S = 0.05
SLOWEST_MPS, FASTEST_MPS = 0.6, 1.5
ACCELERATION_MPS2 = 2.0
PERSONAL_M = 1.4  # distance within which others are avoided
APART_M = 0.75  # least distance between people
STOP_CHANCE = 0.35
DOORS = 12  # places at the walls where people come and go
LEAVING_S = 5.0  # time before leaving at which a person heads for a door


@dataclass(slots=True)
class _Crowd:
    """State of all people at one tick."""

    xy_m: Float64[np.ndarray, "person 2"]
    velocity_mps: Float64[np.ndarray, "person 2"]
    goal_m: Float64[np.ndarray, "person 2"]
    pace_mps: Float64[np.ndarray, " person"]
    wait_s: Float64[np.ndarray, " person"]


def wander(
    people: int, width_m: float, depth_m: float, seconds: float, rng: np.random.Generator
) -> tuple[FloorPath, ...]:
    """Return the paths of people who wander about a room centred at the origin.

    About half of them are there from the start; the others come in through doors in the walls,
    and every third one leaves before the end.
    """
    half_m = np.array([width_m, depth_m]) / 2
    enter_s, leave_s = _hours(people, seconds, rng)
    ticks_s = np.arange(int(np.ceil(seconds / TICK_S)) + 1) * TICK_S
    doors_m = _doors(half_m)
    crowd = _begin(people, half_m, enter_s, rng)
    track_m = np.empty((len(ticks_s), people, 2))
    here = np.zeros(people, dtype=bool)
    for tick, t_s in enumerate(ticks_s):
        for comer in np.flatnonzero((enter_s <= t_s) & ~here & (t_s > 0)):
            crowd.xy_m[comer] = _clearest(doors_m, crowd.xy_m[here])
            crowd.velocity_mps[comer] = 0.0
        here = (enter_s <= t_s) & (t_s <= leave_s)
        _choose_goals(crowd, half_m, doors_m, leave_s - t_s, rng)
        _advance(crowd, here, half_m)
        track_m[tick] = crowd.xy_m
    paths = []
    for person in range(people):
        known = (ticks_s >= enter_s[person]) & (ticks_s <= leave_s[person])
        paths.append(through(ticks_s[known], track_m[known, person]))
    return tuple(paths)


def _hours(
    people: int, seconds: float, rng: np.random.Generator
) -> tuple[Float64[np.ndarray, " person"], Float64[np.ndarray, " person"]]:
    """Return when each person comes and goes [s]; infinite for people who stay."""
    order = np.arange(people)
    late = order >= (people + 1) // 2
    enter_s = np.where(late, rng.uniform(0.1, 0.35, people) * seconds, 0.0)
    early = (order % 3 == 2) & (seconds > 2 * LEAVING_S)
    leave_s = np.where(early, rng.uniform(0.75, 0.95, people) * seconds, np.inf)
    enter_s = np.round(enter_s / TICK_S) * TICK_S
    return enter_s, leave_s


def _doors(half_m: Float64[np.ndarray, " 2"]) -> Float64[np.ndarray, "door 2"]:
    angle = (np.arange(DOORS) + 0.5) * 2 * np.pi / DOORS
    round_m = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    doors_m: Float64[np.ndarray, "door 2"] = (
        round_m / np.abs(round_m).max(axis=1, keepdims=True) * half_m
    )
    return doors_m


def _begin(
    people: int,
    half_m: Float64[np.ndarray, " 2"],
    enter_s: Float64[np.ndarray, " person"],
    rng: np.random.Generator,
) -> _Crowd:
    xy_m = np.full((people, 2), np.inf)
    for person in np.flatnonzero(enter_s <= 0):
        places_m = rng.uniform(-0.8, 0.8, (40, 2)) * half_m
        xy_m[person] = _clearest(places_m, xy_m[:person])
    return _Crowd(
        xy_m=np.where(np.isfinite(xy_m), xy_m, 0.0),
        velocity_mps=np.zeros((people, 2)),
        goal_m=rng.uniform(-0.8, 0.8, (people, 2)) * half_m,
        pace_mps=rng.uniform(SLOWEST_MPS + 0.1, FASTEST_MPS, people),
        wait_s=np.zeros(people),
    )


def _clearest(
    places_m: Float64[np.ndarray, "place 2"], others_m: Float64[np.ndarray, "person 2"]
) -> Float64[np.ndarray, " 2"]:
    """Return the place with the most free space."""
    gap_m = np.linalg.norm(places_m[:, None] - others_m[None], axis=2).min(axis=1, initial=np.inf)
    clearest_m: Float64[np.ndarray, " 2"] = places_m[np.argmax(gap_m)]
    return clearest_m


def _choose_goals(
    crowd: _Crowd,
    half_m: Float64[np.ndarray, " 2"],
    doors_m: Float64[np.ndarray, "door 2"],
    left_s: Float64[np.ndarray, " person"],
    rng: np.random.Generator,
) -> None:
    """Give a new goal to people who have arrived; some stand for a while first."""
    there = np.linalg.norm(crowd.goal_m - crowd.xy_m, axis=1) < 0.5
    people = len(crowd.wait_s)
    stops = there & (rng.uniform(size=people) < STOP_CHANCE)
    crowd.wait_s = np.where(stops, rng.uniform(1.0, 3.0, people), crowd.wait_s - TICK_S)
    goal_m = rng.uniform(-0.85, 0.85, (people, 2)) * half_m
    crowd.goal_m = np.where(there[:, None], goal_m, crowd.goal_m)
    for person in np.flatnonzero((left_s < LEAVING_S) & (left_s > 0)):
        nearest = np.argmin(np.linalg.norm(doors_m - crowd.xy_m[person], axis=1))
        crowd.goal_m[person], crowd.wait_s[person] = doors_m[nearest], 0.0


def _advance(crowd: _Crowd, here: np.ndarray, half_m: Float64[np.ndarray, " 2"]) -> None:
    """Move the people present by one tick, towards their goals and around each other."""
    towards_m = crowd.goal_m - crowd.xy_m
    distance_m = np.linalg.norm(towards_m, axis=1, keepdims=True)
    pace_mps = crowd.pace_mps[:, None] * np.minimum(distance_m / 0.6, 1.0)
    pace_mps = np.where(crowd.wait_s[:, None] > 0, 0.0, pace_mps)
    wish_mps = towards_m / np.maximum(distance_m, 1e-9) * pace_mps + _avoidance(crowd, here)
    change = np.clip(wish_mps - crowd.velocity_mps, -ACCELERATION_MPS2, ACCELERATION_MPS2)
    velocity_mps = crowd.velocity_mps + change * 2 * TICK_S
    speed_mps = np.linalg.norm(velocity_mps, axis=1, keepdims=True)
    velocity_mps *= np.minimum(1.0, FASTEST_MPS / np.maximum(speed_mps, 1e-9))
    moved_m = np.where(here[:, None], crowd.xy_m + velocity_mps * TICK_S, crowd.xy_m)
    moved_m = np.clip(_keep_apart(moved_m, here), -half_m, half_m)
    crowd.velocity_mps, crowd.xy_m = velocity_mps, moved_m


def _avoidance(crowd: _Crowd, here: np.ndarray) -> Float64[np.ndarray, "person 2"]:
    """Return the avoidance velocity [m/s]: back, and to the right."""
    away_m = crowd.xy_m[:, None] - crowd.xy_m[None]
    distance_m = np.linalg.norm(away_m, axis=2)
    near = (distance_m < PERSONAL_M) & here[:, None] & here[None] & (distance_m > 0)
    push = np.where(near, 2.0 * (PERSONAL_M - distance_m) / np.maximum(distance_m, 0.1), 0.0)
    back: Float64[np.ndarray, "person 2"] = (push[..., None] * away_m).sum(axis=1)
    return back + 0.6 * np.stack((-back[:, 1], back[:, 0]), axis=1)


def _keep_apart(xy_m: Float64[np.ndarray, "person 2"], here: np.ndarray) -> np.ndarray:
    """Separate pairs that are too close, half each, in a few iterations."""
    for _ in range(3):
        away_m = xy_m[:, None] - xy_m[None]
        distance_m = np.linalg.norm(away_m, axis=2)
        close = (distance_m < APART_M) & here[:, None] & here[None] & (distance_m > 1e-6)
        if not close.any():
            break
        share = np.where(close, (APART_M - distance_m) / np.maximum(distance_m, 1e-6) / 2, 0.0)
        xy_m = xy_m + (share[..., None] * away_m).sum(axis=1)
    return xy_m
