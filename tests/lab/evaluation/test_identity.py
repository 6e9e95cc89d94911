"""IDF1, MOTA and HOTA: cases counted by hand, and the slow twins."""

import sys
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lab.evaluation import reference_scores
from lab.evaluation.scored_cases import moments_of, places, scores_of, truth_of
from often import often
from trecsim.errors import SetupError
from trecsim.lab.evaluation.identity import Identity, IdentityCount

A_AND_B = truth_of([0.0] * 4, [3.0] * 4)


def test_one_switch_among_eight_person_moments() -> None:
    found = [{1: 0.0, 2: 3.0}, {1: 0.0, 2: 3.0}, {1: 0.0, 7: 3.0}, {1: 0.0, 7: 3.0}]
    identity = scores_of(A_AND_B, found).identity
    assert (identity.switches, identity.mota_switches) == (1, 1)
    assert identity.mota == pytest.approx(1 - 1 / 8)
    # A is 1 four times; B is either 2 or 7, two times: 6 of 8 agree
    assert identity.idf1 == pytest.approx(6 / 8)
    # four pairs share all their time, four (2 and 7 with B) half of it
    assert identity.assa == pytest.approx((4 * 1 + 4 * 0.5) / 8)
    assert identity.deta == pytest.approx(1.0)
    assert identity.hota == pytest.approx(np.sqrt(0.75))


def test_two_people_who_exchange_their_identities_half_way() -> None:
    found = [{1: 0.0, 2: 3.0}, {1: 0.0, 2: 3.0}, {2: 0.0, 1: 3.0}, {2: 0.0, 1: 3.0}]
    identity = scores_of(A_AND_B, found).identity
    assert identity.switches == 2
    assert identity.mota == pytest.approx(1 - 2 / 8)
    assert identity.idf1 == pytest.approx(4 / 8)
    # each pair is together twice; person and name are apart twice each: 2 / (4 + 4 - 2)
    assert identity.assa == pytest.approx(1 / 3)
    assert identity.hota == pytest.approx(np.sqrt(1 / 3))


def test_a_false_positive_and_a_missed_person() -> None:
    truth = truth_of([0.0, 0.0], [3.0, 3.0])
    scores = scores_of(truth, [{1: 0.0, 9: 6.0}, {1: 0.0}])
    identity = scores.identity
    # two are found, B is missed twice, one is a false positive
    assert identity.mota == pytest.approx(1 - (2 + 1) / 4)
    assert identity.idf1 == pytest.approx(2 * 2 / (4 + 3))
    assert identity.deta == pytest.approx(2 / (2 + 2 + 1))
    assert identity.assa == pytest.approx(1.0)


def test_hota_asks_how_near() -> None:
    identity = scores_of(truth_of([0.0]), [{1: 0.22}]).identity
    # similarity 0.78: above 15 of the 19 thresholds, 0.05 to 0.75
    assert identity.deta == pytest.approx(15 / 19)
    assert identity.hota == pytest.approx(15 / 19)
    assert identity.mota == pytest.approx(1.0)


def test_the_threshold_of_similarity_is_the_gate_of_distance() -> None:
    near, far = scores_of(truth_of([0.0]), [{1: 0.499}]), scores_of(truth_of([0.0]), [{1: 0.501}])
    assert (near.matched, near.identity.mota, near.identity.idf1) == (1, 1.0, 1.0)
    assert (far.matched, far.identity.mota, far.identity.idf1) == (0, -1.0, 0.0)


def test_mota_keeps_a_pair_that_is_still_within_the_gate() -> None:
    truth = truth_of([0.0, 0.0], [0.4, 0.4])
    found = [{1: 0.0, 2: 0.4}, {1: 0.25, 2: 0.15}]  # the second time each is nearer to the other
    identity = scores_of(truth, found).identity
    assert identity.switches == 2
    assert identity.mota_switches == 0


def test_mota_rather_keeps_a_pair_than_makes_two() -> None:
    truth = truth_of([0.0, 0.0], [np.nan, -0.4])
    found = [{1: 0.0}, {1: 0.0, 2: 0.45}]  # B is near 1 only, and 1 was A's before
    scores = scores_of(truth, found)
    assert scores.matched == 3
    # A keeps 1; B is missed and 2 is a false positive, of three person-moments
    assert scores.identity.mota == pytest.approx(1 - 2 / 3)


