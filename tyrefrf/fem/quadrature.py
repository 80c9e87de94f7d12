"""Gauss-Legendre points on the reference line, square and cube [-1, 1]^d."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np

from tyrefrf.arrays import FloatArray, frozen


@cache
def gauss(n: int, n_dims: int) -> tuple[FloatArray, FloatArray]:
    """Points (n^d, d) and weights (n^d,) of the n-point product rule; read-only."""
    x, w = np.polynomial.legendre.leggauss(n)
    points = np.array(list(product(x, repeat=n_dims)))
    weights = np.prod(list(product(w, repeat=n_dims)), axis=1)
    frozen(points)
    frozen(weights)
    return points, weights
