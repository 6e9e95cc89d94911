"""The simulated detector beside the real one it is tuned to.

*Recorded* are the figures of OpenPose on Shelf that the simulator is tuned to, measured once.
*Here* are those that the code of this repository finds on all 301 frames of the recording, where
it is among the data beside the repository.

Run: ``python benchmarks/detector_figures.py``
"""

from harness.command import alone
from harness.figures import Figures, Skipped, once
from harness.options import Options, shared_data

# Some errors are rare (left and right swapped: once in 250 people): one run may be off by a tenth.
SEEDS = range(1, 9)


def mean(runs: list[dict[str, float]]) -> dict[str, float]:
    """Return the mean of every figure over the runs."""
    return {name: sum(run[name] for run in runs) / len(runs) for name in runs[0]}


def measure(options: Options) -> Figures:
    """Measure the errors of the simulated detector, beside those of the real one."""
    from detector.openpose_on_shelf import MEASURED, recorded, simulated
    from trecsim.lab.simulation.detector_errors import ANNOTATED, REAL

    seeds = SEEDS[:1] if options.quick else SEEDS
    options.input.update(
        data="made people before the cameras of Shelf", seeds=[seeds[0], seeds[-1]]
    )
    runs = {"annotated": [], "real": []}
    for seed in seeds:
        runs["annotated"].append(simulated(ANNOTATED, seed))
        runs["real"].append(simulated(REAL, seed))
        options.tell(f"seed {seed}")
    annotated, real = mean(runs["annotated"]), mean(runs["real"])
    here: dict[str, float] = {}
    try:
        here = recorded(shared_data("shelf"))
    except Skipped as reason:
        options.skipped["the recording itself"] = str(reason)
    figures: dict[str, Figures] = {}
    for name, measured in MEASURED.items():
        off_by = 100 * abs(annotated[name] / measured - 1)
        figures[name] = {
            "recorded": once(measured, "", watched=False),
            **({"here": once(here[name], "", watched=False)} if here else {}),
            "annotated": once(annotated[name], "", watched=False),
            "off by": once(off_by, "%", matters=2.0, watched=not options.quick),
            "real": once(real[name], "", watched=False),
        }
    return figures


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
