"""Tracks as pandas tables; pandas is imported on first use."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import pyarrow as pa

from trecsim.extras import needed
from trecsim.skeleton import COCO17
from trecsim.store.rows import COLUMNS, COVARIANCE, DETAIL_SCHEMA, SCHEMA, VELOCITY

if TYPE_CHECKING:
    from pandas import DataFrame


def tidy_frame(tables: Sequence[pa.Table], details: bool) -> "DataFrame":
    """Return one row per time, person and joint; `joint` is categorical.

    Raises
    ------
    SetupError
        When pandas is not installed.
    """
    _check_pandas()
    schema = DETAIL_SCHEMA if details else SCHEMA
    table = pa.concat_tables([schema.empty_table(), *tables]).unify_dictionaries()
    frame: DataFrame = table.to_pandas()
    return frame


def wide_frame(tables: Sequence[pa.Table], details: bool) -> "DataFrame":
    """Return one row per time and person, with columns for each joint.

    Raises
    ------
    SetupError
        When pandas is not installed.
    """
    tidy = tidy_frame(tables, details)
    keys = ["t_s", "person", *(["state"] if details else [])]
    numbers = [*COLUMNS[3:], *((*VELOCITY, *COVARIANCE) if details else ())]
    joints = tidy["joint"].astype(str)
    wide = tidy.assign(joint=joints).pivot(index=keys, columns="joint", values=numbers)
    wanted = [(number, joint) for joint in COCO17.joints for number in numbers]
    wide = wide.reindex(columns=wanted)
    wide.columns = [f"{joint}_{number}" for number, joint in wanted]
    frame: DataFrame = wide.reset_index()
    return frame


def _check_pandas() -> None:
    needed("tables need pandas, which is not installed", "pandas", "pandas")
