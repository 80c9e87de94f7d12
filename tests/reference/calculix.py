"""Reads the CalculiX reference of ../shared/reference: cells, cell matrices, results.

Their angle runs the other way (z = -r sin theta): cell k of theirs is cell N - 1 - k of ours, and
their RIGHT section is our left one. Cartesian axes are the same, so displacements are compared in
x, y, z and no sign changes.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from rings import PAPER, UNDAMPED, Ring
from scipy.sparse import coo_array, csc_array

from tyrefrf.arrays import ComplexArray, FloatArray, IntArray
from tyrefrf.fem.elements import Element, Incompatible
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.mesh.outside import Elements, OutsideMesh
from tyrefrf.mesh.section import SectionMesh

FOLDER = Path(__file__).resolve().parents[2].parent / "shared" / "reference"
N_CELLS = 45
SECTOR = 2.0 * np.pi / N_CELLS
LOADS = ("radial", "tangential", "axial")
BRICK = Incompatible(corrected=False, mass_points=2)
"""CalculiX's C3D8I with its modes condensed and massless: Taylor's factor left out, 2x2x2 mass."""

needs_reference = pytest.mark.skipif(
    not FOLDER.is_dir(), reason=f"NOT VERIFIED against CalculiX: {FOLDER} is absent"
)


def arrays(name: str) -> dict[str, FloatArray]:
    """The arrays of an .npz file."""
    with np.load(FOLDER / f"{name}.npz") as file:
        return dict(file)


def facts(name: str) -> dict:
    """The contents of a .json file."""
    return json.loads((FOLDER / f"{name}.json").read_text())


def ring(name: str, element: Element, eta: float = 0.1) -> Ring:
    """The reference's tyre on its own mesh, `A_C3D8I` for instance, with one of our elements."""
    stuff = {"rubber": PAPER.model_copy(update={"eta": eta})}  # E, nu and rho are the paper's
    return Ring(read_cell(name), stuff, element, N_CELLS, UNDAMPED)


def read_cell(name: str) -> CellMesh:
    """The one-cell mesh of an .inp file in our numbering: their RIGHT, INTERIOR, LEFT nodes."""
    cards = _cards((FOLDER / f"{name}_cell.inp").read_text())
    nodes = np.array(cards["*NODE, NSET=NALL"]).reshape(-1, 4)
    assert np.array_equal(nodes[:, 0], np.arange(1, len(nodes) + 1))
    left, right, rim, interior = (
        np.array(cards.get(f"*NSET, NSET={name}", []), dtype=np.int64) - 1
        for name in ("LEFT", "RIGHT", "RIM", "INTERIOR")
    )
    ours = np.empty(len(nodes), dtype=np.int64)  # our number of every node of theirs
    ours[np.concatenate([right, interior, left])] = np.arange(len(nodes))

    x, y, z = nodes[:, 1:].T
    points = np.empty((len(nodes), 3))
    points[ours] = np.stack([np.hypot(x, z), y, SECTOR + np.arctan2(z, x)], axis=1)

    (bricks,) = (rows for card, rows in cards.items() if card.startswith("*ELEMENT"))
    n_nodes = 20 if len(interior) else 8
    theirs = np.array(bricks, dtype=np.int64).reshape(-1, 1 + n_nodes)[:, 1:] - 1
    section, planes = _section(points, ours[theirs], ours[right], ours[left])
    mesh = CellMesh.over(section, points, ours[theirs], planes, SECTOR)
    assert set(mesh.rim) == set(ours[rim])
    return mesh


def read_outside(name: str) -> OutsideMesh:
    """The .inp file as it is, for `periodic_cell`."""
    text = (FOLDER / f"{name}_cell.inp").read_text()
    cards = _cards(text)
    nodes = np.array(cards["*NODE, NSET=NALL"]).reshape(-1, 4)
    (bricks,) = (rows for card, rows in cards.items() if card.startswith("*ELEMENT"))
    kind, n_nodes = ("hexahedron20", 20) if "C3D20" in name else ("hexahedron", 8)
    rows = np.array(bricks, dtype=np.int64).reshape(-1, 1 + n_nodes)
    innermost = np.array(cards["*ELSET, ELSET=INNERE"], dtype=np.int64)
    return OutsideMesh(
        path=f"{name}_cell.inp",
        points=nodes[:, 1:],
        numbers=nodes[:, 0].astype(np.int64),
        elements=(Elements(kind, rows[:, 1:] - 1, rows[:, 0]),),
        element_sets={"ERUBBER": rows[:, 0]},
        node_sets={
            set_name: np.array(cards[f"*NSET, NSET={set_name}"], dtype=np.int64) - 1
            for set_name in ("LEFT", "RIGHT", "RIM")
        },
        surfaces={"INNER": np.stack([innermost, np.full(len(innermost), 3)], axis=1)},
    )


