"""The cases that are spoilt: those that come with the program, made coarse, and some with more.

Coarse, as a case that still computes after it was spoilt is computed, ten thousand times.
"""

from __future__ import annotations

import re
import shutil
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyuff
from scipy.io import mmwrite

from tyrefrf.case import builtin_text, parse_case, starter_text
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.study.model import build_mesh, build_model

from ..written import as_drawn, cdb_text, msh_text

CASES = Path(__file__).parents[2] / "cases"

COARSER = (
    (r"^elements_along = 40\b", "elements_along = 12"),
    (r"^elements_along = 28\b", "elements_along = 8"),
    (r"^elements_along = 24\b(?=.*stations)", "elements_along = 6"),
    (
        r"^elements_along = 12\nelements_through = 2    # rows",
        "elements_along = 6\nelements_through = 2 # rows",
    ),
    (r"^elements_along = 24$", "elements_along = 12"),
    (r"^sector_angle = [68]\.0", "sector_angle = 24.0"),
    (r"^stop = .*", "stop = 450.0"),
    (r"^step = .*", "step = 150.0"),
    (r"^sector_angle = \[.*", "sector_angle = [24.0, 36.0]"),
)
"""What is replaced in the cases that come with the program."""

DRAWN = {"starter"}
"""That whose results are drawn, which takes longer than to compute them."""

RICH = """\
title = "Some of everything"
sensors = "mounted"

[geometry]
elements_along = 12
elements_through = 3
material = "carcass"
[geometry.tread]
material = "rubber"
elements_along = 6
elements_through = 2
grooves = { width = "6 mm", depth = "6.5 mm", rib = "20 mm", offset = 1.0 }
[geometry.belt]
material = "belt"
[geometry.bead]
material = "wire"

[materials.rubber]
nu = 0.48
rho = "1.1 g/cm3"
E_static = "5 MPa"
modulus = { kind = "prony", E_inf = "6 MPa", g = [0.2, 0.3], tau = ["1 ms", 1e-5] }
[materials.carcass]
kind = "transverse"
E_1 = "90 MPa"
E_2 = "20 MPa"
nu_12 = 0.4
nu_23 = 0.5
G_12 = "6 MPa"
rho = 1200
eta = 0.1
angle = -20
[materials.belt]
kind = "ply"
cord = { E = "2 GPa", nu = 0.3, rho = 1400 }
rubber = { E = "6 MPa", nu = 0.48, rho = 1100, eta = 0.1 }
volume_fraction = 0.3
angles = [20, -20]
shares = [1.0, 2.0]
[materials.wire]
kind = "orthotropic"
E_1 = "9 GPa"
E_2 = 2e8
E_3 = 3e8
nu_12 = 0.4
nu_13 = 0.5
nu_23 = 0.2
G_12 = 6e7
G_13 = 4e7
G_23 = 1e8
rho = 1800
eta = 0.05
angle = "0.5 rad"

[cell]
sector_angle = 24.0
elements_around = 3

[damping]
alpha = "2 1/s"
beta = "1 us"

[inflation]
pressure = "0.4 bar"

[frequency]
start = 50
stop = "0.4 kHz"
count = 3
spacing = "log"

[[loads]]
name = "disc"
kind = "patch"
s = 0.6
direction = "r"
diameter = "20 mm"
[[loads]]
name = "knot"
node = 40
angle = 30
direction = "theta"

[[probes]]
name = "shaken"
s = 0.8
angle = 31.0
direction = "y"
sensor_mass = "5 g"
[[probes]]
name = "area"
kind = "region"
s = [0.2, 0.8]
surface = "inner"
angle = [-30, 90]
direction = "r"
count = [3, 4]
[[probes]]
name = "patch"
kind = "patch"
surface = "inner"
s = 0.5
direction = "r"
[[probes]]
kind = "hub"

[solver]
name = "direct"
library = "superlu"

[output]
plots = []
deflections = ["100 Hz"]
export = ["csv", "mat", "uff58"]

[[measured]]
file = "curve.csv"
columns = { frequency = 1, level = 2, phase = 3 }
quantity = "accelerance"
load = "disc"
probe = "shaken"
scale = -1.0

[sweep]
eta_carcass = [0.1, 0.2]
"inflation.pressure" = { range = ["0 bar", "0.4 bar"], count = 2 }
"""

