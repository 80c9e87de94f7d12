"""Matrices and lists of rows in other programs' formats: what is read, and what is refused."""

import gzip
import re

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import csr_array, save_npz

from tyrefrf.errors import MeshError
from tyrefrf.fem.matrix_files import read_dofs, read_matrix

A = np.array([[4.0, -1.0, 0.0], [-1.0, 5.0, -2.5], [0.0, -2.5, 6.0]])
UPPER = "1 1  4.0000000000000e+00\n1 2 -1.0\n2 2  5.0\n1 3  0.0\n2 3 -2.5\n3 3 6\n"
LOWER = "1, 1, 4.0\n2, 1, -1.0\n2, 2, 5.0\n3, 2, -2.5\n3, 3, 6.0\n"
MARKET = "%%MatrixMarket matrix coordinate real "
SYMMETRIC = MARKET + "symmetric\n3 3 5\n1 1 4\n2 1 -1\n2 2 5\n3 2 -2.5\n3 3 6\n"
FULL = MARKET + "general\n3 3 7\n1 1 4\n1 2 -1\n2 1 -1\n2 2 5\n2 3 -2.5\n3 2 -2.5\n3 3 6\n"
TRIANGLE = MARKET + "general\n3 3 5\n1 1 4\n1 2 -1\n2 2 5\n2 3 -2.5\n3 3 6\n"


@pytest.mark.parametrize(
    ("name", "text", "triangle"),
    [
        ("K.sti", UPPER, "upper"),
        ("abaqus.mtx.txt", "** from a step\n" + LOWER, "lower"),
        ("K.mtx", SYMMETRIC, ""),
        ("K.mtx", FULL, ""),
        ("K.mtx", TRIANGLE, "upper"),
        ("K.txt", SYMMETRIC, ""),
    ],
)
def test_texts_are_read_as_the_matrix_they_mean(name, text, triangle, tmp_path):
    (tmp_path / name).write_text(text)
    found = read_matrix(tmp_path / name)
    np.testing.assert_array_equal(found.matrix.toarray(), A)
    assert found.triangle == triangle


@pytest.mark.parametrize("kind", ["csr", "csc", "coo", "bsr", "dia"])
def test_scipys_own_file_in_every_form(kind, tmp_path):
    save_npz(tmp_path / "K.npz", csr_array(A).asformat(kind))
    np.testing.assert_array_equal(read_matrix(tmp_path / "K.npz").matrix.toarray(), A)


def test_rounding_in_the_symmetry_is_halved_and_said(tmp_path):
    skew = A.copy()
    skew[0, 1] += 6e-10
    mmwrite(tmp_path / "K.mtx", csr_array(skew))
    found = read_matrix(tmp_path / "K.mtx")
    assert found.asymmetry == pytest.approx(1e-10, rel=1e-5)
    assert found.matrix[0, 1] == found.matrix[1, 0] == pytest.approx(-1.0 + 3e-10, abs=1e-15)


COMPLEX = "%%MatrixMarket matrix coordinate complex symmetric\n1 1 1\n1 1 4 0.1\n"


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("K.sti", UPPER.replace("1 2 -1.0", "1 2 -1.x"), r"K\.sti:2: '-1\.x' is not a number"),
        ("K.sti", UPPER.replace("6\n", "nan\n"), "K.sti:6: nan is not a fin"),
        ("K.sti", LOWER.replace("2, 2, 5.0", "2, 5.0"), "K.sti:3: 2 entries; expected row, col"),
        ("K.sti", UPPER[:40], "ends within a line; it seems to have been cut"),
        ("K.sti", LOWER.replace("3, 2", "0, 2"), "row 0, column 2; rows and columns are whole"),
        ("K.sti", LOWER.replace("3, 2", "3.5, 2"), r"row 3\.5, column 2"),
        ("K.sti", LOWER.replace("3, 2", "3e15, 2"), "row 3e"),
        ("K.sti", "", "K.sti: holds no entries"),
        ("K.sti", "1 2 1.0\n2 1 3.0\n", r"not symmetric: \|A - A\^T\| is 6\.7e-01 .* row 1, col"),
        ("K.mtx", SYMMETRIC.replace("3 3 6\n", ""), "K.mtx: is not a Matrix Market file: .*Trunc"),
        ("K.mtx", SYMMETRIC.replace("3 2 -2", "4 2 -2"), "Market file: Line 6: Row index out of b"),
        ("K.mtx", SYMMETRIC.replace("3 2 -2.5", "3 2 two"), "Market file: Line 6: Invalid"),
        ("K.mtx", COMPLEX, "complex numbers; bring the real matrix, and the loss .* as eta"),
        ("K.mtx", "1 1 4\n", "is not a Matrix Market file"),
        (
            "K.mtx",
            MARKET + "general\n2 3 1\n1 1 4\n",
            "has 2 rows and 3 columns; expected",
        ),
        ("K.mtx", MARKET + "general\n1 1 1\n1 1 inf\n", "NaN or infinite"),
        ("K.mtx", FULL.replace("1 2 -1\n", "1  1.5\n"), "Market file: Line 4: Invalid; expected 3"),
        ("K.mtx", FULL + "3 3 6\n", "Market file: Truncated, or too long: 8 .* expected 7"),
        ("K.mtx", FULL.replace("3 3 7", "3 x 7"), "is not a Matrix Market file"),
        ("K.mtx", FULL.replace("3 3 7", "99999999 3 7"), "Line 2: .* does not say how large"),
        ("K.mtx", FULL.replace("real", "pattern"), "coordinate pattern is not read"),
        ("K.mtx", FULL.replace("general", "odd"), "'odd' is no symmetry"),
        ("K.mtx", FULL.replace("2 2 5", "2 2.5 5"), "Line 6: Column index out of bounds"),
        ("K.npz", "PK", "is not a sparse matrix of scipy .*; write it with scipy.sparse.save_npz"),
    ],
)
def test_what_is_no_matrix_is_refused_with_its_line(name, text, message, tmp_path):
    (tmp_path / name).write_text(text)
    with pytest.raises(MeshError, match=message):
        read_matrix(tmp_path / name)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(MeshError, match=re.escape(f"{tmp_path}/K.mtx: cannot be read: no such")):
        read_matrix(tmp_path / "K.mtx")


