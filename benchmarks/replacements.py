"""What takes the place of functions of the fusion, where a part of its model is switched off.

Those in place of kernels are compiled, and see the kernels that they call as they usually are.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from trecsim.fusion.images import Images, prepare
from trecsim.fusion.kernels import Bones, Views, Who
from trecsim.fusion.kernels.camera_corrections import prior_of
from trecsim.fusion.kernels.distances import hold_distances
from trecsim.fusion.kernels.fitting_kernels import nis_ratio
from trecsim.fusion.kernels.presence import survive_all
from trecsim.fusion.kernels.reported_covariance import disagreement_m2
from trecsim.fusion.model import Model
from trecsim.fusion.tuning import LONGEST_STEP_S

NEVER, ALWAYS = 1e-9, 1e9  # as times, lengths, shares: so little or much that it is none or all

# In place of kernels: never true, nothing done, nothing of it, all of it.


def no(*_: Any) -> bool:
    """Say no."""
    return False


def nothing(*_: Any) -> None:
    """Do nothing; say that there is none."""


def none(*_: Any) -> float:
    """Return zero."""
    return 0.0


def all_(*_: Any) -> float:
    """Return one."""
    return 1.0


def inlier(*_: Any) -> float:
    """Return odds that leave no doubt."""
    return 1e300


def on_no_ground(*_: Any) -> tuple[int, float, float]:
    """Return that nothing rests on the ground."""
    return -1, 0.0, 1.0


def all_trusted(two_view_s: Any, _swap_evidence: Any) -> Any:
    """Return that two cameras support everybody now."""
    return np.full(two_view_s.shape, np.inf)


def nis_of_everything(_cameras: Any, _noise: Any, _measured: Any, person: Any, located: Any) -> Any:
    """Return the ratio with all that cameras are off by in it."""
    return nis_ratio(located, person.prior_m2)


def zeros(_A: Any, _B: Any, out: Any) -> None:
    """Write zeros in place of a product."""
    out[:] = 0.0


def no_inverse(_A: Any, out: Any) -> None:
    """Write zeros in place of an inverse."""
    out[:] = 0.0


def only_spread(noise: Any, j: Any, sights: Any, k: Any, now_s: Any) -> Any:
    """Return the variance of disagreement without that of cameras which do not agree."""
    return 0.0, disagreement_m2(noise, j, sights, k, now_s)[1]


def only_apart(noise: Any, j: Any, sights: Any, k: Any, now_s: Any) -> Any:
    """Return the variance of disagreement without the spread of cameras that agree."""
    return disagreement_m2(noise, j, sights, k, now_s)[0], 0.0


def count_looking_back(sights: Any, now_s: Any, out: Any) -> None:
    """Count cameras that supported a joint lately, whatever their newest images show."""
    last_s, look_back_s = sights.joint_s, sights.look_back_s
    for k in range(out.shape[0]):
        for j in range(out.shape[1]):
            n = 0
            for c in range(last_s.shape[2]):
                n += last_s[k, j, c] > now_s - look_back_s[c]
            out[k, j] = n


def survive_as_old(
    sightings: Any, who: Any, doubts: Any, views: Any, x_m: Any, now_s: Any, look_back_s: Any,
    limits: Any, alive: Any,
) -> Any:  # fmt: skip
    """Judge who lives on as if everybody had existed for long."""
    old = Who(who.id, who.born_s - ALWAYS, who.confirmed)
    return survive_all(sightings, old, doubts, views, x_m, now_s, look_back_s, limits, alive)


def hold_singles(
    shown: Any, tracks: Any, bodies: Any, sightings: Any, confirmed: Any, ranges: Any, matches: Any,
    now: Any, is_single: Any,
) -> None:  # fmt: skip
    """Hold only those at their distances whom two cameras have never seen."""
    if is_single:
        hold_distances(shown, tracks, bodies, sightings, confirmed, ranges, matches, now, is_single)


# In place of what stays Python.


def two_cameras(people: Any, *_: Any) -> Any:
    """Return that two cameras should find everybody."""
    n, n_cam = people.last_seen_s.shape
    return Views(np.full(n, 2, np.int64), np.zeros(n, bool), np.zeros((n, n_cam), bool))


def all_expected(views: Any, *_: Any) -> Any:
    """Return all cameras that should find people, whether they have looked since or not."""
    return views.expected


def nobody_missing(people: Any, *_: Any) -> Any:
    """Return that no camera looks in vain."""
    return np.zeros(len(people), np.int64)


def one_each(self: Any, *_: Any) -> Any:
    """Return that one camera should find each person of a single camera."""
    return np.ones(len(self), np.int64)


def none_explained(_self: Any, found: Any, *_: Any) -> Any:
    """Return that no detection shows somebody who is followed already."""
    return np.zeros(len(found), bool)


def any_detection_s(_found: Any, since_s: Any) -> Any:
    """Return that a detection is worth its time, however weak."""
    return np.minimum(since_s, LONGEST_STEP_S)


def no_levels(*_: Any) -> list[float]:
    """Return that nobody has shown where the ground is."""
    return []


def at_rest(*_: Any) -> Any:
    """Return no velocity."""
    return np.zeros(3)


def as_it_is(_self: Any, snapshot: Any) -> Any:
    """Return a snapshot with the supports of now."""
    return snapshot


def at_one_time(*arguments: Any) -> Images:
    """Return images as if all had been taken with the newest."""
    images = prepare(*arguments)
    return replace(images, t_s=np.full(len(images), images.t_s.max(initial=-np.inf)))


def prior_of_turns(found: Any, scale: Any) -> Any:
    """Return a prior by which all clocks are right."""
    prior = prior_of(found, scale)
    for c in range(prior.shape[0]):
        prior[c, 3] = NEVER**2
    return prior


def prior_of_delays(found: Any, scale: Any) -> Any:
    """Return a prior by which no camera is turned."""
    prior = prior_of(found, scale)
    for c in range(prior.shape[0]):
        prior[c, 0] = prior[c, 1] = prior[c, 2] = NEVER**2
    return prior


def same_prior(found: Any, scale: Any) -> Any:
    """Return the same prior for all cameras, whatever was found."""
    return prior_of(np.zeros(found.shape), scale)


def apply_all(c: Any, found: Any, _cov: Any, _prior: Any, applied: Any) -> None:
    """Apply all errors of a camera as they were found."""
    for i in range(found.shape[1]):
        applied[c, i] = found[c, i]


# Models without something.


def same_noise(model: Model) -> Model:
    """Return a model in which all joints are as easy to find."""
    mean_m = np.full_like(model.noise.sigma_m, model.noise.sigma_m.mean())
    return replace(model, noise=model.noise._replace(sigma_m=mean_m))


def same_common(model: Model) -> Model:
    """Return a model in which cameras share as much of the error of every joint."""
    mean_m2 = np.full_like(model.noise.common_m2, model.noise.common_m2.mean())
    return replace(model, noise=model.noise._replace(common_m2=mean_m2))


def no_postures(model: Model) -> Model:
    """Return the model without any knowledge of postures."""
    return replace(model, postures=model.postures._replace(trunk=np.empty(0, np.int64)))


def no_limbs(model: Model) -> Model:
    """Return a model in which limbs have any length."""
    slack_m2 = np.full_like(model.limbs.slack_m2, ALWAYS)
    return replace(model, limbs=model.limbs._replace(slack_m2=slack_m2))


def no_bones(model: Model) -> Model:
    """Return a model in which newcomers need no anatomy."""
    return replace(model, bones=Bones(*(values[:0].copy() for values in model.bones)))
