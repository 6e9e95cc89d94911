"""Studies can be stopped, continued and changed; nothing is done twice, nothing is lost."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from trecsim.errors import InputError, SetupError
from trecsim.lab.simulation.scene import simulate
from trecsim.lab.study import code_digest, running, scenes
from trecsim.lab.study.cli_table import scenes_table, settings_table
from trecsim.lab.study.plan import Study, planned
from trecsim.lab.study.running import Job, jobs_of, run_one, run_study
from trecsim.lab.study.runs_file import NAME, read_runs
from trecsim.lab.study.settings_file_table import StudyTable

TINY = "room:people=1,cameras=2,seconds=1"
FIGURES = {
    "mean_m": 0.03, "recall_15cm": 0.9, "switches": 0.0, "missed": 2.0, "ghosts": 0.0,
    "person_frames": 100.0, "fusion_ms": 2.5,
}  # fmt: skip


def study_of(
    *settings: str, scene: tuple[str, ...] = (TINY,), seeds: str = "1-2", lag_s: float = 0.0
) -> Study:
    data = {
        "format": "trecsim.study/1", "seeds": seeds, "lag_s": lag_s,
        "settings": settings_table(settings or ("knot_s=0.08,0.1,0.15",)),
        "scenes": scenes_table(scene),
    }  # fmt: skip
    return planned(StudyTable.model_validate(data), "the study")


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[Job]:
    """Let runs take no time, and return those that were made."""
    made: list[Job] = []

    def quick(job: Job) -> dict[str, float]:
        made.append(job)
        return FIGURES

    monkeypatch.setattr(running, "run_one", quick)
    monkeypatch.setattr(running, "prepare", lambda choice, seed, out: out)
    monkeypatch.setattr(running, "code_changed", lambda: False)
    return made


def lines(out: Path) -> list[str]:
    return [json.loads(line)["key"] for line in (out / NAME).read_text().splitlines()]


def stop_after(count: int) -> Callable[[int, int | None], None]:
    def progress(done: int, total: int | None) -> None:
        if done == count:
            raise KeyboardInterrupt

    return progress


def test_a_study_that_was_stopped_goes_on_and_does_nothing_twice(
    tmp_path: Path, runs: list[Job]
) -> None:
    study = study_of()
    with pytest.raises(KeyboardInterrupt):
        run_study(study, tmp_path, workers=1, progress=stop_after(4))
    assert len(lines(tmp_path)) == 4
    done = run_study(study, tmp_path, workers=1)
    assert (done.runs, done.made, done.failed) == (6, 2, 0)
    assert len(lines(tmp_path)) == len(set(lines(tmp_path))) == 6
    assert run_study(study, tmp_path, workers=1).made == 0


def test_a_torn_line_is_made_again(tmp_path: Path, runs: list[Job]) -> None:
    run_study(study_of(), tmp_path, workers=1)
    path = tmp_path / NAME
    path.write_bytes(path.read_bytes()[:-20])
    assert run_study(study_of(), tmp_path, workers=1).made == 1
    assert len(set(lines(tmp_path))) == 6


def test_a_study_that_was_changed_takes_what_it_can(tmp_path: Path, runs: list[Job]) -> None:
    run_study(study_of("knot_s=0.08,0.1"), tmp_path, workers=1)
    runs.clear()
    told: list[str] = []
    wider = study_of("knot_s=0.08,0.1,0.12", seeds="1-3")
    assert run_study(wider, tmp_path, workers=1, remark=told.append).made == 5
    assert {(job.seed, job.settings.knot_s) for job in runs} == {
        (1, 0.12), (2, 0.12), (3, 0.08), (3, 0.1), (3, 0.12),
    }  # fmt: skip
    assert told == [
        f"the study in {tmp_path} has changed: other seeds, settings; runs that still fit are "
        "reused",
        "4 runs are already there, 5 are missing",
    ]
    told.clear()
    run_study(wider, tmp_path, workers=1, remark=told.append)
    assert told == ["9 runs are already there, 0 are missing"]
    other = study_of("knot_s=0.08,0.1,0.12", seeds="1-3", scene=("crossing-30cm",), lag_s=0.1)
    run_study(other, tmp_path, workers=1, remark=told.append)
    assert "has changed: other scenes, lag; " in told[1]


@pytest.mark.parametrize("name", ["tracks.csv", "study.toml", NAME])
def test_a_folder_of_something_else_is_left_alone(
    tmp_path: Path, runs: list[Job], name: str
) -> None:
    (tmp_path / name).write_text('mine = "yes"\n')
    with pytest.raises(InputError, match=r"is not empty and contains no study; nothing is overwr"):
        run_study(study_of(), tmp_path, workers=1)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert runs == []


@pytest.mark.parametrize("left", ["", '{"ke', '{"key": "a", "code'])
def test_a_study_that_crashed_at_once_goes_on(tmp_path: Path, runs: list[Job], left: str) -> None:
    (tmp_path / NAME).write_text(left)
    (tmp_path / "scenes").mkdir()
    assert run_study(study_of(), tmp_path, workers=1).made == 6


def test_another_lag_or_scene_is_another_run(tmp_path: Path) -> None:
    studies = (study_of(), study_of(lag_s=0.1), study_of(scene=("room:people=2,seconds=1",)))
    keys = [{job.key for job in jobs_of(study, tmp_path)} for study in studies]
    assert len(set.union(*keys)) == 18


def test_runs_of_other_code_are_named_and_not_used(
    tmp_path: Path, runs: list[Job], monkeypatch: pytest.MonkeyPatch
) -> None:
    run_study(study_of(), tmp_path, workers=1)
    old = code_digest.code_digest()
    for module in (running, code_digest):
        monkeypatch.setattr(module, "code_digest", lambda: "changed")
    monkeypatch.setattr(running, "code_changed", lambda: False)
    told: list[str] = []
    assert run_study(study_of(), tmp_path, workers=1, remark=told.append).made == 6
    assert told == [
        f"runs made with other code are kept but not used: 6 of version {old}; now it is changed"
    ]
    assert len(read_runs(tmp_path / NAME)) == 12


def test_code_that_changes_while_the_study_runs_is_told(
    tmp_path: Path, runs: list[Job], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(running, "code_changed", lambda: True)
    told: list[str] = []
    run_study(study_of(), tmp_path, workers=1, remark=told.append)
    assert "changed while the study ran" in told[-1]


def test_the_version_follows_the_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "package"
    (package / "fusion").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "fusion" / "a.py").write_text("x = 1\n")
    monkeypatch.setattr(code_digest.trecsim, "__file__", str(package / "__init__.py"))
    first = code_digest.digest_of(("fusion",))
    (package / "fusion" / "a.py").write_text("x = 1\r\n")
    assert code_digest.digest_of(("fusion",)) == first
    (package / "fusion" / "a.py").write_text("x = 2\n")
    assert code_digest.digest_of(("fusion",)) != first


@pytest.mark.parametrize(
    "name",
    [
        "sources/poses_jsonl.py",
        "calibration/formats/trecsim_toml.py",
        "toml_models/toml_reading.py",
        "store/npz.py",
    ],
)
def test_how_files_are_read_and_written_belongs_to_the_version(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "package"
    shutil.copytree(
        Path(code_digest.trecsim.__file__).parent,
        package,
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    monkeypatch.setattr(code_digest.trecsim, "__file__", str(package / "__init__.py"))
    versions = (code_digest.code_digest.__wrapped__, code_digest.simulation_digest.__wrapped__)
    before = [version() for version in versions]
    with (package / name).open("a") as file:
        file.write("x = 1\n")
    assert all(version() != old for version, old in zip(versions, before, strict=True))


def test_a_run_that_fails_is_written_down_and_the_others_go_on(
    tmp_path: Path, runs: list[Job], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fragile(job: Job) -> dict[str, float]:
        if job.settings.knot_s == 0.1 and job.seed == 1:
            raise ValueError("the matrix is singular\nat the third step")
        return FIGURES

    monkeypatch.setattr(running, "run_one", fragile)
    assert run_study(study_of(), tmp_path, workers=1).failed == 1
    faults = [run.fault for run in read_runs(tmp_path / NAME)]
    assert sorted(faults)[-1] == "ValueError: the matrix is singular at the third step"
    assert len(faults) == 6
    monkeypatch.setattr(running, "run_one", lambda job: FIGURES)
    assert run_study(study_of(), tmp_path, workers=1).made == 1
    assert not any(run.fault for run in read_runs(tmp_path / NAME))


def test_a_full_disk_ends_the_study(
    tmp_path: Path, runs: list[Job], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(job: Job) -> dict[str, float]:
        raise SetupError("the disk is full")

    monkeypatch.setattr(running, "run_one", full)
    with pytest.raises(SetupError, match="disk is full"):
        run_study(study_of(), tmp_path, workers=1)


def test_a_scene_is_simulated_once_for_all_settings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []
    monkeypatch.setattr(
        scenes, "simulate", lambda scene, seed: (made.append(seed), simulate(scene, seed))[1]
    )
    study = study_of("knot_s=0.1,0.12", seeds="1-2")
    assert run_study(study, tmp_path, workers=1).failed == 0
    assert sorted(made) == [1, 2]
    assert len(list((tmp_path / "scenes").iterdir())) == 2


def test_the_same_run_gives_the_same_figures_but_for_the_time(tmp_path: Path) -> None:
    job = jobs_of(study_of(), tmp_path)[0]
    first, second = run_one(job), run_one(job)
    assert first.pop("fusion_ms") > 0 < second.pop("fusion_ms")
    assert first == second
    assert first["person_frames"] > 0
    assert 0.0 < first["mean_m"] < 0.5


def test_a_made_scene_is_tried_without_seeds(tmp_path: Path) -> None:
    job = jobs_of(study_of(), tmp_path / "first")[0]
    folder = scenes.prepare(job.choice, 1, tmp_path / "first")
    study = study_of(scene=(f"mine={folder}",))
    assert [(scene.name, seed) for scene, seed in study.blocks] == [("mine", None)]
    second = jobs_of(study, tmp_path / "second")[0]
    figures, same = run_one(second), run_one(job)
    assert {**figures, "fusion_ms": 0} == {**same, "fusion_ms": 0}
    (folder / "truth.npz").unlink()
    with pytest.raises(InputError, match=r"scenes\.mine.*truth\.npz"):
        study_of(scene=(f"mine={folder}",))


def test_processes_do_the_same_as_one(tmp_path: Path) -> None:
    study = study_of("knot_s=0.1,0.12", seeds="1")
    run_study(study, tmp_path / "many", workers=2)
    run_study(study, tmp_path / "one", workers=1)
    many, one = (
        {run.key: {**run.figures, "fusion_ms": 0.0} for run in read_runs(tmp_path / where / NAME)}
        for where in ("many", "one")
    )
    assert many == one
    assert len(many) == 2
