"""Run the command line by ``python -m img2tri``."""

from __future__ import annotations

import sys

from img2tri.cli.program import main

if __name__ == "__main__":
    sys.exit(main())
