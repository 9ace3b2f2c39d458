"""Texts in XML. What the standard library has for that loads half of its network library: so it waits until there is something to write."""

from __future__ import annotations


def xml_escaped(text: str) -> str:
    """Return a text as it stands between tags.

    Examples
    --------
    >>> xml_escaped("a < b")
    'a &lt; b'
    """
    from xml.sax.saxutils import escape

    return escape(text)


def xml_quoted(text: str) -> str:
    """Return a text as the value of an attribute, in quotes.

    Examples
    --------
    >>> xml_quoted("a & b")
    '"a &amp; b"'
    """
    from xml.sax.saxutils import quoteattr

    return quoteattr(text)
