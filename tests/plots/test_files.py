"""Every figure becomes a file of its own in the directory, and nothing leaves it."""

from __future__ import annotations

from dataclasses import replace

import matplotlib as mpl
import pytest
import synthetic

from tyrefrf.errors import ResultsError
from tyrefrf.plots import draw_plots
from tyrefrf.plots.files import FIGURES
from tyrefrf.results import Results

FEW = synthetic.LINES[::40]
MAGIC = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}


def named(*names: str) -> Results:
    """Results of radial loads with these names."""
    made = synthetic.results(FEW)
    loads = tuple(replace(made.loads[0], name=name) for name in names)
    return synthetic.results(FEW, loads=loads, probes=made.probes[:1])


def test_every_figure_is_written(tmp_path):
    written = draw_plots(synthetic.results(FEW), tmp_path / "plots")
    assert [path.name for path in written] == [
        "mobility_radial.png",
        "mobility_tangential.png",
        "driving_points.png",
        "blocked_force.png",
        "section.png",
    ]
    assert sorted((tmp_path / "plots").iterdir()) == sorted(written)


@pytest.mark.parametrize("form", ["png", "pdf", "svg"])
def test_formats_are_what_they_say(tmp_path, form):
    written = draw_plots(named("radial"), tmp_path, formats=(form,))
    assert {path.suffix for path in written} == {f".{form}"}
    assert all(path.read_bytes().startswith(MAGIC[form]) for path in written)


def test_several_formats_are_written_side_by_side(tmp_path):
    written = draw_plots(named("radial"), tmp_path, formats=("png", "svg"))
    assert [path.name for path in written[:2]] == ["mobility_radial.png", "mobility_radial.svg"]


def test_without_a_format_nothing_is_drawn(tmp_path, monkeypatch):
    drawn = FIGURES[type(synthetic.results())](synthetic.results())
    monkeypatch.setitem(FIGURES, type(synthetic.results()), lambda results: drawn)
    assert draw_plots(synthetic.results(), tmp_path / "plots", ()) == []
    assert not (tmp_path / "plots").exists()
    assert next(drawn)[0] == "mobility_radial"  # nobody has asked before


def test_letters_that_the_font_lacks_are_boxes_and_no_warnings(tmp_path):
    load = replace(synthetic.LOADS[0], name="轮胎")
    drive = replace(load, name="轮胎.drive")
    made = synthetic.results(loads=(load,), probes=(drive,))
    assert draw_plots(made, tmp_path)


def test_an_unknown_format_is_refused_before_anything_is_drawn(tmp_path):
    with pytest.raises(ResultsError, match="no plots in format gif; there are: png, pdf, svg"):
        draw_plots(named("radial"), tmp_path, formats=("png", "gif"))
    assert list(tmp_path.iterdir()) == []


def test_names_never_leave_the_directory(tmp_path):
    written = draw_plots(named("../../etc/x", "..", "C:\\y", "l" * 500), tmp_path / "plots")
    assert list(tmp_path.iterdir()) == [tmp_path / "plots"]
    assert all(path.parent == tmp_path / "plots" and path.is_file() for path in written)
    assert written[0].name == "mobility_.._.._etc_x.png"


def test_names_that_collide_are_numbered(tmp_path):
    written = draw_plots(named("a/b", "a b", "A_B"), tmp_path)
    assert [path.name for path in written[:3]] == [
        "mobility_a_b.png",
        "mobility_a_b-2.png",
        "mobility_A_B-3.png",
    ]


def test_a_split_figure_does_not_overwrite_a_load_of_that_name(tmp_path):
    probes = tuple(synthetic.place(f"p{i}", i / 20, "r") for i in range(1, 10))
    loads = tuple(replace(synthetic.LOADS[0], name=name) for name in ("a", "a_2"))
    written = draw_plots(synthetic.results(FEW, loads=loads, probes=probes), tmp_path)
    assert [path.name for path in written[:4]] == [
        "mobility_a.png",
        "mobility_a_2.png",
        "mobility_a_2-2.png",
        "mobility_a_2_2.png",
    ]


def test_the_users_matplotlib_settings_are_left_alone(tmp_path):
    with mpl.rc_context({"font.size": 7.5}):
        before = dict(mpl.rcParams)
        draw_plots(named("radial"), tmp_path)
        assert dict(mpl.rcParams) == before


def test_a_directory_that_cannot_be_made_is_a_clear_error(tmp_path):
    (tmp_path / "plots").write_text("a file", encoding="utf-8")
    with pytest.raises(ResultsError, match="cannot be written"):
        draw_plots(named("radial"), tmp_path / "plots")