def test_pickles_and_other_archives_are_not_loaded(tmp_path):
    """An object array would run code as it is loaded."""
    np.savez(tmp_path / "K.npz", data=np.array([{}], dtype=object), format=b"csr", shape=(1, 1))
    with pytest.raises(MeshError, match="not a sparse matrix of scipy"):
        read_matrix(tmp_path / "K.npz")
    np.savez(tmp_path / "M.npz", K_row=[0], K_col=[0], K_val=[1.0])
    with pytest.raises(MeshError, match="not a sparse matrix of scipy"):
        read_matrix(tmp_path / "M.npz")


DOFS = [[7, 0], [7, 1], [7, 2], [12, 0], [12, 5]]


@pytest.mark.parametrize(
    "text",
    [
        "7.1\n7.2\n7.3\n12.1\n12.6\n",
        "node direction\n7 1\n7 2\n7 3\n12 1\n12 6\n",
        "7,x\n7,y\n7,z\n12,UX\n12,ROTZ\n",
        "7;r\n7;y\n7;theta\n12;r\n12;6\n",
        "Matrix Eqn  Node  Dof\n 1  7  UX\n 2  7 UY\n 5 12 ROTZ\n 3  7 UZ\n 4  12  UX\n",
    ],
)
def test_rows_by_node_and_direction_in_every_form(text, tmp_path):
    (tmp_path / "cell.dof").write_text(text)
    np.testing.assert_array_equal(read_dofs(tmp_path / "cell.dof"), DOFS)


@pytest.mark.parametrize(
    ("word", "direction"),
    [
        *[("1", 0), ("2", 1), ("3", 2), ("4", 3), ("5", 4), ("6", 5), ("0", 3)],
        *[("x", 0), ("Y", 1), ("z", 2), ("UX", 0), ("uy", 1), ("Uz", 2)],
        *[("r", 0), ("Theta", 2), ("UR", 0), ("utheta", 2)],
        *[("ROTX", 3), ("roty", 4), ("RotZ", 5)],
    ],
)
def test_every_name_of_a_direction(word, direction, tmp_path):
    (tmp_path / "cell.dof").write_text(f"7 {word}\n")
    np.testing.assert_array_equal(read_dofs(tmp_path / "cell.dof"), [[7, direction]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("7.1\n7.2\n7.2\n", "node 7 has direction 2 in two rows"),
        ("7.1\n7.w\n", "cell.dof:2: 'w' is not a direction; expected 1, 2, 3 or x, y, z"),
        ("7.1\nseven.2\n", "cell.dof:2: is not node.direction"),
        ("1 7 1\n1 7 2\n", "cell.dof:2: row 1 is there twice"),
        ("1 7 1\n3 7 2\n", "rows 1 to 3 should be there, but only 2 are"),
        ("1 7 1 4\n", "cell.dof:1: is not node.direction"),
        ("# nothing\n", "holds no rows"),
    ],
)
def test_what_is_no_list_of_rows_is_refused(text, message, tmp_path):
    (tmp_path / "cell.dof").write_text(text)
    with pytest.raises(MeshError, match=message):
        read_dofs(tmp_path / "cell.dof")


@pytest.mark.parametrize("packed", ["", ".gz"])
@pytest.mark.parametrize("symmetry", ["general", "symmetric"])
@pytest.mark.parametrize("dense", [False, True], ids=["coordinate", "array"])
def test_what_scipy_writes_comes_back(dense, symmetry, packed, tmp_path):
    rng = np.random.default_rng(0)
    A = rng.normal(size=(7, 7)) * (rng.random((7, 7)) < 0.5)
    A += A.T
    opened = gzip.open if packed else open
    with opened(tmp_path / f"K.mtx{packed}", "wb") as file:
        mmwrite(file, A if dense else csr_array(A), symmetry=symmetry, precision=17)
    found = read_matrix(tmp_path / f"K.mtx{packed}")
    np.testing.assert_array_equal(found.matrix.toarray(), A)
