"""Tables of forecasts."""

from collections.abc import Mapping

from harness.figures import Result
from harness.markdown import fixed, table, value_of

Results = Mapping[str, Result]
LEVELS = ("0.5", "0.8", "0.9", "0.95")


def poses(results: Results) -> str:
    """Return the errors of pose forecasts beside those of zero velocity."""
    figures = results["forecast"].figures.get("poses", {})
    head = ["recorded motion", "ahead", "mean joint error [cm]", "zero velocity [cm]"]
    rows = [
        [name, ahead, *(fixed(found.value, 1) for found in of_one.values())]
        for name, group in figures.items()
        for ahead, of_one in group.items()
    ]
    return table(head, rows)


def forecast(results: Results, *, short: bool) -> str:
    """Return distances and coverage per scene; of the short table only distances."""
    figures = results["forecast"].figures
    head = ["scene", "samples", "ADE / FDE [m]", "constant velocity [m]", "best of 20 [m]"]
    head += [] if short else ["in the regions of 50 / 80 / 90 / 95 %", "whole path, 90 %", "NLL"]
    rows = []
    for scene, group in figures.items():
        if "ADE" not in group:
            continue

        def of(*names: str, scene: str = scene, places: int = 3) -> str:
            return fixed(value_of(figures, scene, *names), places)

        row = [scene, of("samples", places=0), f"{of('ADE')} / {of('FDE')}"]
        row += [
            f"{of(kind, 'ADE')} / {of(kind, 'FDE')}" for kind in ("constant velocity", "best of 20")
        ]
        if not short:
            row.append(" / ".join(of("coverage", level) for level in LEVELS))
            row += [of("whole path at 90 %"), of("NLL", places=2)]
        rows.append(row)
    return table(head, rows)
