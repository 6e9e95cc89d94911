"""Limb lengths of real people, measured with a tape, to compare with."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from trecsim.lab.evaluation.limbs import LIMBS, Given, limb_named
from trecsim.toml_models import Table, file_faults, read_text, validated
from trecsim.toml_models.toml_reading import Fault, nearest

KIND = "file of measured limb lengths"

Identity = Annotated[int, Field(ge=0)]
LengthCm = Annotated[float, Field(gt=0, le=200)]


class SubjectTable(Table):
    """One measured person."""

    people: Annotated[tuple[Identity, ...], Field(strict=False, min_length=1)]
    """Identities of this person in the tracks."""
    lengths_cm: dict[str, LengthCm]
    """Length by the name of the limb, as `limb_named` knows it [cm]."""


class MeasuredFile(Table):
    """The whole file."""

    format: Literal["trecsim.limbs/1"]
    """Format of the file."""
    subjects: dict[str, SubjectTable]
    """Measured people, by any name."""


def read_measured(path: Path | str) -> Given:
    """Read limb lengths measured with a tape from a TOML file.

    Raises
    ------
    ConfigError
        It cannot be read or is invalid; all faults are reported with their lines.

    Examples
    --------
    >>> path = getfixture("tmp_path") / "measured.toml"
    >>> _ = path.write_text('''
    ... format = "trecsim.limbs/1"
    ... [subjects.one]
    ... people = [3]
    ... lengths_cm = { "shoulder width" = 40, "right thigh" = 47 }
    ... ''')
    >>> float(read_measured(path)[3][LIMBS.index("right thigh")])
    0.47
    """
    path = Path(path)
    text = read_text(path, KIND)
    measured = validated(MeasuredFile, path, text, KIND)
    faults = [*_unknown_limbs(measured), *_limbs_twice(measured), *_shared_identities(measured)]
    if faults:
        raise file_faults(path, text, faults)
    return {
        identity: np.array([lengths_cm.get(limb, np.nan) for limb in LIMBS]) / 100.0
        for subject in measured.subjects.values()
        for lengths_cm in [{limb_named(name): cm for name, cm in subject.lengths_cm.items()}]
        for identity in subject.people
    }


def _unknown_limbs(measured: MeasuredFile) -> Iterator[Fault]:
    for name, subject in measured.subjects.items():
        for limb in subject.lengths_cm:
            if limb_named(limb) is None:
                yield (
                    ("subjects", name, "lengths_cm", limb),
                    f"no such limb; {nearest(limb, LIMBS)}",
                )


def _limbs_twice(measured: MeasuredFile) -> Iterator[Fault]:
    for name, subject in measured.subjects.items():
        first: dict[str, str] = {}
        for written in subject.lengths_cm:
            limb = limb_named(written)
            if limb in first:
                yield (
                    ("subjects", name, "lengths_cm", written),
                    f"the same limb as {first[limb]!r}; give one of them",
                )
            elif limb is not None:
                first[limb] = written


def _shared_identities(measured: MeasuredFile) -> Iterator[Fault]:
    owner: dict[int, str] = {}
    for name, subject in measured.subjects.items():
        for identity in subject.people:
            if identity in owner:
                yield (
                    ("subjects", name, "people"),
                    f"identity {identity} is also that of {owner[identity]!r}",
                )
            owner[identity] = name
