"""What a results file owes to those who open it without this program."""

from __future__ import annotations

import h5py


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
