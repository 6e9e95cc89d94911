"""The study file: settings to vary, scenes, seeds and design."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from trecsim.fusion.arguments import LONGEST_LAG_S
from trecsim.lab.simulation.camera_tables import MOST_CAMERAS
from trecsim.lab.simulation.scene import LONGEST_S
from trecsim.lab.simulation.scene_tables import FEWEST_CAMERAS, MOST_PEOPLE
from trecsim.toml_models import FilePath, Table, read_text, validated
from trecsim.toml_models.table import beside_the_file

FORMAT = "trecsim.study/1"
KIND = "study file"
MOST_LEVELS = 100
MOST_POINTS = 5_000


def _scene_beside_the_file(name: str, info: Any) -> str:
    return str(beside_the_file(Path(name), info)) if name.endswith(".toml") else name


Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$")]


class SettingTable(Table):
    """Values of one setting: a list or a range."""

    values: list[Any] | None = Field(default=None, min_length=2, max_length=MOST_LEVELS)
    """List of values."""
    low: float | None = None
    """Smallest value of a range."""
    high: float | None = None
    """Largest value of a range."""
    steps: int | None = Field(default=None, ge=2, le=MOST_LEVELS)
    """Number of values of the range; without it the random design draws from all of it."""
    log: bool = False
    """Whether equal steps are equal factors."""

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        ends = (self.low, self.high)
        if self.values is not None:
            if any(end is not None for end in (*ends, self.steps)) or self.log:
                raise ValueError("expected either a list of values or low and high, found both")
        elif self.low is None or self.high is None:
            raise ValueError("expected a list of values, or low and high")
        elif not self.low < self.high:
            raise ValueError(f"low must lie below high, found {self.low:g} and {self.high:g}")
        elif self.log and self.low <= 0:
            raise ValueError(f"equal factors need a low above 0, found {self.low:g}")
        return self


class ChoiceTable(Table):
    """One scene: a room with wandering people, a scene by name or file, or an existing one."""

    people: int | None = Field(default=None, ge=1, le=MOST_PEOPLE)
    """Number of people in the room (4)."""
    cameras: int | None = Field(default=None, ge=FEWEST_CAMERAS, le=MOST_CAMERAS)
    """Number of cameras (4)."""
    seconds: float | None = Field(default=None, gt=0, le=LONGEST_S)
    """Length of the scene [s] (20)."""
    width_m: float | None = Field(default=None, gt=0, le=1000)
    """Size of the room along x [m] (8)."""
    depth_m: float | None = Field(default=None, gt=0, le=1000)
    """Size of the room along y [m] (6)."""
    height_m: float | None = Field(default=None, gt=0, le=100)
    """Height of the room's cameras [m] (2.7)."""
    fps: float | None = Field(default=None, gt=0, le=1000)
    """Images per second of each camera in the room (25)."""
    scene: Annotated[str, AfterValidator(_scene_beside_the_file)] | None = None
    """Name of a built-in scene, or a scene file."""
    folder: FilePath | None = None
    """Folder of a synthetic scene, with `rig.toml`, `poses.jsonl` and `truth.npz`."""

    @property
    def room(self) -> dict[str, Any]:
        """The keys of the room."""
        return self.model_dump(exclude={"scene", "folder"}, exclude_none=True)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [bool(self.room), self.scene is not None, self.folder is not None]
        if sum(kinds) > 1:
            raise ValueError("expected one of: a room (people, cameras, ...), scene, folder")
        return self


def _values_table(given: Any) -> Any:
    return {"values": given} if isinstance(given, list) else given


def _scene_tables(given: Any) -> Any:
    if isinstance(given, list) and all(isinstance(name, str) for name in given):
        return {name: {"scene": name} for name in given}
    return given


def _seed_text(given: Any) -> Any:
    if isinstance(given, int) and not isinstance(given, bool):
        return str(given)
    if isinstance(given, list) and all(type(seed) is int for seed in given):
        return ",".join(map(str, given))
    return given


class StudyTable(Table):
    """A study: settings, scenes, seeds and design."""

    format: Literal["trecsim.study/1"]
    """Format of the file."""
    design: Literal["grid", "one-at-a-time", "random"] = "grid"
    """All combinations, the default with one value changed, or random points."""
    points: int | None = Field(default=None, ge=2, le=MOST_POINTS)
    """Number of points of the random design."""
    lag_s: float = Field(default=0.0, ge=0.0, le=LONGEST_LAG_S)
    """Lag of the reported positions [s]."""
    seeds: Annotated[str, BeforeValidator(_seed_text, json_schema_input_type=str | list[int])]
    """Ranges and numbers: `"100-109,120"`, or a list."""
    settings: dict[
        str,
        Annotated[SettingTable, BeforeValidator(_values_table, json_schema_input_type=Any)],
    ] = Field(min_length=1)
    """Values by the name of the setting."""
    scenes: Annotated[
        dict[Name, ChoiceTable], BeforeValidator(_scene_tables, json_schema_input_type=Any)
    ] = Field(min_length=1, max_length=100)
    """Scenes by a name for each, or a list of built-in ones."""


def read_study_table(path: Path) -> StudyTable:
    """Read a study file.

    Raises
    ------
    ConfigError
        It cannot be read or is invalid; the text lists all faults.
    """
    text = read_text(path, KIND)
    return validated(StudyTable, path, text, KIND, {"folder": path.parent.absolute()})


def toml_of(table: StudyTable) -> str:
    """Return a study as the text of a study file with absolute paths."""
    data = table.model_dump(mode="python", exclude_none=True)
    tables = {name: data.pop(name) for name in ("settings", "scenes")}
    lines = [f"{name} = {_toml(value)}" for name, value in data.items()]
    for name, entries in tables.items():
        lines += ["", f"[{name}]"]
        lines += [f"{_toml(key)} = {_toml(_plain(value))}" for key, value in entries.items()]
    return "\n".join(lines) + "\n"


def _plain(value: Mapping[str, Any]) -> Any:
    return value.get("values", value)


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, int | float):
        return repr(value)
    return '"' + "".join(map(_escaped, str(value))) + '"'


def _escaped(character: str) -> str:
    if character in '"\\':
        return "\\" + character
    return character if character.isprintable() else f"\\U{ord(character):08x}"
