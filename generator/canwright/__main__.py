"""`python -m canwright`, and what the command `canwright` runs."""

from __future__ import annotations

import gc
import os
import sys


def run() -> None:
    """The command line, as a process of its own.

    What a run makes it keeps to its end, so neither looking for cycles to free nor freeing all of it at last is worth
    the time that it takes.
    """
    gc.disable()
    from .cli import main

    try:
        main()
    except SystemExit as ended:
        sys.stdout.flush()
        sys.stderr.flush()
        if isinstance(ended.code, int):
            os._exit(ended.code)
        raise


if __name__ == "__main__":
    run()
