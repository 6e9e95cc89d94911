"""The scene file: all keys for cameras, people and their actions.

This module defines the keys; :mod:`trecsim.lab.simulation.scene_file` reads a file by it.
"""

from dataclasses import asdict
from math import hypot, radians
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from trecsim.errors import InputError
from trecsim.geometry.rig import Rig
from trecsim.lab.simulation.actions import AnyAction, Point, Seconds
from trecsim.lab.simulation.camera_placement import Make
from trecsim.lab.simulation.camera_tables import (
    MOST_CAMERAS,
    CameraTable,
    ClockTable,
    Length,
    Place,
    RigTable,
    possible,
)
from trecsim.lab.simulation.detector_errors import ANNOTATED, CLOTHED, PERFECT, REAL, Detector
from trecsim.lab.simulation.failures import turned
from trecsim.lab.simulation.occlusion import Obstacle
from trecsim.lab.simulation.people import PeopleGroups, ScriptedPeople, Wanderers
from trecsim.lab.simulation.roles import SHORTEST_M, TALLEST_M, Role, Visit
from trecsim.lab.simulation.scene import LONGEST_S, Scene
from trecsim.toml_models import Table
from trecsim.toml_models.toml_reading import Fault

FEWEST_CAMERAS = 2
MOST_PEOPLE = 200
MOST_ACTIONS = 200

PRESETS = {"real": REAL, "clothed": CLOTHED, "annotated": ANNOTATED, "perfect": PERFECT}
"""Detectors from which a scene file can start."""

SceneName = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$")]
"""A name that can be used in a file name."""


def _over_preset(given: Any) -> Any:
    """Return the table with the values of its preset where it gives none."""
    preset = given.get("preset", "real") if isinstance(given, dict) else None
    return {**asdict(PRESETS[preset]), **given} if preset in list(PRESETS) else given


class ObstacleTable(Table):
    """An opaque box: a pillar, a wall, a shelf."""

    low_m: Place
    """Corner with the smallest coordinates [m]."""
    high_m: Place
    """Corner with the largest coordinates [m]."""

    def obstacle(self) -> Obstacle:
        """Return the box."""
        return Obstacle(self.low_m, self.high_m)

    @model_validator(mode="after")
    def _possible(self) -> "ObstacleTable":
        possible(self.obstacle)
        return self


class VisitTable(Table):
    """One visit of a person, from appearing to leaving."""

    start_m: Point
    """Position at which the person appears, x and y [m]."""
    facing_deg: float | None = Field(default=None, ge=-3600, le=3600)
    """Direction faced, counter-clockwise from +x; if left out, to the first way point [degrees]."""
    enter_s: Seconds = 0.0
    """Time at which the person appears [s]."""
    leaves: bool = False
    """Whether the person disappears after the last action, or stays."""
    actions: Annotated[tuple[AnyAction, ...], Field(strict=False, max_length=MOST_ACTIONS)] = ()
    """Actions, done one after the other."""

    def visit(self, later_s: float = 0.0, shift_m: tuple[float, float] = (0.0, 0.0)) -> Visit:
        """Return the visit, delayed and shifted."""
        moved = Visit(
            start_m=self.start_m,
            actions=self.actions,
            facing_rad=None if self.facing_deg is None else radians(self.facing_deg),
            enter_s=self.enter_s + later_s,
            leaves=self.leaves,
        )
        return moved if hypot(*shift_m) == 0 else moved.shifted(shift_m)


class PersonTable(VisitTable):
    """A person with a script, or several who do the same one after the other."""

    stature_m: float | None = Field(default=None, ge=SHORTEST_M, le=TALLEST_M)
    """Height standing upright [m]; random if left out."""
    again: Annotated[tuple[VisitTable, ...], Field(strict=False, max_length=50)] = ()
    """Further visits of the same person."""
    copies: int = Field(default=1, ge=1, le=MOST_PEOPLE)
    """Number of people who do the same."""
    every_s: Seconds = 0.0
    """Delay of each of them after the one before [s]."""
    shift_m: Point = (0.0, 0.0)
    """Shift of each of them from the one before [m]."""

    def roles(self) -> list[Role]:
        """Return the roles of all these people."""
        return [
            Role(
                tuple(
                    table.visit(
                        number * self.every_s,
                        (number * self.shift_m[0], number * self.shift_m[1]),
                    )
                    for table in (self, *self.again)
                ),
                self.stature_m,
            )
            for number in range(self.copies)
        ]

    @model_validator(mode="after")
    def _possible(self) -> "PersonTable":
        times_s = [self.enter_s, *(visit.enter_s for visit in self.again)]
        if times_s != sorted(set(times_s)):
            raise ValueError("a further visit must begin later than the one before: check enter_s")
        if self.again and not self.leaves:
            raise ValueError("a person with further visits must leave: leaves = true is missing")
        return self