SOFT = """\
geometry = { material = "rubber", elements_along = 8 }
materials.rubber.nu = 0.42
materials.rubber.rho = 1200.0
materials.rubber.modulus.kind = "zener"
materials.rubber.modulus.E_0 = "20 MPa"
materials.rubber.modulus.E_inf = "300 MPa"
materials.rubber.modulus.tau = "2 us"
materials.rubber.modulus.alpha = 0.6
materials.rubber.modulus.shift = { C1 = 17.4, C2 = 51.6, T_ref = 20, temperature = 5 }
cell = { sector_angle = 24.0, element = "hex20r" }
inflation = { pressure = "0.2 bar", kind = "nonlinear" }
frequency = { values = [0.0, "100 Hz", 400.0] }
loads = [{ name = "radial", s = 0.5, direction = "r" }]
probes = [{ name = "side", s = 0.83, angle = 90.0, direction = "y" }]
solver = { name = "modal", modes = 60, static_correction = true }
output = { plots = [] }
"""

TABLED = """\
[geometry]
material = "rubber"
elements_along = 8
[materials.rubber]
nu = 0.45
rho = 1100
[materials.rubber.modulus]
kind = "table"
frequencies = [1, 100, 1000]
E = ["30 MPa", "40 MPa", "60 MPa"]
eta = [0.1, 0.15, 0.2]
extrapolate = true
[cell]
sector_angle = 20
element = "hex20"
[frequency]
stop = 600
step = 12
adaptive = true
tolerance = "0.01 dB"
[[loads]]
name = "radial"
s = 0.5
direction = "r"
[[probes]]
name = "hub"
kind = "hub"
[solver]
name = "cyclic"
[output]
plots = []
[sweep]
nu_rubber = [0.3, 0.45]
"""

BROUGHT = """\
[matrices]
K = { file = "K.mtx", eta = 0.1 }
M = "M.mtx"
nodes = "nodes.csv"
directions = "cylindrical"
units = "SI"
left = "left.txt"
right = "right.txt"
rim = "rim.txt"
[cell]
sector_angle = 24.0
[frequency]
values = [60.0, 220.0]
[[loads]]
name = "drive"
node = 8
direction = "r"
[[probes]]
name = "far"
kind = "node"
node = 8
angle = 168.0
direction = "theta"
[[probes]]
kind = "hub"
[output]
plots = []
"""


MEASURED = """\
geometry = { material = "rubber", elements_along = 8 }
materials.rubber = { E = "80 MPa", nu = 0.42, rho = 1200.0, eta = 0.1 }
cell = { sector_angle = 24.0 }
frequency = { start = 20, stop = 200, step = 60 }
loads = [{ name = "radial", s = 0.5, direction = "r" }]
output = { plots = [] }
[[measured]]
file = "curve.csv"
columns = { frequency = 1, level = 2, phase = 3 }
quantity = "accelerance"
load = "radial"
probe = "radial.drive"
[[measured]]
file = "curve.uff"
load = "radial"
probe = "radial.drive"
"""


@cache
def bases() -> dict[str, str]:
    """Case texts by what they are called."""
    found = {"starter": starter_text(), "builtin": builtin_text()}
    for path in sorted([*CASES.glob("*.toml"), *CASES.glob("paper/*.toml")]):
        found[path.stem] = path.read_text(encoding="utf-8")
    found = {name: _coarser(text) for name, text in found.items()}
    for name in found.keys() - DRAWN:
        found[name] += "\n[output]\nplots = []\n"
    own = {"rich": RICH, "soft": SOFT, "tabled": TABLED, "brought": BROUGHT, "measured": MEASURED}
    ansys = found["mesh_section"].replace("meshes/section.inp", "section.cdb")
    ansys = ansys.replace('inner = "LINER"', "").replace("RUBBER =", '"MAT 1" =')
    gmsh = found["mesh_section"].replace("meshes/section.inp", "section.msh")
    own["gmsh"], own["ansys"] = (text.replace("node = 30 ", "node = 8 ") for text in (gmsh, ansys))
    return found | own


