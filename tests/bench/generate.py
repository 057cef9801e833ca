"""How long runs of `canwright` take, as whole processes: `python -m tests.bench.generate`.

Times are those of the processor, the least of some runs: a run waits for nothing, and other processes disturb these
less than those of a clock. The time of generating is relative to that of a bare Jinja2 script, in turns. The script
does the least that any script with Jinja2 does: it imports Jinja2 and PyYAML, loads the same YAML files, and renders
and writes the same files. It takes their lines from an earlier output, and each line is one expression of a template.

The exit status is 1 if a figure misses its bar. A spec of 100 times the commands exceeds the maximum size, which is raised.
"""

from __future__ import annotations

import copy
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml
from canwright.project.loader import frames_file
from canwright.rules.too_large import VARIABLE

from ..spec_texts import ROOT
from .bars import Measure, report

MAIN = ROOT / "spec/mwd_motor/v2.35.yaml"
FRAMES = ROOT / "spec/mwd_motor/v2.35.frames.yaml"
ROUNDS = 7

SCRIPT = """
import pathlib, sys
import jinja2, yaml
specs, lines_of, out = sys.argv[1].split(), pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
for spec in specs:
    with open(spec, "rb") as stream:
        yaml.load(stream, yaml.CSafeLoader)
environment = jinja2.Environment(undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
template = environment.from_string("{% for line in lines %}{{ line }}{% endfor %}")
for file in lines_of.rglob("*"):
    if file.is_file():
        path = out / file.relative_to(lines_of)
        path.parent.mkdir(parents=True, exist_ok=True)
        lines = file.read_text("utf-8").splitlines(keepends=True)
        path.write_text(template.render(lines=lines), "utf-8", newline="")
"""

RUN = """
import resource, subprocess, sys
done = subprocess.run([sys.executable, *sys.argv[1:]], capture_output=True, text=True)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime)
print(done.stdout + done.stderr)
sys.exit(done.returncode)
"""


