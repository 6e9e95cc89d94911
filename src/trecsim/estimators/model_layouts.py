"""Which kind of pose network a file holds, told from the shapes of what goes in and comes out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import UInt8

from trecsim.errors import ConfigError
from trecsim.estimators import decode
from trecsim.estimators.decode import Detections
from trecsim.estimators.letterbox import Size

Read = Callable[[Sequence[np.ndarray], Size], Detections]

_ANCHORS = 3
_MOST_INPUT_PX = 8192  # per side; a file that asks for more is damaged

KNOWN = (
    "YOLOv7-pose (1 x candidates x 57, or end to end), YOLOv8-pose and YOLO11-pose "
    "(1 x 56 x candidates), YOLO26-pose (1 x 300 x 57), RTMO (dets and keypoints), "
    "MoveNet MultiPose (1 x people x 56)"
)


@dataclass(frozen=True, slots=True)
class Tensor:
    """What goes into a network or comes out.

    Attributes
    ----------
    name
        In the file.
    shape
        A dimension that is not fixed is None or a name.
    dtype
        Of its numbers, as NumPy calls it.
    """

    name: str
    shape: tuple[int | str | None, ...]
    dtype: str

    def __str__(self) -> str:
        sides = " x ".join("?" if not isinstance(side, int) else str(side) for side in self.shape)
        return f"{self.name} ({sides}, {self.dtype})"


@dataclass(frozen=True, slots=True)
class Layout:
    """How to feed a network and how to read it.

    Attributes
    ----------
    name
        Of the family of networks.
    outputs
        Names of the outputs that `read` takes, in its order.
    read
        Turns the outputs and the (width, height) of the input into people.
    input_px
        (width, height) of the input; None where any is taken.
    multiple
        Width and height must be multiples of this.
    channels_first, colours, full_scale
        Order of the axes, order of the colours, and the value of white.
    dtype
        Of the numbers that go in.
    centred, fill
        Where the padding goes, and its grey.
    min_person_score, min_joint_score
        Who or what scores less is left out, unless the user says otherwise.
    """

    name: str
    outputs: tuple[str, ...]
    read: Read
    input_px: Size | None
    dtype: str
    multiple: int = 32
    channels_first: bool = True
    colours: Literal["rgb", "bgr"] = "rgb"
    full_scale: float = 1.0
    centred: bool = True
    fill: int = 114
    min_person_score: float = 0.25
    min_joint_score: float = 0.3

    def feed(self, image: UInt8[np.ndarray, "h w 3"]) -> np.ndarray:
        """Return `image`, RGB and of the right size, as the network wants it."""
        pixels = image[..., ::-1] if self.colours == "bgr" else image
        if self.channels_first:
            pixels = pixels.transpose(2, 0, 1)
        if self.full_scale == 255.0:
            return np.ascontiguousarray(pixels[None].astype(self.dtype))
        scaled = pixels[None].astype(np.float32) * np.float32(self.full_scale / 255.0)
        return np.ascontiguousarray(scaled.astype(self.dtype))


def recognise(inputs: Sequence[Tensor], outputs: Sequence[Tensor]) -> Layout:
    """Return the layout of a network with these inputs and outputs.

    Raises
    ------
    ConfigError
        When it is none that is known.
    """
    if len(inputs) == 1 and len(inputs[0].shape) == 4:
        image = inputs[0]
        if image.shape[3] == 3 and image.shape[1] != 3:
            layout = _movenet(image, outputs)
        else:
            layout = _rtmo(image, outputs) or _yolo(image, outputs)
        if layout is not None:
            return layout
    raise ConfigError(
        f"its layout is not known: in: {', '.join(map(str, inputs))}; "
        f"out: {', '.join(map(str, outputs))}. Known are {KNOWN}. Networks that look at one person "
        "at a time (RTMPose) need a detector: see the estimator 'rtmlib'"
    )


def _movenet(image: Tensor, outputs: Sequence[Tensor]) -> Layout | None:
    if len(outputs) != 1 or len(outputs[0].shape) != 3 or outputs[0].shape[2] != 56:
        return None
    return Layout(
        name="MoveNet MultiPose",
        outputs=(outputs[0].name,),
        read=lambda out, input_px: decode.movenet(out[0], input_px),
        input_px=_fixed(image, image.shape[1:3]),
        dtype=image.dtype,
        channels_first=False,
        full_scale=255.0,
        centred=False,
        fill=0,
        min_person_score=0.2,
        min_joint_score=0.2,
    )


def _rtmo(image: Tensor, outputs: Sequence[Tensor]) -> Layout | None:
    dets = [out for out in outputs if len(out.shape) == 3 and out.shape[2] == 5]
    joints = [out for out in outputs if len(out.shape) == 4 and out.shape[2:] == (17, 3)]
    if len(dets) != 1 or len(joints) != 1:
        return None
    return Layout(
        name="RTMO",
        outputs=(dets[0].name, joints[0].name),
        read=lambda out, _: decode.rtmo(out[0], out[1]),
        input_px=_fixed(image, image.shape[2:]) or (640, 640),  # what its makers train it at
        dtype=image.dtype,
        colours="bgr",
        full_scale=255.0,
        centred=False,
        min_person_score=0.3,
    )


def _yolo(image: Tensor, outputs: Sequence[Tensor]) -> Layout | None:
    for out in outputs:
        if len(out.shape) == 3 and out.shape[1] == 56:
            return _yolo_layout(image, out, 32, lambda array, _: decode.yolo_raw(array[0]))
        if len(out.shape) in (2, 3) and out.shape[-1] == 57:
            return _yolo_layout(image, out, 64, _read_57)
    return None


def _yolo_layout(image: Tensor, out: Tensor, multiple: int, read: Read) -> Layout:
    return Layout(
        name="YOLO-pose",
        outputs=(out.name,),
        read=read,
        input_px=_fixed(image, image.shape[2:]),
        dtype=image.dtype,
        multiple=multiple,
    )


def _read_57(out: Sequence[np.ndarray], input_px: Size) -> Detections:
    """Read 57 columns: every candidate of every cell, or only the people that are left.

    Both have the same shape but for the number of rows, which the size of the input gives for the
    first kind; YOLOv7-pose has cells of 8, 16 and 32 pixels, its larger kin also of 64.
    """
    cells = [-(-input_px[0] // step) * -(-input_px[1] // step) for step in (8, 16, 32, 64)]
    if out[0].size // 57 in (_ANCHORS * sum(cells), _ANCHORS * sum(cells[:3])):
        return decode.yolov7_raw(out[0])
    return decode.yolo_end_to_end(out[0])


def _fixed(image: Tensor, sides: Sequence[int | str | None]) -> Size | None:
    height, width = sides
    if not (isinstance(height, int) and isinstance(width, int)):
        return None
    if not (0 < width <= _MOST_INPUT_PX and 0 < height <= _MOST_INPUT_PX):
        raise ConfigError(f"its input {image} is no image")
    return width, height
