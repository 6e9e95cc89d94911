import sys

import pytest

from trecsim.errors import InputError, SetupError
from trecsim.lab.plots.canvas import floor_figure, save_figure

FIRST_BYTES = {".png": b"\x89PNG", ".jpg": b"\xff\xd8", ".pdf": b"%PDF", ".svg": b"<?xml"}


@pytest.mark.parametrize("suffix", FIRST_BYTES)
def test_the_suffix_is_the_format_of_the_picture(suffix, tmp_path):
    figure, _ = floor_figure((0.0, 4.0), (0.0, 2.0))
    save_figure(figure, tmp_path / f"floor{suffix}")
    assert (tmp_path / f"floor{suffix}").read_bytes().startswith(FIRST_BYTES[suffix])


@pytest.mark.parametrize("name", ["floor", "floor.bmp", "floor.txt"])
def test_a_name_that_is_no_picture_is_refused(name, tmp_path):
    figure, _ = floor_figure((0.0, 4.0), (0.0, 2.0))
    with pytest.raises(InputError, match=r"ends in \.png, \.svg, \.pdf, \.jpg, got"):
        save_figure(figure, tmp_path / name)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("size_m", "step_m"), [(6.0, 0.5), (10.0, 1.0), (40.0, 5.0), (1e3, 100.0)])
def test_the_grid_is_in_round_metres_and_the_axes_are_equal(size_m, step_m):
    _, axes = floor_figure((0.0, size_m), (0.0, size_m / 2))
    assert axes.get_aspect() == 1.0
    ticks = axes.get_xticks()
    assert ticks[1] - ticks[0] == pytest.approx(step_m)


def test_without_matplotlib_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(SetupError, match=r"pip install .*\[plot\]"):
        floor_figure((0.0, 1.0), (0.0, 1.0))
