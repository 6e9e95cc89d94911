"""Twins of the scores of identities, slow and close to their definitions.

A moment is (true identities, identities found, similarity of each pair).
"""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

Moment = tuple[list[int], list[int], np.ndarray]


def best(worth: np.ndarray) -> list[tuple[int, int]]:
    """Return the pairs that are worth most altogether."""
    rows, columns = linear_sum_assignment(-worth)
    return [(int(r), int(c)) for r, c in zip(rows, columns, strict=True)]


def mota(moments: Sequence[Moment]) -> tuple[float, int]:
    """Return MOTA and its switches: pairs of the moment before are kept as long as they can be."""
    there = false_positives = missed = switches = 0
    last: dict[int, int] = {}
    just_now: dict[int, int] = {}
    for true, found, alike in moments:
        there += len(true)
        if not true or not found:
            missed, false_positives = missed + len(true), false_positives + len(found)
            continue
        kept = np.array([[just_now.get(person) == other for other in found] for person in true])
        worth = np.where(alike >= 0.5, alike + 1000 * kept, 0.0)
        pairs = {true[r]: found[c] for r, c in best(worth) if worth[r, c] > 0}
        switches += sum(last.get(person, other) != other for person, other in pairs.items())
        missed += len(true) - len(pairs)
        false_positives += len(found) - len(pairs)
        last |= pairs
        just_now = pairs
    return 1 - (missed + false_positives + switches) / there, switches


def idf1(moments: Sequence[Moment]) -> float:
    """Return the F1 of person-moments under the best one-to-one naming of people."""
    agree: Counter[tuple[int, int]] = Counter()
    for true, found, alike in moments:
        agree.update((true[r], found[c]) for r, c in np.argwhere(alike >= 0.5))
    people = sorted({person for true, _, _ in moments for person in true})
    names = sorted({name for _, found, _ in moments for name in found})
    table = np.array([[agree[person, name] for name in names] for person in people])
    right = sum(table[pair] for pair in best(table)) if table.size else 0
    total = sum(len(true) + len(found) for true, found, _ in moments)
    return float(2 * right / total)


def hota(moments: Sequence[Moment]) -> tuple[float, float, float]:
    """Return HOTA, DetA and AssA, means over the thresholds."""
    aligned = alignment(moments)
    of_person = Counter(person for true, _, _ in moments for person in true)
    of_name = Counter(name for _, found, _ in moments for name in found)
    pairs = []
    for true, found, alike in moments:
        worth = np.array([[aligned[p, n] for n in found] for p in true]).reshape(alike.shape)
        pairs += [(true[r], found[c], alike[r, c]) for r, c in best(worth * alike)]
    scores = []
    for threshold in np.arange(1, 20) / 20:
        kept = Counter((p, n) for p, n, similar in pairs if similar >= threshold - 1e-9)
        hits = sum(kept.values())
        deta = hits / (sum(of_person.values()) + sum(of_name.values()) - hits)
        shares = [
            count * count / (of_person[p] + of_name[n] - count) for (p, n), count in kept.items()
        ]
        assa = sum(shares) / max(hits, 1)
        scores.append((np.sqrt(deta * assa), deta, assa))
    first, second, third = np.mean(scores, axis=0)
    return float(first), float(second), float(third)


def alignment(moments: Sequence[Moment]) -> dict[tuple[int, int], float]:
    """Return for person and name how well they go together over the whole time."""
    together: Counter[tuple[int, int]] = Counter()
    alone: Counter[tuple[str, int]] = Counter()
    for true, found, alike in moments:
        alone.update(("true", person) for person in true)
        alone.update(("found", name) for name in found)
        for row, person in enumerate(true):
            for column, name in enumerate(found):
                around = alike[row].sum() + alike[:, column].sum() - alike[row, column]
                together[person, name] += alike[row, column] / around if around > 0 else 0.0
    return {
        (person, name): share / (alone["true", person] + alone["found", name] - share)
        for (person, name), share in together.items()
    }
