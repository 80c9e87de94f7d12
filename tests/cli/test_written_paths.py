"""Whatever a case calls things, nothing is written outside of the output directory.

Every command that writes is given a case whose names would lead elsewhere if they were paths. What
Python opens to write, makes, renames and removes is listened to; what HDF5 writes by itself shows
in the tree, which is the same before and after but for the output directory.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import matplotlib
import pytest
import tomli_w
from command import command_here

from tests.faults.bases import lay_out

AWAY = "../../away"
NAMES = (AWAY, "/tmp/tyrefrf-away", "..", "a/b", "..\\..\\away", "~", "$HOME", "x" * 90, "*")
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
CHANGES = {
    "os.mkdir": 1,
    "os.rename": 2,
    "os.remove": 1,
    "os.rmdir": 1,
    "os.link": 2,
    "os.symlink": 2,
    "os.truncate": 1,
    "os.chmod": 1,
    "shutil.rmtree": 1,
}
"""What changes files, and how many of its arguments are paths."""

_heard: list[Path] | None = None


def _listen(event, arguments) -> None:
    if _heard is None:
        return
    paths = arguments[: CHANGES.get(event, 0)]
    if event == "open" and isinstance(arguments[2], int) and arguments[2] & WRITES:
        paths = arguments[:1]
    if event in ("os.remove", "os.rmdir", "os.mkdir") and arguments[-1] != -1:
        return  # within a directory that is removed as a whole, which was said before
    for path in paths:
        if isinstance(path, str | bytes | os.PathLike):
            where = os.path.abspath(os.fsdecode(path))  # noqa: PTH100  links are not followed
            _heard.append(Path(where))


sys.addaudithook(_listen)


@pytest.fixture
def written(monkeypatch):
    """Paths that were written, made or removed since."""
    heard: list[Path] = []
    monkeypatch.setattr(sys.modules[__name__], "_heard", heard)
    return heard


def hostile_case() -> str:
    """A case with a name like a path wherever a name may stand."""
    rubber = {"E": 80e6, "nu": 0.42, "rho": 1200.0, "eta": 0.1}
    data = {
        "title": AWAY,
        "geometry": {"elements_along": 8, "material": AWAY},
        "materials": {AWAY: rubber},
        "cell": {"sector_angle": 24.0},
        "frequency": {"values": [100.0, 200.0]},
        "loads": [
            {"name": name, "s": 0.3 + 0.04 * k, "direction": "r"} for k, name in enumerate(NAMES)
        ],
        "probes": [
            {"name": name, "s": 0.3 + 0.04 * k, "direction": "y"} for k, name in enumerate(NAMES)
        ],
        "measured": [
            {
                "file": "curve.csv",
                "name": AWAY,
                "quantity": "mobility",
                "load": NAMES[0],
                "probe": NAMES[0],
            }
        ],
        "output": {
            "plots": ["svg"],
            "export": ["csv", "mat", "uff58"],
            "deflections": [100.0],
        },
        "sweep": {f"eta_{AWAY}": [0.1, 0.2]},
    }
    return tomli_w.dumps(data)


@pytest.fixture(scope="module")
def ready(tmp_path_factory):
    """A directory with the case, deep enough that AWAY stays within the sandbox."""
    outside = tmp_path_factory.mktemp("outside")
    inside = outside / "up" / "inside"
    inside.mkdir(parents=True)
    lay_out(inside)
    (inside / "case.toml").write_text(hostile_case())
    (outside / "beside.txt").write_text("as it was")
    for command in ("run", "modes"):  # fills what libraries keep for the next time
        command_here(command, "case.toml", "--output", "first", cwd=inside)
    return outside, inside


def tree(outside: Path, but: Path) -> dict[str, bytes | None]:
    return {
        str(path): path.read_bytes() if path.is_file() else None
        for path in outside.rglob("*")
        if path != but and but not in path.parents
    }


ONE = ("--jobs", "1")
COMMANDS = {
    "run": ("run", "case.toml", *ONE, "--certify"),
    "sweep": ("sweep", "case.toml", *ONE),
    "modes": ("modes", "case.toml", "--count", "10", "--vtk", "2"),
    "dispersion": ("dispersion", "case.toml", *ONE, "--lines", "2"),
    "compare": ("compare", "case.toml", "--solvers", "cyclic,recursive", "--lines", "1"),
    "plot": ("plot", "first/case.h5"),
    "export": ("export", "first/case.h5", "--to", "csv,mat,uff58"),
    "export of fields": ("export", "first/case.h5", "--to", "vtk", "--at", "150"),
    "export of shapes": ("export", "first/case_modes.h5", "--to", "vtk", "--shapes", "1"),
}
LIBRARIES = [Path(matplotlib.get_cachedir()), Path(sys.prefix), Path("/dev"), Path("/proc")]


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_nothing_is_written_outside_of_the_output_directory(words, ready, written, request):
    outside, inside = ready
    output = inside / f"out-{request.node.callspec.id.replace(' ', '-')}"
    before = tree(outside, output)
    options = () if words[0] in ("check", "info") else ("--output", output.name)
    done = command_here(*words, *options, cwd=inside)
    assert done.status == 0, done
    assert list(output.rglob("*.*"))
    assert tree(outside, output) == before
    scratch = Path(tempfile.gettempdir())
    elsewhere = [
        path
        for path in written
        if not path.is_relative_to(output)
        and not any(path.is_relative_to(place) for place in LIBRARIES)
        and not path.relative_to(scratch).parts[:1][0].startswith("tyrefrf_")
    ]
    assert elsewhere == []
    assert any(path.is_relative_to(output) for path in written)


def test_without_an_output_directory_it_is_results_and_the_case_s_name(ready, written):
    outside, inside = ready
    before = tree(outside, inside / "results")
    assert command_here("run", "case.toml", *ONE, cwd=inside).status == 0
    assert tree(outside, inside / "results") == before
    assert [path.name for path in (inside / "results").iterdir()] == ["case"]


@pytest.mark.parametrize("name", ["..", "../up", "/tmp/up", "a/b", "a\\b", ".hidden", "~", "-rf"])
def test_a_case_s_own_name_is_no_way_out(name, ready):
    outside, inside = ready
    (inside / "named.toml").write_text(f"name = {tomli_w.dumps({'x': name})[4:]}{hostile_case()}")
    before = tree(outside, inside / "nothing")
    done = command_here("run", "named.toml", *ONE, cwd=inside)
    assert done.status == 2
    assert "named.toml:1: name: " in done.stderr
    assert tree(outside, inside / "nothing") == before


def test_a_link_in_the_output_directory_is_replaced_and_not_followed(ready):
    outside, inside = ready
    (inside / "linked").mkdir(exist_ok=True)
    (outside / "target.h5").write_text("as it was")
    (inside / "linked" / "case.h5").symlink_to(outside / "target.h5")
    done = command_here("run", "case.toml", *ONE, "--output", "linked", "--force", cwd=inside)
    assert done.status == 0, done
    assert (outside / "target.h5").read_text() == "as it was"
    assert not (inside / "linked" / "case.h5").is_symlink()
