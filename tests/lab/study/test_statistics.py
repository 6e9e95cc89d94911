"""Effects, interactions and noise on synthetic data with known effects."""

import numpy as np
import pytest
from scipy import stats

from trecsim.lab.study.default_rank import default_rank
from trecsim.lab.study.inference import Analysis, analyse
from trecsim.lab.study.resampling import blocks_of

FIRST = np.array([0.0, 1.0, 3.0])
SECOND = np.array([0.5, 0.0, 0.0, -0.5])
THIRD = np.zeros(2)


def grid() -> np.ndarray:
    """Return the levels of a full grid of three settings with 3, 4 and 2 values."""
    axes = np.meshgrid(np.arange(3), np.arange(4), np.arange(2), indexing="ij")
    return np.stack([axis.ravel() for axis in axes], axis=1)


def made(
    rng: np.random.Generator, *, seeds: int = 8, noise: float = 0.1, planted: float = 0.0
) -> np.ndarray:
    """Return outcomes of the grid: seeds differ a lot, the first two settings have effects."""
    level = grid()
    truth = FIRST[level[:, 0]] + SECOND[level[:, 1]]
    truth = truth + planted * ((level[:, 0] == 2) & (level[:, 1] == 3))
    hard = 20.0 * rng.standard_normal((seeds, 1))
    return 50.0 + hard + truth + noise * rng.standard_normal((seeds, len(level)))


def analysed(outcome: np.ndarray, reference: int = 0) -> Analysis:
    level = grid()
    blocks = blocks_of(np.zeros(len(outcome), np.int64))
    against = [np.eye(count)[reference] for count in (3, 4, 2)]
    return analyse(outcome, level, blocks, against)


def test_effects_of_an_additive_model_come_out_exactly() -> None:
    found = analysed(made(np.random.default_rng(0), noise=0.0))
    for effect, truth in zip(found.effects, (FIRST, SECOND, THIRD), strict=True):
        np.testing.assert_allclose(effect.difference, truth - truth[0], atol=1e-7)
        np.testing.assert_allclose(effect.spread, np.ptp(truth), atol=1e-7)
    assert found.explained == pytest.approx(1.0)
    assert [effect.matters for effect in found.effects] == [True, True, False]
    assert not any(pair.matters for pair in found.pairs.values())


def test_shares_of_the_variance_add_up_to_one_in_an_additive_model() -> None:
    found = analysed(made(np.random.default_rng(0), noise=0.0))
    assert sum(effect.share for effect in found.effects) == pytest.approx(1.0)


def test_effects_are_found_under_noise_and_seeds_that_differ_far_more() -> None:
    found = analysed(made(np.random.default_rng(1)))
    assert [effect.matters for effect in found.effects] == [True, True, False]
    strengths = [effect.strength for effect in found.effects]
    assert strengths == sorted(strengths, reverse=True)
    for effect, truth in zip(found.effects[:2], (FIRST, SECOND), strict=True):
        assert (effect.low <= truth - truth[0] + 1e-9).all()
        assert (effect.high >= truth - truth[0] - 1e-9).all()


def test_a_planted_interaction_is_found_and_is_the_strongest() -> None:
    found = analysed(made(np.random.default_rng(2), planted=1.0))
    assert found.pairs[0, 1].matters
    others = [pair.strength for key, pair in found.pairs.items() if key != (0, 1)]
    assert found.pairs[0, 1].strength > 5 * max(others)
    departure = found.pairs[0, 1].difference.reshape(3, 4)
    assert np.unravel_index(np.argmax(departure), (3, 4)) == (2, 3)


def test_the_heat_map_of_a_pair_shows_the_mean_of_each_cell() -> None:
    outcome, level = made(np.random.default_rng(3), planted=1.0), grid()
    cell = outcome[:, (level[:, 0] == 2) & (level[:, 1] == 3)].mean()
    assert analysed(outcome).pairs[0, 1].mean.reshape(3, 4)[2, 3] == pytest.approx(cell)


def test_pure_noise_rarely_looks_like_an_effect() -> None:
    rng = np.random.default_rng(4)
    found = [analysed(rng.standard_normal((6, 24))) for _ in range(60)]
    alarms = [effect.matters for one in found for effect in (*one.effects, *one.pairs.values())]
    assert 0.005 < np.mean(alarms) < 0.10


def test_intervals_hold_the_truth_about_as_often_as_they_say() -> None:
    rng = np.random.default_rng(5)
    inside = []
    for _ in range(80):
        effect = analysed(made(rng, seeds=5, noise=1.0)).effects[0]
        truth = FIRST - FIRST[0]
        inside.append((effect.low[1:] <= truth[1:]) & (truth[1:] <= effect.high[1:]))
    assert 0.88 < np.mean(inside) < 0.995


