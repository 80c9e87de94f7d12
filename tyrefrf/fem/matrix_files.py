"""Matrices as other programs write them: Matrix Market, scipy's .npz, CalculiX's .sti and .mas.

CalculiX writes K and M with `*FREQUENCY, SOLVER=MATRIXSTORAGE`: a line `row column value` for every
entry of the upper triangle, counted from 1, and in its .dof file a line `node.direction` for every
row. Abaqus' `*MATRIX OUTPUT, FORMAT=COORDINATE` has the same three columns.
"""

from __future__ import annotations

import gzip
import os
import warnings
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np
from scipy.sparse import coo_array, csr_array, load_npz, tril, triu

from tyrefrf.arrays import FloatArray, IntArray
from tyrefrf.errors import MeshError
from tyrefrf.mesh.node_files import finite, is_number, lines_of, wrong

SYMMETRIC = 1e-8
"""Largest |A - A^T| over the largest |A| up to which a matrix counts as symmetric: above what text
of ten digits leaves."""

MAX_ROWS = 10**7  # far beyond any cell: a number like that is a slip of the pen
MOST_DIGITS = 12

MAX_DENSE = 10**8
MIRRORED = {"general": 0.0, "symmetric": 1.0, "hermitian": 1.0, "skew-symmetric": -1.0}
"""What stands above the diagonal of a Matrix Market file, of what stands below."""

COMPLEX = (
    "holds complex numbers; bring the real matrix, and the loss of a stiffness as eta beside its "
    "file"
)

DIRECTIONS = {
    **{"1": 0, "2": 1, "3": 2, "x": 0, "y": 1, "z": 2, "ux": 0, "uy": 1, "uz": 2},
    **{"r": 0, "theta": 2, "ur": 0, "utheta": 2},
}
"""What files call the three displacements of a node."""


@dataclass(frozen=True, slots=True, eq=False)
class MatrixFile:
    """What a file of a matrix holds: made symmetric, with what was done to have it so.

    matrix: (n, n). path: its file. triangle: "upper" or "lower" if the file has only that one,
    else "". is_open: whether its file does not say how many rows it has, so that empty ones may
    follow. asymmetry: largest |A - A^T| over the largest |A| of a file with both.
    """

    matrix: csr_array
    path: Path
    triangle: str
    is_open: bool
    asymmetry: float

    @property
    def size(self) -> int:
        """Rows."""
        return int(self.matrix.shape[0])

    def of_size(self, n: int) -> csr_array:
        """The matrix with empty rows up to n."""
        return csr_array(
            (
                self.matrix.data,
                self.matrix.indices,
                np.append(self.matrix.indptr, np.full(n - self.size, self.matrix.nnz)),
            ),
            shape=(n, n),
        )


def read_matrix(path: Path) -> MatrixFile:
    """A real symmetric matrix from a .mtx, .npz or text file of row, column and value.

    Raises MeshError, with the line where there is one, for what is no such matrix.
    """
    if not path.is_file():
        raise MeshError(f"{path}: cannot be read: no such file")
    if path.suffix == ".npz":
        return _symmetric(_from_npz(path), path, is_open=False)
    with path.open("rb") as file:
        is_market = file.read(14) == b"%%MatrixMarket"
    if is_market or path.name.endswith((".mtx", ".mtx.gz")):
        return _symmetric(_from_market(path), path, is_open=False)
    return _symmetric(_from_triplets(path), path, is_open=True)


def read_dofs(path: Path) -> IntArray:
    """(n, 2) node and direction (0 to 2; 3 and more of what is no displacement) of every row.

    A line is `node.direction` or `node direction`, row after row, or `row node direction`, as in
    the .mapping file of Ansys. Raises MeshError, with the line.
    """
    found: dict[int, tuple[int, int]] = {}
    for line, words in lines_of(path):
        if not found and not is_number(words[0]):
            continue  # a heading
        if len(words) == 1:
            words = words[0].split(".")
        row, node, direction = [str(len(found) + 1)] * (3 - len(words)) + words[:3]
        if len(words) > 3 or not (_is_count(row) and _is_count(node)):
            raise wrong(path, line, "is not node.direction, node direction or row node direction")
        if int(row) in found:
            raise wrong(path, line, f"row {row} is there twice")
        found[int(row)] = int(node), _direction(path, line, direction)
    rows = sorted(found)
    if not rows:
        raise MeshError(f"{path}: holds no rows")
    if rows != list(range(1, len(rows) + 1)):
        raise MeshError(f"{path}: rows 1 to {rows[-1]} should be there, but only {len(rows)} are")
    dofs = np.array([found[row] for row in rows])
    unique, count = np.unique(dofs, axis=0, return_counts=True)
    if np.any(count > 1):
        node, direction = unique[count > 1][0]
        raise MeshError(f"{path}: node {node} has direction {direction + 1} in two rows")
    return dofs


