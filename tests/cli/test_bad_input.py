"""Whatever is wrong with the input: one clear message, the exit code of the contract, no trace."""

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from made_site import make_site
from made_videos import numbered, write_sound, write_video
from trecsim.store.tracks import read_tracks

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the current directory, which holds a site that can be run."""
    make_site(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def change(path: Path, pattern: str, by: str) -> None:
    text = path.read_text()
    changed = re.sub(pattern, by, text, count=1, flags=re.DOTALL)
    assert changed != text
    path.write_text(changed)


RIGS = {
    "no cameras": (r"\[cameras.*", "", "no camera|cameras"),
    "a singular K": (r"K = \[\[[^,]*", "K = [[0.0", "K|focal"),
    "K of a wrong size": (r"K = \[\[[^\]]*\], ", "K = [", "K"),
    "an unknown distortion": (r'"none"', '"fishy"', "fishy.*fisheye"),
    "no image size": (r"size_px = [^\n]*\n", "", "size_px"),
    "a number that is not finite": (r"K = \[\[[^,]*", "K = [[nan", "K"),
    "not TOML": (r"\[cameras", "[[[cameras", "TOML"),
}


@pytest.mark.parametrize(("pattern", "by", "message"), RIGS.values(), ids=RIGS.keys())
def test_a_wrong_rig(trecsim: Command, folder: Path, pattern: str, by: str, message: str) -> None:
    change(folder / "rig.toml", pattern, by)
    for command in (["track", "rig.toml", "walk.poses.jsonl"], ["run", "site.toml"]):
        code, out, err = trecsim(*command)
        assert (code, out) == (2, "")
        assert err.startswith("trecsim: ")
        assert "rig.toml" in err
        assert re.search(message, err), err
    assert sorted(path.name for path in folder.iterdir()) == [
        "rig.toml",
        "site.toml",
        "walk.poses.jsonl",
    ]


POSES = {
    "a wrong number of key points": (r"\], \[[^\]]*\]\]", "]]", "17"),
    "a number that is not finite": (r"\[\[\d+\.\d+", "[[NaN", "NaN"),
    "a huge number": (r"\[\[\d+\.\d+", "[[1e308", "1e"),
    "an unknown camera": (r'"cam1"', '"cam9"', "cam9.*rename it"),
    "time running backwards": (r'("cam0", "t_s": )1\.0', r"\g<1>0.1", "backwards|order"),
    "text for a time": (r'("t_s": )0\.0', r'\1"noon"', "t_s"),
    "half a line": (r"\]\}\n", "\n", "JSON"),
    "another format": (r"poses2d/1", "poses2d/7", "poses2d/1"),
}


@pytest.mark.parametrize(("pattern", "by", "message"), POSES.values(), ids=POSES.keys())
def test_wrong_poses(trecsim: Command, folder: Path, pattern: str, by: str, message: str) -> None:
    change(folder / "walk.poses.jsonl", pattern, by)
    code, out, err = trecsim("track", "rig.toml", "walk.poses.jsonl", "--out", "tracks.csv")
    assert (code, out) == (2, "")
    assert re.match(r"trecsim: .*walk\.poses\.jsonl.*line \d+", err, re.DOTALL), err
    assert re.search(message, err), err
    assert not (folder / "tracks.csv").exists()


def video_site(folder: Path) -> Path:
    """Write a site with a video per camera, 64 x 48 px, for which the rig is not calibrated."""
    text = (folder / "site.toml").read_text().replace('poses = "walk.poses.jsonl"\n', "")
    sources = "".join(f'[sources.cam{i}]\nvideo = "cam{i}.mp4"\n' for i in range(3))
    for i in range(3):
        write_video(folder / f"cam{i}.mp4", numbered(10))
    (folder / "site.toml").write_text(text + sources)
    return folder / "site.toml"


def test_all_wrong_videos_of_a_site_are_told_at_once(trecsim: Command, folder: Path) -> None:
    site = video_site(folder)
    (folder / "cam0.mp4").write_bytes((folder / "cam0.mp4").read_bytes()[:200])
    write_sound(folder / "cam1.mp4")
    change(site, r"sources\.cam2\]", "sources.cam3]\\nvideo = 'gone.mp4'\\n[sources.cam2]")
    code, out, err = trecsim("run", "site.toml")
    assert (code, out) == (2, "")
    assert re.search(r"line 5: sources\.cam0\.video: .*cam0\.mp4", err), err
    assert re.search(r"line 7: sources\.cam1\.video: .*cam1\.mp4.*(no image|no video)", err), err
    assert re.search(
        r"line 8: sources\.cam3: .* is not in the rig; known: cam0, cam1, cam2", err
    ), err
    assert re.search(r"line 9: sources\.cam3\.video: .*gone\.mp4: no such file", err), err
    assert "expected images of 1920 x 1080 px" in err
    assert not (folder / "recordings").exists()


INTRINSICS = [
    "calibrate", "intrinsics", "cam0=gone", "--board", "4x7", "--square-m", "0.06",
]  # fmt: skip
ARGUMENTS = {
    "a rig that is not there": (["track", "gone.toml", "walk.poses.jsonl"], "gone.toml"),
    "poses that are not there": (["track", "rig.toml", "gone.jsonl"], "gone.jsonl"),
    "a site that is not there": (["run", "gone.toml"], "gone.toml"),
    "a video in place of poses": (["track", "rig.toml", "rig.toml"], "rig.toml"),
    "rig and poses exchanged": (
        ["track", "walk.poses.jsonl", "rig.toml"],
        "walk.poses.jsonl is a file of 2D poses; give the rig first: "
        "trecsim track rig.toml walk.poses.jsonl\n",
    ),
    "poses twice": (
        ["track", "walk.poses.jsonl", "walk.poses.jsonl"],
        "give the rig first: trecsim track RIG walk.poses.jsonl\n",
    ),
    "a rig twice": (["track", "rig.toml", "rig.toml"], "trecsim track rig.toml POSES\n"),
    "a folder of poses in place of the rig": (
        ["track", "poses", "rig.toml"],
        "rig.toml is a calibration by its name, not a file of 2D poses; give the rig first, "
        "then the poses: trecsim track rig.toml poses\n",
    ),
    "a negative lag": (["track", "rig.toml", "walk.poses.jsonl", "--lag-s", "-1"], "lag"),
    "a lag too long": (["track", "rig.toml", "walk.poses.jsonl", "--lag-s", "1e9"], "lag"),
    "a lag that is no number": (["track", "rig.toml", "walk.poses.jsonl", "--lag-s", "nan"], "lag"),
    "no such directory": (["track", "rig.toml", "walk.poses.jsonl", "--out", "no/t.csv"], "no/t"),
    "an unknown suffix": (["track", "rig.toml", "walk.poses.jsonl", "--out", "t.xls"], "t.xls"),
    "a report in place of the rig": (
        [
            "calibrate",
            "people",
            "walk.poses.jsonl",
            "--intrinsics",
            "rig.toml",
            "--out",
            "t.toml",
            "--report",
            "./t.toml",
        ],
        "--report: t.toml is the rig file to write; give another name",
    ),
    "a rig in place of its intrinsics": (
        [
            "calibrate",
            "people",
            "walk.poses.jsonl",
            "--intrinsics",
            "rig.toml",
            "--out",
            "./rig.toml",
        ],
        "--out: rig.toml is the file of the intrinsics, whose poses, and cameras",
    ),
    "a report in place of the intrinsics": (
        [*INTRINSICS, "--out", "t.toml", "--report", "t.toml"],
        "--report: t.toml is the rig file to write; give another name",
    ),
    "intrinsics into a directory that is not there": (
        [*INTRINSICS, "--out", "no/t.toml"],
        "cannot write no/t.toml: the directory no does not exist",
    ),
    "too few views to choose": (
        [*INTRINSICS, "--out", "t.toml", "--most-views", "0"],
        "--most-views must be 3 or more, got 0\n",
    ),
    "a floor into a page": (
        ["calibrate", "floor", "rig.toml", "--point", "cam0:1,2=0,0", "--out", "t.html"],
        "--out: expected a rig file that ends in .toml, got t.html\n",
    ),
    "a rig in place of the poses in step": (
        [
            "sync",
            "walk.poses.jsonl",
            "--rig",
            "rig.toml",
            "--out",
            "t.jsonl",
            "--out-rig",
            "t.jsonl",
        ],
        "--out-rig: t.jsonl is the file of 2D poses to write; give another name\n",
    ),
    "a file that is no tracks": (["export", "rig.toml", "t.csv"], "rig.toml"),
    "a broken recording": (["export", "broken.parquet", "t.csv"], "broken.parquet"),
}


@pytest.mark.parametrize(("arguments", "message"), ARGUMENTS.values(), ids=ARGUMENTS.keys())
def test_wrong_arguments(
    trecsim: Command, folder: Path, arguments: list[str], message: str
) -> None:
    (folder / "broken.parquet").write_bytes(b"PAR1" + bytes(100))
    (folder / "poses").mkdir()
    code, out, err = trecsim(*arguments)
    assert (code, out) == (2, "")
    assert err.startswith("trecsim: ")
    assert err.count("\n") == 1
    assert message in err
    assert not list(folder.glob("t.*"))


# What only a process of its own can show: limits and signals of the system.


def command(*arguments: str, before: str = "") -> list[str]:
    # What runs in the background of a shell inherits that Ctrl-C is ignored.
    heed = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    script = f"import sys\n{heed}\n{before}\nfrom trecsim.cli import main\nmain(sys.argv[1:])"
    return [sys.executable, "-c", script, *arguments]


def test_a_full_disk(folder: Path) -> None:
    # Python would keep the half of a compiled module that fits, and fail on it for ever after.
    # Python would keep as much of a compiled module as fits, and fail on it for ever after.
    limit = (
        "import resource; sys.dont_write_bytecode = True\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))"
    )
    ended = subprocess.run(
        command("track", "rig.toml", "walk.poses.jsonl", "--out", "tracks.csv", before=limit),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 1
    assert ended.stdout == ""
    assert ended.stderr.splitlines()[-1].startswith(
        "trecsim: cannot write tracks.csv: the disk is full"
    )
    assert "Traceback" not in ended.stderr
    assert not (folder / "tracks.csv").exists()


SLOW = """
import time
from trecsim import pipeline, site_run
read_poses = site_run.read_poses
def slow(*a, **k):
    for one in read_poses(*a, **k):
        time.sleep(0.01)
        yield one
