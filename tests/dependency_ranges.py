"""Runs the tests with the lowest or the newest versions that `pyproject.toml` permits, in an environment of its own.

`python -m tests.dependency_ranges lowest|newest [ARGUMENT OF PYTEST ...]`
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).parents[1]

RESOLUTIONS = {"lowest": "lowest-direct", "newest": "highest"}


def main(arguments: list[str]) -> int:
    """The exit status of pytest; 2 for unknown arguments."""
    if not arguments or arguments[0] not in RESOLUTIONS:
        print(__doc__, file=sys.stderr)
        return 2
    end, *rest = arguments
    with tempfile.TemporaryDirectory() as folder:
        venv.create(folder, with_pip=True)
        python = Path(folder) / "bin" / "python"
        pip = (python, "-m", "pip", "--disable-pip-version-check")
        uv = (python, "-m", "uv", "pip", "install", "-q", "--python", python, "--resolution", RESOLUTIONS[end])
        for command in ((*pip, "install", "-q", "uv"), (*uv, "-e", ".[test-interop]"), (*pip, "list")):
            subprocess.run(command, cwd=ROOT, check=True)
        return subprocess.run([python, "-m", "pytest", *rest], cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
