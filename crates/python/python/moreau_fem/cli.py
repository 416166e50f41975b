"""The command ``moreau``."""

import signal
import sys

from ._core import command


def main() -> None:
    """Does what the command line says, and ends with its exit status."""
    # The command has an answer of its own to Ctrl-C.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(command(["moreau", *sys.argv[1:]]))
