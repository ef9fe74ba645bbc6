"""The program ``granflow``."""

from __future__ import annotations

import sys

from . import _native


def main() -> int:
    """Does what the command line asks for; returns the exit status."""
    return _native.program(["granflow", *sys.argv[1:]])
