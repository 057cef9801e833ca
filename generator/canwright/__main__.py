"""`python -m canwright`, and what the command `canwright` runs."""

from __future__ import annotations

import errno
import gc
import os
import sys

CANNOT_PRINT = 2


def run() -> None:
    """The command line, as a process of its own.

    What a run makes it keeps to its end, so neither looking for cycles to free nor freeing all of it at last is worth
    the time that it takes.
    """
    gc.disable()
    from .cli import main

    status = 0
    try:
        try:
            main()
        except SystemExit as ended:
            status = ended.code if isinstance(ended.code, int) else 0
        sys.stdout.flush()
    except OSError as error:  # of printing: commands tell what became of files
        status = CANNOT_PRINT
        if error.errno != errno.EPIPE:
            sys.stderr.write(f"canwright: cannot print: {error.strerror or error}\n")
    sys.stderr.flush()
    os._exit(status)


if __name__ == "__main__":
    run()
