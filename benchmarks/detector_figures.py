"""The simulated detector beside the real one it was made after, as a table.

Run: ``python benchmarks/detector_figures.py [SEED]``; seed 1 is the one of the documentation.
"""

import sys

from trecsim.evaluation.detector_figures import MEASURED, simulated
from trecsim.simulation.detector import ANNOTATED, REAL


def main() -> None:
    """Print the table."""
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    annotated, real = simulated(ANNOTATED, seed), simulated(REAL, seed)
    print("| figure | measured | annotated | deviation | real |\n|---|---|---|---|---|")
    for name, measured in MEASURED.items():
        deviation = 100 * (annotated[name] / measured - 1)
        print(
            f"| {name} | {measured:.3g} | {annotated[name]:.3g} | {deviation:+.0f} % "
            f"| {real[name]:.3g} |"
        )


if __name__ == "__main__":
    main()
