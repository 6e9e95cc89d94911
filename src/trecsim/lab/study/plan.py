"""Checks a study table and builds its runs; all faults are reported before anything runs."""

from collections.abc import Callable
from dataclasses import dataclass, fields

from trecsim.errors import ConfigError
from trecsim.fusion import FusionSettings
from trecsim.fusion.settings import RENAMED
from trecsim.lab.study.design import (
    Design,
    Factor,
    Point,
    Value,
    between,
    grid,
    one_at_a_time,
    random,
)
from trecsim.lab.study.scenes import SceneChoice, chosen
from trecsim.lab.study.settings_file_table import SettingTable, StudyTable
from trecsim.toml_models.toml_reading import nearest

FIRST_REPORTING_SEED = 1000
"""Seeds below are for choosing settings, seeds from here on for reporting results."""

MOST_RUNS = 200_000
_MOST_SEEDS = 10_000
_LARGEST_SEED = 2**63 - 1
_MOST_FAULTS = 8
_DEFAULTS = FusionSettings()
_KINDS: dict[str, type] = {
    field.name: type(getattr(_DEFAULTS, field.name)) for field in fields(_DEFAULTS)
}


@dataclass(frozen=True, slots=True)
class Study:
    """A study that can be run."""

    table: StudyTable
    scenes: tuple[SceneChoice, ...]
    seeds: tuple[int, ...]
    design: Design

    @property
    def blocks(self) -> tuple[tuple[SceneChoice, int | None], ...]:
        """Scenes with their seeds; within a block only the settings differ."""
        return tuple(
            (scene, seed)
            for scene in self.scenes
            for seed in (self.seeds if scene.is_simulated else (None,))
        )

    @property
    def runs(self) -> int:
        """Number of runs."""
        return len(self.blocks) * len(self.design.points)


def planned(table: StudyTable, origin: str) -> Study:
    """Return the study of a table.

    Raises
    ------
    ConfigError
        Unknown settings, invalid values, seeds or scenes, or too many runs.
    """
    seeds = parse_seeds(table.seeds, origin)
    factors = _factors(table, origin)
    scenes = chosen(table.scenes, origin)
    blocks = sum(len(seeds) if scene.is_simulated else 1 for scene in scenes)
    _limit_runs(table, factors, blocks, origin)
    design = _design(table, factors)
    _check_points(design, origin)
    return Study(table, scenes, seeds, design)


def check_seeds(study: Study, *, reporting: bool) -> None:
    """Refuse seeds that are reserved: for reporting results, or for choosing settings.

    Raises
    ------
    ConfigError
        The seeds are reserved for the other purpose.
    """
    if not any(scene.is_simulated for scene in study.scenes):
        return
    wrong = [seed for seed in study.seeds if (seed >= FIRST_REPORTING_SEED) != reporting]
    if wrong and reporting:
        raise ConfigError(
            f"seed {wrong[0]} may have been tuned on: --reporting takes seeds from "
            f"{FIRST_REPORTING_SEED} on"
        )
    if wrong:
        raise ConfigError(
            f"seed {wrong[0]} is kept for reporting: a study that chooses settings takes seeds "
            f"below {FIRST_REPORTING_SEED}; to state how good chosen settings are, say --reporting"
        )


def parse_seeds(text: str, origin: str) -> tuple[int, ...]:
    """Return the seeds that a text like ``100-109,120`` names, each once, in order.

    Raises
    ------
    ConfigError
        It is invalid, or names too many seeds.

    Examples
    --------
    >>> parse_seeds("7,100-102,101", "the study")
    (7, 100, 101, 102)
    """
    seeds: set[int] = set()
    for part in text[:100_000].split(","):
        low, dash, high = (word.strip() for word in part.partition("-"))
        ends = [low, high if dash else low]
        if not all(end.isascii() and end.isdigit() and len(end) <= 19 for end in ends):
            raise ConfigError(
                f"{origin}: seeds: expected whole numbers and ranges, as in 100-109,120, found "
                f"{part.strip()[:40]!r}"
            )
        first, last = int(ends[0]), int(ends[1])
        if last < first or last > _LARGEST_SEED or last - first + len(seeds) >= _MOST_SEEDS:
            raise ConfigError(
                f"{origin}: seeds: {part.strip()[:40]!r} is no range from low to high of at most "
                f"{_MOST_SEEDS} seeds"
            )
        seeds.update(range(first, last + 1))
    return tuple(sorted(seeds))


