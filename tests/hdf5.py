"""What a results file owes to those who open it without this program."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path

import h5py

from tyrefrf.results.seal import seal


def undescribed(path):
    """Names of the datasets that lack a scale on an axis, units, or a long name."""
    bare = []

    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            scaled = item.is_scale or all(len(dim) == 1 for dim in item.dims)
            if not (scaled and item.attrs["long_name"] and "units" in item.attrs):
                bare.append(name)

    with h5py.File(path) as file:
        file.visititems(visit)
    return bare


def differences(path, other, own=()):
    """Names of what two files do not have alike, to the bit: datasets, types, attributes.

    own: names of datasets and attributes whose values may differ.
    """
    one, another = told(path, own), told(other, own)
    return sorted(
        name for name in one.keys() | another.keys() if one.get(name) != another.get(name)
    )


def told(path, own):
    """Everything in a file by its name; references between datasets are not followed."""
    found = {}

    def visit(name, item):
        for key, value in item.attrs.items():
            if key not in own and key not in ("DIMENSION_LIST", "REFERENCE_LIST"):
                found[f"{name}@{key}"] = str(value)
        if isinstance(item, h5py.Dataset):
            value = item[...]
            whole = value.tolist() if value.dtype.kind == "O" else value.tobytes()
            found[name] = (item.shape, str(item.dtype), () if name in own else whole)

    with h5py.File(path) as file:
        visit("", file)
        file.visititems(visit)
    return found


@contextmanager
def changed(path: Path):
    """A results file, open to be changed; sealed again, as another version would have."""
    with h5py.File(path, "r+") as file:
        yield file
    seal_again(path)


def seal_again(path: Path) -> None:
    """Seal a file that a test has changed, as another version of the program would have."""
    with path.open("rb+") as file:
        seal(file)
