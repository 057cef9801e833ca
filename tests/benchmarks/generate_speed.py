"""How long `canwright generate` takes, as a whole process: `python -m tests.benchmarks.generate_speed`.

Beside it stands what cannot be avoided: a process that imports PyYAML and Jinja2, and the time that Jinja2 spends on
compiling and rendering the templates. Specs of 1, 10 and 100 times the commands show how time and memory grow.
"""

from __future__ import annotations

import copy
import functools
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import yaml
from canwright.load import frames_file, spec_files

from ..spec_texts import ROOT

MAIN = ROOT / "spec/mwd_motor/v2.35.yaml"
FRAMES = ROOT / "spec/mwd_motor/v2.35.frames.yaml"
ROUNDS = 3

WATCHED = """
import json, sys, time
import jinja2
spent = {"rendering": 0.0, "depth": 0}
def watched(function):
    def call(*arguments, **named):
        if spent["depth"]:
            return function(*arguments, **named)
        spent["depth"] += 1
        start = time.process_time()
        try:
            return function(*arguments, **named)
        finally:
            spent["rendering"] += time.process_time() - start
            spent["depth"] -= 1
    return call
jinja2.Environment.get_template = watched(jinja2.Environment.get_template)
jinja2.Template.render = watched(jinja2.Template.render)
from canwright.__main__ import run
try:
    run()
except SystemExit:
    print(json.dumps(spent["rendering"]))
"""


@functools.cache
def compiled() -> tempfile.TemporaryDirectory[str]:
    """Where Python keeps compiled modules during the benchmark, so that none is left in the clone."""
    return tempfile.TemporaryDirectory()


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPYCACHEPREFIX": compiled().name, "PYTHONDONTWRITEBYTECODE": ""}


def cpu(*arguments: str, new: Path | None = None) -> tuple[float, str]:
    """The least processor seconds of a few runs of Python with these arguments, and what the last printed.

    With `new`, each run writes into an empty folder of its own there. Modules are compiled before the first run that
    counts, as they are in an installed package.
    """
    found, printed = [], ""
    for number in range(ROUNDS + 1):
        out = ("--out", str(new / str(number))) if new else ()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(
            [sys.executable, *arguments, *out], cwd=ROOT, capture_output=True, text=True, check=False, env=environment()
        )
        if done.returncode:
            raise SystemExit(done.stdout + done.stderr)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        found.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        printed = done.stdout
    return min(found[1:]), printed


def memory(*arguments: str) -> int:
    """The megabytes that Python with these arguments holds at most."""
    code = "import resource, subprocess, sys; subprocess.run([sys.executable, *sys.argv[1:]], check=True); "
    code += "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        env=environment(),
    )
    return int(done.stdout.split()[-1]) // 1024


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
            one = copy.deepcopy(address)
            one |= {
                "extended": True,
                "id": f"0x{(i + 1) << 12 | base:X} + node" if "nodes" in address else (i + 1) << 12 | base,
            }
            data["addresses"][f"{name}_{i}"] = one | ({"nodes": "1..4"} if "nodes" in address else {})
        for name, command in commands.items():
            one = copy.deepcopy(command) | {"address": f"{command.get('address', 'motor')}_{i}"}
            if isinstance(one["reply"], dict) and "of" in one["reply"]:
                one["reply"]["of"] += f"_{i}"
            data["commands"][f"{name}_{i}"] = one
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


def main() -> None:
    libraries, _ = cpu("-c", "import yaml, jinja2")
    modules, _ = cpu("-c", "import gc; gc.disable(); import canwright.cli.generate")
    imports = modules - libraries
    for name, specs in {
        "one edition": [MAIN],
        "all editions": spec_files(ROOT / "spec"),
    }.items():
        options = [part for spec in specs for part in ("--spec", str(spec))]
        with tempfile.TemporaryDirectory() as folder:
            first, _ = cpu("-m", "canwright", "generate", *options, new=Path(folder) / "new")
            whole, _ = cpu("-m", "canwright", "generate", *options, "--out", folder)
            _, printed = cpu("-c", WATCHED, "generate", *options, "--out", folder)
            checked, _ = cpu("-m", "canwright", "check", *options, "--out", folder)
        alone, _ = cpu("-m", "canwright", "check", *options)
        rendering = json.loads(printed.splitlines()[-1])
        print(
            f"{name}: generate {whole:.2f} s, into an empty folder {first:.2f} s; importing {libraries:.2f} s and rendering {rendering:.2f} s, "
            f"ratio {whole / (libraries + rendering):.2f}; imports of canwright {imports:.2f} s; check {checked:.2f} s, check of the specs alone {alone:.2f} s"
        )
    print("growth, each to the one before it:")
    before = (0.0, 0)
    for times in (1, 10, 100):
        with tempfile.TemporaryDirectory() as folder:
            spec = multiplied(Path(folder), times)
            arguments = ("-m", "canwright", "generate", "--spec", str(spec), "--out", f"{folder}/out")
            start = time.perf_counter()
            whole, _ = cpu(*arguments)
            held = memory(*arguments)
            ratio = (
                f", {whole / before[0]:.1f} times the time, {held / before[1]:.1f} times the memory"
                if before[1]
                else ""
            )
            print(
                f"  {times:3} times the commands: {whole:.2f} s, {held} MB{ratio} ({time.perf_counter() - start:.0f} s)"
            )
            before = (whole, held)


if __name__ == "__main__":
    main()