class Runs:
    """Runs of Python with their own caches in a temporary folder, so that none is left in the clone."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._environment = {
            **os.environ,
            "PYTHONPYCACHEPREFIX": str(folder / "compiled"),
            "PYTHONDONTWRITEBYTECODE": "",
            "XDG_CACHE_HOME": str(folder / "cache"),
            VARIABLE: "1000000",
        }

    def run(self, *arguments: str) -> float:
        """The seconds of one run of Python with these arguments."""
        command = [sys.executable, "-c", RUN, *arguments]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, env=self._environment)
        if done.returncode:
            raise SystemExit(done.stdout + done.stderr)
        return float(done.stdout.split()[0])

    def canwright(self, *arguments: str) -> float:
        return self.run("-m", "canwright", *arguments)

    def seconds(self, *arguments: str) -> float:
        """The least time of a run after the first one, which compiles modules and leaves the record of the run."""
        self.canwright(*arguments)
        return min(self.canwright(*arguments) for _ in range(ROUNDS))

    def relative_to_script(self, spec: Path, rounds: int) -> float:
        """The time of `canwright generate` into an empty folder, relative to that of the script."""
        name = spec.stem
        first = self.folder / name / "first"
        self.canwright("generate", "--spec", str(spec), "--out", str(first))
        (first / ".canwright.json").unlink()
        specs = f"{spec} {frames_file(spec)}"
        whole, bare = [], []
        for number in range(rounds):
            out = self.folder / name / str(number)
            whole.append(self.canwright("generate", "--spec", str(spec), "--out", str(out / "canwright")))
            bare.append(self.run("-c", SCRIPT, specs, str(first), str(out / "script")))
            same_files(first, out / "script")
        return min(whole) / min(bare)


def same_files(folder: Path, expected: Path) -> None:
    """Exits unless two folders contain the same files."""
    for file in folder.rglob("*"):
        if file.is_file() and file.read_bytes() != (expected / file.relative_to(folder)).read_bytes():
            raise SystemExit(f"the script writes another {file.relative_to(folder)}")


def multiplied(folder: Path, times: int) -> Path:
    """The first edition with its commands so many times, each time on addresses of their own, for four nodes.

    Beside it stand golden frames, one for each direction of each command.
    """
    data: dict[str, Any] = yaml.safe_load(MAIN.read_text("utf-8").replace("date: 2023-03", "date: '2023-03'"))
    data["errata"] = []
    addresses, commands = data["addresses"], data["commands"]
    data["addresses"], data["commands"] = {}, {}
    for i in range(times):
        for name, address in addresses.items():
            base = int(str(address["id"]).split(" ")[0], 16 if isinstance(address["id"], str) else 10)
            copied_address = copy.deepcopy(address)
            copied_address |= {
                "extended": True,
                "id": f"0x{(i + 1) << 12 | base:X} + node" if "nodes" in address else (i + 1) << 12 | base,
            }
            data["addresses"][f"{name}_{i}"] = copied_address | ({"nodes": "1..4"} if "nodes" in address else {})
        for name, command in commands.items():
            copied_command = copy.deepcopy(command) | {"address": f"{command.get('address', 'motor')}_{i}"}
            if isinstance(copied_command["reply"], dict) and "of" in copied_command["reply"]:
                copied_command["reply"]["of"] += f"_{i}"
            data["commands"][f"{name}_{i}"] = copied_command
    for state in data["states"].values():
        state["entered_by"] = [f"{name}_{i}" for name in state["entered_by"] for i in range(times)]
    file = folder / f"times{times}.yaml"
    file.write_text(yaml.safe_dump(data, allow_unicode=True, sort_keys=False), "utf-8")
    golden: dict[str, Any] = yaml.safe_load(FRAMES.read_text("utf-8"))
    once = {(f.get("request"), f.get("reply")): f for f in golden["frames"] if (f.get("node") or 0) <= 4}
    frames = [_moved(frame, i) for i in range(times) for frame in once.values()]
    golden |= {"frames": frames, "refused": [], "exchanges": []}
    frames_file(file).write_text(yaml.safe_dump(golden, allow_unicode=True, sort_keys=False), "utf-8")
    return file


def _moved(frame: dict[str, Any], i: int) -> dict[str, Any]:
    """A golden frame of the i-th copy of a command."""
    names: dict[str, Any] = {key: f"{frame[key]}_{i}" for key in ("request", "reply") if key in frame}
    return {**copy.deepcopy(frame), **names, "id": (i + 1) << 12 | frame["id"], "extended": True}


def measures(runs: Runs) -> Iterator[Measure]:
    yield Measure("canwright --help, ms", runs.seconds("--help") * 1000, at_most=80)
    for arguments in (["show", "0xA1"], ["editions"]):
        took = runs.seconds(*arguments, "--spec", str(MAIN)) * 1000
        yield Measure(f"canwright {' '.join(arguments)}, one edition, ms", took, at_most=250)
    script = f"import canwright; canwright.load({str(MAIN)!r}, for_output=False)"
    runs.run("-c", script)
    took = min(runs.run("-c", script) for _ in range(ROUNDS)) * 1000
    yield Measure("canwright.load of one edition for decoding, ms", took, at_most=250)
    for line in ("show 0xA1", "editions", "diff v2.35 v2.36-2025-03 --fail-on none", "decode 141#A1329B00F4010040"):
        yield Measure(f"canwright {line}, all editions, ms", runs.seconds(*line.split()) * 1000, at_most=500)
    out = str(runs.folder / "all")
    runs.canwright("generate", "--out", out)
    for command in ("generate", "check"):
        took = runs.seconds(command, "--out", out) * 1000
        yield Measure(f"canwright {command} with nothing to do, all editions, ms", took, at_most=100)
    relative = runs.relative_to_script(MAIN, ROUNDS)
    yield Measure("generate one edition, time relative to a bare Jinja2 script", relative, at_most=3.5)
    relative = runs.relative_to_script(multiplied(runs.folder, 100), 2)
    yield Measure("the same with 100 times the commands", relative, at_most=3)


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        return report(list(measures(Runs(Path(folder)))))


if __name__ == "__main__":
    sys.exit(main())
