"""Files for ParaView as VTK's own readers see them."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("vtkmodules", reason='vtk, of the extra "test", is not installed')

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader


class Grid:
    """An unstructured grid of VTK's: a copy, that its reader may go on."""

    def __init__(self, read):
        self.grid = grid = read.NewInstance()
        grid.DeepCopy(read)
        self.points = vtk_to_numpy(grid.GetPoints().GetData())
        self.n_cells = grid.GetNumberOfCells()
        self.types = {grid.GetCellType(i) for i in range(self.n_cells)}
        self.point_data = _arrays(grid.GetPointData())
        self.cell_data = _arrays(grid.GetCellData())
        self.field_data = _values(grid.GetFieldData())

    @property
    def volume(self):
        """Of every cell, as VTK's filter has it: curved ones as straight tetrahedra."""
        sizes = vtkCellSizeFilter()
        sizes.SetInputData(self.grid)
        sizes.Update()
        return vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume")).copy()

    @property
    def integrated_volume(self):
        """Of every cell, by VTK's shape functions."""
        return np.array([_integral(self.grid.GetCell(i)) for i in range(self.n_cells)])


def read_vtu(path) -> Grid:
    """A .vtu file."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return Grid(reader.GetOutput())


class Series:
    """A temporal .vtkhdf file."""

    def __init__(self, path):
        self.reader = vtkHDFReader()
        assert self.reader.CanReadFile(str(path))
        self.reader.SetFileName(str(path))
        self.reader.UpdateInformation()
        pipeline = self.reader.GetExecutive()
        self.times = np.array(self.reader.GetOutputInformation(0).Get(pipeline.TIME_STEPS()))

    def at(self, time) -> Grid:
        """The grid at a time."""
        self.reader.UpdateTimeStep(time)
        return Grid(self.reader.GetOutput())


def _arrays(data):
    names = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
    return {name: vtk_to_numpy(data.GetArray(name)) for name in names}


def _values(data):
    """The one value of every array of the field data."""
    arrays = [data.GetAbstractArray(i) for i in range(data.GetNumberOfArrays())]
    assert all(array.GetNumberOfValues() == 1 for array in arrays)
    return {array.GetName(): array.GetValue(0) for array in arrays}


def _integral(cell):
    """Volume of a cell by 3 Gauss points each way, as many as the solid's mass takes."""
    X = vtk_to_numpy(cell.GetPoints().GetData())
    x, w = np.polynomial.legendre.leggauss(3)
    volume, derivatives = 0.0, [0.0] * (3 * len(X))
    for i, j, k in np.ndindex(3, 3, 3):
        cell.InterpolateDerivs([(1.0 + x[n]) / 2.0 for n in (i, j, k)], derivatives)
        jacobian = np.reshape(derivatives, (3, len(X))) @ X
        volume += w[i] * w[j] * w[k] / 8.0 * np.linalg.det(jacobian)
    return volume
