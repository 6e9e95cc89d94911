"""The command `trecsim evaluate-forecast`."""

from pathlib import Path

from trecsim.cli.terminal import finish, progress_bar


def evaluate_forecast(inputs: list[Path], /, *, json: bool = False) -> None:
    """Evaluate forecasts on recorded paths.

    Distances of the single guess and of the best of 20 paths, coverage of the regions, likelihood.

    A sample is a person and a moment with 8 positions 0.4 s apart behind it (3.2 s) and 12 ahead
    (4.8 s). Of several inputs each counts the same. The folder of ETH/UCY gives the five scenes of
    published tables, and beside them the same with ETH in its true time.

    Parameters
    ----------
    inputs
        Tracks (`*.csv`, `*.parquet`, directory of a recording), CSV files of floor points, text
        files of ETH/UCY, or their folder.
    json
        Print all scores as one JSON object.
    """
    from trecsim.cli.forecast_scores import score_text, summary_of
    from trecsim.forecast_files import evaluate_forecast as run

    with progress_bar("recordings", quiet=json) as bar:
        summary = summary_of(run(inputs, bar))
    finish(summary, json, score_text(summary))