def _is_count(word: str) -> bool:
    """Whether a word is a number of a row, a node or a direction."""
    return word.isdecimal() and len(word) <= MOST_DIGITS


def _direction(path: Path, line: int, word: str) -> int:
    """0 to 2, or 3 and more for another unknown of the node."""
    known = DIRECTIONS.get(word.lower())
    if known is not None:
        return known
    if _is_count(word):
        return int(word) - 1 if int(word) > 3 else 3
    if word.lower() in ("rotx", "roty", "rotz"):
        return 3 + "xyz".index(word[-1].lower())
    raise wrong(path, line, f"{word[:40]!r} is not a direction; expected 1, 2, 3 or x, y, z")


def _from_npz(path: Path) -> csr_array:
    """As `scipy.sparse.save_npz` writes it; pickles are not loaded."""
    try:
        return csr_array(load_npz(path))
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise MeshError(
            f"{path}: is not a sparse matrix of scipy ({error}); write it with "
            "scipy.sparse.save_npz, or as Matrix Market with scipy.io.mmwrite"
        ) from None


def _from_market(path: Path) -> csr_array:
    """A matrix in the Matrix Market exchange format, real and not only a pattern.

    Not by scipy's reader: version 1.17 takes `1  1.5`, where a column is missing, for the entry
    0.5 of row and column 1, and crashes on other damaged files.
    Source: Boisvert, Pozo and Remington, The Matrix Market exchange formats, NISTIR 5935 (1996).
    """
    try:
        with gzip.open(path, "rt") if path.suffix == ".gz" else path.open() as file:
            return _market(file)
    except (OSError, EOFError, ValueError) as error:
        raise MeshError(f"{path}: is not a Matrix Market file: {error}") from None


def _market(file: IO[str]) -> csr_array:
    """The matrix of an open file. Raises ValueError with what is wrong, and its line."""
    banner, n_lines = file.readline().lower().split(), 1
    if len(banner) != 5 or banner[:2] != ["%%matrixmarket", "matrix"]:
        raise ValueError("it does not begin with %%MatrixMarket matrix ...")
    form, field, symmetry = banner[2:]
    if field == "complex":
        raise ValueError(COMPLEX)
    if field not in ("real", "double", "integer") or form not in ("coordinate", "array"):
        raise ValueError(f"{form} {field} is not read; write coordinate real")
    if symmetry not in MIRRORED:
        raise ValueError(f"{symmetry[:40]!r} is no symmetry")
    line, n_lines = file.readline(), n_lines + 1
    while line.startswith("%") or line.isspace():
        line, n_lines = file.readline(), n_lines + 1
    sizes = [int(word) for word in line.split()]
    if len(sizes) != (3 if form == "coordinate" else 2) or not 0 < max(sizes[:2]) <= MAX_ROWS:
        raise ValueError(f"Line {n_lines}: {line.strip()[:40]!r} does not say how large it is")
    if form == "coordinate":
        A = _of_entries(_numbers(file, 3, sizes[2], n_lines), sizes, n_lines)
    else:
        A = _of_columns(file, sizes, symmetry, n_lines)
    return csr_array(A + MIRRORED[symmetry] * tril(A, -1).T) if MIRRORED[symmetry] else A


def _numbers(file: IO[str], width: int, count: int, n_lines: int) -> FloatArray:
    """(count, width) the rest of a file, behind so many lines. Raises ValueError as `_market`."""
    begin = file.tell()
    try:
        with warnings.catch_warnings(action="error"):  # of a file without numbers
            found: FloatArray = np.loadtxt(file, ndmin=2, comments="%")
    except (ValueError, UserWarning):
        found = np.empty((0, 0))  # the line is said below
    if found.shape == (count, width):
        return found
    file.seek(begin)
    there = 0
    for number, line in enumerate(file, start=n_lines + 1):
        words = line.partition("%")[0].split()
        if words and (len(words) != width or not all(map(is_number, words))):
            raise ValueError(f"Line {number}: Invalid; expected {width} number(s)")
        there += bool(words)
    if there == count == 0:
        return np.empty((0, width))
    raise ValueError(f"Truncated, or too long: {there} lines of numbers; expected {count}")