def _factors(table: StudyTable, origin: str) -> tuple[Factor, ...]:
    faults: list[str] = []
    factors = []
    for name, setting in table.settings.items():
        if name not in _KINDS:
            told = (
                f"renamed to {RENAMED[name]}"
                if name in RENAMED
                else (f"unknown setting; {nearest(name, _KINDS)}")
            )
            faults.append(f"settings.{name[:60]}: {told}")
            continue
        try:
            factors.append(_factor(name, setting, drawn=table.design == "random"))
        except ConfigError as fault:
            faults.append(f"settings.{name}: {fault}")
    if table.design == "random" and table.points is None:
        faults.append("points: the random design needs their number")
    if faults:
        raise _all_of(origin, faults)
    return tuple(factors)


def _factor(name: str, setting: SettingTable, *, drawn: bool) -> Factor:
    kind = _KINDS[name]
    default: Value = getattr(_DEFAULTS, name)
    if setting.values is not None:
        levels = tuple(_typed(value, kind) for value in setting.values)
        return Factor(name, default, _distinct(levels), whole=kind is int)
    if setting.low is None or setting.high is None or kind not in (int, float):
        raise ConfigError(
            f"a range needs numbers, and this setting is {kind.__name__}; list values"
        )
    if setting.steps is None and not drawn:
        raise ConfigError("steps is missing: the number of values of the range")
    if setting.steps is None:
        span = (setting.low, setting.high)
        return Factor(name, default, (), span, setting.log, whole=kind is int)
    shares = [k / (setting.steps - 1) for k in range(setting.steps)]
    values = [between(setting.low, setting.high, share, log=setting.log) for share in shares]
    rounded = tuple(round(v) if kind is int else float(f"{v:.6g}") for v in values)
    return Factor(name, default, _distinct(rounded), log=setting.log, whole=kind is int)


def _typed(value: object, kind: type) -> Value:
    if kind is float and isinstance(value, int | float) and not isinstance(value, bool):
        return float("inf") if abs(value) > 1e300 else float(value)
    if isinstance(value, kind) and (kind is bool or not isinstance(value, bool)):
        return value  # type: ignore[return-value]
    wanted = {int: "whole numbers", float: "numbers", bool: "true or false"}.get(kind, "text")
    raise ConfigError(f"expected {wanted}, found {value!r:.60}")


def _distinct(values: tuple[Value, ...]) -> tuple[Value, ...]:
    distinct = tuple(dict.fromkeys(values))
    if len(distinct) < 2:
        raise ConfigError(f"expected at least two different values, found only {distinct[0]}")
    return distinct


def _limit_runs(table: StudyTable, factors: tuple[Factor, ...], blocks: int, origin: str) -> None:
    points = 1
    for factor in factors:
        points *= max(1, len(factor.levels))
    if table.design == "one-at-a-time":
        points = sum(len(factor.levels) for factor in factors)
    if table.design == "random":
        points = table.points or 1
    if points * blocks > MOST_RUNS:
        raise ConfigError(
            f"{origin}: {points} points on {blocks} scenes and seeds are {points * blocks} runs, "
            f"more than {MOST_RUNS}; try fewer values, or the random or one-at-a-time design"
        )


def _design(table: StudyTable, factors: tuple[Factor, ...]) -> Design:
    makers: dict[str, Callable[[], Design]] = {
        "grid": lambda: grid(factors),
        "one-at-a-time": lambda: one_at_a_time(factors),
        "random": lambda: random(factors, table.points or 2),
    }
    return makers[table.design]()


def _check_points(design: Design, origin: str) -> None:
    faults: dict[str, str] = {}  # by reason, as in a grid many points have the same
    for point in design.points:
        try:
            settings_of(design, point)
        except ConfigError as error:
            reason = str(error).removeprefix("fusion settings: ")
            faults.setdefault(reason, _guilty(design, point))
    if faults:
        raise _all_of(origin, [f"{values}: {reason}" for reason, values in faults.items()])


def _guilty(design: Design, point: Point) -> str:
    """Return the invalid values of a point; all values if each is valid alone."""
    default = design.points[0]
    told, alone = [], []
    for k, (factor, value) in enumerate(zip(design.factors, point, strict=True)):
        told.append(f"{factor.name} = {value}")
        try:
            settings_of(design, (*default[:k], value, *default[k + 1 :]))
        except ConfigError:
            alone.append(told[-1])
    return ", ".join(alone or told)


def settings_of(design: Design, point: Point) -> FusionSettings:
    """Return the settings of a point; all others are at their defaults.

    Raises
    ------
    ConfigError
        The settings are invalid.
    """
    values = {factor.name: value for factor, value in zip(design.factors, point, strict=True)}
    return FusionSettings(**values)  # type: ignore[arg-type]


def _all_of(origin: str, faults: list[str]) -> ConfigError:
    if len(faults) == 1:
        return ConfigError(f"{origin}: {faults[0]}")
    told = faults[:_MOST_FAULTS]
    if len(faults) > len(told):
        told.append(f"and {len(faults) - len(told)} more")
    return ConfigError("\n  ".join([f"{origin}: {len(faults)} faults", *told]))
