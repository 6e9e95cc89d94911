"""The simulated detector beside the real one it was made after.

Recorded are the figures of OpenPose on Shelf, measured once. *Here* are those of the recording by
the same code as the simulated ones, where it is among the data beside the repository.

Run: ``python benchmarks/detector_figures.py``
"""

from harness.command import alone
from harness.figures import Figures, Skipped, once
from harness.options import Options, shared_data

SEED = 1  # the detector was made on others, but its figures are those of the documentation


def measure(options: Options) -> Figures:
    """Measure the habits of the simulated detector, beside those of the real one."""
    from trecsim.evaluation.detector_figures import MEASURED, recorded, simulated
    from trecsim.simulation.detector import ANNOTATED, REAL

    options.input.update(data="made people before the cameras of Shelf", seeds=[SEED, SEED])
    annotated, real = simulated(ANNOTATED, SEED), simulated(REAL, SEED)
    options.tell("simulated")
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
            "off by": once(off_by, "%", matters=2.0),
            "real": once(real[name], "", watched=False),
        }
    return figures


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
