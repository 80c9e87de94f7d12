"""From the case to the ring problem: section, cell, matrices, and columns for loads and probes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np
from scipy.sparse import csc_array, hstack

from tyrefrf.case import (
    AtNode,
    Case,
    HubProbe,
    OnPatch,
    OnSurface,
    Point,
    RegionProbe,
    file_digests,
)
from tyrefrf.case.bounds import section_elements
from tyrefrf.case.places import Direction
from tyrefrf.errors import CaseError, MeshError, Problem
from tyrefrf.fem.assembly import CellAssembly, CellMatrices
from tyrefrf.fem.columns import hub_columns, node_column, surface_column
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.fem.inflation import Inflation
from tyrefrf.mesh.cell import CellMesh, revolve, revolve_between
from tyrefrf.mesh.grooves import cut_elements, groove_layers
from tyrefrf.mesh.node_cell import NodeCell
from tyrefrf.mesh.place import REGION, Nodes, Place
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.mesh.surface import Spots, Surface
from tyrefrf.solvers import RingProblem, Sensors
from tyrefrf.study.brought import BroughtCell, NodeFinder, bring_matrices
from tyrefrf.study.inflate import elasticity_key, inflate
from tyrefrf.study.memory import check_fits, need_of_cell
from tyrefrf.study.outside import mesh_of_file

Placed = tuple[Place, csc_array]


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A case made computable.

    loads: places of the loads. probes: places of the probes, first the driving point of every
    load, "<load>.drive". The problem's probes are theirs, then six of the hub if `hub`; its last
    loads and probes are the places of the sensors, in three directions each.
    inflation: the state about which the problem vibrates; None without pressure.
    brought: the matrices that the case brings; None where they are assembled.
    """

    case: Case
    mesh: CellMesh | NodeCell
    problem: RingProblem
    loads: tuple[Place, ...]
    probes: tuple[Place, ...]
    hub: bool
    inflation: Inflation | None
    brought: BroughtCell | None = None


def build_model(case: Case) -> Model:
    """Mesh and assemble a case and place its loads and probes.

    Raises CaseError, naming the key, where a place is not on this mesh, the pressure is more than
    the tyre bears, or a file that the case names cannot be read, and MeshError where the section or
    cell cannot be meshed.
    """
    return Workshop().model(case)


