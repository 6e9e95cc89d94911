"""What a benchmark is asked to do, and how it tells how far it is."""

import hashlib
import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from harness.figures import Skipped
from harness.machine import ROOT

if TYPE_CHECKING:
    from trecsim.fusion import FusionSettings
    from trecsim.values import Poses2D

SHARED_DATA = ROOT.parent / "shared" / "data"
SAMPLE = ROOT / "sample"
REPORTING_SEEDS = range(1000, 2000)
"""Seeds below are for tuning; what is reported was never tuned on."""

Item = TypeVar("Item")
Out = TypeVar("Out")


@dataclass(slots=True)
class Options:
    """What a benchmark is asked to do.

    Attributes
    ----------
    quick
        Only a part, with the same input as the whole has there.
    overrides
        Settings of the fusion that differ from their defaults.
    jobs
        Processes for what is not timed.
    folder
        Of data, where a benchmark takes one.
    only_seeds
        Other seeds than those for reporting, to tune with.
    skipped
        Parts that could not run, and why; to be filled by the benchmark.
    fingerprints
        Of input that is made on the way; where one changes, seeds are not compared one by one.
    """

    quick: bool = False
    overrides: Mapping[str, Any] = field(default_factory=dict)
    jobs: int = field(default_factory=lambda: len(os.sched_getaffinity(0)))
    folder: Path | None = None
    only_seeds: tuple[int, ...] = ()
    skipped: dict[str, str] = field(default_factory=dict)
    fingerprints: dict[str, str] = field(default_factory=dict)
    input: dict[str, Any] = field(default_factory=dict)
    began_s: float = field(default_factory=time.monotonic)

    def settings(self) -> "FusionSettings":
        """Return the settings of the fusion."""
        return settings_from(self.overrides)

    def seeds(self, whole: int, quick: int) -> list[int]:
        """Return so many of the seeds for reporting; the quick ones are among the whole."""
        if self.only_seeds:
            return list(self.only_seeds)
        return list(REPORTING_SEEDS[: quick if self.quick else whole])

    def tell(self, text: str) -> None:
        """Say how far it is, on stderr."""
        print(f"  {time.monotonic() - self.began_s:5.0f} s  {text}", file=sys.stderr, flush=True)

    def over(
        self, function: Callable[[Item], Out], items: Iterable[Item], name: str
    ) -> Iterator[Out]:
        """Yield a function's results in order, computed in several processes.

        Parameters
        ----------
        function
            At the top of a module.
        items
            What it is called with.
        name
            Of the whole, for the progress.
        """
        todo = list(items)
        if self.jobs <= 1 or len(todo) <= 1:
            results: Iterable[Out] = map(function, todo)
            yield from self._told(results, len(todo), name)
            return
        with ProcessPoolExecutor(min(self.jobs, len(todo)), initializer=_leave_interrupts) as pool:
            try:
                yield from self._told(pool.map(function, todo), len(todo), name)
            except BaseException:
                pool.shutdown(wait=True, cancel_futures=True)
                raise

    def _told(self, results: Iterable[Out], count: int, name: str) -> Iterator[Out]:
        for number, result in enumerate(results, start=1):
            if number == count or number % max(count // 4, 1) == 0:
                self.tell(f"{name}: {number} of {count}")
            yield result


def _leave_interrupts() -> None:
    """Leave Ctrl-C to the process that gave the work."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def settings_from(overrides: Mapping[str, Any]) -> "FusionSettings":
    """Return the settings of the fusion, some of them changed."""
    from trecsim.fusion import FusionSettings

    return FusionSettings(**overrides)


def parse_override(text: str) -> tuple[str, Any]:
    """Return name and value of ``name=value``, for a setting of the fusion.

    Raises
    ------
    ValueError
        There is no such setting, or the value is not of its type.
    """
    from dataclasses import fields

    from trecsim.fusion import FusionSettings

    name, equals, value = text.partition("=")
    known: dict[str, Any] = {f.name: f.default for f in fields(FusionSettings)}
    if not equals:
        raise ValueError(f"expected NAME=VALUE, got {text!r}")
    if name not in known:
        raise ValueError(
            f"there is no setting {name!r}; the settings are {', '.join(sorted(known))}"
        )
    if isinstance(known[name], bool):
        if value.lower() not in ("true", "false"):
            raise ValueError(f"{name} is true or false, got {value!r}")
        return name, value.lower() == "true"
    return name, type(known[name])(value)


def fingerprint(poses: "Iterable[Poses2D]") -> str:
    """Return a short hash of 2D poses, which changes when they do by more than rounding."""
    import numpy as np

    digest = hashlib.sha256()
    for image in poses:
        digest.update(f"{image.camera} {image.t_s:.6f}".encode())
        digest.update(np.round(np.nan_to_num(image.xy_px, nan=-1.0), 3).astype("<f4").tobytes())
    return digest.hexdigest()[:12]


def sample_folder(options: Options) -> Path:
    """Return the folder of the sample recording.

    Raises
    ------
    Skipped
        It is not there.
    """
    places = (options.folder,) if options.folder else (SAMPLE, SHARED_DATA / "pose2sim_demo")
    for place in places:
        if place is not None and (place / "MultiPerson").is_dir():
            return place
    raise Skipped("the sample recording is not there; fetch it with: trecsim sample")


def shared_data(name: str) -> Path:
    """Return a folder of the data beside the repository.

    Raises
    ------
    Skipped
        It is not there.
    """
    folder = SHARED_DATA / name
    if not folder.is_dir():
        raise Skipped(f"{name} is not among the data beside the repository (../shared/data)")
    return folder
