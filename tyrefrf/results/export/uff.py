"""Universal files (UFF, also .unv): header, units, geometry, and a dataset 58 per response.

Written by pyuff, in ASCII: pyuff 2.5.8 states a third of the bytes that its binary complex data
have, and other programs misread it. ASCII holds 12 digits of a value, and 6 of a frequency:

- lines are stored as first line and step where 6 digits reproduce every one of them, as at
  0, 5, 10 Hz; otherwise, as with a step of 1/3 Hz, line by line, each with 6 digits, so that
  their errors do not add up;
- lines that 6 digits cannot tell apart are refused.

A line without an answer is left out, as the format has no word for one, and the others are stored
line by line. Text is ASCII, 80 characters at most: accents are dropped, other letters become "?".

Source: Universal file formats, datasets 15, 18, 58, 82, 151, 164, SDRL of the University of
Cincinnati.
"""

from __future__ import annotations

import unicodedata
from collections import Counter
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.errors import ResultsError
from tyrefrf.results.derived import UNITS
from tyrefrf.results.export.geometry import (
    FIRST_SYSTEM,
    Geometry,
    axes_at,
    direction_code,
    geometry_of,
    hub_code,
)
from tyrefrf.results.results import Quantity, Results

DataSet = dict[str, Any]
"""A dataset in pyuff's own words."""

FREQUENCY_RESPONSE, FREQUENCY, EXCITATION_FORCE, REACTION_FORCE = 4, 18, 13, 9
ORDINATES: dict[Quantity, tuple[int, str, str]] = {
    "receptance": (8, "Displacement", "m"),
    "mobility": (11, "Velocity", "m/s"),
    "accelerance": (12, "Acceleration", "m/s^2"),
}
"""Codes of dataset 58 for what is on the ordinate, its label and its units."""

KEPT = 1e-9
"""How nearly, relatively, first line and step have to give every line to be stored instead."""

WIDTH = 80
PLACE_COLOUR, CORNER_COLOUR, LINE_COLOUR = 11, 8, 7


def write_uff(path: Path, results: Results, quantity: Quantity, point: str = "") -> None:
    """Write a run's responses to a universal file that is not there yet.

    quantity: what the responses are. point: which one of a sweep, in words.
    Raises ResultsError where a frequency line cannot be told from its neighbour.
    """
    import pyuff

    class File(pyuff.UFF):  # type: ignore[misc]  # pyuff has no types
        """A file that is not read again after each dataset, which would take n^2 time."""

        def refresh(self) -> bool:
            return True

    geometry = geometry_of(results)
    File(str(path)).write_sets(list(_datasets(results, geometry, quantity, point)), "add")


def _datasets(
    results: Results, geometry: Geometry, quantity: Quantity, point: str
) -> Iterator[DataSet]:
    yield _header(results, point)
    yield _units()
    if len(geometry.angles):
        yield _systems(geometry.angles)
    yield _nodes(geometry)
    for number, (name, nodes) in enumerate(geometry.lines, start=1):
        yield {
            "type": 82,
            "trace_num": number,
            "n_nodes": len(nodes),
            "color": LINE_COLOUR,
            "id": ascii_line(name),
            "nodes": nodes,
        }
    yield from _functions(results, geometry, quantity, point)


def _header(results: Results, point: str) -> DataSet:
    origin = results.provenance
    date, time = _written(origin.created).split(" ")
    program = f"tyrefrf {origin.version}"
    return {
        "type": 151,
        "model_name": ascii_line(origin.case_name),
        "description": ascii_line("; ".join(filter(None, [point, origin.title]))),
        "db_app": program,
        "version_db1": 0,
        "version_db2": 0,
        "file_type": 0,
        "date_db_created": date,
        "time_db_created": time,
        "date_db_saved": date,
        "time_db_saved": time,
        "program": program,
        "date_file_written": date,
        "time_file_written": time,
    }


def _units() -> DataSet:
    """SI: every factor 1, temperatures relative to 273.15 K."""
    return {
        "type": 164,
        "units_code": 1,
        "units_description": "SI: m, N",
        "temp_mode": 2,
        "length": 1.0,
        "force": 1.0,
        "temp": 1.0,
        "temp_offset": 273.15,
    }


def _systems(angles: FloatArray) -> DataSet:
    """Cartesian systems with X = r, Y = y, Z = theta at each angle."""
    axes = [axes_at(angle) for angle in angles]
    n = len(angles)
    return {
        "type": 18,
        "cs_num": FIRST_SYSTEM + np.arange(n),
        "cs_type": np.zeros(n, int),
        "ref_cs_num": np.zeros(n, int),
        "color": np.full(n, CORNER_COLOUR),
        "method": np.ones(n, int),
        "cs_name": [f"r, y, theta at {np.rad2deg(angle):.6g} deg" for angle in angles],
        "ref_o": np.zeros((n, 3)),
        "x_point": np.array([axis["r"] for axis in axes]),
        "xz_point": np.array([axis["theta"] for axis in axes]),
    }


def _nodes(geometry: Geometry) -> DataSet:
    x, y, z = geometry.points.T
    n_places = len(geometry.nodes) + bool(geometry.hub)
    colour = np.where(np.arange(len(x)) < n_places, PLACE_COLOUR, CORNER_COLOUR)
    return {
        "type": 15,
        "node_nums": geometry.numbers,
        "def_cs": np.zeros(len(x), int),
        "disp_cs": geometry.systems,
        "color": colour,
        "x": x,
        "y": y,
        "z": z,
    }


