"""Materials laid at an angle that an element set of a mesh file gives."""

from __future__ import annotations

from collections.abc import Mapping

from tyrefrf.case.material import Isotropic, Material, Ply
from tyrefrf.case.mesh import MeshFile, Region


def laid_name(region: Region) -> str:
    """What the material of a region is called: its own name, and the angle where it has one."""
    if region.angle is None:
        return region.material
    return name_at(region.material, region.angle)


def name_at(material: str, angle: float) -> str:
    """What a material at another angle [deg] is called."""
    return f"{material} at {angle:.10g} deg"


def laid_materials(materials: Mapping[str, Material], mesh: MeshFile | None) -> dict[str, Material]:
    """The materials at angles of their own, by their `laid_name`; none without a mesh file."""
    regions = mesh.regions.values() if mesh is not None else ()
    return {
        laid_name(region): _turned(materials[region.material], region.angle)
        for region in regions
        if region.angle is not None
    }


def _turned(stuff: Material, angle: float) -> Material:
    """A material with its axis 1 at another angle [deg]; the case saw to it that it has one."""
    if isinstance(stuff, Ply):
        return stuff.model_copy(update={"angles": (angle,)})
    assert not isinstance(stuff, Isotropic)
    return stuff.model_copy(update={"angle": angle})
