"""Nodes and sets of nodes in text files."""

import numpy as np
import pytest

from tyrefrf.errors import MeshError
from tyrefrf.mesh.node_files import read_node_set, read_nodes

XYZ = "# from scipy\nnumber, x, y, z\n4, 300, 20, 0\n9, 0, -10, 250.5\n"


@pytest.mark.parametrize(
    "text",
    [
        XYZ,
        XYZ.replace("number, x, y, z\n", "").replace(",", ";"),
        XYZ.replace(",", " "),
        "number r y theta\n4 300 20 0\n9 250.5 -10 90\n",
        "*NODE, NSET=NALL\n4, 300., 20., 0.\n9, 0, -10, 2.505e2\n*ELEMENT, TYPE=T3D2\n1, 4, 9\n",
    ],
)
def test_nodes_in_every_writing(text, tmp_path):
    path = tmp_path / ("nodes.inp" if text.startswith("*") else "nodes.csv")
    path.write_text(text)
    found = read_nodes(path, 1e-3, "y")
    np.testing.assert_array_equal(found.numbers, [4, 9])
    np.testing.assert_allclose(found.points, [[0.3, 0.02, 0.0], [0.0, -0.01, 0.2505]], atol=1e-16)


@pytest.mark.parametrize(
    ("axis", "row"), [("y", "0.3 0.02 0.1"), ("z", "0.1 0.3 0.02"), ("x", "0.02 0.1 0.3")]
)
def test_every_axle_becomes_y_without_mirroring(axis, row, tmp_path):
    (tmp_path / "nodes.txt").write_text(f"1 {row}\n")
    np.testing.assert_allclose(
        read_nodes(tmp_path / "nodes.txt", 1.0, axis).points, [[0.3, 0.02, 0.1]]
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (XYZ.replace("9, 0,", "4, 0,"), "nodes.csv: node 4 is there twice"),
        (XYZ.replace("9, 0,", "9,"), "nodes.csv:4: 3 entries; a node has 4"),
        (XYZ.replace("250.5", "here"), "nodes.csv:4: 'here' is not a number"),
        (XYZ.replace("250.5", "inf"), "nodes.csv:4: inf is not a finite number"),
        (XYZ.replace("9,", "9.5,"), "nodes.csv:4: 9.5 is not the number of a node"),
        (
            XYZ.replace("x, y, z", "x, z"),
            "nodes.csv:2: the heading is .*; expected number, x",
        ),
        ("# no\n", "nodes.csv: holds no nodes"),
    ],
)
def test_what_is_no_node_is_refused_with_its_line(text, message, tmp_path):
    (tmp_path / "nodes.csv").write_text(text)
    with pytest.raises(MeshError, match=message):
        read_nodes(tmp_path / "nodes.csv", 1.0, "y")


def test_a_set_is_any_numbers_to_a_line(tmp_path):
    (tmp_path / "left.txt").write_text("node\n12, 4\n7 # the last\n")
    np.testing.assert_array_equal(read_node_set(tmp_path / "left.txt"), [4, 7, 12])


@pytest.mark.parametrize(
    ("text", "message"), [("4\nx\n", "left.txt:2: 'x' is not a number"), ("", "holds no numbers")]
)
def test_what_is_no_set_is_refused(text, message, tmp_path):
    (tmp_path / "left.txt").write_text(text)
    with pytest.raises(MeshError, match=message):
        read_node_set(tmp_path / "left.txt")


def test_what_is_no_text_is_refused(tmp_path):
    (tmp_path / "left.txt").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(MeshError, match="cannot be read: it is not text"):
        read_node_set(tmp_path / "left.txt")
