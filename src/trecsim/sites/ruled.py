"""What rules need of a site file: its time zone, its places, and the rules themselves."""

from collections.abc import Iterator
from typing import Annotated, Self

from pydantic import Field, model_validator

from trecsim.forecasting.walls import MOST_WALLS, Walls
from trecsim.sites.feed_tables import FeedTable
from trecsim.sites.mode_tables import ModeTable, mode_faults
from trecsim.sites.places import (
    EdgeTable,
    LineTable,
    TimeZone,
    VolumeTable,
    WallTable,
    ZoneTable,
)
from trecsim.sites.rule_tables import MOST_RULES, AnyRule
from trecsim.sites.rules import Places, feed_faults, refuse, rule_faults
from trecsim.sites.site_names import Name
from trecsim.toml_models import Table
from trecsim.toml_models.toml_reading import Fault

RULED = (
    "format", "name", "timezone", "zones", "lines", "edges", "walls", "volumes", "exclusions",
    "portals", "feeds", "rules", "modes",
)  # fmt: skip
"""Keys of a site file that rules on recordings need."""


class Ruled(Table):
    """A site file with places and rules."""

    timezone: TimeZone = "UTC"
    """Time zone of the site, for the page and reports: an IANA name as `Europe/Zurich`."""
    zones: dict[Name, ZoneTable] = Field(default_factory=dict)
    """Parts of the floor, by name; the page draws them."""
    lines: dict[Name, LineTable] = Field(default_factory=dict)
    """Directed lines on the floor, by name; the page draws them."""
    exclusions: dict[Name, ZoneTable] = Field(default_factory=dict)
    """Beds, benches, sofas, by name: rules on falls do not fire while the hips are in there."""
    portals: dict[Name, LineTable] = Field(default_factory=dict)
    """Ways in and out of the site, by name; "in" is into it. The report of a day counts people by
    the portals through which they came and left."""
    edges: dict[Name, EdgeTable] = Field(default_factory=dict)
    """Edges of drops, by name; the page draws them."""
    walls: dict[Name, WallTable] = Field(default_factory=dict)
    """What nobody walks through, by name: forecasts stop at them. The page draws them."""
    volumes: dict[Name, VolumeTable] = Field(default_factory=dict)
    """Boxes that move by a timetable or by a feed, by name."""
    feeds: Annotated[dict[Name, FeedTable], Field(max_length=50)] = Field(default_factory=dict)
    """Messages of other systems, by name, such as access control and vehicles."""
    rules: Annotated[list[AnyRule], Field(max_length=MOST_RULES)] = Field(default_factory=list)
    """What to tell of the people: see the kinds of rules."""

    modes: Annotated[dict[Name, ModeTable], Field(max_length=50)] = Field(default_factory=dict)
    """Modes, by name: which rules are off by day, by night, or for maintenance."""

    @property
    def places(self) -> Places:
        """Zones, lines, edges and volumes, by kind and name."""
        return {
            "zone": self.zones, "line": self.lines, "edge": self.edges, "volume": self.volumes,
        }  # fmt: skip

    @property
    def walls_m(self) -> Walls:
        """The walls as forecasts take them."""
        return Walls.along([wall.points_m for wall in self.walls.values()])

    @model_validator(mode="after")
    def _rules_fit(self) -> Self:
        faults = [
            *rule_faults(self.rules, self.places, self.feeds),
            *feed_faults(self.volumes, self.feeds),
            *mode_faults(self.modes, self.rules),
            *self._wall_faults(),
        ]
        if faults:
            refuse("Site", faults)
        return self

    def _wall_faults(self) -> Iterator[Fault]:
        """Yield that there are more walls than forecasts bear."""
        found = len(self.walls_m)
        if found > MOST_WALLS:
            yield (
                ("walls",),
                f"expected at most {MOST_WALLS} straight pieces in all, found {found}; leave out "
                "walls that nobody gets near, and draw round ones with fewer points",
            )
