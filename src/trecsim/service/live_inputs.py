"""What a live site reads."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from trecsim.estimators import Estimator2D
from trecsim.looking.live import for_live
from trecsim.safety.signals import SignalSource
from trecsim.service.monitor import StreamReadings
from trecsim.sites.check import CheckedSite, load_estimator
from trecsim.sources.base import Source
from trecsim.values import Frame, Poses2D


@dataclass(frozen=True, slots=True)
class LiveInputs:
    """What a live site reads.

    Attributes
    ----------
    sources
        One per camera, or one with the 2D poses of several.
    readings
        What each camera tells about itself.
    estimator
        Finds the 2D poses if the sources deliver images.
    close
        Ends the sources.
    signals
        The messages of feeds; None takes them as the site file says.
    """

    sources: Sequence[Source[Poses2D]] | Sequence[Source[Frame]]
    readings: Sequence[StreamReadings] = ()
    estimator: Estimator2D | None = None
    close: Callable[[], None] = lambda: None
    signals: SignalSource | None = None


def live_inputs(checked: CheckedSite, *, as_live: bool = False) -> LiveInputs | None:
    """Return what a live site reads; None where all are recordings that are not played as live.

    Parameters
    ----------
    checked
        What `trecsim.sites.check.check_site` returns.
    as_live
        Play recordings as if they were live cameras.

    Raises
    ------
    ConfigError
        When credentials cannot be found.
    SetupError
        When something that is needed is not installed.
    """
    from trecsim.sites.live_sources import image_sources, poses_source

    site = checked.file.site
    if not (as_live or site.is_live):
        return None
    if site.poses is not None:
        played = poses_source(checked)
        return LiveInputs([played], played.readings, close=played.close)
    estimator = for_live(load_estimator(checked.file), site.estimator.cores)
    sources = image_sources(checked, estimator)

    def close() -> None:
        for source in sources:
            source.close()

    readings = [reading for source in sources for reading in source.readings]
    return LiveInputs(sources, readings, estimator, close)
