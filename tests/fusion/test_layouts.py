"""How arrays lie in memory is nothing the fusion may notice: it would be compiled again."""

from dataclasses import replace
from importlib import import_module
from pkgutil import iter_modules

import numpy as np
import pytest

from fusion.made import frame_sets, made, path
from trecsim.fusion import Tracker, kernels
from trecsim.geometry import Camera, Rig
from trecsim.values import FrameSet


def read_only(array):
    array = array.copy()
    array.setflags(write=False)
    return array


def strided(array):
    wide = np.repeat(array, 2, axis=-1)
    return wide[..., ::2]


def turned(array):
    return np.ascontiguousarray(array[..., ::-1])[..., ::-1]


LAYOUTS = {
    "read-only": read_only,
    "Fortran order": np.asfortranarray,
    "strided": strided,
    "backwards": turned,
}


def signatures():
    """Return for which types each kernel has been compiled or loaded."""
    found = {}
    for module in iter_modules(kernels.__path__, kernels.__name__ + "."):
        for name, kernel in vars(import_module(module.name)).items():
            if hasattr(kernel, "signatures"):
                found[f"{module.name}.{name}"] = list(kernel.signatures)
    return found


@pytest.fixture(scope="module")
def scene():
    return made([path((0, 1, 1), (1, 2, 2))], cameras=3, seconds=0.6)


def tracked(scene, laid):
    rig = Rig(
        tuple(
            Camera(c.name, c.size_px, laid(c.K), laid(c.T_cam_world), "brown", laid(np.zeros(5)))
            for c in scene.rig
        )
    )
    tracker = Tracker(rig)
    return [
        tracker.step(
            FrameSet(
                one.t_s,
                tuple(
                    replace(view, xy_px=laid(view.xy_px), score=laid(view.score))
                    for view in one.views
                ),
            )
        )
        for one in frame_sets(scene)
    ]


@pytest.mark.parametrize("laid", LAYOUTS.values(), ids=LAYOUTS)
def test_arrays_of_any_layout_give_the_same_people_and_compile_nothing_again(scene, laid):
    plain = tracked(scene, np.array)
    before = signatures()

    snapshots = tracked(scene, laid)

    assert signatures() == before
    assert snapshots[-1].id.tolist() == [0]
    np.testing.assert_array_equal(snapshots[-1].xyz_m, plain[-1].xyz_m)
