"""`python -m canwright`, and what the command `canwright` runs."""

from __future__ import annotations

import errno
import gc
import os
import sys

from .cli import HELP, INTERRUPTED

CANNOT_PRINT = 2

OBJECTS_BETWEEN_COLLECTIONS = 50_000
"""Nearly all objects of a run live until its end. With the default of 700, a tenth of the time of a large spec goes into
looking for those that do not.
"""


def run() -> None:
    """Runs the command line; a standard output that cannot be written to is an error line, not a traceback."""
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)
    status = 0
    try:
        try:
            _run(sys.argv[1:])
        except SystemExit as ended:
            status = ended.code if isinstance(ended.code, int) else 0
        except KeyboardInterrupt:
            status = INTERRUPTED
        sys.stdout.flush()
    except OSError as error:  # of printing: commands report what became of files
        status = CANNOT_PRINT
        if error.errno != errno.EPIPE:
            sys.stderr.write(f"canwright: cannot print: {error.strerror or error}\n")
        for stream in (1, 2):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream)  # the interpreter flushes once more at exit
    sys.exit(status)


def _run(arguments: list[str]) -> None:
    """Prints the overview or the result of a run with nothing to do at once, without importing the command line."""
    from .cli.streams import prepare_streams

    prepare_streams()
    if arguments in (["-h"], ["--help"]):
        sys.stdout.write(HELP)
        return
    from .cli.run_record import RunRecord

    record = RunRecord(arguments)
    printed = record.printed()
    if printed is None:
        from .cli import main

        main(obj=record)
        return
    if printed.error:
        from .cli.terminal import print_text  # removes colours where there is no terminal

        print_text(printed.error, error=True, styled=True)
    sys.stdout.write(printed.out)


if __name__ == "__main__":
    run()
