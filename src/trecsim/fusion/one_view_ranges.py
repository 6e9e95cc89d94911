"""The distances of confirmed people while only one camera sees them."""

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion.along_rays import log_range, move_along_rays, relative_sigma
from trecsim.fusion.association import Association
from trecsim.fusion.fitting import Step
from trecsim.fusion.images import Images
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.ranging import (
    Known,
    Ranges,
    above_ankle_m,
    believed,
    sizes,
    upright_bones,
)
from trecsim.fusion.tuning import (
    GROUND_MEASURE_M2,
    KNOWN_RATE_MPS,
    KNOWN_SIZE_SPREAD,
    PLACE_SIGMA_M,
    SAT_DOWN,
    UPRIGHT,
)


class OneViewRanges:
    """Holds confirmed people at the distance that body and ground tell, while one camera sees them.

    Two cameras have measured both before, so that they are known better than those of somebody new.
    """

    def __init__(self) -> None:
        self._id: Int64[np.ndarray, " track"] = np.empty(0, np.int64)
        self._ranges = Ranges.none()
        self._upright: Bool[np.ndarray, " track"] = np.empty(0, bool)

    def take(
        self, people: Population, images: Images, association: Association, step: Step, model: Model
    ) -> None:
        """Measure distances in a frame set that `people` have taken in, and put them there."""
        if not len(self._id) and (people.last_two_view_s == step.now.t_s).all():
            return
        supports = people.last_seen_s > step.now.t_s - step.look_back_s
        alone = people.confirmed & (supports.sum(axis=1) == 1)
        if not (alone.any() or len(self._id)) or len(upright_bones(model)) < 2:
            return
        self._keep(np.isin(self._id, people.id[people.confirmed & (supports.sum(axis=1) <= 1)]))
        self._ranges.predict(step.now.elapsed_s)
        for k in np.flatnonzero(alone).tolist():
            self._begin(people, k, int(supports[k].argmax()), step, model)
        row_of = {identity: row for row, identity in enumerate(self._id.tolist())}
        tracks = np.flatnonzero(alone).tolist()
        rows = [(k, row_of[int(people.id[k])]) for k in tracks]
        tall = height_share(people, model)
        for k, row in rows:
            self._upright[row] = tall[k] >= (SAT_DOWN if self._upright[row] else UPRIGHT)
        upright = [(k, row) for k, row in rows if self._upright[row]]
        self._measure(people, images, association, upright, step, model)
        self._place(people, rows, step, model)
        self._tell(people, row_of, model)

    def _keep(self, which: Bool[np.ndarray, " track"]) -> None:
        self._id, self._ranges = self._id[which], self._ranges.keep(which)
        self._upright = self._upright[which]

    def _place(
        self, people: Population, rows: list[tuple[int, int]], step: Step, model: Model
    ) -> None:
        """Put those who stand or walk at their distances; take over those of others."""
        for k, row in rows:
            origin_m = model.cameras.position_m[self._ranges.cam[row]]
            if self._upright[row]:
                log_m, rate = self._ranges.mean[row, :2].tolist()
                move_along_rays(people, k, origin_m, log_m, rate, step.now, model)
            else:
                log_m, rate = log_range(people, k, origin_m, step.now, model)
                self._ranges.stay(row, log_m, rate, step.now.elapsed_s)

    def _tell(self, people: Population, row_of: dict[int, int], model: Model) -> None:
        """Write how far off the distances may be to `people`."""
        people.range_sigma[:] = people.range_rate_sigma[:] = 0.0
        for k, identity in enumerate(people.id.tolist()):
            if identity in row_of:
                row = row_of[identity]
                people.range_from_m[k] = model.cameras.position_m[self._ranges.cam[row]]
                people.range_sigma[k] = self._ranges.sigma[row]
                people.range_rate_sigma[k] = self._ranges.rate_sigma[row]

    def _begin(self, people: Population, k: int, cam: int, step: Step, model: Model) -> None:
        """Begin to measure the distance of a person from the camera that alone sees the person.

        Another camera saw the person until now, alone, or two did.
        """
        mine = self._id == people.id[k]
        if (self._ranges.cam[mine] == cam).all() and mine.any():
            return
        before = float(self._ranges.sigma[mine].sum())
        self._keep(~mine)
        origin_m = model.cameras.position_m[cam]
        log_m, rate = log_range(people, k, origin_m, step.now, model)
        distance_m = np.exp(log_m)
        bones = upright_bones(model)
        limb_m = people.limb_m[k, model.body.bone][bones]
        limb_m2 = people.limb_m2[k, model.body.bone][bones]
        above_m = max(above_ankle_m(model, cam, people.ground_level[k, 0]), 0.1)
        level_m2 = people.ground_level[k, 1] + GROUND_MEASURE_M2
        known = Known(
            log_m=log_m,
            log_m2=relative_sigma(people, k, origin_m, model) ** 2
            + (PLACE_SIGMA_M / distance_m) ** 2
            + before**2,
            rate=rate,
            rate2=(KNOWN_RATE_MPS / distance_m) ** 2,
            size=float(np.log(model.bones.length_m[bones] / limb_m).mean()),
            size2=float((limb_m2 / limb_m**2).mean()) + KNOWN_SIZE_SPREAD**2,
            level2=level_m2 / above_m**2,
        )
        self._id = np.append(self._id, people.id[k])
        self._upright = np.append(self._upright, False)
        self._ranges = self._ranges.joined(Ranges.known(cam, known))

    def _measure(
        self,
        people: Population,
        images: Images,
        association: Association,
        rows: list[tuple[int, int]],
        step: Step,
        model: Model,
    ) -> None:
        """Take in what the detections of people tell of their distances."""
        for k, row in rows:
            for v in np.flatnonzero(association.match[k] >= 0).tolist():
                if images.cam[v] != self._ranges.cam[row]:
                    continue
                which = np.zeros(len(images.xy_px), bool)
                which[association.match[k, v]] = True
                one, flip = images.detections(which), int(association.flip[k, v])
                told = sizes(model, believed(people, k, one, flip, model.noise.mirror))
                cam = int(images.cam[v])
                above_m = above_ankle_m(model, cam, people.ground_level[k, 0])
                self._ranges.look(row, told, 0, above_m, float(step.since_s[v]))


def height_share(people: Population, model: Model) -> Float64[np.ndarray, " track"]:
    """Return how high the limbs from shoulders to ankles are, as a share of their lengths."""
    bones = upright_bones(model)
    first, second = model.bones.joints[bones].T
    high_m = np.abs(people.xyz_m[:, first, 2] - people.xyz_m[:, second, 2]).sum(axis=1)
    return np.asarray(high_m / people.limb_m[:, model.body.bone][:, bones].sum(axis=1))
