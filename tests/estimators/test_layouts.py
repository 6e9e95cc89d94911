import numpy as np
import pytest

from trecsim.errors import ConfigError
from trecsim.estimators.model_layouts import Tensor, recognise

IMAGE = Tensor("images", (1, 3, 640, 640), "float32")


def out(*shape, name="output"):
    return Tensor(name, shape, "float32")


@pytest.mark.parametrize(
    ("inputs", "outputs", "name", "input_px"),
    [
        (IMAGE, [out(1, 56, 8400)], "YOLO-pose", (640, 640)),
        (IMAGE, [out("batch", 56, "anchors")], "YOLO-pose", (640, 640)),
        (IMAGE, [out(1, 300, 57)], "YOLO-pose", (640, 640)),
        (IMAGE, [out(1, 25500, 57)], "YOLO-pose", (640, 640)),
        (IMAGE, [out("people", 57)], "YOLO-pose", (640, 640)),
        (IMAGE, [out(1, 3, 80, 80, 57), out(1, 25500, 57)], "YOLO-pose", (640, 640)),
        (
            Tensor("images", ("batch", 3, "height", "width"), "float16"),
            [out("batch", 56, "anchors")],
            "YOLO-pose",
            None,
        ),
        (
            Tensor("images", (1, 3, 384, 640), "float32"),
            [out(1, 300, 57)],
            "YOLO-pose",
            (640, 384),
        ),
        (
            Tensor("input", ("b", 3, 640, 640), "float32"),
            [out("b", "n", 5, name="dets"), out("b", "n", 17, 3, name="keypoints")],
            "RTMO",
            (640, 640),
        ),
        (
            Tensor("input", ("b", 3, "h", "w"), "float32"),
            [out("b", "n", 17, 3, name="keypoints"), out("b", "n", 5, name="dets")],
            "RTMO",
            (640, 640),
        ),
        (
            Tensor("input", (1, None, None, 3), "int32"),
            [out(1, 6, 56)],
            "MoveNet MultiPose",
            None,
        ),
        (
            Tensor("input", (1, 256, 320, 3), "uint8"),
            [out(1, 6, 56)],
            "MoveNet MultiPose",
            (320, 256),
        ),
    ],
)
def test_networks_are_known_by_their_shapes(inputs, outputs, name, input_px):
    layout = recognise([inputs], outputs)
    assert (layout.name, layout.input_px) == (name, input_px)


def test_outputs_are_read_in_the_order_that_the_decoder_takes():
    layout = recognise(
        [Tensor("input", (1, 3, 640, 640), "float32")],
        [out(1, "n", 17, 3, name="keypoints"), out(1, "n", 5, name="dets")],
    )
    assert layout.outputs == ("dets", "keypoints")


@pytest.mark.parametrize(
    ("inputs", "outputs"),
    [
        ([IMAGE], [out(1, 1000)]),
        ([IMAGE], [out(1, 84, 8400)]),
        ([IMAGE], []),
        ([], [out(1, 56, 8400)]),
        ([IMAGE, IMAGE], [out(1, 56, 8400)]),
        ([Tensor("x", (1, 3), "float32")], [out(1, 56, 8400)]),
        ([Tensor("x", (1, 192, 192, 3), "int32")], [out(1, 1, 17, 3)]),
    ],
)
def test_other_networks_are_refused_with_what_was_found(inputs, outputs):
    with pytest.raises(ConfigError, match=r"its layout is not known: in: .*Known are YOLOv7"):
        recognise(inputs, outputs)


def test_networks_for_one_person_are_sent_to_the_estimator_that_has_a_detector():
    with pytest.raises(ConfigError, match=r"simcc_x.*'rtmlib'"):
        recognise([IMAGE], [out(1, 17, 384, name="simcc_x"), out(1, 17, 512, name="simcc_y")])


def test_an_input_that_is_no_image_is_refused():
    with pytest.raises(ConfigError, match="1 x 3 x 0 x 640"):
        recognise([Tensor("x", (1, 3, 0, 640), "float32")], [out(1, 56, 8400)])
    with pytest.raises(ConfigError, match="is no image"):
        recognise([Tensor("x", (1, 3, 640, 10**9), "float32")], [out(1, 56, 8400)])


def read_57(rows, input_px):
    table = np.zeros((1, rows, 57), np.float32)
    table[0, 0, :6] = [10, 20, 30, 40, 0.8, 0.5]
    return recognise([IMAGE], [out(1, rows, 57)]).read([table], input_px)


@pytest.mark.parametrize("input_px", [(640, 640), (960, 576)])
@pytest.mark.parametrize("steps", [(8, 16, 32), (8, 16, 32, 64)])
def test_57_columns_for_every_cell_are_yolov7_before_suppression(input_px, steps):
    cells = 3 * sum((input_px[0] // step) * (input_px[1] // step) for step in steps)
    found = read_57(cells, input_px)
    np.testing.assert_allclose(found.person_score[0], 0.4)
    np.testing.assert_allclose(found.box_px[0], np.array([-5, 0, 25, 40]) - 0.5)


@pytest.mark.parametrize("rows", [1, 100, 300])
def test_57_columns_for_few_people_are_end_to_end(rows):
    found = read_57(rows, (640, 640))
    np.testing.assert_allclose(found.person_score[0], 0.8)
    np.testing.assert_allclose(found.box_px[0], np.array([10, 20, 30, 40]) - 0.5)


RED = np.array([[[255, 0, 51]]], np.uint8)


def test_yolo_is_fed_rgb_from_zero_to_one_channels_first():
    fed = recognise([IMAGE], [out(1, 56, 8400)]).feed(RED)
    assert fed.shape == (1, 3, 1, 1)
    assert fed.dtype == np.float32
    np.testing.assert_allclose(fed.ravel(), [1.0, 0.0, 0.2])


def test_half_precision_networks_are_fed_half_precision():
    image = Tensor("images", (1, 3, 640, 640), "float16")
    assert recognise([image], [out(1, 56, 8400)]).feed(RED).dtype == np.float16


def test_rtmo_is_fed_bgr_up_to_255():
    outputs = [out(1, "n", 5), out(1, "n", 17, 3, name="joints")]
    fed = recognise([IMAGE], outputs).feed(RED)
    np.testing.assert_allclose(fed.ravel(), [51, 0, 255])
    assert fed.flags.c_contiguous


def test_movenet_is_fed_rgb_up_to_255_channels_last():
    fed = recognise([Tensor("x", (1, None, None, 3), "int32")], [out(1, 6, 56)]).feed(RED)
    assert fed.shape == (1, 1, 1, 3)
    assert fed.dtype == np.int32
    np.testing.assert_array_equal(fed.ravel(), [255, 0, 51])
