"""Cylindrical axes at the nodes: [6]-[13] of the paper."""

from __future__ import annotations

import numpy as np

from tyrefrf.arrays import FloatArray


def axes(theta: FloatArray) -> FloatArray:
    """Rows e_r, e_y, e_theta (..., 3, 3) in Cartesian components: [6]. theta: (...) [rad]."""
    c, s, o = np.cos(theta), np.sin(theta), np.zeros_like(theta)
    rows = [[c, o, s], [o, o + 1.0, o], [-s, o, c]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rotations(theta: FloatArray) -> FloatArray:
    """Block-diagonal T (e, 3a, 3a) with [6] at every node: q^P = T q^C, [7] and [11].

    theta: (e, a) angles of the nodes [rad].
    """
    n_elements, n_nodes = theta.shape
    T = np.zeros((n_elements, n_nodes, 3, n_nodes, 3))
    a = np.arange(n_nodes)
    T[:, a, :, a, :] = axes(theta).transpose(1, 0, 2, 3)
    return T.reshape(n_elements, 3 * n_nodes, 3 * n_nodes)


def turned(T: FloatArray, A_C: FloatArray) -> FloatArray:
    """A_P = T A_C T^-1 with T^-1 = T^T, [12] and [13]."""
    return T @ A_C @ T.transpose(0, 2, 1)
