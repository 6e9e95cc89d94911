"""Track every person in 3D from two or more fixed, calibrated cameras.

The public names are imported on first use, so that `import trecsim` is fast.

Examples
--------
::

    import trecsim

    rig = trecsim.read_rig("rig.toml")
    for snapshot in trecsim.follow(trecsim.read_poses("walk.poses.jsonl"), rig):
        print(snapshot.t_s, snapshot.id, snapshot.xyz_m[:, 0])
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from trecsim.assessing import assess as assess
    from trecsim.calibration import read_rig as read_rig
    from trecsim.calibration import write_rig as write_rig
    from trecsim.errors import CalibrationError as CalibrationError
    from trecsim.errors import ConfigError as ConfigError
    from trecsim.errors import Error as Error
    from trecsim.errors import InputError as InputError
    from trecsim.errors import SetupError as SetupError
    from trecsim.estimators.pool import estimate as estimate
    from trecsim.export.exporting import ExportSettings as ExportSettings
    from trecsim.export.exporting import export_tracks as export_tracks
    from trecsim.forecast_files import evaluate_forecast as evaluate_forecast
    from trecsim.forecast_files import forecast as forecast
    from trecsim.forecasting import Forecaster as Forecaster
    from trecsim.fusion import FusionSettings as FusionSettings
    from trecsim.fusion import Tracker as Tracker
    from trecsim.geometry import Camera as Camera
    from trecsim.geometry import Rig as Rig
    from trecsim.geometry import triangulate as triangulate
    from trecsim.lab.evaluation.evaluating import evaluate as evaluate
    from trecsim.lab.report.building import report as report
    from trecsim.page.client import LiveEvent as LiveEvent
    from trecsim.page.client import connect as connect
    from trecsim.pipeline import track as track
    from trecsim.site_run import run as run
    from trecsim.sites.check import check_site as check_site
    from trecsim.skeleton import COCO17 as COCO17
    from trecsim.skeleton import Skeleton as Skeleton
    from trecsim.sources import VideoFile as VideoFile
    from trecsim.sources import read_poses as read_poses
    from trecsim.store.tracks import read_tracks as read_tracks
    from trecsim.store.truth import read_truth as read_truth
    from trecsim.sync import frame_sets as frame_sets
    from trecsim.tracking import follow as follow
    from trecsim.values import Frame as Frame
    from trecsim.values import FrameSet as FrameSet
    from trecsim.values import Poses2D as Poses2D
    from trecsim.values import Snapshot as Snapshot

_HOMES = {
    "trecsim.assessing": ("assess",),
    "trecsim.calibration": ("read_rig", "write_rig"),
    "trecsim.sites.check": ("check_site",),
    "trecsim.errors": ("CalibrationError", "ConfigError", "Error", "InputError", "SetupError"),
    "trecsim.estimators.pool": ("estimate",),
    "trecsim.lab.evaluation.evaluating": ("evaluate",),
    "trecsim.lab.report.building": ("report",),
    "trecsim.forecast_files": ("evaluate_forecast", "forecast"),
    "trecsim.forecasting": ("Forecaster",),
    "trecsim.fusion": ("FusionSettings", "Tracker"),
    "trecsim.geometry": ("Camera", "Rig", "triangulate"),
    "trecsim.page.client": ("LiveEvent", "connect"),
    "trecsim.pipeline": ("track",),
    "trecsim.site_run": ("run",),
    "trecsim.skeleton": ("COCO17", "Skeleton"),
    "trecsim.sources": ("VideoFile", "read_poses"),
    "trecsim.export.exporting": ("ExportSettings", "export_tracks"),
    "trecsim.store.tracks": ("read_tracks",),
    "trecsim.store.truth": ("read_truth",),
    "trecsim.sync": ("frame_sets",),
    "trecsim.tracking": ("follow",),
    "trecsim.values": ("Frame", "FrameSet", "Poses2D", "Snapshot"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = sorted(_HOME_OF)


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME_OF[name]), name)


def __dir__() -> list[str]:
    return sorted([*__all__, *(name for name in globals() if name.startswith("__"))])
