"""The folder of a study: whether it is one, and how it differs from another study."""

from pathlib import Path

from trecsim.errors import ConfigError, InputError
from trecsim.lab.study.plan import Study, parse_seeds
from trecsim.lab.study.runs_file import NAME, holds_runs
from trecsim.lab.study.settings_file_table import FORMAT, StudyTable, read_study_table
from trecsim.store.atomic import disk_faults
from trecsim.toml_models import parsed, read_text

STUDY = "study.toml"


def check_folder(out: Path) -> None:
    """Refuse a folder that contains something other than a study; hidden files are ignored.

    Raises
    ------
    InputError
        It is not empty and contains no study, or cannot be read.
    """
    with disk_faults(out):
        is_empty = not out.is_dir() or all(path.name.startswith(".") for path in out.iterdir())
    if not (is_empty or _holds_study_file(out / STUDY) or holds_runs(out / NAME)):
        raise InputError(
            f"{out} is not empty and contains no study; nothing is overwritten: give another --out"
        )


def _holds_study_file(path: Path) -> bool:
    try:
        return parsed(path, read_text(path, STUDY), STUDY).get("format") == FORMAT
    except ConfigError:
        return False


def changed_parts(study: Study, out: Path) -> list[str]:
    """Return the parts in which a study differs from the one in its folder, if any is there."""
    try:
        before = read_study_table(out / STUDY)
        seeds = parse_seeds(before.seeds, STUDY)
    except ConfigError:
        return []
    now = study.table
    differs = {
        "scenes": before.scenes != now.scenes,
        "seeds": seeds != study.seeds,
        "settings": before.settings != now.settings,
        "design": _design(before) != _design(now),
        "lag": before.lag_s != now.lag_s,
    }
    return [name for name, other in differs.items() if other]


def _design(table: StudyTable) -> tuple[str, int | None]:
    return table.design, table.points
