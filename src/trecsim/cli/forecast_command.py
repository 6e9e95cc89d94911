"""The command `trecsim forecast`."""

from pathlib import Path

from trecsim.cli.terminal import counted, counted_people, finish, progress_bar


def forecast(
    tracks: Path,
    /,
    *,
    out: Path,
    ahead_s: float = 4.8,
    step_s: float = 0.4,
    every_s: float = 0.0,
    json: bool = False,
) -> None:
    """Forecast where people will be in the next seconds.

    One line per moment and person: several modes with weights, floor points and covariances, the
    first of which is the single guess, and regions that hold the person with 50, 80, 90 and 95 %.
    What is written for a moment uses nothing after it.

    Parameters
    ----------
    tracks
        A file `*.csv` or `*.parquet`, the directory of a recording, a CSV file of floor points with
        the columns `t_s,person,x_m,y_m`, or a text file of ETH/UCY (frame, person, x, y).
    out
        The file to write, JSON Lines.
    ahead_s
        The farthest horizon [s].
    step_s
        Time between two horizons [s].
    every_s
        Time between two forecasts [s]; 0 writes one for every moment.
    json
        Print the summary as one JSON object.
    """
    from trecsim.forecasting.forecaster import Forecaster
    from trecsim.forecasting.values import horizons
    from trecsim.store.atomic import atomic_write
    from trecsim.store.floor_paths import read_floor_paths
    from trecsim.store.forecast_file import forecast_line

    forecaster = Forecaster(horizons(ahead_s, step_s), every_s=every_s)
    moments = read_floor_paths(tracks)
    lines, people = 0, set[int]()
    with atomic_write(out) as file, progress_bar("moments", len(moments), quiet=json) as bar:
        for moment in moments:
            for one in forecaster.step(*moment):
                file.write(forecast_line(one))
                lines += 1
                people.add(one.person)
            bar.advance()
    summary = {"out": out, "moments": len(moments), "people": len(people), "forecasts": lines}
    text = f"{out}: {counted(lines, 'forecast')} for {counted_people(len(people))}"
    finish(summary, json, text)
