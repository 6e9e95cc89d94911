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
    from trecsim.errors import InputError
    from trecsim.forecasting.scores import evaluated, joined
    from trecsim.store.ethucy import sets_in
    from trecsim.store.floor_paths import read_floor_paths

    found = sets_in(inputs)
    with progress_bar("recordings", len(found), quiet=json) as bar:
        scores = {}
        for name, files in found.items():
            scores[name] = joined([evaluated(read_floor_paths(file)) for file in files])
            bar.advance()
    for name, one in scores.items():
        if not len(one.error_m):
            raise InputError(
                f"{name}: nobody is there for 8 seconds in a row (3.2 s to observe, 4.8 s to "
                "compare with), so no forecast can be judged; give a longer recording"
            )
    summary = summary_of(scores)
    finish(summary, json, score_text(summary))
