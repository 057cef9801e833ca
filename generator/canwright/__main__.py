"""`python -m canwright`, and what the command `canwright` runs."""

from __future__ import annotations

import gc


def run() -> None:
    """The command line, as a process of its own.

    What a run makes it keeps to its end, so looking for cycles to free takes time and frees next to nothing.
    """
    gc.disable()
    from .cli import main

    main()


if __name__ == "__main__":
    run()
