"""The command `stead`, which comes with the package."""

from __future__ import annotations

import signal
import sys
from typing import NoReturn

from . import _stead


def main() -> NoReturn:
    """Runs the command line and leaves with its exit code."""
    # Ctrl-C is handled by the command itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_stead.run_command(sys.argv))
