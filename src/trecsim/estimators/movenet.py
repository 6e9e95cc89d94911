"""The default estimator: MoveNet MultiPose Lightning on the processor, run by OpenVINO."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Float32, UInt8

from trecsim.errors import ConfigError, SetupError
from trecsim.estimators import decode, store
from trecsim.estimators.estimator_settings import (
    LongSide,
    MaxPeople,
    Score,
    SecondLook,
    Threads,
    checked,
    cores,
)
from trecsim.estimators.letterbox import Letterbox
from trecsim.estimators.looks import Look
from trecsim.extras import install_command
from trecsim.skeleton import COCO17
from trecsim.values import Frame, Poses2D

if TYPE_CHECKING:
    import openvino as ov

_MULTIPLE_PX = 32  # what the network divides its input by
_FAINTEST_CENTRE = 0.1  # centres of people score above 0.8, of nobody below 0.03


@dataclass(frozen=True, slots=True)
class MoveNetSettings:
    """How MoveNet looks at images.

    Attributes
    ----------
    long_side
        Longer side of the image as the network sees it [px]. Larger finds smaller people and
        places joints more precisely, costs more, and misses people who fill the image.
    max_people
        At most so many in one image; time is taken by those who are there.
    min_person_score, min_joint_score
        Who or what scores less is left out. Good poses score 0.3 to 0.8.
    second_look
        Longer side of a second, smaller version of each image [px], in which those are found who
        stand so close that they fill the image: 91 of 100 such, instead of 16 without it. It costs
        a third more time; 0 leaves it out.
    threads
        Processor threads to use; None takes all cores.
    precision
        ``auto`` computes in bfloat16 where the processor can, which takes about half the time and
        moves key points by less than they are uncertain; ``f32`` gives the same numbers on every
        machine.
    """

    long_side: LongSide = 512
    max_people: MaxPeople = 40
    min_person_score: Score = 0.2
    min_joint_score: Score = 0.2
    second_look: SecondLook = 256
    threads: Threads | None = None
    precision: Literal["auto", "f32"] = "auto"


class MoveNet:
    """MoveNet MultiPose Lightning; may be called by `workers` threads at the same time.

    Parameters
    ----------
    path
        The model, a ``.tflite`` file.
    settings
        How it looks at images.

    Raises
    ------
    SetupError
        When OpenVINO is missing or does not take the file.
    """

    skeleton = COCO17.name

    def __init__(self, path: Path, settings: MoveNetSettings) -> None:
        self.settings = settings
        self.workers = settings.threads or cores()
        self.image_limit_px = (settings.long_side, settings.long_side)
        self.usual: tuple[Look, ...] = (Look(settings.long_side),)
        if 0 < settings.second_look < settings.long_side:
            self.usual += (Look(settings.second_look),)
        model = _compile(path, settings, self.workers)
        self._idle: SimpleQueue[ov.InferRequest] = SimpleQueue()
        for _ in range(self.workers):
            self._idle.put(model.create_infer_request())

    def __call__(self, frame: Frame) -> Poses2D:
        """Find the people; key points are pixels of `frame`'s image."""
        return self.look(frame, self.usual)

    def look(self, frame: Frame, looks: Sequence[Look]) -> Poses2D:
        """Find the people in `frame`'s image, the earlier looks first."""
        chosen, people = self.settings, decode.NOBODY
        for look in looks:
            merge = decode.better if look.turns else decode.complete
            people = merge(people, self._found(frame.image, look))
        people = people.first(chosen.max_people)
        return decode.to_poses(people, chosen.min_joint_score, frame.camera, frame.t_s)

    def _found(self, image: UInt8[np.ndarray, "h w 3"], look: Look) -> decode.Detections:
        """Return the people whom one look finds [px of `image`]."""
        turned = look.turned(image)
        height, width, _ = turned.shape
        box = Letterbox.along((width, height), look.long_side, _MULTIPLE_PX)
        found = decode.movenet(self._infer(box.apply(turned, fill=0)), box.input_px).in_image(box)
        chosen = self.settings
        best = decode.choose(found, chosen.min_person_score, chosen.max_people)
        return look.turned_back(best, (image.shape[1], image.shape[0]))

    def _infer(self, image: UInt8[np.ndarray, "h w 3"]) -> Float32[np.ndarray, "1 person 56"]:
        request = self._idle.get()
        try:
            out: Float32[np.ndarray, "1 person 56"] = request.infer([image[None]])[0].copy()
        finally:
            self._idle.put(request)
        return out


