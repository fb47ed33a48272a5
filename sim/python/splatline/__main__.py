"""`python -m splatline`: the command line."""

import os
import signal
import sys

from . import _native


def main() -> int:
    # As for any other program, Ctrl-C ends it: Python would wait for the drawing's end.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.command_line(["splatline", *sys.argv[1:]])


if __name__ == "__main__":
    os._exit(main())
