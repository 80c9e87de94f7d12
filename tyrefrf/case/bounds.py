"""How large a case may be: bounds on what its numbers ask for together.

Whether what is within them fits into a machine's memory is estimated before a run (`study.memory`);
what is beyond them fits into none, and is a slip of the pen.
"""

from __future__ import annotations

from collections.abc import Iterator

from tyrefrf.case.faults import Fault
from tyrefrf.case.model import Case
from tyrefrf.case.places import HubProbe, Probe, RegionProbe

MAX_ELEMENTS = 1_000_000  # in one cell
MAX_IN_RING = 100_000_000  # elements
MAX_POINTS = 100_000  # of all probes together
MAX_RESPONSES = 1_000_000_000  # complex numbers; 16 GB
MAX_FIELDS = 10_000  # files of deflections, for every load and frequency


def size_faults(case: Case) -> Iterator[Fault]:
    """Yield what is too large in an otherwise right case."""
    yield from _mesh_faults(case)
    points = n_points(case)
    if points > MAX_POINTS:
        message = f"have {points} points together; must be at most {MAX_POINTS}"
        yield Fault(("probes",), message)
        return
    n_lines, n_loads = len(case.frequency.lines()), len(case.loads)
    responses = n_responses(case)
    if responses > MAX_RESPONSES:
        made = f"{n_lines} lines of {n_loads} loads at {n_loads + points} probes, driving points"
        message = f"{made} included, make {responses} responses; must be at most {MAX_RESPONSES}"
        yield Fault(("frequency",), message)
    fields = n_loads * len(case.output.deflections)
    if fields > MAX_FIELDS:
        message = f"make {fields} fields of all loads; must make at most {MAX_FIELDS}"
        yield Fault(("output", "deflections"), message)


def n_points(case: Case) -> int:
    """Responses that the probes take, the hub's six included."""
    return sum(map(_points_of, case.probes))


def _points_of(probe: Probe) -> int:
    if isinstance(probe, HubProbe):
        return 6
    return probe.count[0] * probe.count[1] if isinstance(probe, RegionProbe) else 1


def n_responses(case: Case) -> int:
    """Numbers in the results: of every load at every probe and driving point on every line."""
    n_loads = len(case.loads)
    return len(case.frequency.lines()) * n_loads * (n_loads + n_points(case))


def section_elements(case: Case) -> int:
    """At most so many elements in the built-in section; 0 where it comes from a file."""
    geometry = case.geometry
    if geometry is None:
        return 0
    rows = geometry.elements_through
    if geometry.tread is not None:
        rows += geometry.tread.elements_through
    return geometry.elements_along * rows


def _mesh_faults(case: Case) -> Iterator[Fault]:
    section = section_elements(case)
    elements = section * case.cell.elements_around
    if elements > MAX_ELEMENTS:
        of = f"{section} elements in a section"
        of += f" make {elements} in a cell" if case.cell.elements_around > 1 else ""
        key = ("cell", "elements_around") if section <= MAX_ELEMENTS else ("geometry",)
        yield Fault(key, f"{of}; must be at most {MAX_ELEMENTS}")
    in_ring = elements * case.cell.n_cells
    if in_ring > MAX_IN_RING:
        made = f"{case.cell.n_cells} cells of {elements} elements make {in_ring}"
        yield Fault(("cell", "sector_angle"), f"{made}; must be at most {MAX_IN_RING}")