def load(argument: str = "", **settings: object) -> MoveNet:
    """Return the default estimator; fetch its model on first use.

    Parameters
    ----------
    argument
        Nothing.
    settings
        See `MoveNetSettings`.

    Raises
    ------
    ConfigError
        When a setting is wrong.
    SetupError
        When OpenVINO or the model is missing.
    """
    chosen = check(argument, **settings)
    return MoveNet(store.pull("movenet"), chosen)


def check(argument: str = "", **settings: object) -> MoveNetSettings:
    """Return the settings for `load`, without loading anything.

    Raises
    ------
    ConfigError
        When a setting is wrong.
    """
    if argument:
        raise ConfigError(
            f"estimator 'movenet' takes nothing after a colon, got {argument!r}; "
            "for a model of your own: onnx:FILE"
        )
    return checked(MoveNetSettings, settings, "movenet")


def _compile(path: Path, settings: MoveNetSettings, threads: int) -> "ov.CompiledModel":
    try:
        import openvino as ov
    except ImportError as error:
        raise SetupError(
            f"the estimator 'movenet' needs OpenVINO ({error}): {install_command('video')}"
        ) from error
    core = ov.Core()
    config: dict[str, object] = {
        "INFERENCE_NUM_THREADS": threads,
        "NUM_STREAMS": threads,  # one image per thread: the most images per second
        "ENABLE_CPU_PINNING": False,  # decoding and fusion share the cores
    }
    if settings.precision == "f32":
        config["INFERENCE_PRECISION_HINT"] = "f32"
    try:
        model = core.read_model(path)
        _lift_limit(model, settings.max_people)
        return core.compile_model(model, "CPU", config)
    except (RuntimeError, ValueError) as error:
        reason = str(error).strip().splitlines()[-1:] or ["no reason given"]
        raise SetupError(f"OpenVINO does not take the model {path}: {reason[0]}") from error


def _lift_limit(model: "ov.Model", max_people: int) -> None:
    """Make the network look for as many people as there are, up to `max_people`, not for six.

    Notes
    -----
    The network takes the best six of its map of people's centres, and spends time on each of them
    whether anybody is there or not. Here the number becomes that of the centres that are not
    nothing, so few people cost less than with six, and forty can be found.
    """
    from openvino import opset13 as ops

    nodes = {node.get_friendly_name(): node for node in model.get_ops()}
    if not {"Minimum/x", "Reshape_34/shape"} <= nodes.keys():
        raise RuntimeError("it is not MoveNet MultiPose")
    limit, shape = nodes["Minimum/x"], nodes["Reshape_34/shape"]
    centres = _only_user(_only_user(limit)).input_value(0)  # of the node that takes the best
    somebody = ops.convert(ops.greater(centres, ops.constant(np.float32(_FAINTEST_CENTRE))), "i32")
    count = ops.reduce_sum(somebody, ops.constant(np.array([0, 1], np.int64)))
    count = ops.minimum(count, ops.constant(np.int32(max_people)))
    _replace(limit, ops.maximum(count, ops.constant(np.int32(1))))
    _replace(shape, ops.constant(np.array([1, -1, 51], np.int32)))
    model.validate_nodes_and_infer_types()


def _only_user(node: "ov.Node") -> "ov.Node":
    (user,) = node.output(0).get_target_inputs()
    return user.get_node()


def _replace(old: "ov.Node", new: "ov.Node") -> None:
    for user in old.output(0).get_target_inputs():
        user.replace_source_output(new.output(0))
