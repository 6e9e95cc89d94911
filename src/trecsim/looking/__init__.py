"""How often and how to look at images: the 2D estimator's time is spent where it tells most."""

from trecsim.looking.attention import Attention, noted
from trecsim.looking.look_policy import ByNeed, LookPolicy, cost

__all__ = ["Attention", "ByNeed", "LookPolicy", "cost", "noted"]
