"""Messages of the library -> the words of the command line: options as they are typed, no values that cannot be."""

from __future__ import annotations

import re

from img2tri.cli.option_arguments import flag_of
from img2tri.cli.save_arguments import SAVE_OPTIONS
from img2tri.options import OPTIONS

FLAGS = {name: flag_of(name, option) for name, option in OPTIONS.items()}
FLAGS |= {name: option.flag for name, option in SAVE_OPTIONS.items()} | {"workers": "--workers", "scheduler": "--scheduler"}
IN_PYTHON = ("np.", "image[", "numpy")  # advice with these is for those who hold an array


def in_words_of_the_command_line(message: str) -> str:
    """Name options the way they are typed here.

    Examples
    --------
    >>> in_words_of_the_command_line("edge_length: expected a number above 0, found -1")
    '--edge-length: expected a number above 0, found -1'
    >>> in_words_of_the_command_line("labels: expected values other than the background, found 0; give background=None to mesh it too")
    '--labels: expected values other than the background, found 0; give --background none to mesh it too'
    >>> in_words_of_the_command_line("names: expected 'x', 'y' or None, found 3; use np.pad(image)")
    "--name: expected 'x' or 'y', found 3"
    """
    names = "|".join(FLAGS)
    # Either the name a message begins with, or a name with a value somewhere in it.
    pattern = rf"^({names})(?=[:\[])|\b({names})=(True|None|[\d.]+|)"

    def option(match: re.Match[str]) -> str:
        value = {None: "", "": "", "True": "", "None": " none"}.get(match[3], f" {match[3]}")
        return FLAGS[match[1] or match[2]] + value

    first, *advice = message.split("; ")
    first = re.sub(r", ([^,]+) or None(?=[,;])", r" or \1", first).replace(" or None,", ",")
    kept = [part for part in advice if not any(word in part for word in IN_PYTHON)]
    return re.sub(pattern, option, "; ".join([first, *kept]))
