"""Rules between the tables of a case.

They run on the file's plain data, so that they report even where a table is wrong otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from tyrefrf.case.faults import Fault, did_you_mean, shown
from tyrefrf.case.reach import reach_faults

REGIONS = ("tread", "belt", "bead")
"""Sub-tables of geometry that name a material of their own."""


def cross_faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield what is wrong between the tables of a case, given as plain data of any quality."""
    yield from _material_faults(_table(data, "geometry"), _table(data, "materials"))
    deflections = _table(data, "output").get("deflections", ())
    yield from reach_faults(_table(data, "materials"), data.get("frequency"), deflections)
    yield from _inflation_faults(_table(data, "inflation"), _table(data, "cell"))
    loads, probes = _entries(data, "loads"), _entries(data, "probes")
    hubs = [i for i, probe in probes.items() if probe.get("kind") == "hub"]
    for i in hubs[1:]:
        yield Fault(("probes", i, "kind"), "a second hub probe; one gives all six components")
    names = {i: probe.get("name", "hub" if i in hubs[:1] else None) for i, probe in probes.items()}
    load_names = {i: load.get("name") for i, load in loads.items()}
    yield from _repeated("loads", load_names)
    yield from _repeated("probes", names)
    yield from _reserved(names, load_names)
    moving = {i: name for i, name in names.items() if i not in hubs}
    yield from _measured_faults(_entries(data, "measured"), load_names, moving)
    yield from _of_regions(names, {i for i in probes if probes[i].get("kind") == "region"})


def _material_faults(geometry: dict[str, Any], materials: dict[str, Any]) -> Iterator[Fault]:
    used = _region_materials(geometry)
    if not materials or not all(isinstance(name, str) for name in used.values()):
        return  # the table's own error says it
    undefined = {key: str(name) for key, name in used.items() if name not in materials}
    defined = f"[materials] has {', '.join(shown(name) for name in materials)}"
    for key, name in undefined.items():
        message = f"undefined material {shown(name)}; {defined}{did_you_mean(name, materials)}"
        yield Fault(("geometry", *key), message)
    if undefined:
        return  # what seems unused may be what was meant
    for name in materials:
        if name not in used.values():
            regions = ", ".join(".".join(("geometry", *key)) for key in used)
            message = f"no region uses this material; remove it, or name it in {regions}"
            yield Fault(("materials", name), message)


def _region_materials(geometry: dict[str, Any]) -> dict[tuple[str, ...], object]:
    """The material that each region of the section names, by its key within geometry."""
    used: dict[tuple[str, ...], object] = {("material",): geometry.get("material")}
    for region in REGIONS:
        table = geometry.get(region)
        if table is not None:
            table = table if isinstance(table, dict) else {}
            used[region, "material"] = table.get("material")
    return used


def _inflation_faults(inflation: dict[str, Any], cell: dict[str, Any]) -> Iterator[Fault]:
    element = cell.get("element", "hex8i")
    if inflation.get("kind") == "nonlinear" and element in ("hex8i", "hex8"):
        message = f"'nonlinear' needs bricks with finite strains; cell.element is {shown(element)}"
        yield Fault(("inflation", "kind"), f"{message}; use hex20 or hex20r, or kind = 'linear'")


def _repeated(table: str, names: dict[int, object]) -> Iterator[Fault]:
    first: dict[str, int] = {}
    for i, name in names.items():
        if isinstance(name, str) and first.setdefault(name, i) != i:
            message = f"{shown(name)} is the name of {table}[{first[name]}] already; must be unique"
            yield Fault((table, i, "name"), message)


def _reserved(names: dict[int, object], load_names: dict[int, object]) -> Iterator[Fault]:
    drives = {f"{name}.drive": name for name in load_names.values() if isinstance(name, str)}
    for i, name in names.items():
        if isinstance(name, str) and name in drives:
            owner = f"the driving point of load {shown(drives[name])}"
            yield Fault(("probes", i, "name"), f"{shown(name)} is reserved for {owner}")


def _measured_faults(
    measured: dict[int, dict[str, Any]],
    load_names: dict[int, object],
    probe_names: dict[int, object],
) -> Iterator[Fault]:
    """Curves of loads and probes that the case has not."""
    loads = [name for name in load_names.values() if isinstance(name, str)]
    probes = [name for name in probe_names.values() if isinstance(name, str)]
    there = {"load": loads, "probe": [*(f"{name}.drive" for name in loads), *probes]}
    for i, entry in measured.items():
        for key, names in there.items():
            name = entry.get(key)
            if isinstance(name, str) and name not in names:
                hint = did_you_mean(name, names) or f"; there are {', '.join(names)}"
                yield Fault(("measured", i, key), f"no {key} {shown(name)} in this case{hint}")


def _of_regions(names: dict[int, object], regions: set[int]) -> Iterator[Fault]:
    owners = {names[i] for i in regions if isinstance(names[i], str)}
    for i, name in names.items():
        owner, dot, number = str(name).rpartition(".")
        if dot and number.isdecimal() and owner in owners:
            message = f"{shown(name)} is reserved for a point of region {shown(owner)}"
            yield Fault(("probes", i, "name"), message)


def _table(data: Mapping[str, Any], key: str) -> dict[str, Any]:
    table = data.get(key)
    return table if isinstance(table, dict) else {}


def _entries(data: Mapping[str, Any], key: str) -> dict[int, dict[str, Any]]:
    entries = data.get(key)
    if not isinstance(entries, list | tuple):
        return {}
    return {i: entry for i, entry in enumerate(entries) if isinstance(entry, dict)}
