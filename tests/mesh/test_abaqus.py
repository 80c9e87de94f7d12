"""The .inp format, card by card, and what is wrong with a deck, with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from reference.calculix import FOLDER, needs_reference

from tyrefrf.errors import MeshError
from tyrefrf.mesh.abaqus import read_inp

DECK = """\
*HEADING
a square of two elements
*NODE, NSET=ALL
1, 0.1, 0.0
2, 0.2, 0.0
3, 0.3, 0.
** a comment
4, 1.D-1, 1.E-1
5, 0.2, 0.1, 0.0
6, 0.3, 0.1
*ELEMENT, TYPE=CAX4RH,
ELSET=left
10, 1, 2, 5, 4
*Element, type=CAX4, elset=RIGHT
20, 2, 3, 6, 5
*NSET, NSET=bottom, GENERATE
1, 3
*NSET, NSET=BOTTOM
6,
*NSET, NSET=SUM
bottom, 4
*ELSET, ELSET=BOTH
LEFT, 20
*NSET, NSET=FROM, ELSET=RIGHT
*SURFACE, NAME=IN
LEFT, S1
20, S3
*SURFACE, NAME=FREE
BOTH,
*SURFACE, NAME=NODES, TYPE=NODE
BOTTOM,
*SURFACE, NAME=SHELL
LEFT, SPOS
*MATERIAL, NAME=X
*ELASTIC
1.0, 0.3
"""


def deck(tmp_path, text=DECK) -> Path:
    path = tmp_path / "deck.inp"
    path.write_text(text)
    return path


def test_every_card_is_read(tmp_path):
    mesh = read_inp(deck(tmp_path))
    assert mesh.points[3].tolist() == [0.1, 0.1, 0.0]
    (block,) = mesh.elements
    assert (block.kind, block.numbers.tolist()) == ("quad", [10, 20])
    assert mesh.numbers[block.nodes].tolist() == [[1, 2, 5, 4], [2, 3, 6, 5]]
    sets = {name: mesh.numbers[places].tolist() for name, places in mesh.node_sets.items()}
    assert sets == {
        "ALL": [1, 2, 3, 4, 5, 6],
        "bottom": [1, 2, 3, 6],
        "SUM": [1, 2, 3, 4, 6],
        "FROM": [2, 3, 5, 6],
        "NODES": [1, 2, 3, 6],
    }
    assert {name: found.tolist() for name, found in mesh.element_sets.items()} == {
        "left": [10],
        "RIGHT": [20],
        "BOTH": [10, 20],
    }
    assert {name: faces.tolist() for name, faces in mesh.surfaces.items()} == {
        "IN": [[10, 1], [20, 3]],
        "FREE": [[10, 0], [20, 0]],
    }


def test_files_may_be_included(tmp_path):
    head, tail = DECK.split("*ELEMENT, TYPE=CAX4RH", 1)
    (tmp_path / "nodes.inp").write_text(head)
    whole = read_inp(deck(tmp_path))
    parts = read_inp(deck(tmp_path, f"*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=CAX4RH{tail}"))
    assert np.array_equal(whole.points, parts.points)
    with pytest.raises(MeshError, match=r"deck.inp:1: \*INCLUDE: .*gone.inp: cannot be read"):
        read_inp(deck(tmp_path, "*INCLUDE, INPUT=gone.inp\n"))
    with pytest.raises(MeshError, match="includes itself"):
        read_inp(deck(tmp_path, "*INCLUDE, INPUT=deck.inp\n"))


def test_one_part_with_one_instance_is_a_flat_mesh(tmp_path):
    flat = read_inp(deck(tmp_path))
    nodes, rest = DECK.split("*MATERIAL", 1)
    text = f"*PART, NAME=P\n{nodes}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=P\n"
    text += "*END INSTANCE\n*NSET, NSET=TOP, INSTANCE=P-1\n4, 5\n*NSET, NSET=DOT\nP-1.6\n"
    mesh = read_inp(deck(tmp_path, f"{text}*END ASSEMBLY\n*MATERIAL{rest}"))
    assert np.array_equal(mesh.points, flat.points)
    assert mesh.numbers[mesh.node_sets["TOP"]].tolist() == [4, 5]
    assert mesh.numbers[mesh.node_sets["DOT"]].tolist() == [6]


def test_long_elements_go_on_after_a_comma(tmp_path):
    nodes = "".join(f"{n}, {n}.0, {n * n}.0\n" for n in range(1, 9))
    text = f"*NODE\n{nodes}*ELEMENT, TYPE=CAX8\n5, 1, 2, 3, 4,\n5, 6, 7, 8\n"
    (block,) = read_inp(deck(tmp_path, text)).elements
    assert (block.kind, block.nodes.tolist()) == ("quad8", [[0, 1, 2, 3, 4, 5, 6, 7]])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("10, 1, 2, 5, 4", "10, 1, 2, 5", "13: element 10 has 3 nodes; quad has 4"),
        ("10, 1, 2, 5, 4", "10, 1, 2, , 4", "13: element 10 has 3 nodes; quad has 4"),
        ("TYPE=CAX4RH", "TYPE=CAX8R", "13: element 10 has 4 nodes; quad8 has 8"),
        ("10, 1, 2, 5, 4", "10, 1, 2, 5, 9", "13: element 10 has node 9, which the file does not"),
        ("20, 2, 3, 6, 5", "10, 2, 3, 6, 5", "15: element 10 is there already, at .*deck.inp:13"),
        ("6, 0.3, 0.1", "5, 0.3, 0.1", "10: node 5 is there twice, at different places"),
        ("6, 0.3, 0.1", "6, 0.3, 0.l", "10: '0.l' is not a number"),
        ("6, 0.3, 0.1", "6, 0.3, nan", "10: 'nan' is not a finite number"),
        ("6, 0.3, 0.1", "6.5, 0.3", "10: '6.5' is not a whole number"),
        ("bottom, 4", "botom, 4", "21: 'botom' is neither a number nor a set above"),
        ("bottom, 4", "bottom, 44", "node set 'SUM' has node 44, which the file does not define"),
        ("LEFT, 20", "LEFT, 21", "element set 'BOTH' has element 21, which the file does not"),
        ("1, 3\n", "1, 3, 0\n", "17: GENERATE needs first, last and step"),
        ("*HEADING\n", "*NGEN\n", r"1: \*NGEN makes or moves nodes"),
        ("*NODE, NSET=ALL", "*NODE, SYSTEM=C", "3: nodes in cylindrical"),
        ("*HEADING\n", "*PART, NAME=P\n*END PART\n*PART, NAME=Q\n", "3: a second part or instance"),
        ("*HEADING\n", "*INSTANCE, NAME=I\n0., 1., 0.\n*HEADING\n", "2: an instance that is moved"),
        ("*HEADING\n", "", ":1: data before the first keyword"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(tmp_path, old, new, words):
    assert old in DECK
    with pytest.raises(MeshError, match=f"deck.inp:? ?{words}|{words}"):
        read_inp(deck(tmp_path, DECK.replace(old, new, 1)))


@pytest.mark.parametrize("text", ["", "** nothing\n", "*NODE\n", "*NODE\n1, 0., 0.\n"])
def test_a_file_without_a_mesh_is_refused(tmp_path, text):
    with pytest.raises(MeshError, match="holds no"):
        read_inp(deck(tmp_path, text))


def test_a_truncated_file_is_refused_wherever_an_element_is_cut(tmp_path):
    start, end = DECK.index("10, 1, 2"), DECK.index("*Element")
    for length in range(start + 4, end - 3):
        with pytest.raises(MeshError):
            read_inp(deck(tmp_path, DECK[:length]))


def test_an_unknown_element_keeps_its_name(tmp_path):
    mesh = read_inp(deck(tmp_path, DECK.replace("TYPE=CAX4RH", "TYPE=SFMGAX1")))
    assert [(block.kind, block.numbers.tolist()) for block in mesh.elements] == [
        ("SFMGAX1", [10]),
        ("quad", [20]),
    ]


@needs_reference
@pytest.mark.parametrize(
    ("name", "kind"), [("A_C3D8I", "hexahedron"), ("A_C3D20-curved", "hexahedron20")]
)
def test_calculix_decks_are_read_as_they_are(name, kind):
    mesh = read_inp(FOLDER / f"{name}_cell.inp")
    (block,) = mesh.elements
    assert (block.kind, len(block.numbers)) == (kind, 28)
    assert len(mesh.node_sets["LEFT"]) == len(mesh.node_sets["RIGHT"])
    assert mesh.surfaces["INNER"].tolist() == [[number, 3] for number in range(1, 29)]
