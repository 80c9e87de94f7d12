"""One dataset of a results file: what writer and reader share.

Every dataset names its axes; an axis is itself a dataset of that name, an HDF5 dimension scale.
A dataset whose only axis is itself is such a scale.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Kind = Literal["text", "complex", "float", "int", "bool"]

DTYPES: dict[Kind, Any] = {
    "text": object,
    "complex": np.complex128,
    "float": np.float64,
    "int": np.int64,
    "bool": np.bool_,
}


@dataclass(frozen=True, slots=True)
class Field:
    """One dataset: its path, the paths of its axes, and how it is taken from what is stored.

    more: attributes of its own, beside units and long_name.
    """

    name: str
    axes: tuple[str, ...]
    kind: Kind
    units: str
    long_name: str
    value: Callable[[Any], ArrayLike]
    more: tuple[tuple[str, str], ...] = ()

    def of(self, stored: Any) -> NDArray[Any]:
        """The dataset's array."""
        return np.asarray(self.value(stored), dtype=DTYPES[self.kind])

    @property
    def group(self) -> str:
        """The group that the dataset is in; "" for the file's root."""
        return self.name.rpartition("/")[0]

    @property
    def is_scale(self) -> bool:
        """Whether this dataset is itself an axis."""
        return self.axes == (self.name,)


Dataset = tuple[Field, NDArray[Any]]
"""A dataset and its array."""

Columns = dict[str, NDArray[Any]]
"""The arrays of a file by the names of their fields."""
