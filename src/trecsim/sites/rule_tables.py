"""The tables `[[rules]]` of a site file, made of the kinds of rules there are."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, Union

from pydantic import AfterValidator, Field, create_model, model_validator
from pydantic.fields import FieldInfo

from trecsim.safety.early_warning import LONGEST_S
from trecsim.safety.kinds import KINDS
from trecsim.safety.rule import Key, Kind, Severity
from trecsim.safety.schedules import read_hours
from trecsim.toml_models import Table
from trecsim.toml_models.table import MADE

MOST_RULES = 1000
_LONGEST_S = 86400.0
_Seconds = Annotated[float, Field(ge=0.0, le=_LONGEST_S)]


def _hours(text: str) -> str:
    read_hours(text)
    return text


class RuleTable(Table):
    """One rule: what to look for, where, and when."""

    id: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$")]
    """What the rule is called: letters, digits, `-` and `_`; no other rule has the same."""
    kind: str
    """What the rule looks for."""
    severity: Severity = "warning"
    """How bad it is: info, warning, alarm or critical."""
    schedule: (
        Annotated[list[Annotated[str, AfterValidator(_hours)]], Field(min_length=1, max_length=100)]
        | None
    ) = None
    """When the rule is armed, in the local time of the site, as `["Mo-Fr 22:00-06:00"]`; a range
    past midnight belongs to the day on which it starts. Always, if not given."""
    on_delay_s: _Seconds = 0.0
    """How long the condition must hold before an event [s]."""
    off_delay_s: _Seconds = 0.5
    """How long the condition must not hold before the event ends [s]."""
    cooldown_s: _Seconds = 0.0
    """How long after the end of an event of the same person or place no other one begins [s]."""
    p_on: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.9
    """From which probability on the condition holds."""
    p_off: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.5
    """Below which probability it does not hold any more."""
    early_s: Annotated[float, Field(ge=0.0, le=LONGEST_S)] = 0.0
    """So soon an event must be expected for a warning of it [s]; 0 warns of nothing."""

    @model_validator(mode="after")
    def _hysteresis(self) -> Self:
        if self.p_off > self.p_on:
            raise ValueError(
                f"expected p_off of at most p_on, found p_off = {self.p_off:g} and p_on = "
                f"{self.p_on:g}"
            )
        return self

    @property
    def of_kind(self) -> Kind:
        """The kind of rule."""
        return KINDS[self.kind]

    @property
    def place(self) -> str | None:
        """The name of the zone, line or edge that the rule is about."""
        kind = self.of_kind.place
        return None if kind is None else getattr(self, kind)

    def keys(self) -> dict[str, Any]:
        """Return the values of the keys of its kind."""
        return {key.name: getattr(self, key.name) for key in self.of_kind.keys}


def _table_of(kind: Kind) -> type[RuleTable]:
    fields: dict[str, Any] = {"kind": (Literal[kind.name], FieldInfo(description=kind.about))}
    for name in ("on_delay_s", "off_delay_s", "early_s"):
        about = RuleTable.model_fields[name]
        fields[name] = (
            about.annotation,
            FieldInfo.merge_field_infos(about, default=getattr(kind, name)),
        )
    if kind.place is not None:
        named: Any = str | None if kind.place_is_optional else str
        where = f"Name of the {kind.place}" + (
            "; everywhere if not given." if kind.place_is_optional else "."
        )
        fields[kind.place] = (
            named,
            FieldInfo(default=None if kind.place_is_optional else ..., description=where),
        )
    fields.update({key.name: _field_of(key) for key in kind.keys})
    name = "".join(part.capitalize() for part in kind.name.replace("_", ".").split("."))
    return create_model(
        f"{name}Rule", __base__=RuleTable, __doc__=kind.about, __cls_kwargs__=MADE, **fields
    )


def _field_of(key: Key) -> tuple[Any, FieldInfo]:
    return key.type, FieldInfo(default=key.default, description=key.about, **key.limits)


TABLES = tuple(_table_of(kind) for kind in KINDS.values())

if TYPE_CHECKING:
    AnyRule = RuleTable
else:
    AnyRule = Annotated[Union[TABLES], Field(discriminator="kind")]  # noqa: UP007
"""A rule of any kind; the key `kind` says which."""
