"""What came of `trecsim run`, as a value and as ``summary.json`` in the folder of the recording."""

import json
import platform
from contextlib import suppress
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Literal

import numpy as np

from trecsim.sites.check import CheckedSite
from trecsim.store.atomic import atomic_write
from trecsim.store.rig_digest import rig_sha256

SUMMARY = "summary.json"
Ended = Literal["complete", "stopped", "failed"]


@dataclass(frozen=True, slots=True)
class RunSummary:
    """What came of `run`.

    Attributes
    ----------
    site
        Name of the site.
    out
        Directory with everything that was kept.
    ended
        Whether the recordings came to their end, or what ended the run.
    fault
        What was wrong, if it failed.
    images, frame_sets, people
        How many went through the fusion, and how many different people came out.
    first_s, last_s
        Times of the first and last snapshot [s]; None when there was none.
    wall_s
        How long the run took [s].
    fusion_ms
        Median, 95th percentile, largest and mean time of a step of the fusion [ms].
    gaps_s
        Where the recording was continued: the last time before and the first time after, each [s].
        Numbers of images, frame sets and people count from the last of these on.
    remarks
        What was said about poses and rig that do not fit together.
    """

    site: str
    out: Path
    ended: Ended
    fault: str | None
    images: int
    frame_sets: int
    people: int
    first_s: float | None
    last_s: float | None
    wall_s: float
    fusion_ms: dict[str, float]
    gaps_s: tuple[tuple[float, float], ...] = ()
    remarks: tuple[str, ...] = ()


def gaps_before(folder: Path) -> tuple[tuple[float, float], ...]:
    """Return the gaps that the summary of an earlier run in `folder` names.

    Parameters
    ----------
    folder
        Of the recording; it may lack a summary.
    """
    try:
        gaps = json.loads((folder / SUMMARY).read_bytes())["gaps_s"]
        return tuple((float(low), float(high)) for low, high in gaps)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ()  # it ended without a summary


def write_summary(summary: RunSummary, checked: CheckedSite) -> None:
    """Write the summary, the configuration and the versions into the folder of the recording.

    Parameters
    ----------
    summary
        What came of the run.
    checked
        The site that it ran.
    """
    facts = {
        "format": "trecsim.summary/1",
        **asdict(summary),
        "out": str(summary.out),
        "rig_sha256": rig_sha256(checked.rig),
        "configuration": checked.file.site.model_dump(mode="json"),
        "versions": {"python": platform.python_version(), **_versions()},
    }
    facts["fusion_ms"] = {k: None if np.isnan(v) else v for k, v in summary.fusion_ms.items()}
    with atomic_write(summary.out / SUMMARY) as file:
        file.write(json.dumps(facts, indent=2, allow_nan=False) + "\n")


def _versions() -> dict[str, str]:
    found = {}
    for package in ("mc3d-trecsim", "numpy", "numba", "av", "openvino"):
        with suppress(PackageNotFoundError):
            found[package] = version(package)
    return found
