"""Rules between the tables of a case.

They run on the file's plain data, so that they report even where a table is wrong otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from tyrefrf.case.faults import Fault, did_you_mean, shown
from tyrefrf.case.laid import name_at
from tyrefrf.case.reach import reach_faults

SOURCES = ("geometry", "mesh", "matrices")
"""Tables that say what the tyre is; a case has one of them."""

REGIONS = ("tread", "belt", "bead")
"""Sub-tables of geometry that name a material of their own."""


def cross_faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield what is wrong between the tables of a case, given as plain data of any quality."""
    yield from _source_faults(data)
    yield from _material_faults(_regions(data), _table(data, "materials"))
    yield from _angle_faults(_table(data, "mesh"), _table(data, "materials"))
    yield from _around_faults(_table(data, "mesh"), _table(data, "cell"))
    if data.get("matrices") is not None:
        yield from _matrices_faults(data)
    deflections = _table(data, "output").get("deflections", ())
    yield from reach_faults(_table(data, "materials"), data.get("frequency"), deflections)
    parts = _table(_table(data, "matrices"), "K")
    yield from reach_faults(parts, data.get("frequency"), deflections, ("matrices", "K"))
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


def _source_faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """A case has exactly one of the tables that say what the tyre is."""
    there = [name for name in SOURCES if data.get(name) is not None]
    if not there:
        tables = " or ".join(f"[{name}]" for name in SOURCES)
        yield Fault(SOURCES[:1], f"missing: the section of the tyre; give {tables}")
    for name in there[1:]:
        yield Fault((name,), f"not together with [{there[0]}]; give one of the two")
    if "matrices" not in there and data.get("materials", {}) == {}:
        found = "missing: materials by name, as [materials.rubber]"
        if "materials" in data:
            found = "is empty; must have at least 1"
        yield Fault(("materials",), found)


def _matrices_faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """What brought matrices hold already, or cannot be given any more."""
    if _table(data, "materials"):
        message = "not together with [matrices], which hold the stiffness and the mass"
        yield Fault(("materials",), f"{message}; give losses as matrices.K.<part>.eta")
    cell = _table(data, "cell")
    for key, default in (("elements_around", 1), ("element", "hex8i")):
        if cell.get(key, default) != default:
            yield Fault(("cell", key), "not together with [matrices]: there are no elements")
    if _table(data, "output").get("deflections"):
        message = "not together with [matrices]: there are no elements to draw"
        yield Fault(("output", "deflections"), message)
    if _table(data, "inflation").get("pressure", 0.0) not in (0, 0.0):
        message = "not together with [matrices]: there is no surface to press on"
        yield Fault(
            ("inflation", "pressure"),
            f"{message}; bring the stiffness of the inflated tyre as matrices.K_G, or within K",
        )


def _material_faults(
    used: dict[tuple[str, ...], object], materials: dict[str, Any]
) -> Iterator[Fault]:
    """Regions without a material, and materials without a region."""
    if not used or not materials or not all(isinstance(name, str) for name in used.values()):
        return  # the table's own error says it
    undefined = {key: str(name) for key, name in used.items() if name not in materials}
    defined = f"[materials] has {', '.join(shown(name) for name in materials)}"
    for key, name in undefined.items():
        message = f"undefined material {shown(name)}; {defined}{did_you_mean(name, materials)}"
        yield Fault(key, message)
    if undefined:
        return  # what seems unused may be what was meant
    for name in materials:
        if name not in used.values():
            regions = ", ".join(".".join(key) for key in used)
            message = f"no region uses this material; remove it, or name it in {regions}"
            yield Fault(("materials", name), message)


def _regions(data: Mapping[str, Any]) -> dict[tuple[str, ...], object]:
    """The material that each region of the tyre names, by its key."""
    if data.get("mesh") is not None:
        sets = _table(_table(data, "mesh"), "materials")
        return {
            ("mesh", "materials", name): entry.get("material") if isinstance(entry, dict) else entry
            for name, entry in sets.items()
        }
    geometry = _table(data, "geometry")
    if data.get("geometry") is None:
        return {}
    used: dict[tuple[str, ...], object] = {("geometry", "material"): geometry.get("material")}
    for region in REGIONS:
        table = geometry.get(region)
        if table is not None:
            table = table if isinstance(table, dict) else {}
            used["geometry", region, "material"] = table.get("material")
    return used


def _angle_faults(mesh: dict[str, Any], materials: dict[str, Any]) -> Iterator[Fault]:
    """Sets that turn what has no one axis to turn."""
    for name, entry in _table(mesh, "materials").items():
        if not isinstance(entry, dict) or entry.get("angle") is None:
            continue
        key = ("mesh", "materials", name, "angle")
        stuff = _table(materials, str(entry.get("material")))
        kind, called = stuff.get("kind", "isotropic"), shown(entry.get("material"))
        if (
            isinstance(entry["angle"], float)
            and name_at(entry["material"], entry["angle"]) in materials
        ):
            yield Fault(key, f"{called} at this angle is called as another material; rename that")
        if stuff and kind == "isotropic":
            yield Fault(key, f"{called} is isotropic: it has no axis to turn")
        angles = stuff.get("angles")
        if kind == "ply" and isinstance(angles, list | tuple) and len(angles) > 1:
            message = f"{called} has plies at {len(angles)} angles; give each angle its own set"
            yield Fault(key, f"{message}, or a material of its own")


def _around_faults(mesh: dict[str, Any], cell: dict[str, Any]) -> Iterator[Fault]:
    if mesh.get("kind") == "cell" and cell.get("elements_around", 1) != 1:
        message = "not with mesh.kind = 'cell': the file has its own elements around; leave it out"
        yield Fault(("cell", "elements_around"), message)


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
