"""The simulated detector beside the real one it was made after, as a table.

Run: ``python benchmarks/detector_figures.py [SEED]``; seed 1 is the one of the documentation. The
column "here" is the recording itself, by the same code, where it is among the data beside the
repository.
"""

import sys

from harness.options import Skipped, shared_data
from trecsim.evaluation.detector_figures import MEASURED, recorded, simulated
from trecsim.simulation.detector import ANNOTATED, REAL


def main() -> None:
    """Print the table."""
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    annotated, real = simulated(ANNOTATED, seed), simulated(REAL, seed)
    try:
        here = recorded(shared_data("shelf"))
    except Skipped:
        here = {}
    print("| figure | recorded | here | `annotated` | off by | `real` |")
    print("|---|---|---|---|---|---|")
    for name, measured in MEASURED.items():
        again = f"{here[name]:.3g}" if here else ""
        off_by = 100 * (annotated[name] / measured - 1)
        print(
            f"| {name} | {measured:.3g} | {again} | {annotated[name]:.3g} | {off_by:+.0f} % "
            f"| {real[name]:.3g} |"
        )


if __name__ == "__main__":
    main()