def _of_entries(body: FloatArray, sizes: Sequence[int], n_lines: int) -> csr_array:
    """From rows, columns and values."""
    places = body[:, :2].astype(np.int64)
    whole = (places == body[:, :2]) & (places >= 1) & (places <= sizes[:2])
    if not whole.all():
        entry = int(np.argmin(whole.all(axis=1)))
        which = "Column" if whole[entry, 0] else "Row"
        raise ValueError(f"Line {n_lines + 1 + entry}: {which} index out of bounds")
    row, column = (places - 1).T
    return csr_array(coo_array((body[:, 2], (row, column)), shape=tuple(sizes[:2])))


def _of_columns(file: IO[str], sizes: Sequence[int], symmetry: str, n_lines: int) -> csr_array:
    """From all values, column by column; of a symmetric matrix those from the diagonal down."""
    rows, columns = sizes
    if rows * columns > MAX_DENSE:
        raise ValueError(f"{rows} x {columns} numbers are too many; write coordinate real")
    row, column = np.indices((columns, rows))[::-1]
    above = {"general": -rows, "skew-symmetric": 1}.get(symmetry, 0)
    here = row - column >= above
    A = np.zeros((columns, rows))
    A[here] = _numbers(file, 1, int(here.sum()), n_lines)[:, 0]
    return csr_array(A.T)


def _from_triplets(path: Path) -> csr_array:
    """A text of row, column and value; rows and columns counted from 1."""
    try:
        with warnings.catch_warnings(action="error"):  # of a file without numbers
            table: FloatArray = np.loadtxt(path, ndmin=2, comments=("#", "*"))
    except (OSError, ValueError, UserWarning):
        table = _slowly(path)  # says which line is wrong
    if table.shape[1] != 3 or not np.all(np.isfinite(table)):
        table = _slowly(path)
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        if file.read(1) not in b"\r\n":
            raise MeshError(f"{path}: ends within a line; it seems to have been cut off")
    places = table[:, :2].astype(np.int64)
    bad = np.any((places < 1) | (places > MAX_ROWS) | (places != table[:, :2]), axis=1)
    if bad.any():
        row, column = table[bad][0, :2]
        raise MeshError(
            f"{path}: an entry is in row {row:.10g}, column {column:.10g}; rows and columns are "
            f"whole numbers from 1 to {MAX_ROWS}"
        )
    n = int(places.max())
    row, column = (places - 1).T
    return csr_array(coo_array((table[:, 2], (row, column)), shape=(n, n)))


def _slowly(path: Path) -> FloatArray:
    """The same line by line. Raises MeshError at the first that is wrong."""
    rows = []
    for line, words in lines_of(path):
        if words[0].startswith("*"):
            continue
        if len(words) != 3:
            raise wrong(path, line, f"{len(words)} entries; expected row, column and value")
        rows.append([finite(path, line, word) for word in words])
    if not rows:
        raise MeshError(f"{path}: holds no entries")
    return np.array(rows)


def _symmetric(A: csr_array, path: Path, *, is_open: bool) -> MatrixFile:
    """The matrix made whole of its triangle, or rid of the rounding in its symmetry."""
    if A.shape[0] != A.shape[1]:
        raise MeshError(
            f"{path}: has {A.shape[0]} rows and {A.shape[1]} columns; expected a square"
        )
    if np.iscomplexobj(A.data):
        raise MeshError(f"{path}: {COMPLEX}")
    A = csr_array(A.astype(np.float64))
    A.sum_duplicates()
    A.eliminate_zeros()
    if not np.all(np.isfinite(A.data)):
        raise MeshError(f"{path}: holds NaN or infinite entries")
    above, below = triu(A, 1), tril(A, -1)
    if bool(above.nnz) != bool(below.nnz):
        whole = csr_array(A + (above + below).T)
        return MatrixFile(whole, path, "upper" if above.nnz else "lower", is_open, 0.0)
    difference = abs(A - A.T)
    asymmetry = float(difference.max() / abs(A).max()) if difference.nnz else 0.0
    if asymmetry > SYMMETRIC:
        i, j = (int(k) for k in np.unravel_index(difference.argmax(), difference.shape))
        raise MeshError(
            f"{path}: is not symmetric: |A - A^T| is {asymmetry:.1e} of the largest entry, at row "
            f"{i + 1}, column {j + 1}; at most {SYMMETRIC:g} is rounding"
        )
    return MatrixFile(csr_array((A + A.T) / 2.0), path, "", is_open, asymmetry)
