"""Check the arguments of a tracker; one line says what is wrong."""

from trecsim.errors import ConfigError, InputError
from trecsim.fusion.settings import FusionSettings
from trecsim.geometry import Rig
from trecsim.skeleton import Skeleton

LONGEST_LAG_S = 10.0
"""Longest smoothing lag [s]; the live window of the splines grows with it."""


def check_arguments(rig: object, settings: object, skeleton: object, lag_s: object) -> None:
    """Raise an error for arguments that a tracker cannot take.

    Parameters
    ----------
    rig, settings, skeleton, lag_s
        As for `Tracker`.

    Raises
    ------
    InputError
        The rig or the skeleton is of another type.
    ConfigError
        The settings are of another type or need more joints than the skeleton has, or the lag is
        out of range.
    """
    if not isinstance(rig, Rig):
        raise InputError(
            f"rig must be a Rig, as trecsim.read_rig returns it, got {called(rig)}{_hint(rig)}"
        )
    if not isinstance(skeleton, Skeleton):
        raise InputError(
            f"skeleton must be a Skeleton, such as trecsim.COCO17, got {called(skeleton)}"
        )
    if settings is not None and not isinstance(settings, FusionSettings):
        raise ConfigError(
            "settings must be FusionSettings, such as FusionSettings(knot_s=0.08), got "
            f"{called(settings)}"
        )
    if settings is not None and settings.min_joints > len(skeleton.joints):
        raise ConfigError(
            f"fusion settings: min_joints = {settings.min_joints} leaves nobody, as the skeleton "
            f"{skeleton.name} has {len(skeleton.joints)} joints; give at most as many"
        )
    _check_lag(lag_s)


def _check_lag(lag_s: object) -> None:
    if isinstance(lag_s, bool) or not isinstance(lag_s, int | float):
        raise ConfigError(
            f"the lag must be a number of seconds between 0 and {LONGEST_LAG_S:g}, got "
            f"{called(lag_s)}"
        )
    if not 0.0 <= lag_s <= LONGEST_LAG_S:
        raise ConfigError(f"the lag must lie between 0 and {LONGEST_LAG_S:g} s, got {lag_s:g} s")


def called(value: object) -> str:
    """Return a short description of a wrong argument.

    Examples
    --------
    >>> called("rig.toml"), called(0.5), called([])
    ("the text 'rig.toml'", 'the number 0.5', 'a list')
    """
    if _is_path(value):
        return f"the text {str(value)[:80]!r}"
    if isinstance(value, int | float) and not isinstance(value, bool):
        return f"the number {value!r}"
    if value is None:
        return "nothing (None)"
    name = type(value).__name__
    return f"{'an' if name[0] in 'AEIOUaeio' else 'a'} {name}"


def _hint(rig: object) -> str:
    if _is_path(rig):
        return "; read the file first: trecsim.read_rig(path)"
    if isinstance(rig, FusionSettings):
        return "; the rig comes before the settings"
    return ""


def _is_path(value: object) -> bool:
    return isinstance(value, str) or hasattr(value, "__fspath__")