def _coarser(text: str) -> str:
    for old, new in COARSER:
        text = re.sub(old, new, text, flags=re.MULTILINE)
    return text


@cache
def files() -> dict[str, bytes]:
    """What is in the files that these cases name, by their names."""
    with TemporaryDirectory() as scratch:
        directory = Path(scratch)
        _write_files(directory)
        paths = [path for path in directory.rglob("*") if path.is_file()]
        return {path.relative_to(directory).as_posix(): path.read_bytes() for path in paths}


def lay_out(directory: Path) -> None:
    """Put the files that these cases name into a directory."""
    for name, content in files().items():
        (directory / name).parent.mkdir(parents=True, exist_ok=True)
        (directory / name).write_bytes(content)


def _write_files(directory: Path) -> None:
    shutil.copytree(CASES / "meshes", directory / "meshes")
    rows = [f"{10 * k}; {-40 + k % 7},5; {-3 * k}" for k in range(1, 60)]
    (directory / "curve.csv").write_text("\n".join(["f; dB; deg", *rows]) + "\n")
    _write_matrices(directory)
    _write_curve(directory / "curve.uff")
    section = build_mesh(parse_case(bases()["starter"], "starter", "starter")).section
    (directory / "section.msh").write_text(msh_text(as_drawn(section)))
    (directory / "section.cdb").write_text(cdb_text(as_drawn(section)))


def _write_matrices(directory: Path) -> None:
    """One cell of the starter's tyre as matrices, its nodes and its sets."""
    model = build_model(parse_case(bases()["starter"], "starter", "starter"))
    mesh, cell = model.mesh, model.problem.cell
    assert isinstance(mesh, CellMesh)
    mmwrite(directory / "K.mtx", cell.sparse(sum(cell.K.values())))
    mmwrite(directory / "M.mtx", cell.sparse(cell.M))
    r, y, theta = mesh.points.T
    table = np.column_stack([np.arange(len(r)), r, y, np.rad2deg(theta)])
    lines = [f"{int(n)}, {r:.17g}, {y:.17g}, {t:.17g}" for n, r, y, t in table]
    (directory / "nodes.csv").write_text("\n".join(["number, r, y, theta", *lines]) + "\n")
    sets = {"left": range(mesh.n_face), "right": range(mesh.n_own, mesh.n_nodes), "rim": mesh.rim}
    for name, nodes in sets.items():
        (directory / f"{name}.txt").write_text("\n".join(map(str, nodes)) + "\n")


def _write_curve(path: Path) -> None:
    """An accelerance as a laboratory stores it."""
    f = np.arange(10.0, 300.0, 10.0)
    header = {"type": 58, "binary": 0, "func_type": 4, "ver_num": 0, "load_case_id": 0}
    ends = {"rsp_node": 1, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3}
    ends |= {f"{end}_ent_name": "NONE" for end in ("rsp", "ref")}
    axes = {
        f"{axis}_{key}": 0
        for axis in ("abscissa", "ordinate", "orddenom", "z_axis")
        for key in ("spec_data_type", "len_unit_exp", "force_unit_exp", "temp_unit_exp")
    }
    axes |= {"abscissa_spec_data_type": 18, "ordinate_spec_data_type": 12}
    axes |= {"orddenom_spec_data_type": 13}
    names = {f"{axis}_axis_lab": "NONE" for axis in ("abscissa", "ordinate", "orddenom", "z_axis")}
    spacing = {"abscissa_spacing": 1, "abscissa_min": 10.0, "abscissa_inc": 10.0, "z_axis_value": 0}
    data = {
        "x": f,
        "data": (1.0 + 0.1j) * f,
        "num_pts": len(f),
        "ord_data_type": 5,
        "version_num": 0,
    }
    ids = {f"id{k}": "NONE" for k in range(1, 6)}
    pyuff.UFF(str(path)).write_sets(header | ends | axes | names | spacing | data | ids, "add")
