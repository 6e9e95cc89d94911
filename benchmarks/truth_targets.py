"""What is asked of the truth of the tracker's claims, and where the figure reached is stored."""

from targets import Relation, Target

_LAGS = {"newest": "no lag", "lag 0.2 s": "0.2 s lag"}
_ACTORS = {
    "SinglePerson, man": "man alone",
    "MultiPerson, man": "man behind the woman",
    "MultiPerson, woman": "woman",
}
_HELD: tuple[tuple[int, str, Relation, float], ...] = (
    (50, "at least", ">=", 40),
    (50, "at most", "<=", 65),
    (90, "at least", ">=", 85),
    (90, "at most", "<=", 95),
    (99, "at least", ">=", 97),
)


def _held(group: str, text: str, *where: str) -> list[Target]:
    """Return what is asked of the shares of errors inside their regions."""
    return [
        Target(group, f"{text}: {share} % regions hold, {which}",
               (*where, f"in {share} % regions"), relation, limit, "%")
        for share, which, relation, limit in _HELD
    ]  # fmt: skip


def _real_video() -> list[Target]:
    pairs, cells, limbs = "disjoint pairs of cameras", "cameras left out", "impossible"
    return [
        *(Target(pairs, f"90 % regions hold, {who}, {lag}",
                 ("left_out", actor, key, "disjoint pairs", "in 90 % regions"), ">=", 80, "%")
          for actor, who in _ACTORS.items() for key, lag in _LAGS.items()),
        *(target for actor, who in _ACTORS.items()
          for target in _held(cells, f"from 3, {who}", "left_out", actor, "*", "3 cameras",
                              "regions")),
        *(Target(cells, f"from 2, more than 100 px off though said to be known, {who}, {lag}",
                 ("left_out", actor, key, "2 cameras", "far off, of the sure"), "<=", 2.4, "%",
                 "Pose2Sim 2.4")
          for actor, who in _ACTORS.items() for key, lag in _LAGS.items()),
        *(Target(limbs, f"limbs over 1.5 x their median, {who}",
                 ("left_out", actor, "*", "* cameras", "limbs too long"), "<=", 0, "%")
          for actor, who in _ACTORS.items()),
    ]  # fmt: skip


def _staggered() -> list[Target]:
    group, turns = "cameras in turn", ("[!a]*",)
    return [
        target
        for key, lag in _LAGS.items()
        for target in (
            Target(group, f"step of who stands, median of the worst staggering, {lag}",
                   ("staggered", *turns, key, "step, median"), "<=", 0.5, "cm"),
            Target(group, f"error, of that in step, worst staggering, {lag}",
                   ("staggered", *turns, key, "error / in step"), "<=", 1.1, "x"),
            Target(group, f"either actor found, worst staggering, {lag}",
                   ("staggered", *turns, key, "* found"), ">=", 1),
        )
    ]  # fmt: skip


TRUTH: tuple[Target, ...] = (*_real_video(), *_staggered())
"""What is asked, in the order of the table."""

ALONE = ("left_out", "staggered")
"""The benchmarks that were made for it."""