site_run.read_poses = pipeline.read_poses = slow
"""
ENDINGS = [signal.SIGINT, signal.SIGTERM]


@pytest.mark.parametrize(
    ("name", "ending"), [("tracks.csv", signal.SIGINT), ("tracks.parquet", signal.SIGTERM)]
)
def test_a_signal_ends_tracking_and_says_what_is_kept(
    folder: Path, ending: signal.Signals, name: str
) -> None:
    make_site(folder, moments=400)
    running = subprocess.Popen(
        command("track", "rig.toml", "walk.poses.jsonl", "--out", name, before=SLOW),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    kept = folder / (f"{name}.partial" if name.endswith("csv") else f"{name}.parts")
    while running.poll() is None and not (
        list(kept.glob("*/*.parquet"))
        if kept.is_dir()
        else kept.is_file() and kept.stat().st_size > 5_000
    ):
        time.sleep(0.05)  # until something is on the disk
    running.send_signal(ending)
    out, err = running.communicate(timeout=60)
    assert running.returncode == 1
    assert out == ""
    assert re.search(rf"trecsim: stopped; the results before that are kept in {kept.name}", err), (
        err
    )
    assert 0 < len(list(read_tracks(kept))) < 400


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_signal_ends_a_run_in_order(folder: Path, ending: signal.Signals) -> None:
    make_site(folder, moments=400)
    running = subprocess.Popen(
        command("run", "site.toml", "--out", "out", "--json", before=SLOW),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    parts = folder / "out" / "tracks.parquet.parts"
    while running.poll() is None and not list(parts.glob("*/*.parquet")):
        time.sleep(0.05)  # until something is on the disk
    running.send_signal(ending)
    out, err = running.communicate(timeout=60)
    assert running.returncode == 1
    assert out == ""
    assert "Traceback" not in err
    assert re.search(r"trecsim: stopped; out: 1 person in \d+ frame sets", err), err
    assert (folder / "out" / "summary.json").exists()
    assert 10 < len(list(read_tracks(folder / "out"))) < 400


@pytest.mark.parametrize("where", ["site_run.write_summary", "run_command._draw_paths"])
def test_a_second_ctrl_c_ends_a_run_at_once_and_says_what_is_kept(folder: Path, where: str) -> None:
    """The first ends the recording; writing the summary, or drawing the picture, then hangs."""
    make_site(folder, moments=400)
    hang = f"{SLOW}from trecsim.cli import run_command\n{where} = lambda *given: time.sleep(60)\n"
    running = subprocess.Popen(
        command("run", "site.toml", "--out", "out", before=hang),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    parts = folder / "out" / "tracks.parquet.parts"
    while running.poll() is None and not list(parts.glob("*/*.parquet")):
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    while running.poll() is None and not (folder / "out" / "tracks.parquet").is_file():
        time.sleep(0.05)
    time.sleep(0.2)
    running.send_signal(signal.SIGINT)
    out, err = running.communicate(timeout=30)
    assert running.returncode == 1
    assert out == ""
    assert "Traceback" not in err
    missing = "a summary" if "summary" in where else "a picture"
    assert re.search(
        rf"trecsim: stopped at once after \d+ frame sets; the results before that are "
        rf"kept in out, without {missing}",
        err,
    ), err
    assert 10 < len(list(read_tracks(folder / "out"))) < 400
