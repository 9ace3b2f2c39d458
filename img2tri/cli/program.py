"""The command line: ``img2tri mesh``, ``tiles``, ``view-report``, ``app`` and ``quality``, put together from its parts in `img2tri.cli`.

Options go to `img2tri.mesh_image` under the names it knows, and only if they were given, so its defaults and its checks are the only
ones. Whatever is not as it must be becomes one line on stderr and exit status 2; one bad file does not stop the others. Nothing heavy is
imported before there is work for it, so that ``--help`` answers at once.
"""

from __future__ import annotations

import io
import shlex
import sys
from argparse import Namespace
from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial

from img2tri.cli.arguments import parse
from img2tri.cli.commands.app_command import run_app
from img2tri.cli.commands.tiles_command import run_tiles
from img2tri.cli.file_names import folders, images_typed, jobs_of, mesh_options, suffix_of_stdin
from img2tri.cli.job import Job
from img2tri.cli.meshing_job import about_file, problem, view
from img2tri.cli.printing import Bar, complain, flush, tell, tell_failures, tell_outcome
from img2tri.cli.run_jobs import run, workers_of
from img2tri.cli.stdin_stdout import DASH, abandon_stdout, check_stdin, check_stdout, to_stdout
from img2tri.cli.summary_table import check_summary, is_whole, rows_of, summary_table
from img2tri.errors import Img2triError

DONE, BAD, INTERRUPTED = 0, 2, 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv
        The arguments; None takes those of the process.

    Returns
    -------
    int
        0; 2 where a file or an option is not as it must be; 130 after Ctrl-C.

    Raises
    ------
    SystemExit
        With status 0 for --help and --version, 2 for options that cannot be understood.
    """
    typed = sys.argv[1:] if argv is None else argv
    arguments = parse(typed)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # the name of a file may hold what the terminal cannot show
    try:
        if arguments.command == "app":
            status = run_app(arguments)
        elif arguments.command == "tiles":
            status = run_tiles(arguments)
        elif arguments.command == "view-report":
            status = _view_report(arguments, typed)
        else:
            status = (_mesh if arguments.command == "mesh" else _quality)(arguments)
        flush()
    except (Img2triError, MemoryError) as error:
        complain(problem(error))
        return BAD
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read the output has left.
        abandon_stdout()
        return DONE
    return status


def _mesh(arguments: Namespace) -> int:
    """Run ``img2tri mesh``. All names are checked before the first image is read."""
    failed = []
    images = images_typed(arguments.images)
    with workers_of(arguments, len(images)) as where, folders(arguments):
        jobs = check_summary(arguments.summary, arguments.resume, jobs_of(arguments, images))
        before = rows_of(arguments.summary) if arguments.resume else {}
        whole = {job.image: before[job.image] for job in jobs if is_whole(job, before.get(job.image))}
        if not arguments.quiet:
            tell((f"{image}: whole, as it was made before" for image in whole), aside=DASH in arguments.outputs)
        jobs = [job for job in jobs if job.image not in whole]
        names = [job.image for job in jobs]
        with (
            summary_table(arguments.summary, whole) as table,
            Bar(names, quiet=arguments.quiet) as bar,
            closing(run(jobs, where, bar)) as outcomes,
        ):
            for outcome in outcomes:
                if table is not None:
                    table.add(outcome)
                with bar.aside():
                    tell_outcome(outcome, several=len(jobs) > 1, aside=DASH in arguments.outputs)
                if outcome.data is not None:
                    to_stdout(outcome.data)
                if outcome.problem is not None:
                    failed.append(outcome.image)
    tell_failures(failed, len(jobs))
    if not any((arguments.outputs, arguments.out_dir, arguments.plot, arguments.report, arguments.summary)):
        complain("no file was asked for, none was written; -o mesh.stl writes one")
    return BAD if failed else DONE


def _view_report(arguments: Namespace, typed: Sequence[str]) -> int:
    """Run ``img2tri view-report``."""
    from img2tri.views.formats.atomic_write import store, writable

    sent = arguments.output == DASH
    target = None if sent else writable(arguments.output, [".html"])
    if sent:
        check_stdout(".html")
    if arguments.image == DASH:
        check_stdin()
    with Bar([arguments.image], quiet=arguments.quiet) as bar:
        job = Job(arguments.image, mesh_options(arguments))
        outcome, text = view(job, shlex.join(["img2tri", *typed]), partial(bar, 0))
    if target is None:
        to_stdout(text.encode())
    else:
        store(target, text.encode())
    lines = () if arguments.quiet else (*outcome.lines, *([] if sent else [f"{'saved':<12}{arguments.output}"]))
    tell_outcome(replace(outcome, lines=lines), several=False, aside=sent)
    return DONE


def _quality(arguments: Namespace) -> int:
    """Run ``img2tri quality``."""
    suffix, status = suffix_of_stdin(arguments), DONE
    for path in arguments.meshes:
        try:
            tell(about_file(path, suffix))
        except (Img2triError, MemoryError) as error:
            complain(problem(error))
            status = BAD
    return status
