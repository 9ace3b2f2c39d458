"""Texts typed on the command line -> numbers, pairs, lists and pairs of label and value, as `mesh_image` takes them.

Only what makes a text a number, a pair or a list is checked here; what values may be is for the checks of the options to say.
"""

from __future__ import annotations

from argparse import ArgumentTypeError


def as_typed(given: str) -> str:
    """Leave a text as it is: words, and lengths with their units."""
    return given


def number(given: str) -> float:
    """Return the number a text is."""
    try:
        return float(given)
    except ValueError:
        raise ArgumentTypeError(f"expected a number, found {given!r}") from None


def whole_number(given: str) -> int:
    """Return the whole number a text is."""
    try:
        return int(given)
    except ValueError:
        raise ArgumentTypeError(f"expected a whole number, found {given!r}") from None


def label_number(given: str) -> int:
    """Return a label: a whole number, or a colour as ``#dc2828`` or ``0xdc2828``.

    Examples
    --------
    >>> label_number("7"), label_number("#dc2828") == label_number("0xdc2828") == 0xDC2828
    (7, True)
    """
    if given.startswith("#") or given.lower().startswith("0x"):
        try:
            return int(given.removeprefix("#"), 16)
        except ValueError:
            raise ArgumentTypeError(f"expected a colour as in #dc2828, found {given!r}") from None
    return whole_number(given)


def number_or_word(given: str) -> float | str:
    """Return the number a text is, or the text.

    Examples
    --------
    >>> number_or_word("128"), number_or_word("otsu")
    (128.0, 'otsu')
    """
    try:
        return float(given)
    except ValueError:
        return given


def comma_separated(given: str) -> tuple[float, ...]:
    """Return numbers between commas."""
    return tuple(map(number, given.split(",")))


def pair_or_word(given: str) -> float | str | tuple[float, ...]:
    """Return numbers between commas, one number, or the text."""
    return comma_separated(given) if "," in given else number_or_word(given)


def length_by_label(given: str) -> str | dict[int, str]:
    """Return one length, or lengths by label.

    Examples
    --------
    >>> length_by_label("8px"), length_by_label("1=4,2=8px")
    ('8px', {1: '4', 2: '8px'})
    """
    return dict(map(label_and_value, given.split(","))) if "=" in given else given


def height_by_label(given: str) -> float | dict[int, float]:
    """Return one number, or numbers by label.

    Examples
    --------
    >>> height_by_label("2.5"), height_by_label("1=2,#dc2828=5")
    (2.5, {1: 2.0, 14428200: 5.0})
    """
    return {label: number(text) for label, text in map(label_and_value, given.split(","))} if "=" in given else number(given)


def name_and_file(given: str) -> tuple[str, str]:
    """Return the name of an array and the file it is read from.

    Examples
    --------
    >>> name_and_file("HU=slice.png")
    ('HU', 'slice.png')
    """
    name, _, path = given.partition("=")
    if not (name and path):
        raise ArgumentTypeError(f"expected a name, =, and an image, as in HU=slice.png, found {given!r}")
    return name, path


def all_or_labels(given: str) -> bool | list[int]:
    """Return True for "all", or labels between commas."""
    return True if given == "all" else list(map(label_number, given.split(",")))


def numbers_or_word(given: str) -> float | str | tuple[float, ...]:
    """Return a number, numbers between commas, or the text.

    Examples
    --------
    >>> numbers_or_word("110,190"), numbers_or_word("otsu")
    ((110.0, 190.0), 'otsu')
    """
    return comma_separated(given) if "," in given else number_or_word(given)


def whole_numbers(given: str) -> list[int]:
    """Return whole numbers between commas."""
    return list(map(label_number, given.split(",")))


def yes_or_text(given: str) -> bool | str:
    """Return True for "all", or the text."""
    return True if given == "all" else given


def typed_colours(given: str) -> int | list[int]:
    """Return a count, or colours between commas: ``#dc2828``, ``0xdc2828`` or numbers.

    Examples
    --------
    >>> typed_colours("3"), typed_colours("#dc2828,0xff,80")
    (3, [14428200, 255, 80])
    """
    listed = list(map(label_number, given.split(",")))
    return listed[0] if given.strip().isdigit() else listed


def label_or_none(given: str) -> int | None:
    """Return a label, or None for the word."""
    return None if given.lower() == "none" else label_number(given)


def label_and_value(given: str) -> tuple[int, str]:
    """Return a label and what it gets.

    Examples
    --------
    >>> label_and_value("1=bone")
    (1, 'bone')
    """
    region, _, value = given.partition("=")
    if not value:
        raise ArgumentTypeError(f"expected the number of a region, =, and what it gets, as in 1=bone, found {given!r}")
    return label_number(region), value