class Workshop:
    """Makes models, and makes what several cases share only once."""

    def __init__(self) -> None:
        self._outlines: dict[str, Outline] = {}
        self._inflations: dict[tuple[str, ...], Inflation] = {}

    def model(self, case: Case) -> Model:
        """The model of a case, to the bit the same whatever was made before.

        Raises CaseError and MeshError as `build_model`.
        """
        files = file_digests(case)  # results will need them all: better now than after hours
        tables = {"geometry", "mesh", "matrices", "cell", "loads", "probes", "sensors"}
        losses = {"matrices": {"K": {"__all__": {"eta", "modulus"}}}}
        key = case.model_dump_json(include=tables, exclude=losses) + str(files)
        if key not in self._outlines:
            self._outlines[key] = Outline.of(case)
        outline = self._outlines[key]
        cell = outline.cell(case)
        inflation = self._inflation(key, case, outline.mesh, cell)
        if inflation is not None:
            follows = case.inflation.pressure_stiffness
            cell = inflation.applied_to(cell, pressure_stiffness=follows)
        problem = RingProblem(
            cell=cell,
            n_cells=case.cell.n_cells,
            loads=outline.load_columns,
            probes=outline.probe_columns,
            sensors=outline.sensors,
        )
        return Model(
            case,
            outline.mesh,
            problem,
            outline.loads,
            outline.probes,
            outline.hub,
            inflation,
            outline.brought,
        )

    def _inflation(
        self, outline: str, case: Case, mesh: CellMesh | NodeCell, cell: CellMatrices
    ) -> Inflation | None:
        """The case's inflation; it depends on nothing of the materials but their elasticity."""
        if case.inflation.pressure == 0.0:
            return None
        assert isinstance(mesh, CellMesh)  # the case's rules saw to it
        materials = case.laid_materials
        elasticities = (elasticity_key(materials[name]) for name in mesh.materials)
        key = (outline, case.inflation.model_dump_json(), *elasticities)
        if key not in self._inflations:
            self._inflations[key] = inflate(case, mesh, cell)
        return self._inflations[key]


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """What a case is without its materials: mesh, bricks, loads and probes.

    load_columns, probe_columns: over the ring's dofs; the rest as in `Model`.
    """

    mesh: CellMesh | NodeCell
    assembly: CellAssembly | None
    brought: BroughtCell | None
    loads: tuple[Place, ...]
    probes: tuple[Place, ...]
    hub: bool
    load_columns: csc_array
    probe_columns: csc_array
    sensors: Sensors | None

    @classmethod
    def of(cls, case: Case) -> Outline:
        """From a case's geometry, mesh file or matrices, cell, loads and probes."""
        brought = bring_matrices(case) if case.matrices is not None else None
        mesh = build_mesh(case) if brought is None else brought.matrices.nodes
        loads, probes = _place_all(mesh, case)
        hub = any(isinstance(probe, HubProbe) for probe in case.probes)
        sensors, sensed = _sensors(mesh, case)
        responses = [_displacement(mesh, column) for _, column in loads + probes]
        return cls(
            mesh=mesh,
            assembly=(
                CellAssembly(mesh, ELEMENTS[case.cell.element])
                if isinstance(mesh, CellMesh)
                else None
            ),
            brought=brought,
            loads=tuple(place for place, _ in loads),
            probes=tuple(_driving_point(place) for place, _ in loads)
            + tuple(place for place, _ in probes),
            hub=hub,
            load_columns=hstack([column for _, column in loads] + sensed, format="csc"),
            probe_columns=hstack(
                responses
                + ([hub_columns(mesh)] if hub else [])
                + [_displacement(mesh, column) for column in sensed],
                format="csc",
            ),
            sensors=sensors,
        )

    def cell(self, case: Case) -> CellMatrices:
        """The matrices for the materials, or the losses, of a case of this outline."""
        if self.brought is not None:
            assert case.matrices is not None
            return self.brought.matrices.cell(case.matrices.K, case.damping)
        assert self.assembly is not None
        return self.assembly.cell(case.laid_materials, case.damping)


def build_mesh(case: Case) -> CellMesh:
    """Mesh one cell of a case, or read it.

    Raises CaseError, naming the key, where its sizes do not fit, or its file is no such mesh;
    MeshError where a mesh in memory is none.
    """
    if case.mesh is not None:
        return mesh_of_file(case)
    try:
        return _mesh_of_geometry(case)
    except MeshError as error:
        raise CaseError([Problem(("geometry",), str(error))]) from error


def _mesh_of_geometry(case: Case) -> CellMesh:
    """The built-in section, revolved or cut by grooves."""
    assert case.geometry is not None  # the case saw to it that there is one of them
    check_fits(need_of_cell(case, section_elements(case) * case.cell.elements_around))
    quadratic = ELEMENTS[case.cell.element].n_nodes == 20
    section, tread = tyre_section(case.geometry, quadratic), case.geometry.tread
    if tread is not None and tread.grooves is not None:
        layers = groove_layers(tread.grooves, case.geometry.outer_radius, case.cell)
        cut = cut_elements(case.geometry)
        return revolve_between(section, layers.theta, ~np.outer(layers.grooved, cut))
    return revolve(section, 2.0 * np.pi / case.cell.n_cells, case.cell.elements_around)


def _place_all(mesh: CellMesh | NodeCell, case: Case) -> tuple[list[Placed], list[Placed]]:
    """Loads and probes (the hub left out) on a mesh; one CaseError with all that are not on it."""
    finder = _finder(mesh)
    placed: dict[str, list[Placed]] = {"loads": [], "probes": []}
    problems = []
    for table, points in (("loads", case.loads), ("probes", case.probes)):
        for i, point in enumerate(points):
            if isinstance(point, HubProbe):
                continue
            try:
                placed[table] += finder.find_all(point)
            except MeshError as error:
                key = "node" if getattr(point, "node", None) is not None else "s"
                problems.append(Problem((table, i, key), str(error)))
    if problems:
        raise CaseError(problems)
    return placed["loads"], placed["probes"]


