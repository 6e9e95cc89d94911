"""Pose networks in ONNX files that the user brings, run by ONNX Runtime."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from trecsim.errors import ConfigError, InputError, SetupError
from trecsim.estimators import decode
from trecsim.estimators.estimator_settings import (
    LongSide,
    MaxPeople,
    Score,
    Threads,
    checked,
    cores,
)
from trecsim.estimators.letterbox import Letterbox
from trecsim.estimators.model_layouts import Tensor, recognise
from trecsim.extras import install_command
from trecsim.skeleton import COCO17
from trecsim.values import Frame, Poses2D

if TYPE_CHECKING:
    import onnxruntime as ort

_MOST_AT_ONCE = 4  # images; each needs memory for all its layers
_NUMPY = {
    "tensor(float)": "float32",
    "tensor(float16)": "float16",
    "tensor(double)": "float64",
    "tensor(uint8)": "uint8",
    "tensor(int32)": "int32",
}
_PROVIDERS = {
    "cuda": "CUDAExecutionProvider",
    "tensorrt": "TensorrtExecutionProvider",
    "rocm": "ROCMExecutionProvider",
    "coreml": "CoreMLExecutionProvider",
    "directml": "DmlExecutionProvider",
    "cpu": "CPUExecutionProvider",
}


@dataclass(frozen=True, slots=True)
class OnnxSettings:
    """How a network from a file looks at images.

    Attributes
    ----------
    long_side
        Longer side of the image as the network sees it [px]; for files with a fixed input, that
        of the file counts.
    max_people
        At most so many in one image.
    min_person_score, min_joint_score
        Who or what scores less is left out; None takes what suits the kind of network: 0.25 and
        0.3 for YOLO, 0.3 and 0.3 for RTMO, 0.2 and 0.2 for MoveNet.
    threads
        Processor threads to use; None takes all cores.
    device
        ``auto`` takes CUDA where it is installed, else the processor.
    """

    long_side: LongSide = 640
    max_people: MaxPeople = 100
    min_person_score: Score | None = None
    min_joint_score: Score | None = None
    threads: Threads | None = None
    device: Literal["auto", "cpu", "cuda", "tensorrt", "rocm", "coreml", "directml"] = "auto"


class OnnxEstimator:
    """A pose network from an ONNX file; may be called by `workers` threads at the same time.

    Parameters
    ----------
    path
        The file.
    settings
        How it looks at images.

    Raises
    ------
    InputError
        When the file is no network, or none of a known layout.
    SetupError
        When ONNX Runtime, or what it needs for the device, is missing.
    """

    skeleton = COCO17.name

    def __init__(self, path: Path, settings: OnnxSettings) -> None:
        self.path = path
        self.settings = settings
        threads = settings.threads or cores()
        self.workers = min(threads, _MOST_AT_ONCE)
        self._session = _open(path, settings.device, max(1, threads // self.workers))
        inputs = [_tensor(path, node) for node in self._session.get_inputs()]
        outputs = [_tensor(path, node) for node in self._session.get_outputs()]
        try:
            self.layout = recognise(inputs, outputs)
        except ConfigError as error:
            raise ConfigError(f"{path}: {error}") from None
        self._input_name = inputs[0].name
        side = settings.long_side
        self.image_limit_px = self.layout.input_px or (side, side)

    def __call__(self, frame: Frame) -> Poses2D:
        """Find the people; key points are pixels of `frame`'s image."""
        height, width, _ = frame.image.shape
        box = self._letterbox((width, height))
        out = self._run(self.layout.feed(box.apply(frame.image, self.layout.fill)))
        found = self._read(out, box).in_image(box)
        chosen, layout = self.settings, self.layout
        min_person_score = _or(chosen.min_person_score, layout.min_person_score)
        people = decode.choose(found, min_person_score, chosen.max_people)
        min_joint_score = _or(chosen.min_joint_score, layout.min_joint_score)
        return decode.to_poses(people, min_joint_score, frame.camera, frame.t_s)

    def _letterbox(self, size_px: tuple[int, int]) -> Letterbox:
        layout = self.layout
        if layout.input_px is not None:
            return Letterbox.within(size_px, layout.input_px, centred=layout.centred)
        return Letterbox.along(size_px, self.settings.long_side, layout.multiple)

    def _run(self, feed: np.ndarray) -> list[np.ndarray]:
        try:
            out: list[np.ndarray] = self._session.run(
                list(self.layout.outputs), {self._input_name: feed}
            )
        except _faults() as error:
            raise InputError(
                f"{self.path}, taken for {self.layout.name}, does not run on an input of "
                f"{' x '.join(map(str, feed.shape))}: {_reason(error)}"
            ) from error
        return out

    def _read(self, out: list[np.ndarray], box: Letterbox) -> decode.Detections:
        try:
            return self.layout.read(out, box.input_px)
        except ValueError as error:
            shapes = ", ".join(" x ".join(map(str, array.shape)) for array in out)
            raise InputError(
                f"{self.path}, taken for {self.layout.name}, puts out {shapes}, which does not "
                f"fit: {error}"
            ) from error


