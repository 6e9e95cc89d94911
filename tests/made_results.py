"""Made results of benchmarks."""

from collections.abc import Mapping
from typing import Any

from harness.figures import Figures, Result

ABOUT: dict[str, Any] = {
    "date": "2026-01-02 03:04 UTC",
    "commit": "abc",
    "machine": {"processor": "abacus", "cores": 2, "load_average": [0.5, 0.5, 0.5]},
    "versions": {"python": "3.11.0", "numpy": "2.0.0", "numba": "0.65.0"},
    "fingerprints": {"room": "f00"},
}


def result(figures: Figures, name: str = "made", **about: Any) -> Result:
    return Result(name, figures, {**ABOUT, **about})


def runs(*values: float) -> Mapping[int, float]:
    return dict(enumerate(values, start=1000))