def test_nobody_found_is_zero_and_nobody_there_is_unknown() -> None:
    missed = scores_of(truth_of([0.0, 0.0]), [{}, {}]).identity
    assert (missed.idf1, missed.mota, missed.hota, missed.deta) == (0.0, 0.0, 0.0, 0.0)
    nobody = scores_of(truth_of([np.nan, np.nan]), [{1: 0.0}, {}]).identity
    assert np.isnan([nobody.idf1, nobody.mota, nobody.hota, nobody.deta, nobody.assa]).all()


def random_scene(seed: int, people: int) -> tuple[list[list[complex]], list[dict[int, complex]]]:
    """Return people who come and go in a crowd, and how a poor tracker finds them."""
    rng = np.random.default_rng(seed)

    def scattered(scale_m: float, *shape: int) -> np.ndarray:
        return rng.normal(0, scale_m, shape) + 1j * rng.normal(0, scale_m, shape)

    place_m = np.cumsum(scattered(0.1, people, 12), axis=1) + scattered(0.6, people, 1)
    names = rng.permutation(1000)[:people].tolist()
    found = []
    for moment in range(place_m.shape[1]):
        for person in np.flatnonzero(rng.random(people) < 0.1):
            other = rng.integers(people)
            names[person], names[other] = names[other], names[person]
        seen = np.flatnonzero(rng.random(people) < 0.85)
        found.append({names[p]: place_m[p, moment] + scattered(0.15) for p in seen})
    place_m[rng.random(place_m.shape) < 0.15] = np.nan
    return place_m.tolist(), found


def as_moments(people: list[list[complex]], found: list[dict[int, complex]]) -> list[Any]:
    """Return the same for the twins."""
    moments = []
    for moment, now in enumerate(found):
        true = [p for p, place_m in enumerate(people) if not np.isnan(place_m[moment])]
        apart_m = np.array([[abs(people[p][moment] - at) for at in now.values()] for p in true])
        alike = np.maximum(0.0, 1.0 - apart_m.reshape(len(true), len(now)))
        moments.append((true, list(now), alike))
    return moments


@settings(max_examples=often(40))
@given(st.integers(0, 2**32 - 1), st.integers(1, 14))
def test_scores_equal_their_twins(seed: int, people: int) -> None:
    people_m, found = random_scene(seed, people)
    identity = scores_of(truth_of(*people_m), found).identity
    moments = as_moments(people_m, found)
    if not any(true for true, _, _ in moments):
        assert np.isnan(identity.mota)
        return
    assert (identity.mota, identity.mota_switches) == pytest.approx(reference_scores.mota(moments))
    assert identity.idf1 == pytest.approx(reference_scores.idf1(moments))
    wanted = reference_scores.hota(moments)
    assert (identity.hota, identity.deta, identity.assa) == pytest.approx(wanted)


@pytest.mark.parametrize("seed", range(3))
def test_names_and_their_order_do_not_matter(seed: int) -> None:
    people_m, found = random_scene(seed, 5)
    rng = np.random.default_rng(seed)
    name = dict(zip(range(1000), rng.permutation(5000).tolist(), strict=False))
    renamed = []
    for now in found:
        items = [(name[one], place_m) for one, place_m in now.items()]
        renamed.append(dict(items[i] for i in rng.permutation(len(items))))
    one, other = (scores_of(truth_of(*people_m), case).identity for case in (found, renamed))
    assert one.switches > 0
    for field in Identity.__slots__:
        assert getattr(one, field) == pytest.approx(getattr(other, field))


def test_a_missing_library_is_told_with_the_way_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "motrics", None)
    with pytest.raises(SetupError, match=r"pip install .*\[evaluate\]"):
        IdentityCount(moments_of([{1: 0.0}]))


def test_places_are_what_they_say() -> None:
    np.testing.assert_array_equal(places(1.0, np.nan)[:, 3, 0], [1.0, np.nan])
