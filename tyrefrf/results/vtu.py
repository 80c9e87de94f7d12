"""VTU: a deflection's real and imaginary parts as one XML file, for ParaView of any age.

Own code: pyevtk, the small library for it, has no text in field data. Inline binary, compressed.
Source: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

import sys
import zlib
from base64 import b64encode
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, ElementTree, SubElement

import numpy as np
from numpy.typing import NDArray

from tyrefrf.results import vtk_content as content
from tyrefrf.results.deflection import Deflection
from tyrefrf.results.ring_mesh import RingMesh
from tyrefrf.results.whole import whole_file

TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "u1": "UInt8"}


def write_vtu(path: str | Path, deflection: Deflection) -> None:
    """Write a deflection's real and imaginary parts.

    The directory is made, an existing file replaced. Raises ResultsError where it cannot be
    written.
    """
    path = Path(path)
    document = Element(
        "VTKFile",
        type="UnstructuredGrid",
        version="0.1",
        byte_order="LittleEndian" if sys.byteorder == "little" else "BigEndian",
        compressor="vtkZLibDataCompressor",
    )
    grid = SubElement(document, "UnstructuredGrid")
    _add_field_data(SubElement(grid, "FieldData"), deflection)
    mesh = deflection.mesh
    sizes = {"NumberOfPoints": str(len(mesh.points)), "NumberOfCells": str(len(mesh.bricks))}
    piece = SubElement(grid, "Piece", sizes)
    moving = content.parts(deflection) | content.cylindrical_parts(deflection)
    _add_all(SubElement(piece, "PointData", Vectors="displacement_real"), moving)
    _add_all(SubElement(piece, "CellData"), content.cell_data(mesh))
    _add_all(SubElement(piece, "Points"), {"Points": content.single(mesh.points)})
    _add_all(SubElement(piece, "Cells"), _bricks(mesh))
    with whole_file(path, make_directory=True) as temporary:
        ElementTree(document).write(temporary, encoding="utf-8", xml_declaration=True)


def _bricks(mesh: RingMesh) -> content.Arrays:
    n_bricks, n_corners = mesh.bricks.shape
    return {
        "connectivity": mesh.bricks.ravel().astype(np.int32),
        "offsets": n_corners * np.arange(1, n_bricks + 1, dtype=np.int32),
        "types": np.full(n_bricks, content.CELL_TYPES[n_corners], np.uint8),
    }


def _add_field_data(parent: Element, deflection: Deflection) -> None:
    """Numbers, and texts as VTK has them in XML: numbered bytes, ended by a zero."""
    for name, number in content.numbers(deflection).items():
        _add(parent, name, np.array([number]), NumberOfTuples="1")
    for name, text in content.texts(deflection).items():
        kind = {"type": "String", "Name": name, "NumberOfTuples": "1", "format": "ascii"}
        array = SubElement(parent, "DataArray", kind)
        array.text = " ".join(map(str, [*text.encode(), 0]))


def _add_all(parent: Element, arrays: content.Arrays) -> None:
    for name, array in arrays.items():
        _add(parent, name, array)


def _add(parent: Element, name: str, array: NDArray[Any], **more: str) -> None:
    """One array (n,) or (n, 3), of one compressed block."""
    if array.ndim == 2:
        more["NumberOfComponents"] = str(array.shape[1])
    kind = TYPES[array.dtype.str[1:]]
    element = SubElement(
        parent, "DataArray", {"type": kind, "Name": name, "format": "binary"} | more
    )
    packed = zlib.compress(array.tobytes(), 1)
    header = np.array([1, array.nbytes, 0, len(packed)], np.uint32)
    element.text = (b64encode(header.tobytes()) + b64encode(packed)).decode()
