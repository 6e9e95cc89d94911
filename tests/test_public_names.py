"""What `import trecsim` offers."""

import subprocess
import sys

import pytest

import trecsim


@pytest.mark.parametrize("name", trecsim.__all__)
def test_every_public_name_is_there_and_documented(name):
    value = getattr(trecsim, name)
    assert name == "COCO17" or value.__doc__


def test_public_names_are_sorted_and_listed():
    assert list(trecsim.__all__) == sorted(trecsim.__all__)
    assert set(trecsim.__all__) <= set(dir(trecsim))


def test_completion_offers_public_names_alone():
    shown = {name for name in dir(trecsim) if not name.startswith("__")}
    assert shown == set(trecsim.__all__)


def test_a_name_that_is_not_there_is_an_attribute_error():
    with pytest.raises(AttributeError, match="trakc"):
        trecsim.trakc  # noqa: B018


def test_importing_the_package_imports_neither_numpy_nor_numba():
    code = "import sys, trecsim; print(sorted({'numpy', 'numba', 'pydantic'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_paths_may_be_given_as_text(tmp_path):
    poses = tmp_path / "a.poses.jsonl"
    poses.write_text('{"format": "trecsim.poses2d/1", "skeleton": "coco17"}\n')
    assert list(trecsim.read_poses(str(poses))) == []
    with pytest.raises(trecsim.InputError, match="no tracks"):
        trecsim.read_tracks(str(tmp_path / "none.csv"))
