"""Case files: TOML becomes a frozen, validated `Case`, or one `CaseError` with every problem."""

from tyrefrf.case.cell import Cell
from tyrefrf.case.files import (
    NamedFile,
    file_digests,
    files_of,
    opened,
    read_bytes,
    same_file,
    unreadable,
)
from tyrefrf.case.frequency import Frequency
from tyrefrf.case.geometry import Bead, Belt, Geometry, Thickness, Tread
from tyrefrf.case.grid import Grid, make_grid
from tyrefrf.case.inflation import Inflation
from tyrefrf.case.laid import laid_name
from tyrefrf.case.load import build_case, load_case, parse_case, read_text
from tyrefrf.case.locate import in_sweep, with_lines
from tyrefrf.case.material import (
    Cord,
    Isotropic,
    Material,
    Orthotropic,
    Ply,
    Transverse,
    Viscoelastic,
)
from tyrefrf.case.matrices import Matrices, Part
from tyrefrf.case.measured import Columns, Dof, MeasuredFile
from tyrefrf.case.mesh import CellFile, MeshFile, Region, SectionFile
from tyrefrf.case.model import Case, Damping, Output
from tyrefrf.case.modulus import FractionalZener, ModulusLaw, PronySeries, Shift, TabledModulus
from tyrefrf.case.places import (
    AtNode,
    HubProbe,
    Load,
    NodeLoad,
    NodeProbe,
    OnPatch,
    OnSurface,
    PatchLoad,
    PatchProbe,
    Point,
    PointProbe,
    Probe,
    RegionProbe,
)
from tyrefrf.case.resolved import case_hash, resolved, resolved_toml
from tyrefrf.case.schema import case_schema
from tyrefrf.case.solver import Solver, SolverName
from tyrefrf.case.starter import builtin_text, starter_text
from tyrefrf.case.sweep import Range, Values

__all__ = [
    "AtNode",
    "Bead",
    "Belt",
    "Case",
    "Cell",
    "CellFile",
    "Columns",
    "Cord",
    "Damping",
    "Dof",
    "FractionalZener",
    "Frequency",
    "Geometry",
    "Grid",
    "HubProbe",
    "Inflation",
    "Isotropic",
    "Load",
    "Material",
    "Matrices",
    "MeasuredFile",
    "MeshFile",
    "ModulusLaw",
    "NamedFile",
    "NodeLoad",
    "NodeProbe",
    "OnPatch",
    "OnSurface",
    "Orthotropic",
    "Output",
    "Part",
    "PatchLoad",
    "PatchProbe",
    "Ply",
    "Point",
    "PointProbe",
    "Probe",
    "PronySeries",
    "Range",
    "Region",
    "RegionProbe",
    "SectionFile",
    "Shift",
    "Solver",
    "SolverName",
    "TabledModulus",
    "Thickness",
    "Transverse",
    "Tread",
    "Values",
    "Viscoelastic",
    "build_case",
    "builtin_text",
    "case_hash",
    "case_schema",
    "file_digests",
    "files_of",
    "in_sweep",
    "laid_name",
    "load_case",
    "make_grid",
    "opened",
    "parse_case",
    "read_bytes",
    "read_text",
    "resolved",
    "resolved_toml",
    "same_file",
    "starter_text",
    "unreadable",
    "with_lines",
]