def _sensors(mesh: CellMesh | NodeCell, case: Case) -> tuple[Sensors | None, list[csc_array]]:
    """The sensors of a case, and the columns of their places in three directions each."""
    probes = [
        point
        for probe in case.probes
        if not isinstance(probe, HubProbe)
        for point in (probe.points() if isinstance(probe, RegionProbe) else [probe])
    ]
    sensed = [(k, probe) for k, probe in enumerate(probes) if probe.sensor_mass is not None]
    if not sensed:
        return None, []
    finder = _finder(mesh)
    sensors = Sensors(
        mass=np.array([probe.sensor_mass for _, probe in sensed]),
        probe=np.array([len(case.loads) + k for k, _ in sensed]),
        together=case.sensors == "mounted",
    )
    return sensors, [column for _, probe in sensed for column in finder.all_directions(probe)]


def _displacement(mesh: Nodes, column: csc_array) -> csc_array:
    """A column without its weights on the rim, where nothing moves and probes take forces."""
    moves = ~np.isin(column.indices // 3 % mesh.n_own, mesh.rim)
    indptr = np.array([0, moves.sum()])
    return csc_array((column.data[moves], column.indices[moves], indptr), shape=column.shape)


def _reach(surface: Surface, point: OnSurface) -> None:
    """Raises MeshError, naming the region's point, where it is over a groove."""
    try:
        surface.spots(np.array([point.s]), np.deg2rad([point.angle]))
    except MeshError as error:
        raise MeshError(
            f"point {point.name!r} of the region, s = {point.s:.4g}: {error}; see to the region's "
            "s, angle and count, or take the inner surface"
        ) from None


def _finder(mesh: CellMesh | NodeCell) -> _Finder | NodeFinder:
    return NodeFinder(mesh) if isinstance(mesh, NodeCell) else _Finder(mesh)


class _Finder:
    """Finds places on a mesh."""

    def __init__(self, mesh: CellMesh) -> None:
        self.mesh = mesh
        self.surfaces = {name: Surface(mesh, name) for name in ("outer", "inner")}

    def find_all(self, point: Point | RegionProbe) -> list[Placed]:
        """The one place of a point, or those of a region's points. Raises MeshError as `find`."""
        if not isinstance(point, RegionProbe):
            return [self.find(point)]
        points = list(point.points())
        if not self.mesh.is_revolved:
            raise MeshError(self._only_nodes(points[0]))
        surface = self.surfaces[point.surface]
        s, degrees = np.array([(one.s, one.angle) for one in points]).T
        try:
            spots = surface.spots(s, np.deg2rad(degrees))
        except MeshError:
            for one in points:  # the first that is over a groove says so itself
                _reach(surface, one)
            raise
        return [self._in_region(one, spots.one(k)) for k, one in enumerate(points)]

    def find(self, point: Point) -> Placed:
        """The place actually used, and its column over the ring's dofs.

        Raises MeshError where it is not on the mesh, or on the rim, which is fixed.
        """
        angle = float(np.deg2rad(point.angle))
        if isinstance(point, AtNode):
            place, column = self._at_node(point, angle)
        else:
            assert isinstance(point, OnSurface)
            place, column = self._on_surface(point, angle)
        place = replace(place, sensor_mass=getattr(point, "sensor_mass", None) or 0.0)
        return self._off_rim(place, column)

    def _off_rim(self, place: Place, column: csc_array) -> Placed:
        if _displacement(self.mesh, column).nnz == 0:
            raise MeshError(
                f"{place.name!r} lies on the rim, which is fixed; move it off the rim "
                'or, for the force on the rim, use a probe of kind = "hub"'
            )
        return place, column

    def all_directions(self, point: Point) -> Iterator[csc_array]:
        """The columns of a place along r, y and theta. Raises MeshError as `find`."""
        for direction in get_args(Direction):
            yield self.find(point.model_copy(update={"direction": direction}))[1]

    def _in_region(self, point: OnSurface, spot: Spots) -> Placed:
        """A point of a region, found already."""
        angle = float(np.deg2rad(point.angle))
        r, y = float(spot.r[0]), float(spot.y[0])
        place = Place(point.name, REGION, point.surface, point.s, r, y, angle, point.direction)
        column = surface_column(self.mesh, spot, np.ones(1), point.direction, angle)
        return self._off_rim(place, column)

    def _on_surface(self, point: OnSurface, angle: float) -> Placed:
        """An interpolated point, or a disc around it."""
        surface = self.surfaces[point.surface]
        if not self.mesh.is_revolved:
            raise MeshError(self._only_nodes(point))
        diameter = point.diameter if isinstance(point, OnPatch) else 0.0
        disc = surface.disc(point.s, angle, diameter) if diameter else None
        centre = surface.spots(np.array([point.s]), np.array([angle]))
        spots, share = disc or (centre, np.ones(1))
        place = Place(
            name=point.name,
            kind="patch" if diameter else "point",
            surface=point.surface,
            s=point.s,
            r=float(centre.r[0]),
            y=float(centre.y[0]),
            angle=angle,
            direction=point.direction,
            diameter=diameter,
        )
        return place, surface_column(self.mesh, spots, share, point.direction, angle)

    def _at_node(self, point: AtNode, angle: float) -> Placed:
        """A node of the section by number or by place, in the nearest plane that has it."""
        mesh = self.mesh
        if not mesh.is_revolved:
            return self._at_own_node(point, angle)
        if point.node is None:
            assert point.s is not None  # the case saw to it
            node, plane = self.surfaces[point.surface].nearest(point.s, angle)
        else:
            node = self._numbered(point.node)
            plane = self.surfaces["outer"].nearest_plane(node, angle)
        cell, layer = divmod(plane, len(mesh.planes) - 1)
        cell %= round(2.0 * np.pi / mesh.sector_angle)
        number = int(mesh.planes[layer, node])
        r, y, theta = (float(x) for x in mesh.points[number])
        surface, s = self._surface_of(node)
        angle = cell * mesh.sector_angle + theta
        place = Place(point.name, "node", surface, s, r, y, angle, point.direction)
        return place, node_column(mesh, cell, number, point.direction)

    def _numbered(self, number: int) -> int:
        """The section's node of a number: the file's, if the section was read from one."""
        numbers = self.mesh.section.numbers
        if numbers is None and number < self.mesh.section.n_nodes:
            return number
        if numbers is not None and len(found := np.flatnonzero(numbers == number)):
            return int(found[0])
        n = self.mesh.section.n_nodes
        known = f"0 to {n - 1}" if numbers is None else "a number from the file"
        raise MeshError(f"node {number} is not in the section, which has {n} nodes; give {known}")

    def _at_own_node(self, point: AtNode, angle: float) -> Placed:
        """A node of a cell from a file, by the file's number or by its place on the left section.

        Of the cells that have it, the one where it is nearest to the angle.
        """
        mesh = self.mesh
        if point.node is None:
            assert point.s is not None  # the case saw to it
            number = self.surfaces[point.surface].nearest_node(point.s)
        else:
            there = np.flatnonzero(mesh.numbers == point.node)
            if not len(there):
                raise MeshError(
                    f"no brick has a node {point.node}; the cell's nodes are numbered from "
                    f"{mesh.numbers.min()} to {mesh.numbers.max()}"
                )
            number = int(there[0])
        if number >= mesh.n_own:  # the next cell's, at the same place in the ring
            number -= mesh.n_own
        r, y, theta = (float(x) for x in mesh.points[number])
        turns = round((angle - theta) / mesh.sector_angle)
        surface, s = self._surface_of(number)
        there_angle = round(theta + turns * mesh.sector_angle, 12)  # the file has fewer digits
        place = Place(point.name, "node", surface, s, r, y, there_angle, point.direction)
        cell = turns % round(2.0 * np.pi / mesh.sector_angle)
        return place, node_column(mesh, cell, number, point.direction)

    def _only_nodes(self, point: OnSurface) -> str:
        """Why a place between nodes is not taken on a cell from a file, and which node is near."""
        mesh = self.mesh
        node = mesh.numbers[self.surfaces[point.surface].nearest_node(point.s)]
        return (
            f"{point.name!r} is a place between nodes, where the surface of a cell from a file may "
            f'have blocks and grooves; use kind = "node" with node = its number in the file (on '
            f"the left section {node} is nearest to s = {point.s:.4g}) and an angle"
        )

    def _surface_of(self, node: int) -> tuple[str, float]:
        """The surface that a section node lies on, and where along it; "" and NaN for neither."""
        for name, surface in self.surfaces.items():
            fractions = surface.fractions()
            if node in fractions:
                return name, fractions[node]
        return "", float("nan")


def _driving_point(place: Place) -> Place:
    """The load's own place as a probe."""
    return replace(place, name=f"{place.name}.drive")
