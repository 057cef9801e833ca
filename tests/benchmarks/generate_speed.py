"""How long `canwright generate` takes, as a whole process: `python -m tests.benchmarks.generate_speed`.

Beside it stands what cannot be avoided: a process that imports PyYAML and Jinja2, and the time that Jinja2 by itself
spends on compiling and rendering the templates. Specs of 1, 10 and 100 times the commands show how time and memory grow.

Times are those of a clock, so that they are what a user waits; the least of a few runs. Processor seconds stand beside
them. canwright keeps its compiled templates.
"""

from __future__ import annotations

import copy
import functools
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import yaml
from canwright.project.loader import frames_file, spec_files

from ..spec_texts import ROOT

MAIN = ROOT / "spec/mwd_motor/v2.35.yaml"
FRAMES = ROOT / "spec/mwd_motor/v2.35.frames.yaml"
ROUNDS = 3

WATCHED = """
import gc, os, sys, time
import jinja2
gc.disable()
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # all in this process, where it can be watched
jinja2.FileSystemBytecodeCache.load_bytecode = lambda cache, bucket: None
spent = {"rendering": 0.0, "depth": 0}
def watched(function):
    def call(*arguments, **named):
        if spent["depth"]:
            return function(*arguments, **named)
        spent["depth"] += 1
        start = time.perf_counter()
        try:
            return function(*arguments, **named)
        finally:
            spent["rendering"] += time.perf_counter() - start
            spent["depth"] -= 1
    return call
jinja2.Environment.get_template = watched(jinja2.Environment.get_template)
jinja2.Template.render = watched(jinja2.Template.render)
from canwright.cli import main
try:
    main()
except SystemExit:
    print(spent["rendering"])
"""


class Cost(NamedTuple):
    """What a process takes: seconds of a clock, seconds of processors, and the megabytes of the largest of its like."""

    clock: float
    processor: float
    memory: int


@functools.cache
def compiled() -> tempfile.TemporaryDirectory[str]:
    """Where Python keeps compiled modules during the benchmark, so that none is left in the clone."""
    return tempfile.TemporaryDirectory()


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPYCACHEPREFIX": compiled().name, "PYTHONDONTWRITEBYTECODE": ""}


def cost(*arguments: str, new: Path | None = None) -> Cost:
    """The least of a few runs of Python with these arguments.

    With `new`, each run writes into an empty folder of its own there. Modules and templates are compiled before the
    first run that counts, as they are in an installed package.
    """
    found = [_once(*arguments, *(("--out", str(new / str(number))) if new else ())) for number in range(ROUNDS + 1)]
    return _least(one for one, _ in found[1:])


def beside_rendering(*arguments: str) -> tuple[Cost, float]:
    """The least of a few runs of `canwright`, and the least seconds that Jinja2 takes to compile and render the same.

    They take turns, so that what else the machine does slows both.
    """
    run = ("-m", "canwright", *arguments)
    _once(*run)
    turns = [(_once(*run)[0], float(_once("-c", WATCHED, *arguments)[1].split()[-1])) for _ in range(ROUNDS)]
    return _least(whole for whole, _ in turns), min(alone for _, alone in turns)


def _least(found: Iterable[Cost]) -> Cost:
    return Cost(*map(min, zip(*found, strict=True)))


RUN = """
import json, resource, subprocess, sys, time
start = time.perf_counter()
done = subprocess.run([sys.executable, *sys.argv[1:]], capture_output=True, text=True)
clock = time.perf_counter() - start
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(json.dumps([clock, used.ru_utime + used.ru_stime, used.ru_maxrss // 1024]))
print(done.stdout + done.stderr)
sys.exit(done.returncode)
"""


def _once(*arguments: str) -> tuple[Cost, str]:
    """One run of Python with these arguments, and what it printed."""
    command = [sys.executable, "-c", RUN, *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, env=environment())
    if done.returncode:
        raise SystemExit(done.stdout + done.stderr)
    measured, _, printed = done.stdout.partition("\n")
    return Cost(*json.loads(measured)), printed


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


def shown(name: str, whole: Cost, alone: float) -> str:
    return (
        f"{name}: {whole.clock:.2f} s ({whole.processor:.2f} s of processors, {whole.memory} MB); "
        f"importing PyYAML and Jinja2 and rendering alone {alone:.2f} s, ratio {whole.clock / alone:.2f}"
    )


def main() -> None:
    libraries = cost("-c", "import yaml, jinja2").clock
    modules = cost("-c", "import gc; gc.disable(); import canwright.cli.generate").clock
    print(f"{len(os.sched_getaffinity(0))} processors; imports of canwright besides: {modules - libraries:.2f} s")
    for name, specs in {"one edition": [MAIN], "all editions": spec_files(ROOT / "spec")}.items():
        options = [part for spec in specs for part in ("--spec", str(spec))]
        with tempfile.TemporaryDirectory() as folder:
            first = cost("-m", "canwright", "generate", *options, new=Path(folder) / "new")
            whole, alone = beside_rendering("generate", *options, "--out", folder)
            checked = cost("-m", "canwright", "check", *options, "--out", folder)
        specs_only = cost("-m", "canwright", "check", *options)
        print(shown(name, whole, libraries + alone))
        print(
            f"  into an empty folder {first.clock:.2f} s; check {checked.clock:.2f} s, "
            f"of the specs alone {specs_only.clock:.2f} s"
        )
    print("growth, each to the one before it:")
    before = None
    for times in (1, 10, 100):
        with tempfile.TemporaryDirectory() as folder:
            spec = multiplied(Path(folder), times)
            arguments = ("generate", "--spec", str(spec), "--out", f"{folder}/out")
            whole, alone = beside_rendering(*arguments)
            print(shown(f"  {times:3} times the commands", whole, libraries + alone))
            if before:
                grown = f"{whole.clock / before.clock:.1f} times the time, {whole.memory / before.memory:.1f} times the"
                print(f"      {grown} memory")
            before = whole


if __name__ == "__main__":
    main()