def _cards(text: str) -> dict[str, list[float]]:
    """The numbers under every keyword line."""
    cards: dict[str, list[float]] = {}
    for line in text.splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            numbers = cards.setdefault(line.strip(), [])
        elif "," in line and not line.startswith("INNERE"):
            numbers += [float(word) for word in line.split(",") if word.strip()]
    return cards


def _section(
    points: FloatArray, bricks: IntArray, left: IntArray, right: IntArray
) -> tuple[SectionMesh, IntArray]:
    """The section that was revolved, and the cell's planes. Their low plane is our right one."""
    n_face = len(left)
    flat = bricks - right[0]
    planes = [left, right]
    quads = flat[:, [0, 3, 2, 1]]
    if bricks.shape[1] == 20:
        quads = np.hstack([quads, flat[:, [11, 10, 9, 8]]])
        between = np.full(n_face, -1)
        between[flat[:, :4]] = bricks[:, 16:]
        planes.insert(1, between)
    section = SectionMesh(
        points=points[left, :2],
        quads=quads,
        material=np.zeros(len(quads), dtype=np.int64),
        materials=("rubber",),
        rim=_ends(quads, points[left, 1]),
        outer=quads[:, [1, 2, 5][: 2 + (quads.shape[1] == 8)]],
        inner=quads[:, [0, 3, 7][: 2 + (quads.shape[1] == 8)]],
    )
    return section, np.array(planes)


def _ends(quads: IntArray, y: FloatArray) -> IntArray:
    """Nodes of the first and the last side across the profile: their side k and side k + 1."""
    first, last = quads[0, [0, 1]], quads[-1, [2, 3]]
    if quads.shape[1] == 8:
        first, last = np.append(first, quads[0, 4]), np.append(last, quads[-1, 6])
    assert y[first].max() < 0.0 < y[last].min()
    return np.concatenate([first, last])


def cartesian_nodes(tyre: Ring) -> IntArray:
    """Our ring's node for every ring node of theirs."""
    mesh = tyre.mesh
    n_inner = mesh.n_own - mesh.n_face
    cells = np.arange(N_CELLS)[:, None]
    faces = (-cells % N_CELLS) * mesh.n_own + np.arange(mesh.n_face)
    inner = (N_CELLS - 1 - cells) * mesh.n_own + mesh.n_face + np.arange(n_inner)
    return np.hstack([faces, inner]).ravel()


def their_loads(tyre: Ring, node: int) -> csc_array:
    """Unit radial, tangential and axial force at a node of section 0; their +theta is our -."""
    row = 3 * int(cartesian_nodes(tyre)[node])
    return tyre.columns({row: 1.0}, {row + 2: -1.0}, {row + 1: 1.0})


def cartesian(tyre: Ring, q: ComplexArray) -> ComplexArray:
    """Our field (n_cells, n_own, n_loads) as theirs: (load, ring node, xyz)."""
    n_loads = q.shape[-1]
    u = tyre.to_cartesian @ q.reshape(-1, n_loads)
    return u.reshape(-1, 3, n_loads)[cartesian_nodes(tyre)].transpose(2, 0, 1)


def node_error(u: ComplexArray, expected: ComplexArray) -> FloatArray:
    """Norm of the difference of a node's displacement, relative to that displacement's norm."""
    return np.linalg.norm(u - expected, axis=-1) / np.linalg.norm(expected, axis=-1)


def condensed_cell(name: str) -> tuple[FloatArray, FloatArray, IntArray]:
    """K with the incompatible modes condensed, M of the nodes, and their dofs (node, direction)."""
    K, M, dofs, n_nodes = cell_matrices(name)
    u, m = np.flatnonzero(dofs[:, 0] < n_nodes), np.flatnonzero(dofs[:, 0] >= n_nodes)
    K, M = K.toarray(), M.toarray()
    K_um = K[np.ix_(u, m)]
    K_c = K[np.ix_(u, u)] - K_um @ np.linalg.solve(K[np.ix_(m, m)], K_um.T)
    return K_c, M[np.ix_(u, u)], dofs[u]


def cell_matrices(name: str) -> tuple[csc_array, csc_array, IntArray, int]:
    """K and M of one cell (Cartesian), their dofs (node, direction) 0-based, and the node count."""
    z = arrays(f"{name}_cellmat")
    n = int(z["n"])
    full = []
    for letter in "KM":
        upper = coo_array(
            (z[f"{letter}_val"], (z[f"{letter}_row"], z[f"{letter}_col"])), shape=(n, n)
        )
        diagonal = upper.row == upper.col
        assert np.all(upper.row <= upper.col)
        strict = coo_array(
            (upper.data[~diagonal], (upper.col[~diagonal], upper.row[~diagonal])), shape=(n, n)
        )
        full.append(csc_array(upper + strict))
    return full[0], full[1], z["dof"] - 1, int(z["nodes"])
