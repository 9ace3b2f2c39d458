"""Outcomes -> words on stdout and stderr, and a progress bar while there are none. All that is printed is printed here."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Self

from img2tri.cli.job import Outcome
from img2tri.cli.stdin_stdout import abandon_stdout
from img2tri.cli.wording import in_words_of_the_command_line
from img2tri.errors import FileError

if TYPE_CHECKING:
    from rich.progress import Progress

PATIENCE = 0.5  # seconds; shorter work is over before a progress bar could be read


def tell(lines: Iterable[str], *, aside: bool = False) -> None:
    """Print lines on stdout; aside, on stderr, while stdout has a file."""
    stream = sys.stderr if aside else sys.stdout
    if stream is None:  # closed from the start; print would take it for stdout
        return
    try:
        for line in lines:
            print(line, file=stream)
    except BrokenPipeError:
        raise
    except OSError as problem:
        if not aside:
            _refused(problem)


def tell_outcome(outcome: Outcome, *, several: bool, aside: bool = False) -> None:
    """Print what came of an image."""
    tell(outcome.lines, aside=aside)
    tell((f"img2tri: warning: {outcome.image}: {warning}" for warning in outcome.warnings), aside=True)
    if outcome.problem is not None:
        complain(outcome.problem, f"{outcome.image}: " if several else "")


def tell_failures(failed: Sequence[str], count: int) -> None:
    """Say which of several images have failed."""
    if failed and count > 1:
        complain(f"{len(failed)} of {count} images failed: {', '.join(failed)}")


def complain(problem: str, place: str = "") -> None:
    """Print what is wrong as one line on stderr."""
    tell([f"img2tri: {' '.join((place + in_words_of_the_command_line(problem)).split())}"], aside=True)


def flush() -> None:
    """See that what was printed has arrived."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as problem:
        _refused(problem)


def _refused(problem: OSError) -> None:
    abandon_stdout()
    raise FileError(f"stdout: cannot be written: {problem.strerror or problem}") from problem


class Bar:
    """One progress bar for all images on stderr, once the work has taken a while; nothing where stderr is no terminal."""

    def __init__(self, images: Sequence[str], *, quiet: bool) -> None:
        self.images, self.shown = images, not quiet and sys.stderr is not None and sys.stderr.isatty()
        self.done = [0.0] * len(images)
        self.began = time.monotonic()
        self.progress: Progress | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.progress is not None:
            self.progress.stop()

    def __call__(self, number: int, stage: str, fraction: float) -> None:
        """Show at which stage an image is, and how much of all the work is done."""
        self.done[number] = fraction
        if not self.shown or time.monotonic() - self.began < PATIENCE:
            return
        from rich.markup import escape

        count = len(self.images)
        place = f"{self.done.count(1.0)} of {count} images, {self.images[number]}: " if count > 1 else ""
        text, done = escape(place + stage), sum(self.done) / count
        if self.progress is None:
            from rich.console import Console
            from rich.progress import Progress

            # Gone when done, and no way for what is printed meanwhile: stdout may be a file.
            self.progress = Progress(console=Console(stderr=True), transient=True, redirect_stdout=False, redirect_stderr=False)
            self.progress.add_task(text, total=1.0)
            self.progress.start()
        self.progress.update(self.progress.task_ids[0], description=text, completed=done)

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Take the bar away while something is printed: both may go to one terminal."""
        if self.progress is not None:
            self.progress.stop()
        yield
        if self.progress is not None:
            self.progress.start()
