"""The command line: run, sweep, compare, modes, dispersion, check, plot, export, info and others.

Results go to stdout, progress and messages to stderr. Exit status 0: complete; 1: the run or some
lines failed, or breached their proof; 2: the case or the command line is wrong.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Optional

import typer

from tyrefrf.cli.interrupt import Interrupted, heeding_signals
from tyrefrf.cli.sweeping import InOrder
from tyrefrf.errors import (
    CaseError,
    CommandError,
    MeshError,
    ResultsError,
    SolveError,
    TyreFRFError,
    short_of_memory,
)
from tyrefrf.limits import LEAST, room_of_process
from tyrefrf.study.local import ONE_THREAD

NO_ROOM = "failed to map segment"
"""What the loader says of a library for which there is no memory."""

app = typer.Typer(
    help="Tyre vibrations to 3 kHz from one angular cell, by the recursive wave finite element "
    "method. Start with: tyrefrf init; tyrefrf check case.toml; tyrefrf run case.toml",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


class SolverName(StrEnum):
    """The solvers; all give the same answer, but modal is truncated."""

    recursive = "recursive"
    cyclic = "cyclic"
    direct = "direct"
    modal = "modal"
    auto = "auto"


class PlotFormat(StrEnum):
    """Formats of the plots."""

    png = "png"
    pdf = "pdf"
    svg = "svg"


class QuantityName(StrEnum):
    """Responses per unit force (ISO 7626-1)."""

    mobility = "mobility"
    receptance = "receptance"
    accelerance = "accelerance"


CaseFile = Annotated[
    Optional[Path],  # noqa: UP045  typer reads it so
    typer.Argument(metavar="CASE", help="Case file (TOML); the built-in tyre without one."),
]
ResultsFile = Annotated[Path, typer.Argument(metavar="RESULTS", help="Results file (HDF5).")]
Jobs = Annotated[
    Optional[int],  # noqa: UP045
    typer.Option(min=1, help="Processes; all cores by default. Results do not depend on it."),
]
Scheduler = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        metavar="ADDRESS",
        help="Workers of a dask scheduler instead of this machine's: its address "
        "(tcp://host:8786) or its file.",
    ),
]
SolverOption = Annotated[
    Optional[SolverName],  # noqa: UP045
    typer.Option("--solver", help="Solver instead of the case's."),
]
Json = Annotated[bool, typer.Option("--json", help="One JSON object on stdout, nothing else.")]
Force = Annotated[bool, typer.Option("--force", help="Replace what is there.")]
Resume = Annotated[
    bool,
    typer.Option(
        "--resume",
        help="Go on with a run that was ended: only the lines that are missing or failed.",
    ),
]
Formats = Annotated[
    Optional[list[PlotFormat]],  # noqa: UP045
    typer.Option("--format", help="Plot format instead of the case's; may be repeated."),
]


@app.command()
def run(
    case: CaseFile = None,
    output: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Directory; results/<case name> by default."),
    ] = None,
    solver: SolverOption = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    formats: Formats = None,
    certify: Annotated[
        bool,
        typer.Option(
            "--certify",
            help="Solve a sample of the lines by another solver, and by cells of half the angle.",
        ),
    ] = False,
    resume: Resume = False,
    force: Force = False,
    json: Json = False,
) -> None:
    """Compute the responses that CASE describes.

    Writes DIR/<case name>.h5 and DIR/plots/, and prints a summary with the proof of every line:
    its residual, passivity and reciprocity. A line whose process is killed is tried once more; what
    kills it again is a failed line, and the others are kept. Exits 0 when every line has its
    answer and proof, 1 when some have not, 2 when the case is wrong, 129, 130 or 143 when it is
    ended by SIGHUP, Ctrl-C or SIGTERM.

    Every line is in DIR/<case name>.journal as soon as it is solved: whatever ends the run, even
    kill -9, --resume computes only the rest, and info and plot show what is there so far. It starts
    from the beginning where nothing is there, and is refused where the case has changed.

    More than one machine: dask scheduler; dask worker ADDRESS --nworkers 8 --nthreads 1 on each;
    then --scheduler ADDRESS. Needs pip install "tyrefrf[cluster]". On SLURM, dask-jobqueue
    starts them: see docs/howto/clusters.md.

    For example:

    \b
      tyrefrf run case.toml
      tyrefrf run case.toml --solver cyclic --jobs 1 --format png --format pdf
      tyrefrf run case.toml --certify
      tyrefrf run case.toml --resume
      tyrefrf run case.toml --scheduler tcp://host:8786
      tyrefrf run case.toml --json > summary.json
    """
    from tyrefrf.cli.running import run_to_files

    raise typer.Exit(
        run_to_files(
            case,
            output,
            solver,
            jobs,
            scheduler,
            _names(formats),
            certify=certify,
            resume=resume,
            force=force,
            json=json,
        )
    )


@app.command(cls=InOrder)
def sweep(
    context: typer.Context,
    case: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Argument(
            metavar="CASE",
            help="Case file (TOML); without one case.toml here, or else the built-in tyre.",
        ),
    ] = None,
    param: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(
            metavar="NAME",
            help="Parameter by place (materials.rubber.E) or short name (E_rubber, pressure, "
            "sector_angle, crown); NAME=a,b,c names its values too. Several make a grid.",
        ),
    ] = None,
    values: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(metavar="A,B,C", help='Values of the last --param, such as "14,28,56 MPa".'),
    ] = None,
    range_: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option("--range", metavar="A:B:N", help="N values from A to B, evenly spaced."),
    ] = None,
    log: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(metavar="A:B:N", help="N values from A to B, evenly spaced in logarithm."),
    ] = None,
    output: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Directory; results/<case name>_sweep by default."),
    ] = None,
    solver: SolverOption = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    formats: Formats = None,
    resume: Resume = False,
    force: Force = False,
    json: Json = False,
) -> None:
    """Compute CASE for values of its parameters.

    Without values, a parameter takes those of the case's [sweep] table. Several parameters make
    a grid. All points are checked before the first is computed. Writes DIR/<case name>_sweep.h5
    with the parameters as leading dimensions, and DIR/plots/. Exits, and can be gone on with, as
    run does.

    For example:

    \b
      tyrefrf sweep --param E_rubber
      tyrefrf sweep case.toml --param E_rubber --values "14,28,56 MPa"
      tyrefrf sweep case.toml --param sector_angle --values 4,8 --param eta_rubber --log 0.01:1:5
      tyrefrf sweep case.toml --param E_rubber --values "14,28,56 MPa" --resume
    """
    from tyrefrf.cli.sweeping import sweep_to_files

    given = context.meta["given"]
    raise typer.Exit(
        sweep_to_files(
            case,
            given,
            output,
            solver,
            jobs,
            scheduler,
            _names(formats),
            resume=resume,
            force=force,
            json=json,
        )
    )


@app.command()
def compare(
    case: CaseFile = None,
    solvers: Annotated[
        str,
        typer.Option(
            metavar="A,B,...",
            help="Solvers by name, each once: recursive, cyclic, direct, modal.",
        ),
    ] = "recursive,cyclic,direct",
    lines: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option(min=1, metavar="N", help="So many of CASE's lines, evenly picked; all."),
    ] = None,
    output: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Directory; results/<case name> by default."),
    ] = None,
    formats: Formats = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Solve CASE's lines by several solvers.

    Says what each takes and how far they differ. A table like the paper's table 2: CPU time per
    line, peak memory, size on disk, difference to direct (to the first solver named, without
    direct). The solvers work one after another, each in a process of its own, one thread; one that
    runs out of memory leaves the others their rows. The solver that CASE itself names keeps its
    options. Writes DIR/<case name>_comparison.h5, .md, and overlays of the mobilities in
    DIR/plots/. Exits 0 when every solver has answered every line, else 1; 2 when the case or a name
    is wrong.

    For example:

    \b
      tyrefrf compare case.toml
      tyrefrf compare case.toml --solvers recursive,direct --lines 20
      tyrefrf compare case.toml --solvers recursive,cyclic,direct,modal --json > table.json
    """
    from tyrefrf.cli.comparing import Asked, compare_to_files

    names = tuple(name.strip() for name in solvers.split(",") if name.strip())
    asked = Asked(names, lines, output, _names(formats), force=force, json=json)
    raise typer.Exit(compare_to_files(case, asked))