def test_one_seed_says_nothing_about_chance() -> None:
    found = analysed(made(np.random.default_rng(6), seeds=1))
    assert all(np.isnan(effect.noise_spread) and not effect.matters for effect in found.effects)
    assert np.isnan(found.effects[0].low).all()


def test_every_scene_counts_the_same_however_many_seeds_it_has() -> None:
    blocks = blocks_of(np.array([0, 0, 0, 1]))
    np.testing.assert_allclose(blocks.weight, [1 / 6, 1 / 6, 1 / 6, 1 / 2])
    np.testing.assert_allclose(blocks.drawn.sum(axis=1), 0.0, atol=1e-12)
    assert not blocks.drawn[:, 3].any()


def test_a_place_between_two_values_can_be_the_reference() -> None:
    outcome, level = made(np.random.default_rng(0), noise=0.0), grid()
    halfway = np.array([0.0, 0.5, 0.5])
    found = analyse(
        outcome, level, blocks_of(np.zeros(8, np.int64)), [halfway, np.eye(4)[0], np.eye(2)[0]]
    )
    np.testing.assert_allclose(found.effects[0].difference, FIRST - 2.0, atol=1e-7)


def test_one_at_a_time_gives_the_outcome_with_the_others_at_the_default() -> None:
    level = np.array([[0, 0], [1, 0], [2, 0], [0, 1]])
    outcome = np.array([[5.0, 6.0, 8.0, 4.0], [7.0, 8.0, 10.0, 6.0]])
    found = analyse(
        outcome, level, blocks_of(np.zeros(2, np.int64)), [np.eye(3)[0], np.eye(2)[0]],
        anchor=0, interactions=False,
    )  # fmt: skip
    np.testing.assert_allclose(found.effects[0].mean, [6.0, 7.0, 9.0])
    np.testing.assert_allclose(found.effects[1].mean, [6.0, 5.0])
    assert found.pairs == {}


def test_a_random_design_counts_its_own_imbalance_as_noise() -> None:
    rng = np.random.default_rng(7)
    level = rng.integers(0, 3, (40, 6))
    rough = np.where((level[:, 0] == 1) == (level[:, 1] == 1), 1.0, -1.0)  # pairs alone, no noise
    outcome = np.tile(rough, (6, 1)) + 1e-6 * rng.standard_normal((6, 40))
    blocks, against = blocks_of(np.zeros(6, np.int64)), [np.eye(3)[0]] * 6
    trusting = analyse(outcome, level, blocks, against).effects
    careful = analyse(outcome, level, blocks, against, balanced=False)
    assert sum(effect.matters for effect in trusting) == 6
    assert sum(effect.matters for effect in careful.effects) <= 1
    assert careful.pairs[0, 1].matters


def test_few_seeds_widen_the_deviations_as_students_t_does() -> None:
    per_block = np.array([[1.0], [2.0], [3.0], [6.0]])
    blocks = blocks_of(np.zeros(4, np.int64))
    half_width = 1.96 * float((blocks.drawn @ per_block).std())
    wanted = stats.t.ppf(0.975, 3) * per_block.std(ddof=1) / 2.0
    assert half_width == pytest.approx(wanted, rel=0.05)


@pytest.mark.parametrize("better", [False, True])
def test_the_default_is_ranked_among_all_points(better: bool) -> None:
    outcome = np.array([[3.0, 1.0, 2.0, 4.0]]) + np.array([[0.0], [10.0], [20.0]])
    found = default_rank(
        outcome, [1, 2, 3], blocks_of(np.zeros(3, np.int64)), 0, more_is_better=better
    )
    assert (found.rank, found.points) == ((2, 4) if better else (3, 4))
    assert found.best_point == (3 if better else 1)
    assert found.gain == pytest.approx(1.0 if better else 2.0)
    assert found.default == pytest.approx(13.0)
    assert found.gain_on_other_seeds == pytest.approx(found.gain)


def test_a_default_that_nothing_beats_gains_nothing() -> None:
    found = default_rank(
        np.ones((4, 5)), [1, 2, 3, 4], blocks_of(np.zeros(4, np.int64)), 0, more_is_better=False
    )
    assert (found.rank, found.best_point, found.gain) == (1, 0, 0.0)


def test_luck_of_the_best_does_not_pass_for_a_gain() -> None:
    rng = np.random.default_rng(8)
    blocks, seeds = blocks_of(np.zeros(6, np.int64)), list(range(6))
    found = [
        default_rank(rng.standard_normal((6, 50)), seeds, blocks, 0, more_is_better=False)
        for _ in range(60)
    ]
    assert np.mean([one.gain for one in found]) > 0.5
    assert abs(np.mean([one.gain_on_other_seeds for one in found])) < 0.2
    assert np.mean([one.gain_on_other_seeds_low > 0 for one in found]) < 0.1