def _functions(
    results: Results, geometry: Geometry, quantity: Quantity, point: str
) -> Iterator[DataSet]:
    """A dataset 58 for every response of a probe and every blocked force, load by load."""
    answered = ~results.failed
    stored = _abscissa(results.frequency[answered])
    code, label, units = ORDINATES[quantity]
    response = getattr(results, quantity)
    seen: Counter[tuple[int, ...]] = Counter()
    for i, load in enumerate(results.loads):
        reference = geometry.node(load), direction_code(load)
        common = stored | {
            "id4": ascii_line(load.name),
            "ref_node": reference[0],
            "ref_dir": reference[1],
        }
        for j, probe in enumerate(results.probes):
            dof = geometry.node(probe), direction_code(probe)
            seen[*reference, *dof] += 1
            title = f"{quantity} [{UNITS[quantity]}] {probe.direction} / {load.direction}"
            yield (
                common
                | _function(results, title, point, response[i, j, answered])
                | {
                    "id5": ascii_line(probe.name),
                    "ver_num": seen[*reference, *dof],  # several probes may read one dof
                    "rsp_node": dof[0],
                    "rsp_dir": dof[1],
                    "ordinate_spec_data_type": code,
                    "ordinate_axis_lab": label,
                    "ordinate_axis_units_lab": units,
                }
            )
        for component, force in zip(results.hub, results.blocked_force[i], strict=True):
            moment = component.startswith("M")
            title = f"blocked hub {component} [{'N m/N' if moment else 'N/N'}] / {load.direction}"
            yield (
                common
                | _function(results, title, point, force[answered])
                | {
                    "id5": f"hub {component}",
                    "ver_num": 1,
                    "rsp_node": geometry.hub,
                    "rsp_dir": hub_code(component),
                    "ordinate_spec_data_type": REACTION_FORCE,
                    "ordinate_axis_lab": "Moment" if moment else "Force",
                    "ordinate_axis_units_lab": "N m" if moment else "N",
                }
            )


def _function(results: Results, title: str, point: str, data: ComplexArray) -> DataSet:
    """What every dataset 58 has."""
    origin = results.provenance
    left_out = f"; {results.n_failed} lines without answer left out" if results.n_failed else ""
    run = ", ".join(filter(None, [point, origin.case_name, origin.case_hash[:12], origin.solver]))
    axes = ("abscissa", "ordinate", "orddenom", "z_axis")
    exponents = {f"{axis}_{kind}_unit_exp": 0 for axis in axes for kind in ("len", "force", "temp")}
    return exponents | {
        "type": 58,
        "binary": 0,
        "id1": ascii_line(title + left_out),
        "id2": ascii_line(run),
        "id3": _written(origin.created),
        "func_type": FREQUENCY_RESPONSE,
        "func_id": 0,
        "load_case_id": 0,
        "rsp_ent_name": "NONE",
        "ref_ent_name": "NONE",
        "data": data,
        "abscissa_spec_data_type": FREQUENCY,
        "abscissa_axis_lab": "Frequency",
        "abscissa_axis_units_lab": "Hz",
        "orddenom_spec_data_type": EXCITATION_FORCE,
        "orddenom_axis_lab": "Excitation force",
        "orddenom_axis_units_lab": "N",
        "z_axis_spec_data_type": 0,
        "z_axis_axis_lab": "NONE",
        "z_axis_axis_units_lab": "NONE",
        "z_axis_value": 0.0,
    }


def _abscissa(frequency: FloatArray) -> DataSet:
    """How the lines (f,) [Hz] are stored: as first line and step, or each."""
    if not len(frequency):
        raise ResultsError("no line has an answer: a universal file would be empty")
    if len(frequency) == 1:  # pyuff takes the step from the first two
        return {"x": np.repeat(frequency, 2), "abscissa_spacing": 1}
    rounded = _six_digits(frequency)
    first, step = rounded[0], float(_six_digits(np.array([frequency[1] - frequency[0]]))[0])
    even = first + step * np.arange(len(frequency))
    if np.allclose(even, frequency, rtol=KEPT, atol=0.0):
        return {"x": even, "abscissa_spacing": 1}
    same = np.flatnonzero(np.diff(rounded) <= 0.0)
    if len(same):
        k = int(same[0])
        raise ResultsError(
            f"the lines {frequency[k]:.12g} and {frequency[k + 1]:.12g} Hz are the same in the six "
            "digits of a universal file; give lines further apart, or export csv or mat"
        )
    return {"x": frequency, "abscissa_spacing": 0}


def _six_digits(values: FloatArray) -> FloatArray:
    """Values as the format E13.5 has them."""
    return np.array([float(f"{value:.5e}") for value in values])


def _written(created: str) -> str:
    """A date as universal files have it: `22-Nov-26 07:00:00`."""
    return datetime.fromisoformat(created).strftime("%d-%b-%y %H:%M:%S")


def ascii_line(text: str) -> str:
    """A text as one line of a universal file."""
    plain = unicodedata.normalize("NFKD", text.replace("\N{MICRO SIGN}", "u"))
    kept = "".join(letter for letter in plain if not unicodedata.combining(letter))
    return " ".join(kept.encode("ascii", "replace").decode().split())[:WIDTH].rstrip() or "NONE"