@app.command()
def modes(
    case: CaseFile = None,
    count: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option(
            min=1,
            metavar="N",
            help="The lowest N modes, both members of every pair counted; 100 by default.",
        ),
    ] = None,
    below: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option(min=1e-3, metavar="HZ", help="All modes below HZ instead."),
    ] = None,
    at: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option(
            min=0.0,
            metavar="HZ",
            help="Take moduli that depend on frequency at HZ; without it, every mode at its own "
            "frequency.",
        ),
    ] = None,
    at_rest: Annotated[
        bool, typer.Option("--at-rest", help="Leave the case's inflation away.")
    ] = False,
    vtk: Annotated[
        int,
        typer.Option(
            min=0, metavar="N", help="Write the N lowest shapes for ParaView, and draw them in 3-D."
        ),
    ] = 0,
    output: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Directory; results/<case name>_modes by default."),
    ] = None,
    formats: Formats = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Compute natural modes by order, all of them.

    Modes are those without loss; their loss factors follow from the strain energy in every
    material. None is missing: their number is held against a count by inertia at every order.
    A ring of N cells knows the number n of nodal diameters only modulo N: order h stands for
    n = h, N - h, N + h, and so on. Writes DIR/<case name>_modes.h5 and DIR/plots/, and prints the
    lowest modes. Exits 0, 1 when the count is not met, 2 when the case is wrong or the tyre
    buckles under its pressure.

    For example:

    \b
      tyrefrf modes case.toml
      tyrefrf modes case.toml --below 500 --at-rest
      tyrefrf modes case.toml --count 40 --vtk 6
      tyrefrf modes case.toml --count 400 --at 200 --json > modes.json
    """
    from tyrefrf.cli.modes import modes_to_files

    raise typer.Exit(
        modes_to_files(
            case,
            output,
            count,
            below,
            at,
            _names(formats),
            vtk=vtk,
            at_rest=at_rest,
            force=force,
            json=json,
        )
    )


@app.command()
def dispersion(
    case: CaseFile = None,
    lines: Annotated[
        int,
        typer.Option(
            min=1,
            max=100_000,
            metavar="N",
            help="Frequencies, evenly spread over the case's range, without 0.",
        ),
    ] = 100,
    decay: Annotated[
        float,
        typer.Option(
            min=0.01,
            max=200.0,
            metavar="DB",
            help="Waves that lose up to DB decibels in a radian, 57 degrees, of the tyre; 20: to "
            "a tenth.",
        ),
    ] = 20.0,
    at_rest: Annotated[
        bool, typer.Option("--at-rest", help="Leave the case's inflation away.")
    ] = False,
    output: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Directory; results/<case name>_dispersion by default."),
    ] = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    formats: Formats = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Compute the free waves of CASE's cell.

    Their circumferential order and decay over frequency. A free wave passes from cell to cell
    without a load, q ~ exp(-(decay + i order) theta), running or dying away in the sense of +theta;
    its partner runs the other way. Order is a real number: where it is whole and the decay small,
    the ring resonates. None is missing: the waves within the bound are counted by the argument
    principle. A ring of N cells knows the order only modulo N, from -N/2 to N/2; it is negative
    where phase and energy run against each other. Writes DIR/<case name>_dispersion.h5 and
    DIR/plots/, and prints a summary. Exits 0 when the waves of every line are proved to be all, 1
    when not, 2 when the case is wrong.

    For example:

    \b
      tyrefrf dispersion case.toml
      tyrefrf dispersion case.toml --lines 300 --decay 10 --at-rest
      tyrefrf dispersion case.toml --jobs 1 --json > waves.json
    """
    from tyrefrf.cli.dispersion import dispersion_to_files

    raise typer.Exit(
        dispersion_to_files(
            case,
            output,
            lines,
            decay,
            jobs,
            scheduler,
            _names(formats),
            at_rest=at_rest,
            force=force,
            json=json,
        )
    )


