"""VTKHDF 2.0: a deflection over one cycle, one static mesh in one HDF5 file, for ParaView.

Source: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/. The mesh and what
does not move are stored once; offsets of zero at every step point to them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tyrefrf.results import vtk_content as content
from tyrefrf.results.deflection import Deflection
from tyrefrf.results.file import hdf5_image
from tyrefrf.results.ring_mesh import RingMesh
from tyrefrf.results.whole import whole_file

N_PHASES = 24
"""Steps in a cycle, 15 degrees apart: an animation that loops looks smooth."""

PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def write_vtkhdf(path: str | Path, deflection: Deflection, n_phases: int = N_PHASES) -> None:
    """Write a deflection as a series of phases; the time of a step is its phase [deg].

    The directory is made, an existing file replaced. Raises ResultsError where it cannot be
    written.
    """
    import h5py

    with hdf5_image() as (file, image):
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = [2, 0]
        root.attrs.create(
            "Type",
            b"UnstructuredGrid",
            dtype=h5py.string_dtype("ascii", len("UnstructuredGrid")),
        )
        _write_mesh(root, deflection.mesh)
        steps = _write_steps(root, n_phases)
        _write_arrays(root, steps, deflection, n_phases)
        _write_field_data(root, steps, deflection, n_phases)
    with whole_file(Path(path), make_directory=True) as temporary:
        temporary.write_bytes(image.getbuffer())


def _write_mesh(root: Any, mesh: RingMesh) -> None:
    """Points and bricks, once."""
    n_bricks, n_corners = mesh.bricks.shape
    arrays = {
        "Points": content.single(mesh.points),
        "Connectivity": mesh.bricks.ravel(),
        "Offsets": n_corners * np.arange(n_bricks + 1),
        "Types": np.full(n_bricks, content.CELL_TYPES[n_corners], np.uint8),
    }
    for name, array in arrays.items():
        root.create_dataset(name, data=array, **PACKED)
    root["NumberOfPoints"] = [len(mesh.points)]
    root["NumberOfCells"] = [n_bricks]
    root["NumberOfConnectivityIds"] = [mesh.bricks.size]


def _write_steps(root: Any, n: int) -> Any:
    """The steps' times [deg] and where each finds the mesh: all at its beginning."""
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = n
    steps["Values"] = 360.0 * np.arange(n) / n
    steps["NumberOfParts"] = np.ones(n, np.int64)
    for name in ("PartOffsets", "PointOffsets"):
        steps[name] = np.zeros(n, np.int64)
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps[name] = np.zeros((n, 1), np.int64)
    return steps


def _write_arrays(root: Any, steps: Any, deflection: Deflection, n: int) -> None:
    """The phases one after another, and beside them what is the same at every step."""
    still, n_points = np.zeros(n, np.int64), len(deflection.u)
    for name, array in content.parts(deflection).items():
        root.create_dataset(f"PointData/{name}", data=array, **PACKED)
        steps[f"PointDataOffsets/{name}"] = still
    for name, array in content.cell_data(deflection.mesh).items():
        root.create_dataset(f"CellData/{name}", data=array, **PACKED)
        steps[f"CellDataOffsets/{name}"] = still
    for name, array in content.moment(deflection, 0.0).items():
        shape = (n * n_points, *array.shape[1:])
        root.create_dataset(
            f"PointData/{name}", shape, array.dtype, chunks=array.shape, **PACKED
        )  # a chunk to each phase
        steps[f"PointDataOffsets/{name}"] = n_points * np.arange(n)
    for k in range(n):
        for name, array in content.moment(deflection, 2.0 * np.pi * k / n).items():
            root[f"PointData/{name}"][k * n_points : (k + 1) * n_points] = array


def _write_field_data(root: Any, steps: Any, deflection: Deflection, n: int) -> None:
    """Texts and numbers, each of one value.

    VTK's reader takes text as variable-length ASCII only (UTF-8 fails in VTK 9.7), and asks for
    offset and size at every step. The bytes are UTF-8 all the same, and it shows them so.
    """
    import h5py

    for name, text in content.texts(deflection).items():
        root.create_dataset(
            f"FieldData/{name}", data=[text.encode()], dtype=h5py.string_dtype("ascii")
        )
    for name, number in content.numbers(deflection).items():
        root[f"FieldData/{name}"] = [number]
    for name in root["FieldData"]:
        steps[f"FieldDataOffsets/{name}"] = np.zeros(n, np.int64)
        steps[f"FieldDataSizes/{name}"] = np.ones((n, 2), np.int64)
