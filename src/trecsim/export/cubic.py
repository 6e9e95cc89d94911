"""The C2 cubic spline through samples at any times, evaluated at others."""

import numpy as np
from jaxtyping import Float64


def cubic_through(
    t_s: Float64[np.ndarray, " sample"],
    values: Float64[np.ndarray, "sample column"],
    at_s: Float64[np.ndarray, " time"],
) -> Float64[np.ndarray, "time column"]:
    """Evaluate the cubic spline through samples.

    Parameters
    ----------
    t_s
        Strictly increasing times of at least two samples [s].
    values
        The samples; none is missing.
    at_s
        Where to evaluate it, within the samples [s].

    Notes
    -----
    With slopes m and steps h, continuity of the second derivative at sample i reads
    ``h_i m_(i-1) + 2 (h_(i-1) + h_i) m_i + h_(i-1) m_(i+1) =
    3 (h_i s_(i-1) + h_(i-1) s_i)`` with the secants s. The slopes at the ends are those of the
    parabola through the three nearest samples.

    Examples
    --------
    >>> t_s = np.array([0.0, 1.0, 3.0, 4.0])
    >>> float(cubic_through(t_s, t_s[:, None] ** 2, np.array([2.0]))[0, 0])
    4.0
    """
    slopes = _slopes(t_s, values)
    place = np.clip(np.searchsorted(t_s, at_s, side="right") - 1, 0, len(t_s) - 2)
    step = np.diff(t_s)[place]
    u = ((at_s - t_s[place]) / step)[:, None]
    left, right = values[place], values[place + 1]
    out: Float64[np.ndarray, "time column"] = (
        left * (1 + 2 * u) * (1 - u) ** 2
        + right * u**2 * (3 - 2 * u)
        + step[:, None] * u * (1 - u) * (slopes[place] * (1 - u) - slopes[place + 1] * u)
    )
    return out


def _slopes(
    t_s: Float64[np.ndarray, " sample"], values: Float64[np.ndarray, "sample column"]
) -> Float64[np.ndarray, "sample column"]:
    h = np.diff(t_s)
    secants = np.diff(values, axis=0) / h[:, None]
    if len(t_s) == 2:
        return np.repeat(secants, 2, axis=0)
    first = secants[0] - h[0] * (secants[1] - secants[0]) / (h[0] + h[1])
    last = secants[-1] + h[-1] * (secants[-1] - secants[-2]) / (h[-1] + h[-2])
    right = 3.0 * (h[1:, None] * secants[:-1] + h[:-1, None] * secants[1:])
    right[0] -= h[1] * first
    right[-1] -= h[-2] * last
    inner = solve_tridiagonal(h[1:], 2.0 * (h[:-1] + h[1:]), h[:-1], right)
    return np.concatenate([first[None], inner, last[None]])


def solve_tridiagonal(
    below: Float64[np.ndarray, " row"],
    diagonal: Float64[np.ndarray, " row"],
    above: Float64[np.ndarray, " row"],
    right: Float64[np.ndarray, "row column"],
) -> Float64[np.ndarray, "row column"]:
    """Solve a diagonally dominant tridiagonal system (Thomas' algorithm); ends of bands unused."""
    solved = right.copy()
    factors = np.empty(len(right))
    factors[0] = above[0] / diagonal[0]
    solved[0] /= diagonal[0]
    for row in range(1, len(right)):
        pivot = diagonal[row] - below[row] * factors[row - 1]
        factors[row] = above[row] / pivot
        solved[row] = (solved[row] - below[row] * solved[row - 1]) / pivot
    for row in range(len(right) - 2, -1, -1):
        solved[row] -= factors[row] * solved[row + 1]
    return solved