@app.command()
def check(
    case: CaseFile = None, solver: SolverOption = None, jobs: Jobs = None, json: Json = False
) -> None:
    """Say what CASE would compute and cost.

    And how finely it is meshed. Computes nothing. Exits 2 when the case is wrong, with every
    problem of the file.
    """
    from tyrefrf.cli.running import check_case

    check_case(case, solver, jobs, json=json)


@app.command()
def plot(
    results: ResultsFile,
    output: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Directory; plots/ beside the results by default."),
    ] = None,
    formats: Formats = None,
) -> None:
    """Draw the plots of RESULTS again.

    Whatever command made them.
    """
    from tyrefrf.plots import draw_plots
    from tyrefrf.results import load_any

    directory, forms = output or results.parent / "plots", _names(formats) or ("png",)
    for path in draw_plots(load_any(results), directory, forms):
        typer.echo(str(path))


@app.command()
def export(
    results: ResultsFile,
    to: Annotated[
        str,
        typer.Option(
            metavar="A,B,...",
            help="Formats: uff58 (universal file, needs pyuff), csv, mat (MATLAB, Octave), vtk "
            "(ParaView: how the whole tyre moves).",
        ),
    ],
    quantity: Annotated[
        QuantityName, typer.Option(help="Displacement, velocity or acceleration per unit force.")
    ] = QuantityName.mobility,
    output: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Directory; beside RESULTS by default."),
    ] = None,
    reference: Annotated[
        str,
        typer.Option(
            metavar="X",
            help="What levels in dB are relative to: a number in SI, or iso1683 (1 nm/s over "
            "1 uN for a mobility).",
        ),
    ] = "1",
    at: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(
            metavar="HZ",
            help='vtk, of a run: frequency of a deflection, 250 or "100 Hz"; may be repeated. '
            "Those of the case's output.deflections by default.",
        ),
    ] = None,
    shapes: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option(min=1, metavar="N", help="vtk, of modes: the N lowest shapes; 6 by default."),
    ] = None,
    files: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(
            metavar="DIR",
            help="vtk, of a run: where the files are that its case names (the case file's "
            "directory); here by default.",
        ),
    ] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Write the responses of a run or sweep, or how a whole tyre moves, for other programs.

    Beside RESULTS and named after it: NAME.uff, a universal file with a dataset 58 for every
    response, geometry and SI units, for modal software; NAME.csv, the lines, and NAME_bands.csv,
    one-third-octave bands as rms and level; NAME.mat, all of it. Where --quantity
    is another than mobility, NAME ends with it. A region of the case (a probe of kind "region") has
    its mean square over the area in all but the universal file. Of a sweep, the tables have the
    parameters as columns, and every point is a universal file of its own.
    The results file itself opens in xarray (engine h5netcdf) and in MATLAB (h5read).

    vtk writes fields/*.vtkhdf (a period in phases, ParaView 5.12) and fields/*.vtu. A file of modes
    has its shapes; of a run, the case in the file is solved again, with the file's own materials
    and solver, at the frequencies asked for. What else the case names (a mesh file) has to be there
    as it was. Exits 1 where a frequency has no answer.

    For example:

    \b
      tyrefrf export results/case/case.h5 --to csv
      tyrefrf export results/case/case.h5 --to vtk --at "100 Hz" --at 250
      tyrefrf export results/case_modes/case_modes.h5 --to vtk --shapes 12
      tyrefrf export results/case/case.h5 --to uff58,mat --quantity accelerance
      tyrefrf export results/case/case.h5 --to csv --reference iso1683 --force
    """
    from tyrefrf.cli.exporting import export_to_files
    from tyrefrf.cli.exporting_fields import Wanted

    formats = [name.strip() for name in to.split(",") if name.strip()]
    wanted = Wanted(tuple(at or ()), shapes, files)
    export_to_files(
        results, formats, quantity.value, output, reference, wanted, force=force, json=json
    )


@app.command()
def info(results: ResultsFile, json: Json = False) -> None:
    """Say what RESULTS holds and where from."""
    from tyrefrf.cli.contents import TOLD
    from tyrefrf.cli.report import as_json
    from tyrefrf.results import load_any

    found = load_any(results)
    told = TOLD[type(found)]
    typer.echo(as_json(told.facts(found, [results])) if json else told.words(found))


@app.command()
def init(
    case: Annotated[Path, typer.Argument(help="Case file to write.")] = Path("case.toml"),
    force: Force = False,
) -> None:
    """Write a commented starter case.

    And beside it the schema that editors read.
    """
    from tyrefrf.case import case_schema, starter_text
    from tyrefrf.cli.report import as_json

    schema = case.parent / "tyrefrf.schema.json"
    for path, text in ((case, starter_text()), (schema, as_json(case_schema()) + "\n")):
        if path.exists() and not force:
            if path == schema:
                continue
            raise CommandError(f"{path} exists; give another name, or --force to replace it")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        typer.echo(str(path))


@app.command()
def schema() -> None:
    """Print the JSON schema of case files.

    With it editors complete and check them. Name it in a case's first line: #:schema
    ./tyrefrf.schema.json
    """
    from tyrefrf.case import case_schema
    from tyrefrf.cli.report import as_json

    typer.echo(as_json(case_schema()))


@app.callback(invoke_without_command=True)
def _version(
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
) -> None:
    if version:
        from importlib.metadata import version as version_of

        typer.echo(version_of("tyrefrf"))
        raise typer.Exit


def main() -> None:
    """Run the command line and turn errors into messages and exit statuses.

    One BLAS thread, before any library has started more: the cores work at lines of their own.
    """
    for variable, one in ONE_THREAD.items():
        os.environ.setdefault(variable, one)
    _open_what_is_closed()
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # names may have letters that the terminal has not
            stream.reconfigure(errors="backslashreplace")
    try:
        _refuse_little_memory()
        with heeding_signals():
            app()
    except Interrupted as interrupt:
        _fail(interrupt, interrupt.status)
    except (CaseError, MeshError, CommandError) as error:
        _fail(error, 2)
    except TyreFRFError as error:
        _fail(error, 1)
    except MemoryError as error:
        _fail(SolveError(short_of_memory(error)), 1)
    except ImportError as error:
        if NO_ROOM not in str(error):
            raise
        _fail(SolveError(short_of_memory(MemoryError(str(error)))), 1)
    except OSError as error:
        where = [str(error.filename)] if error.filename else []
        _fail(ResultsError(": ".join([*where, error.strerror or str(error)])), 1)


def _open_what_is_closed() -> None:
    """Give stdout and stderr that are closed, as by 2>&-, to nobody: print would mix them up.

    Processes that are started have them, too: their pipes would get the numbers.
    """
    for number, name in ((1, "stdout"), (2, "stderr")):
        if getattr(sys, name) is None:
            nobody = os.open(os.devnull, os.O_WRONLY)
            if nobody != number:
                os.dup2(nobody, number)
                os.close(nobody)
            os.set_inheritable(number, True)
            setattr(sys, name, os.fdopen(number, "w", encoding="utf-8", closefd=False))


def _refuse_little_memory() -> None:
    """Raise SolveError where a limit leaves no room for what every command imports."""
    if (room := room_of_process()) < LEAST:
        limit = f"{room / 1e6:.0f} MB are left by the limit on a process (ulimit -v)"
        raise SolveError(f"needs {LEAST / 1e6:.0f} MB of memory to begin with, and {limit}")


def _fail(error: BaseException, status: int) -> None:
    """Say on stderr what went wrong, and what it leaves, and exit."""
    with suppress(OSError):  # a terminal that is closed, a log without room
        print(error, *getattr(error, "__notes__", ()), sep="\n", file=sys.stderr)
    sys.exit(status)


def _names(formats: list[PlotFormat] | None) -> tuple[str, ...]:
    """The formats asked for, each once."""
    return tuple(dict.fromkeys(form.value for form in formats or []))
