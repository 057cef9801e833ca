"""`python -m canwright`, and what the command `canwright` runs."""

from __future__ import annotations

import errno
import os
import sys

CANNOT_PRINT = 2


def run() -> None:
    """Runs the command line; a standard output that cannot be written to is an error line, not a traceback."""
    from .cli import main

    status = 0
    try:
        try:
            main()
        except SystemExit as ended:
            status = ended.code if isinstance(ended.code, int) else 0
        sys.stdout.flush()
    except OSError as error:  # of printing: commands report what became of files
        status = CANNOT_PRINT
        if error.errno != errno.EPIPE:
            sys.stderr.write(f"canwright: cannot print: {error.strerror or error}\n")
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the interpreter flushes once more at exit
    sys.exit(status)


if __name__ == "__main__":
    run()
