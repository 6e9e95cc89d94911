"""RTMO and RTMPose by rtmlib, which fetches their weights from their makers."""

import sys
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from trecsim.errors import ConfigError, SetupError
from trecsim.estimators import decode
from trecsim.estimators.estimator_settings import MaxPeople, Score, checked
from trecsim.estimators.onnx import OnnxEstimator, OnnxSettings
from trecsim.extras import install_command
from trecsim.skeleton import COCO17
from trecsim.values import Frame, Poses2D

_DEFAULT = "rtmo-m"
# What the sizes are called in rtmlib's tables.
_RTMO = {"rtmo-s": "lightweight", "rtmo-m": "balanced", "rtmo-l": "performance"}
_RTMPOSE = {"rtmpose-s": "lightweight", "rtmpose-m": "balanced", "rtmpose-x": "performance"}


@dataclass(frozen=True, slots=True)
class RtmPoseSettings:
    """How RTMPose looks at images.

    Attributes
    ----------
    max_people
        At most so many in one image.
    min_person_score
        Who scores less is left out; a person's score is the mean of the key points'.
    min_joint_score
        Key points that score less are left out.
    device
        Where it runs, as rtmlib calls it.
    """

    max_people: MaxPeople = 100
    min_person_score: Score = 0.3
    min_joint_score: Score = 0.3
    device: Literal["cpu", "cuda", "rocm", "mps"] = "cpu"


class RtmPose:
    """People found by YOLOX, their joints by RTMPose; one image at a time on all cores.

    Parameters
    ----------
    body
        rtmlib's ``Body``: called with a BGR image, returns key points [px] and their scores.
    settings
        How it looks at images.
    """

    skeleton = COCO17.name

    def __init__(self, body: Any, settings: RtmPoseSettings) -> None:
        self._body = body
        self.settings = settings

    def __call__(self, frame: Frame) -> Poses2D:
        """Find the people; key points are pixels of `frame`'s image."""
        found = people(*self._body(np.ascontiguousarray(frame.image[..., ::-1])))
        chosen = decode.choose(found, self.settings.min_person_score, self.settings.max_people)
        return decode.to_poses(chosen, self.settings.min_joint_score, frame.camera, frame.t_s)


def people(
    xy_px: Float[np.ndarray, "person 17 2"], score: Float[np.ndarray, "person 17"]
) -> decode.Detections:
    """Return what rtmlib found; an image without people gives it one person with scores of 0."""
    xy_px, score = np.asarray(xy_px, np.float64), np.asarray(score, np.float64)
    box_px = np.hstack([xy_px.min(axis=1), xy_px.max(axis=1)])
    return decode.detections(xy_px, score, score.mean(axis=1), box_px)


def load(argument: str = "", **settings: object) -> OnnxEstimator | RtmPose:
    """Return RTMO or RTMPose; rtmlib fetches the weights on first use.

    Parameters
    ----------
    argument
        ``rtmo-s``, ``rtmo-m`` (the default), ``rtmo-l``, ``rtmpose-s``, ``rtmpose-m`` or
        ``rtmpose-x``.
    settings
        See `trecsim.estimators.onnx.OnnxSettings` for RTMO and `RtmPoseSettings` for RTMPose.

    Raises
    ------
    ConfigError
        When there is no such model, or a setting is wrong.
    SetupError
        When rtmlib is missing, or the weights are and cannot be fetched.
    """
    name, chosen = argument or _DEFAULT, check(argument, **settings)
    if isinstance(chosen, OnnxSettings):
        return OnnxEstimator(_weights(_rtmlib().Body.RTMO_MODE[_RTMO[name]]["pose"]), chosen)
    files = _rtmlib().Body.MODE[_RTMPOSE[name]]
    detector, pose = _weights(files["det"]), _weights(files["pose"])
    with redirect_stdout(sys.stderr):  # rtmlib prints; stdout belongs to results
        body = _rtmlib().Body(
            det=str(detector),
            det_input_size=files["det_input_size"],
            pose=str(pose),
            pose_input_size=files["pose_input_size"],
            backend="onnxruntime",
            device=chosen.device,
        )
    return RtmPose(body, chosen)


def check(argument: str = "", **settings: object) -> OnnxSettings | RtmPoseSettings:
    """Return the settings for `load`, without loading anything.

    Raises
    ------
    ConfigError
        When there is no such model, or a setting is wrong.
    """
    name = argument or _DEFAULT
    if name in _RTMO:
        return checked(OnnxSettings, settings, f"rtmlib:{name}")
    if name in _RTMPOSE:
        return checked(RtmPoseSettings, settings, f"rtmlib:{name}")
    known = ", ".join([*_RTMO, *_RTMPOSE])
    raise ConfigError(f"estimator 'rtmlib' knows no model {name!r}; known: {known}")


def _rtmlib() -> ModuleType:
    try:
        import rtmlib
    except ImportError as error:
        raise SetupError(
            f"the estimator 'rtmlib' needs rtmlib ({error}): {install_command('rtmlib')}"
        ) from error
    module: ModuleType = rtmlib
    return module


def _weights(address: str) -> Path:
    """Return the file that rtmlib keeps of `address`; let it fetch that if it is not there."""
    from rtmlib.tools import file as rtm_files

    try:
        return Path(rtm_files.download_checkpoint(address, progress=sys.stderr.isatty()))
    except (OSError, RuntimeError, ValueError) as error:  # URLError is an OSError
        folder = Path(rtm_files._get_rtmhub_dir()) / "checkpoints"
        stem = Path(address).stem
        raise SetupError(
            f"could not fetch {stem} ({error}). Without a network here, fetch {address} elsewhere "
            f"and put it, or the .onnx file in it under the name {stem}.onnx, into {folder}"
        ) from error
