"""A ring's own cell written as another program would: files of matrices, nodes and sets.

Nothing here comes from the readers: numbering, directions, units and axes are undone by hand.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rings import Ring
from scipy.io import mmwrite
from scipy.sparse import block_diag, coo_array, csr_array, save_npz, triu

from tyrefrf.case import Case, load_case

SI_IN = {  # one metre, one N/m, one kg and one N s/m in the unit systems
    "SI": (1.0, 1.0, 1.0, 1.0),
    "mm-t-s": (1e3, 1e-3, 1e-3, 1e-3),
    "mm-kg-ms": (1e3, 1e-6, 1.0, 1e-3),
}
XYZ = {"y": [0, 1, 2], "z": [2, 0, 1], "x": [1, 2, 0]}
"""Our coordinates that are the file's x, y and z, for every axle of the file."""


@dataclass(frozen=True)
class Style:
    """How the files are written.

    ending: .mtx, .npz or .sti (upper triangle). listed: whether rows are shuffled and a file of
    dofs says what they are; else they follow the nodes, three by three. start: angle of the left
    section in the files' coordinates [rad]. nodes: "xyz" or "r y theta".
    """

    directions: str = "cartesian"
    ending: str = ".mtx"
    units: str = "SI"
    axis: str = "y"
    listed: bool = True
    start: float = 0.0
    nodes: str = "xyz"


@dataclass(frozen=True, eq=False)
class Exported:
    """Files in a directory, and what their author knows.

    number: (n,) file's number of every node of the ring's mesh. rows: (n, 3) place of each dof of
    the mesh in the matrices. matrices: as written, but for the unit.
    """

    directory: Path
    text: str
    number: np.ndarray
    rows: np.ndarray

    def case(self, *changes: tuple[str, str]) -> Case:
        """The case of the files, with parts of its text replaced."""
        text = self.text
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new)
        path = self.directory / "brought.toml"
        path.write_text(text)
        return load_case(path)


def export(ring: Ring, directory: Path, style: Style = Style(), seed: int = 3) -> Exported:
    """Write a ring's cell; loads and probes at two nodes, by their files' numbers."""
    rng = np.random.default_rng(seed)
    mesh, cell, n = ring.mesh, ring.cell, ring.mesh.n_nodes
    number = 1000 + 7 * rng.permutation(n)
    listing = rng.permutation(n)  # order of the nodes in their file
    rows = (
        rng.permutation(3 * n)
        if style.listed
        else 3 * np.argsort(listing).repeat(3) + np.tile([0, 1, 2], n)
    )
    rows = rows.reshape(n, 3)
    metre, newton, kilogram, damper = SI_IN[style.units]
    turn = _turn(mesh.points[:, 2] + style.start, style, rows)

    data = {f"K_{name}": newton * K for name, K in cell.K.items()}
    data |= {"M": kilogram * cell.M, "C": damper * cell.C, "K_G": newton * cell.K_G}
    for name, entries in data.items():
        write(turn.T @ cell.sparse(entries) @ turn, directory / f"{name}{style.ending}")
    _write_nodes(directory / "nodes.csv", mesh, number, listing, style, metre)
    if style.listed:
        of_row = np.argsort(rows.ravel())
        lines = [f"{number[dof // 3]}.{dof % 3 + 1}" for dof in of_row]
        (directory / "cell.dof").write_text("\n".join(lines) + "\n")
    sets = {
        "left": np.arange(mesh.n_face),
        "right": np.arange(mesh.n_own, n),
        "rim": mesh.rim,
    }
    for name, nodes in sets.items():
        text = "\n".join(map(str, number[rng.permutation(nodes)]))
        (directory / f"{name}.txt").write_text(text + "\n")
    return Exported(directory, _text(ring, style, number), number, rows)


def write(A: csr_array, path: Path) -> None:
    """A symmetric matrix in the format of the file's ending."""
    if path.suffix == ".npz":
        save_npz(path, csr_array(A))
    elif path.suffix == ".mtx":
        mmwrite(path, csr_array(A))
    else:  # as CalculiX: column by column of the upper triangle, from 1, fourteen digits
        upper = triu(A, format="csc").tocoo()
        rows = zip(upper.row + 1, upper.col + 1, upper.data, strict=True)
        path.write_text("".join(f"{i} {j} {value:20.13e}\n" for i, j, value in rows))


def _turn(theta: np.ndarray, style: Style, rows: np.ndarray) -> csr_array:
    """Takes the files' dofs to the mesh's r, y, theta."""
    n = len(theta)
    local = np.tile(np.eye(3), (n, 1, 1))
    if style.directions == "cartesian":
        c, s, o, i = np.cos(theta), np.sin(theta), np.zeros(n), np.ones(n)
        local = np.array([[c, o, s], [o, i, o], [-s, o, c]]).transpose(2, 0, 1)
        local = local[:, :, XYZ[style.axis]]
    place = coo_array((np.ones(3 * n), (np.arange(3 * n), rows.ravel())), shape=(3 * n, 3 * n))
    blocks = [csr_array(block) for block in local]
    return csr_array(block_diag(blocks, format="csr") @ place.tocsr())


def _write_nodes(path, mesh, number, listing, style, metre) -> None:
    r, y, theta = mesh.points.T
    theta = theta + style.start
    if style.nodes == "xyz":
        heading = "number, x, y, z"
        table = metre * np.stack([r * np.cos(theta), y, r * np.sin(theta)], axis=1)
        table = table[:, XYZ[style.axis]]
    else:
        heading = "number; r; y; theta"
        table = np.stack([metre * r, metre * y, np.rad2deg(theta)], axis=1)
    apart = heading[6]
    lines = [apart.join([str(number[k]), *(f"{x:.17g}" for x in table[k])]) for k in listing]
    path.write_text("\n".join(["# written by a test", heading, *lines]) + "\n")


def _text(ring: Ring, style: Style, number: np.ndarray) -> str:
    parts = "\n".join(
        f'{name} = {{ file = "K_{name}{style.ending}", eta = {stuff.eta} }}'
        for name, stuff in ring.materials.items()
    )
    node = int(number[ring.mesh.n_face // 2])
    return f"""\
[matrices]
M = "M{style.ending}"
C = "C{style.ending}"
K_G = "K_G{style.ending}"
{'dofs = "cell.dof"' if style.listed else ""}
nodes = "nodes.csv"
directions = "{style.directions}"
axis = "{style.axis}"
units = "{style.units}"
left = "left.txt"
right = "right.txt"
rim = "rim.txt"

[matrices.K]
{parts}

[cell]
sector_angle = {360.0 / ring.n_cells!r}

[frequency]
values = [0.0, 60.0, 220.0, 700.0]

[[loads]]
name = "drive"
node = {node}
direction = "r"

[[probes]]
name = "far"
kind = "node"
node = {node}
angle = 180.0
direction = "theta"

[[probes]]
kind = "hub"
"""


def stressed(ring: Ring, share: float = 0.02) -> Ring:
    """The same ring with a geometric stiffness: so much of the stiffness, without loss."""
    cell = ring.cell
    K_G = share * sum(cell.K.values())
    ring.__dict__["cell"] = replace(cell, K_G=K_G)  # where the cached property keeps it
    return ring
