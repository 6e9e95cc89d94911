"""Left and right exchanged: tracks that cameras read mirrored are mirrored."""

import numpy as np

from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import MIRROR_S


def unmirror(people: Population, model: Model) -> None:
    """Exchange left and right, in place, of tracks that most cameras read the other way round."""
    for k in np.flatnonzero(people.mirrored_duration_s > MIRROR_S):
        people.mirror(int(k), model.noise.mirror)
        people.mirrored_duration_s[k] = 0.0
