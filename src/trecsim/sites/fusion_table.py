"""The table `[fusion]` of a site file, made of the settings of the fusion."""

from collections.abc import Iterator
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Self

from pydantic import create_model, model_validator

from trecsim.errors import ConfigError
from trecsim.fusion import FusionSettings
from trecsim.fusion.settings import BELOW_ONE, RENAMED, by_names_of_today
from trecsim.toml_models import Table
from trecsim.toml_models.described import fields_of
from trecsim.toml_models.table import MADE


class _FusionTable(Table):
    @model_validator(mode="before")
    @classmethod
    def _by_names_of_today(cls, given: Any) -> Any:
        return by_names_of_today(given) if isinstance(given, dict) else given

    @model_validator(mode="after")
    def _fit_together(self) -> Self:
        try:
            fusion_settings(self)
        except ConfigError as error:
            raise ValueError(str(error).removeprefix("fusion settings: ")) from None
        return self


def fusion_settings(table: Table) -> FusionSettings:
    """Return the table `[fusion]` as the fusion takes it.

    Raises
    ------
    ConfigError
        When values do not fit together.
    """
    return FusionSettings(**table.model_dump())


def earlier_names(given: object) -> Iterator[str]:
    """Yield a remark for each key of a table `[fusion]` that has another name today."""
    for name in given if isinstance(given, dict) else ():
        if name in RENAMED:
            yield f"fusion.{name} is called {RENAMED[name]} today; the old name still works"


def _limits(name: str) -> dict[str, float]:
    return {"gt": 0.0, "lt": 1.0} if name in BELOW_ONE else {"gt": 0.0}


if TYPE_CHECKING:
    FusionTable = _FusionTable
else:
    FusionTable = create_model(
        "FusionTable",
        __base__=_FusionTable,
        __doc__="Settings of the association and the fit.",
        __cls_kwargs__=MADE,
        **fields_of(
            FusionSettings, {field.name: _limits(field.name) for field in fields(FusionSettings)}
        ),
    )
