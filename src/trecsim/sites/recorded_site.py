"""The site file as rules on a recording need it: what else it says is not looked at."""

from pathlib import Path
from typing import Any, Literal

from trecsim.geometry import Rig
from trecsim.sites.ruled import Ruled
from trecsim.sites.site_file import NOT_YET, RigPlace
from trecsim.sites.site_names import Name
from trecsim.toml_models import parsed, read_text
from trecsim.toml_models.toml_reading import examined, file_faults

_KIND = "site file"


class RecordedSite(Ruled):
    """A site file whose sources and outputs may be missing, and are not opened."""

    not_yet = NOT_YET

    format: Literal["trecsim.site/1"]
    """Always this."""
    name: Name
    """What the site is called."""
    rig: RigPlace | None = None
    """The calibration of the cameras; events then say which cameras have somebody in view."""
    sources: Any = None
    """Not looked at."""
    secrets: Any = None
    """Not looked at."""
    poses: Any = None
    """Not looked at."""
    estimator: Any = None
    """Not looked at."""
    fusion: Any = None
    """Not looked at."""
    output: Any = None
    """Not looked at."""
    repair: Any = None
    """Not looked at."""
    outputs: Any = None
    """Not looked at."""
    retention: Any = None
    """Not looked at."""
    page: Any = None
    """Not looked at."""


def read_recorded_site(path: Path) -> tuple[RecordedSite, Rig | None]:
    """Read what rules need of a site file, and its rig.

    Parameters
    ----------
    path
        The site file.

    Raises
    ------
    ConfigError
        When it cannot be read or anything in it is wrong; the text lists all faults.
    CalibrationError
        When its rig is wrong.
    """
    site = read_without_rig(path)
    if site.rig is None:
        return site, None
    rig: Rig = site.rig.read(_not_said_again)
    return site, rig


def read_without_rig(path: Path) -> RecordedSite:
    """Read what rules need of a site file; its rig need not be there yet.

    Raises
    ------
    ConfigError
        When it cannot be read or anything in it is wrong; the text lists all faults.
    """
    text = read_text(path, _KIND)
    site, faults = examined(RecordedSite, parsed(path, text, _KIND), {"folder": path.parent})
    if site is None:
        raise file_faults(path, text, faults)
    return site


def _not_said_again(remark: str) -> None:
    """Drop a remark on the rig; whoever tracks with it says it."""
