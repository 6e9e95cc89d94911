"""How often and how to look at images: the 2D estimator's time is spent where it tells most."""

from trecsim.looking.attention import Attention, noted
from trecsim.looking.look_policy import ByNeed, LookPolicy, cost
from trecsim.looking.schedule import Outlook, SchedulePolicy, Together, lighter

__all__ = [
    "Attention", "ByNeed", "LookPolicy", "Outlook", "SchedulePolicy", "Together", "cost",
    "lighter", "noted",
]  # fmt: skip
