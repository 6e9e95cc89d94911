"""The command `trecsim forecast`."""

from dataclasses import asdict
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
    site: Path | None = None,
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
    site
        A site file: forecasts stop at its walls.
    json
        Print the summary as one JSON object.
    """
    from trecsim.forecast_files import forecast as run

    with progress_bar("moments", quiet=json) as bar:
        found = run(
            tracks, out, ahead_s=ahead_s, step_s=step_s, every_s=every_s, site=site, progress=bar
        )
    text = f"{out}: {counted(found.forecasts, 'forecast')} for {counted_people(found.people)}"
    finish({"out": out, **asdict(found)}, json, text)
