"""Scenes of a study: simulated once per seed, stored in folders, shared by all runs."""

import hashlib
import json
import secrets
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from trecsim.calibration import read_rig
from trecsim.errors import ConfigError, Error, InputError
from trecsim.geometry import Rig
from trecsim.lab.simulation.people import clips_of
from trecsim.lab.simulation.scene import Scene, room_scene, simulate
from trecsim.lab.simulation.scene_file import BUILT_IN, built_in_text, read_scene
from trecsim.lab.staging import write_simulation
from trecsim.lab.study.code_digest import simulation_digest
from trecsim.lab.study.settings_file_table import ChoiceTable
from trecsim.sources import read_poses
from trecsim.store.atomic import disk_faults
from trecsim.store.names import POSES, RIG, TRUTH
from trecsim.store.truth import Truth, read_truth
from trecsim.toml_models import read_text
from trecsim.values import Poses2D


@dataclass(frozen=True, slots=True)
class SceneChoice:
    """One scene of a study.

    Attributes
    ----------
    name
        Its name in the study.
    facts
        All that determines its content except the seed, as JSON.
    source
        Name of a built-in scene, or a scene file; empty for a room.
    folder
        Folder of a scene that exists already; None if it is simulated.
    """

    name: str
    facts: Mapping[str, Any] = field(compare=False)
    source: str = ""
    folder: Path | None = None

    @property
    def is_simulated(self) -> bool:
        """Whether the scene is simulated, with a seed."""
        return self.folder is None

    def kept_at(self, out: Path, seed: int | None) -> Path:
        """Return its folder, existing or not."""
        if self.folder is not None:
            return self.folder
        made_by = json.dumps([self.facts, simulation_digest()], sort_keys=True)
        digest = hashlib.sha256(made_by.encode()).hexdigest()[:8]
        return out / "scenes" / f"{self.name}-{seed}-{digest}"


def chosen(tables: Mapping[str, ChoiceTable], origin: str) -> tuple[SceneChoice, ...]:
    """Return the scenes of a study, each checked.

    Raises
    ------
    ConfigError
        A scene is invalid.
    """
    scenes, faults = [], []
    for name, table in tables.items():
        try:
            scenes.append(_choice(name, table))
        except Error as error:
            faults.append(f"scenes.{name}: {error}")
    if faults:
        raise ConfigError(f"{origin}: " + "\n  ".join(faults))
    return tuple(scenes)


def _choice(name: str, table: ChoiceTable) -> SceneChoice:
    if table.folder is not None:
        return SceneChoice(name, {"content": _content(table.folder)}, folder=table.folder)
    if table.scene is not None:
        choice = SceneChoice(name, {"scene": _scene_digest(table.scene)}, table.scene)
    else:
        choice = SceneChoice(name, {"room": table.room})
    scene_of(choice)
    return choice


def _scene_digest(source: str) -> str:
    """Return a digest of a scene file and the clips that it plays."""
    text = built_in_text(source) if source in BUILT_IN else ""
    if not text and (path := Path(source)).suffix:
        text = read_text(path, "scene file")
    digest = hashlib.sha256(text.encode())
    for clip in clips_of(read_scene(source).people):
        digest.update(_file_digest(clip))
    return digest.hexdigest()[:16]


def _content(folder: Path) -> str:
    """Return a digest of an existing scene, after checking its ground truth and rig."""
    read_rig(folder / RIG)
    read_truth(folder / TRUTH)
    digest = hashlib.sha256()
    for name in (RIG, POSES, TRUTH):
        digest.update(_file_digest(folder / name))
    return digest.hexdigest()[:16]


def _file_digest(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").digest()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from None


def scene_of(choice: SceneChoice) -> Scene:
    """Return the scene to simulate.

    Raises
    ------
    InputError
        The scene is invalid.
    """
    return read_scene(choice.source) if choice.source else room_scene(**choice.facts["room"])


def prepare(choice: SceneChoice, seed: int | None, out: Path) -> Path:
    """Simulate a scene unless it exists, and return its folder.

    Raises
    ------
    Error
        It cannot be simulated, or the disk is full.
    """
    folder = choice.kept_at(out, seed)
    if choice.folder is not None or folder.is_dir() or seed is None:
        return folder
    made = simulate(scene_of(choice), seed)
    unfinished = folder.with_name(f".{folder.name}.{secrets.token_hex(4)}.tmp")
    with disk_faults(folder):
        unfinished.mkdir(parents=True)
        try:
            write_simulation(made, unfinished)
            unfinished.rename(folder)
        finally:
            shutil.rmtree(unfinished, ignore_errors=True)
    return folder


@dataclass(frozen=True, slots=True, eq=False)
class LoadedScene:
    """A scene in memory."""

    rig: Rig
    poses: tuple[Poses2D, ...]
    truth: Truth


@lru_cache(maxsize=1)
def load(folder: Path) -> LoadedScene:
    """Read a scene; the last one stays in memory, as runs come scene by scene.

    Raises
    ------
    InputError
        One of its files is invalid.
    """
    rig = read_rig(folder / RIG)
    poses = tuple(read_poses(folder / POSES, rig_cameras=rig.names))
    return LoadedScene(rig, poses, read_truth(folder / TRUTH))
