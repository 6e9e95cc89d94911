"""The people of a scene: with a script, wandering about, or both."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from trecsim.errors import InputError
from trecsim.lab.simulation.actions import Clip
from trecsim.lab.simulation.body_shape import Body, bodies, body
from trecsim.lab.simulation.paths import FloorPath
from trecsim.lab.simulation.roles import Role
from trecsim.lab.simulation.sampled import sampled
from trecsim.lab.simulation.walkers import Motion, walker
from trecsim.lab.simulation.wandering import wander


@dataclass(frozen=True, slots=True, eq=False)
class Person:
    """One person of a scene."""

    stature_m: float
    motion: Motion


@runtime_checkable
class People(Protocol):
    """Makes the people of a scene."""

    @property
    def count(self) -> int:
        """Number of people."""
        ...

    def __call__(self, seconds: float, rng: np.random.Generator) -> tuple[Person, ...]:
        """Return all people for a scene of this length [s]."""
        ...


@dataclass(frozen=True, slots=True)
class Wanderers:
    """People who wander about a floor, come and go."""

    count: int
    width_m: float
    depth_m: float
    centre_m: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if self.count < 0 or not min(self.width_m, self.depth_m) > 0:
            raise InputError(
                "wanderers need a number of people from 0 and a floor with positive sides, got "
                f"{self.count} on {self.width_m:g} m x {self.depth_m:g} m"
            )

    def __call__(self, seconds: float, rng: np.random.Generator) -> tuple[Person, ...]:
        """Return all people for a scene of this length [s]."""
        paths = wander(self.count, self.width_m, self.depth_m, seconds, rng)
        moved = tuple(replace(path, xy_m=path.xy_m + self.centre_m) for path in paths)
        return _walking(bodies(self.count, rng), moved, rng)


@dataclass(frozen=True, slots=True, eq=False)
class PathWalkers:
    """People who walk along given paths, see :func:`trecsim.lab.simulation.paths.through`."""

    paths: tuple[FloorPath, ...]

    @property
    def count(self) -> int:
        """Number of people."""
        return len(self.paths)

    def __call__(self, seconds: float, rng: np.random.Generator) -> tuple[Person, ...]:
        """Return all people; their paths say when each is present."""
        return _walking(bodies(len(self.paths), rng), self.paths, rng)


@dataclass(frozen=True, slots=True)
class ScriptedPeople:
    """People with scripts."""

    roles: tuple[Role, ...]

    @property
    def count(self) -> int:
        """Number of people."""
        return len(self.roles)

    def __call__(self, seconds: float, rng: np.random.Generator) -> tuple[Person, ...]:
        """Return all people for a scene of this length [s]."""
        return tuple(
            _player(role, any_body, seconds, rng)
            for role, any_body in zip(self.roles, bodies(len(self.roles), rng), strict=True)
        )


@dataclass(frozen=True, slots=True)
class PeopleGroups:
    """Several groups of people in one scene, in the order of the ground truth."""

    groups: tuple[People, ...]

    @property
    def count(self) -> int:
        """Number of people."""
        return sum(group.count for group in self.groups)

    def __call__(self, seconds: float, rng: np.random.Generator) -> tuple[Person, ...]:
        """Return all people for a scene of this length [s]; groups do not affect each other."""
        sources = rng.spawn(len(self.groups))
        return tuple(
            person
            for group, own in zip(self.groups, sources, strict=True)
            for person in group(seconds, own)
        )


def clips_of(group: People) -> tuple[Path, ...]:
    """Return the files of recorded motion that a group plays, each once, in order."""
    if isinstance(group, PeopleGroups):
        return tuple(dict.fromkeys(path for one in group.groups for path in clips_of(one)))
    if not isinstance(group, ScriptedPeople):
        return ()
    actions = (action for role in group.roles for visit in role.visits for action in visit.actions)
    return tuple(dict.fromkeys(action.path for action in actions if isinstance(action, Clip)))


def _player(role: Role, any_body: Body, seconds: float, rng: np.random.Generator) -> Person:
    own = any_body if role.stature_m is None else body(role.stature_m, rng)
    style = float(rng.uniform(0, 2 * np.pi))
    return Person(own.stature_m, role.motion(own, seconds, style))


def _walking(
    bodies_: tuple[Body, ...], paths: tuple[FloorPath, ...], rng: np.random.Generator
) -> tuple[Person, ...]:
    return tuple(
        Person(body.stature_m, sampled(walker(body, path, float(rng.uniform(0, 2 * np.pi)))))
        for body, path in zip(bodies_, paths, strict=True)
    )