def load(argument: str = "", **settings: object) -> OnnxEstimator:
    """Return an estimator for the ONNX file at `argument`.

    Parameters
    ----------
    argument
        Path of the file.
    settings
        See `OnnxSettings`.

    Raises
    ------
    InputError
        When the file or a setting is wrong.
    SetupError
        When ONNX Runtime is missing.
    """
    chosen = check(argument, **settings)
    return OnnxEstimator(Path(argument).expanduser(), chosen)


def check(argument: str = "", **settings: object) -> OnnxSettings:
    """Return the settings for `load`, without loading anything.

    Raises
    ------
    InputError
        When the file or a setting is wrong.
    """
    if not argument:
        raise ConfigError("estimator 'onnx' needs a file: onnx:FILE")
    chosen = checked(OnnxSettings, settings, "onnx")
    path = Path(argument).expanduser()
    if not path.is_file():
        raise InputError(f"estimator 'onnx': there is no file {path}")
    return chosen


def _open(path: Path, device: str, threads: int) -> "ort.InferenceSession":
    try:
        import onnxruntime as ort
    except ImportError as error:
        raise SetupError(
            f"the estimator 'onnx' needs ONNX Runtime ({error}): {install_command('onnx')}"
        ) from error
    options = ort.SessionOptions()
    options.intra_op_num_threads = threads
    options.log_severity_level = 3  # errors; they come back as exceptions anyway
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    providers = _providers(device, ort.get_available_providers())
    try:
        return ort.InferenceSession(str(path), options, providers=providers)
    except _faults() as error:
        raise InputError(
            f"{path} is no ONNX file that can be run here: {_reason(error)}"
        ) from error


def _providers(device: str, available: list[str]) -> list[str]:
    if device == "auto":
        device = "cuda" if _PROVIDERS["cuda"] in available else "cpu"
    if _PROVIDERS[device] not in available:
        here = ", ".join(name for name, provider in _PROVIDERS.items() if provider in available)
        raise SetupError(
            f"estimator 'onnx': this ONNX Runtime cannot use the device {device!r}; it can use: "
            f"{here}. Install the build of onnxruntime for it, or choose another device"
        )
    return list(dict.fromkeys([_PROVIDERS[device], _PROVIDERS["cpu"]]))


def _tensor(path: Path, node: "ort.NodeArg") -> Tensor:
    if node.type not in _NUMPY:
        raise InputError(f"{path}: {node.name} is a {node.type}, expected numbers")
    return Tensor(node.name, tuple(node.shape), _NUMPY[node.type])


def _faults() -> tuple[type[Exception], ...]:
    """Return what ONNX Runtime raises: many classes that have nothing in common."""
    from onnxruntime.capi import onnxruntime_pybind11_state as state

    named = [thing for thing in vars(state).values() if isinstance(thing, type)]
    return (RuntimeError, *(kind for kind in named if issubclass(kind, Exception)))


def _reason(error: Exception) -> str:
    return " ".join(str(error).split())[:400]


def _or(value: float | None, default: float) -> float:
    return default if value is None else value
