"""Forecasts of recorded paths, and how good they were: from files to files."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from trecsim.errors import InputError
from trecsim.forecasting import Forecaster
from trecsim.forecasting.forecasts import horizons
from trecsim.forecasting.path_scores import Scores, evaluated, joined
from trecsim.forecasting.walls import NO_WALLS
from trecsim.sites.recorded_site import read_without_rig
from trecsim.store.atomic import atomic_write
from trecsim.store.ethucy import sets_in
from trecsim.store.floor_paths import read_floor_paths
from trecsim.store.forecast_file import forecast_line

Progress = Callable[[int, int | None], None]


@dataclass(frozen=True, slots=True)
class ForecastExtent:
    """What was written.

    Attributes
    ----------
    moments
        Number of moments of the input.
    people
        Number of people with a forecast.
    forecasts
        Number of lines: one per moment and person.
    """

    moments: int
    people: int
    forecasts: int


def forecast(
    tracks: Path | str,
    out: Path | str,
    *,
    ahead_s: float = 4.8,
    step_s: float = 0.4,
    every_s: float = 0.0,
    site: Path | None = None,
    progress: Progress | None = None,
) -> ForecastExtent:
    """Forecast where the people of recorded tracks will be; write JSON Lines.

    Parameters
    ----------
    tracks
        What `read_floor_paths` reads: tracks, floor points, or a file of ETH/UCY.
    out
        The file to write.
    ahead_s
        The farthest horizon [s].
    step_s
        Time between two horizons [s].
    every_s
        Time between two forecasts [s]; 0 writes one for every moment.
    site
        A site file with walls.
    progress
        Called with the number of moments done and that of all.

    Raises
    ------
    InputError
        When the input is wrong, or horizons cannot be had.
    """
    walls = NO_WALLS if site is None else read_without_rig(site).walls_m
    forecaster = Forecaster(horizons(ahead_s, step_s), every_s=every_s, walls=walls)
    moments = read_floor_paths(tracks)
    lines, people = 0, set[int]()
    with atomic_write(Path(out)) as file:
        for done, moment in enumerate(moments, start=1):
            made = forecaster.step(*moment)
            file.writelines(map(forecast_line, made))
            lines += len(made)
            people.update(one.person for one in made)
            if progress is not None:
                progress(done, len(moments))
    return ForecastExtent(len(moments), len(people), lines)


def evaluate_forecast(
    inputs: Sequence[Path | str], progress: Progress | None = None
) -> dict[str, Scores]:
    """Return how good forecasts are on recorded paths, by input or set of ETH/UCY.

    Parameters
    ----------
    inputs
        What `forecast` reads, or the folder of ETH/UCY, which gives its six sets.
    progress
        Called with the number of sets done and that of all.

    Raises
    ------
    InputError
        When the input is wrong, or too short to judge a forecast.
    """
    sets = sets_in([Path(path) for path in inputs])
    scores = {}
    for done, (name, files) in enumerate(sets.items(), start=1):
        scores[name] = joined([evaluated(read_floor_paths(file)) for file in files])
        if not len(scores[name].error_m):
            raise InputError(
                f"{name}: nobody is there for 8 seconds in a row (3.2 s to observe, 4.8 s to "
                "compare with), so no forecast can be judged; give a longer recording"
            )
        if progress is not None:
            progress(done, len(sets))
    return scores
