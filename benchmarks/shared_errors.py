"""What all cameras share of the errors of key points, recorded and simulated.

OpenPose on Shelf against the annotation, and the presets of the simulated detector in a made
recording with the same cameras. The annotation's own errors count as the detector's.

Run: ``python benchmarks/shared_errors.py``
"""

from harness.command import alone
from harness.figures import Figures, Skipped, once
from harness.options import Options, shared_data

SEEDS = range(1, 9)


def measure(options: Options) -> Figures:
    """Measure the errors that all cameras share, of the real detector and of the presets."""
    from detector.shared_on_shelf import recorded, simulated
    from trecsim.lab.simulation.scene_tables import PRESETS

    seeds = SEEDS[:1] if options.quick else SEEDS
    options.input.update(
        data="Shelf beside the repository, and made people before its cameras",
        seeds=[seeds[0], seeds[-1]],
    )
    columns: dict[str, dict[str, float]] = {}
    try:
        columns["recorded"] = recorded(shared_data("shelf"))
    except Skipped as reason:
        options.skipped["the recording itself"] = str(reason)
    for preset in ("annotated", "clothed", "real"):
        runs = [simulated(PRESETS[preset], seed) for seed in seeds]
        columns[preset] = {name: sum(run[name] for run in runs) / len(runs) for name in runs[0]}
        options.tell(preset)
    return {
        name: {column: once(values[name], "", watched=False) for column, values in columns.items()}
        for name in columns["real"]
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