class WanderersTable(Table):
    """People who wander about, avoid each other, come and go."""

    people: int = Field(ge=1, le=MOST_PEOPLE)
    """Number of people."""
    width_m: Length
    """Size of their floor along x [m]."""
    depth_m: Length
    """Size of their floor along y [m]."""
    centre_m: Point = (0.0, 0.0)
    """Centre of their floor, x and y [m]."""

    def wanderers(self) -> Wanderers:
        """Return these people."""
        return Wanderers(self.people, self.width_m, self.depth_m, self.centre_m)


class SceneTable(Table):
    """A scene: cameras, people and their actions, detector, clocks."""

    format: Literal["trecsim.scene/1"]
    """Format of the file."""
    about: str = Field(default="", max_length=200)
    """Description in one line."""
    seconds: float = Field(gt=0, le=LONGEST_S)
    """Length of the scene [s]."""
    seed: int = Field(default=0, ge=0, lt=2**63)
    """Seed of the random bodies, noise and paths of wanderers."""
    rig: RigTable = RigTable()
    """Cameras in a pattern, and the image and lens of all cameras."""
    cameras: dict[SceneName, CameraTable] = Field(default_factory=dict, max_length=MOST_CAMERAS)
    """Single cameras by name: with their own placement, or different from the pattern."""
    clock: ClockTable = ClockTable()
    """Frame rate, clock errors and time stamps of all cameras."""
    detector: Annotated[Detector, BeforeValidator(_over_preset)] = REAL
    """Errors of the 2D pose estimator."""
    people: Annotated[tuple[PersonTable, ...], Field(strict=False, max_length=MOST_PEOPLE)] = ()
    """People with a script."""
    wanderers: Annotated[tuple[WanderersTable, ...], Field(strict=False, max_length=20)] = ()
    """People who wander about."""
    obstacles: Annotated[tuple[ObstacleTable, ...], Field(strict=False, max_length=200)] = ()
    """Boxes that occlude people."""

    @model_validator(mode="after")
    def _possible(self) -> "SceneTable":
        people = sum(table.copies for table in self.people)
        people += sum(table.people for table in self.wanderers)
        if people > MOST_PEOPLE:
            raise ValueError(f"expected at most {MOST_PEOPLE} people, found {people}")
        return self

    def scene(self, name: str) -> tuple[Scene | None, list[Fault]]:
        """Return the scene, or its inconsistencies."""
        faults: list[Fault] = []
        rig = self._rig(faults)
        if rig is None:
            return None, faults
        tables = [self.cameras.get(camera.name, CameraTable()) for camera in rig]
        named = list(zip(rig.names, tables, strict=True))
        scene = Scene(
            rig=rig,
            people=self._people(),
            seconds=self.seconds,
            detector=self.detector,
            clocks=tuple(
                table.clock.clock(self.clock, number) for number, table in enumerate(tables)
            ),
            obstacles=tuple(table.obstacle() for table in self.obstacles),
            outages=tuple(one for camera, table in named for one in table.outages(camera)),
            knocks=(
                *turned(rig, self.rig.turned_deg),
                *(one for camera, table in named for one in table.knocks(camera)),
            ),
            name=name,
            about=self.about,
            seed=self.seed,
        )
        return scene, []

    def _rig(self, faults: list[Fault]) -> Rig | None:
        """Return all cameras, those of the pattern first."""
        cameras = {camera.name: camera for camera in self.rig.rig() or ()}
        common = self.rig.make(Make())
        before = len(faults)
        for name, table in self.cameras.items():
            try:
                cameras[name] = table.camera(name, cameras, common)
            except InputError as error:
                told = str(error).removeprefix(f"camera {name!r}: ")
                faults.append((("cameras", name), told))
        if len(faults) == before and not FEWEST_CAMERAS <= len(cameras) <= MOST_CAMERAS:
            told = (
                f"expected {FEWEST_CAMERAS} to {MOST_CAMERAS} cameras, found {len(cameras)}: give "
                "rig.pattern, or tables [cameras.NAME]"
            )
            faults.append((("cameras",), told))
        return Rig(tuple(cameras.values())) if len(faults) == before else None

    def _people(self) -> PeopleGroups:
        roles = tuple(role for table in self.people for role in table.roles())
        players = (ScriptedPeople(roles),) if roles else ()
        return PeopleGroups((*players, *(table.wanderers() for table in self.wanderers)))
