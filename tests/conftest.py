"""What holds for all tests: no time limits that a loaded machine could miss, and Ctrl-C that reaches children."""

from __future__ import annotations

import signal

import pytest
from hypothesis import settings

settings.register_profile("patient", deadline=None)  # 200 ms for one example is little on a busy machine
settings.load_profile("patient")


@pytest.fixture
def ctrl_c():
    """Children heed Ctrl-C even where pytest itself ignores it, as in the background of a shell."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
