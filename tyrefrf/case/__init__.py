"""Case files: TOML becomes a frozen, validated `Case`, or one `CaseError` with every problem."""

from tyrefrf.case.cell import Cell
from tyrefrf.case.frequency import Frequency
from tyrefrf.case.geometry import Geometry, Thickness
from tyrefrf.case.load import build_case, load_case, parse_case, read_text
from tyrefrf.case.locate import with_lines
from tyrefrf.case.material import Material
from tyrefrf.case.model import Case, Damping, Output, Solver
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
)
from tyrefrf.case.resolved import case_hash, resolved, resolved_toml
from tyrefrf.case.schema import case_schema
from tyrefrf.case.starter import starter_text

__all__ = [
    "AtNode",
    "Case",
    "Cell",
    "Damping",
    "Frequency",
    "Geometry",
    "HubProbe",
    "Load",
    "Material",
    "NodeLoad",
    "NodeProbe",
    "OnPatch",
    "OnSurface",
    "Output",
    "PatchLoad",
    "PatchProbe",
    "Point",
    "PointProbe",
    "Probe",
    "Solver",
    "Thickness",
    "build_case",
    "case_hash",
    "case_schema",
    "load_case",
    "parse_case",
    "read_text",
    "resolved",
    "resolved_toml",
    "starter_text",
    "with_lines",
]
