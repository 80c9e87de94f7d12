"""MKL PARDISO, complex symmetric, by ctypes: pypardiso takes real matrices only.

The library is the `mkl` wheel's, or one on the loader's path. Source: Intel oneMKL developer
reference for C, "oneMKL PARDISO - Parallel Direct Sparse Solver Interface"; iparm counts from 0.
"""

from __future__ import annotations

import ctypes
import os
import re
import weakref
from collections.abc import Mapping
from ctypes.util import find_library
from functools import cache
from importlib import metadata
from itertools import chain

import numpy as np

from tyrefrf.arrays import ComplexArray, IntArray
from tyrefrf.errors import SingularError, SolveError

COMPLEX_SYMMETRIC = 6
ANALYSE, FACTORISE, SOLVE, RELEASE_FACTOR, RELEASE_ALL = 11, 22, 33, 0, -1

DIAGONAL = {
    0: 1,  # none of MKL's defaults: what is not here is 0
    1: 2,  # nested dissection by METIS
    9: 8,  # a pivot below 1e-8 ||A|| is perturbed, and the solution then refined twice
    20: 1,  # pivots 1x1 and 2x2 (Bunch and Kaufman) within a supernode
    34: 1,  # indices count from 0
}
"""iparm for damped tyres: the analysis looks at the pattern alone and serves every line."""

MATCHED = DIAGONAL | {7: 10, 9: 5, 10: 1, 12: 1}
"""iparm where diagonal pivots fail: matched and scaled by the line's own values, the smallest
pivots perturbed, and up to ten steps of refinement to make up for it."""

ERRORS = {
    -1: "inconsistent input",
    -2: "not enough memory",
    -3: "reordering failed",
    -4: "zero pivot",
    -7: "singular diagonal",
    -8: "too large for 32-bit integers",
}


class Pardiso:
    """Factorisations of complex symmetric matrices of one pattern.

    indptr, indices: the upper triangle by rows, with all of the diagonal.
    iparm: `DIAGONAL` or `MATCHED`; entries: the values that `MATCHED` analyses.
    factor_entries: how many L will have; memory: what analysis, factorisation and solution take
    at most [bytes]: both as the analysis foretells them.
    """

    def __init__(
        self,
        indptr: IntArray,
        indices: IntArray,
        iparm: Mapping[int, int] = DIAGONAL,
        entries: ComplexArray | None = None,
    ) -> None:
        self._indptr = np.ascontiguousarray(indptr, np.int64)
        self._indices = np.ascontiguousarray(indices, np.int64)
        self._handle = np.zeros(64, np.int64)
        self._iparm = np.zeros(64, np.int64)
        self._iparm[list(iparm)] = list(iparm.values())
        self._iparm[17] = -1  # count the entries of L
        weakref.finalize(self, _call, self._handle, RELEASE_ALL, self._iparm.copy())
        self._call(ANALYSE, np.ones(len(indices), complex) if entries is None else entries)
        peak, kept, factor = (1024 * int(self._iparm[k]) for k in (14, 15, 16))
        self.factor_entries, self.memory = int(self._iparm[17]), max(peak, kept + factor)

    def solve(self, entries: ComplexArray, f: ComplexArray) -> ComplexArray:
        """A^-1 f (n, m) for the matrix with these entries of its upper triangle.

        Raises SingularError where a pivot is zero. Where digits were lost on the way, which
        PARDISO does not notice, the residual tells.
        """
        b = np.asfortranarray(f, complex)
        x = np.empty_like(b)
        self._call(FACTORISE, entries)
        self._call(SOLVE, entries, b, x)
        return x

    def release_factor(self) -> None:
        """Give back the memory of L until the next line; the analysis stays."""
        self._call(RELEASE_FACTOR)

    def _call(
        self,
        phase: int,
        entries: ComplexArray | None = None,
        b: ComplexArray | None = None,
        x: ComplexArray | None = None,
    ) -> None:
        _call(self._handle, phase, self._iparm, self._indptr, self._indices, entries, b, x)


def _call(
    handle: IntArray,
    phase: int,
    iparm: IntArray,
    indptr: IntArray | None = None,
    indices: IntArray | None = None,
    entries: ComplexArray | None = None,
    b: ComplexArray | None = None,
    x: ComplexArray | None = None,
) -> None:
    """One phase of pardiso_64, whose integers have 64 bits in every MKL."""
    n = 0 if indptr is None else len(indptr) - 1
    n_columns = 0 if b is None else b.shape[1]
    one, mtype, phases, size, columns, quiet, error = (
        ctypes.c_longlong(k) for k in (1, COMPLEX_SYMMETRIC, phase, n, n_columns, 0, 0)
    )
    library().pardiso_64(
        _array(handle),
        *(ctypes.byref(k) for k in (one, one, mtype, phases, size)),
        *(_array(a) for a in (entries, indptr, indices, None)),
        ctypes.byref(columns),
        _array(iparm),
        ctypes.byref(quiet),
        *(_array(a) for a in (b, x)),
        ctypes.byref(error),
    )
    if error.value in (-4, -7):
        raise SingularError(f"PARDISO: {ERRORS[error.value]}")
    if error.value:
        raise SolveError(f"PARDISO: {ERRORS.get(error.value, 'failed')} (error {error.value})")


def _array(a: IntArray | ComplexArray | None) -> ctypes.c_void_p | None:
    return None if a is None else a.ctypes.data_as(ctypes.c_void_p)


def installed() -> bool:
    """Whether MKL can be loaded here."""
    try:
        library()
    except OSError:
        return False
    return True


@cache
def library() -> ctypes.CDLL:
    """MKL's single dynamic library, set up once. Raises OSError where there is none.

    One thread unless MKL_NUM_THREADS says otherwise: lines run beside one another.
    """
    mkl = ctypes.CDLL(_path())
    if os.environ.get("MKL_NUM_THREADS", "1") == "1":
        mkl.MKL_Set_Threading_Layer(1)  # sequential: no OpenMP
    mkl.MKL_CBWR_Set(2)  # the same code path on every call: results do not depend on the jobs
    return mkl


def _path() -> str:
    """Where MKL is: among the wheel's files, or on the loader's path."""
    try:
        files = metadata.files("mkl") or []
    except metadata.PackageNotFoundError:
        files = []
    wheel = (str(file.locate()) for file in files if re.match(r"(lib)?mkl_rt\.", file.name))
    path = next(chain(wheel, filter(None, [find_library("mkl_rt")])), None)
    if path is None:
        message = "no MKL"
        raise OSError(message)
    return path
