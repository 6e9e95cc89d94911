"""The linearised equations of an adjustment; poses of placements are eliminated."""

import numpy as np
from jaxtyping import Float64, Int64


class Equations:
    """Normal equations of cameras and boards, and of each placement.

    Attributes
    ----------
    matrix, slope
        Of the unknowns of cameras and boards: (column, column) and (column,).
    own, own_slope
        Of the pose of each placement: (placement, 6, 6) and (placement, 6).
    mixed
        Coupling of the two: (placement, column, 6).
    slope_of
        The part of `slope` from each placement: (placement, column).
    """

    def __init__(self, unknowns: int, placements: int) -> None:
        self.matrix = np.zeros((unknowns, unknowns))
        self.slope = np.zeros(unknowns)
        self.mixed = np.zeros((placements, unknowns, 6))
        self.own = np.zeros((placements, 6, 6))
        self.own_slope = np.zeros((placements, 6))
        self.slope_of = np.zeros((placements, unknowns))

    def step(
        self, damping: float
    ) -> tuple[Float64[np.ndarray, " column"], Float64[np.ndarray, "placement 6"]]:
        """Return the change of the unknowns and of the placements."""
        own = self.own + damping * _diagonals(self.own) + 1e-12 * np.eye(6)
        right = np.concatenate((np.swapaxes(self.mixed, 1, 2), self.own_slope[..., None]), axis=2)
        solved = np.linalg.solve(own, right)
        matrix = self.matrix + damping * np.diag(np.diag(self.matrix))
        if len(matrix):
            matrix = matrix - np.tensordot(self.mixed, solved[..., :-1], axes=((0, 2), (0, 1)))
            slope = self.slope - np.tensordot(self.mixed, solved[..., -1], axes=((0, 2), (0, 1)))
            change = _solved(matrix, slope)
        else:
            change = np.empty(0)
        return change, solved[..., -1] - solved[..., :-1] @ change

    def covariance(
        self, count: int, columns: Int64[np.ndarray, " column"]
    ) -> Float64[np.ndarray, "unknown unknown"]:
        """Return the covariance of all unknowns, the placements being unknown.

        Notes
        -----
        Corners of one placement err together: a board is not flat, an image is blurred. The scores
        of the placements show it, and where they say more than the residuals, they count (the
        sandwich of Huber and White, one cluster per placement).
        """
        full = np.zeros((count, count))
        if not len(columns):
            return full
        own = self.own + 1e-12 * np.eye(6)
        right = np.concatenate((np.swapaxes(self.mixed, 1, 2), self.own_slope[..., None]), axis=2)
        solved = np.linalg.solve(own, right)
        matrix = self.matrix - np.tensordot(self.mixed, solved[..., :-1], axes=((0, 2), (0, 1)))
        from_residuals = np.linalg.pinv(matrix, hermitian=True)
        score = self.slope_of - np.einsum("mui,mi->mu", self.mixed, solved[..., -1])
        score = score - score.mean(axis=0)
        placements = len(score)
        spare = max(placements - len(columns) / 6, 1.0)
        sandwich = from_residuals @ (score.T @ score) @ from_residuals * placements / spare
        sd, from_scores = (np.sqrt(np.maximum(np.diag(m), 0.0)) for m in (from_residuals, sandwich))
        wider = np.where(sd > 0, np.maximum(from_scores / np.where(sd > 0, sd, 1.0), 1.0), 1.0)
        full[np.ix_(columns, columns)] = from_residuals * np.outer(wider, wider)
        return full


def _diagonals(matrices: Float64[np.ndarray, "many n n"]) -> Float64[np.ndarray, "many n n"]:
    return matrices * np.eye(matrices.shape[-1])


def _solved(
    matrix: Float64[np.ndarray, "n n"], right: Float64[np.ndarray, " n"]
) -> Float64[np.ndarray, " n"]:
    """Return the solution, with all unknowns in like units; the smallest if undetermined."""
    scale = 1 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    scaled = matrix * np.outer(scale, scale)
    try:
        solution = np.linalg.solve(scaled, scale * right)
    except np.linalg.LinAlgError:
        solution = np.linalg.lstsq(scaled, scale * right, rcond=None)[0]
    return scale * solution
