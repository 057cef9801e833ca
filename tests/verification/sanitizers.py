"""Calls every function of every generated header under the sanitizers of GCC and clang, and under libFuzzer.

    python -m tests.verification.sanitizers [--rounds N] [--seconds N] [SPEC...]

AddressSanitizer and UndefinedBehaviorSanitizer of both compilers, and MemorySanitizer of clang, with random inputs and
changed golden frames; then libFuzzer, which starts with the stored inputs in `corpus/`.
On Debian: apt-get install clang gcc
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ..spec_texts import SPECS
from ..tools import tool
from .calls import Calls
from .headers import Header, each, write_headers

HERE = Path(__file__).parent
CORPUS = HERE / "corpus"
"""For some headers a text with one input in hex on each line: the smallest set that libFuzzer found (`-merge=1`)."""

EXTENDED, REMOTE = 1 << 31, 1 << 30


class Sanitizer(NamedTuple):
    """A compiler and its options."""

    compiler: str
    options: tuple[str, ...]


UNDEFINED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
"""Options of GCC and clang that stop a program at undefined behaviour."""

_COMMON = ("-std=c11", "-g", "-O1")
SANITIZERS: Mapping[str, Sanitizer] = {
    "gcc, ASan and UBSan": Sanitizer("gcc", (*_COMMON, *UNDEFINED)),
    "clang, ASan and UBSan": Sanitizer("clang", (*_COMMON, *UNDEFINED)),
    "clang, MSan": Sanitizer("clang", (*_COMMON, "-fsanitize=memory", "-DCHECKS_MEMORY")),
}
FUZZER = Sanitizer("clang", (*_COMMON, *UNDEFINED, "-fsanitize=fuzzer", "-DLIBFUZZER"))


def build(header: Header, sanitizer: Sanitizer, program: Path) -> Path:
    """The program that calls every function of a header."""
    folder = program.with_suffix(".calls")
    folder.mkdir(exist_ok=True)
    (folder / "calls.h").write_text(_calls(header), "utf-8")
    command = [tool(sanitizer.compiler), *sanitizer.options, f"-I{header.include}", f"-I{folder}"]
    subprocess.run([*command, f"-DHEADER=<{header.name}>", HERE / "sanitizers.c", "-o", program], check=True)
    return program


def _calls(header: Header) -> str:
    def fill(name: str, kind: str) -> str:
        return f"take_frame(&{name});" if kind.endswith("frame_t") else f"take(&{name}, sizeof {name});"

    bodies = Calls(header, fill, "CHECK({0});".format).bodies()
    calls = "".join(f"static void call_{number}(void)\n{{\n{body}}}\n\n" for number, body in enumerate(bodies))
    names = ", ".join(f"call_{number}" for number in range(len(bodies)))
    golden = ",\n    ".join(_golden(header))
    return f"static const golden_t GOLDEN[] = {{\n    {golden}\n}};\n\n{calls}static void (*const CALLS[])(void) = {{{names}}};\n"


def _golden(header: Header) -> Iterator[str]:
    """The golden frames of an edition; without any, an empty frame."""
    frames = header.specification.frames
    for frame in frames.frames if frames else ():
        id_ = frame.id | (EXTENDED if frame.extended else 0) | (REMOTE if frame.remote else 0)
        yield f"{{0x{id_:X}u, {len(frame.data)}u, {{{', '.join(map(str, frame.data)) or '0'}}}}}"
    if frames is None:
        yield "{0u, 0u, {0}}"


def failures(header: Header, sanitizer: Sanitizer, rounds: int) -> str:
    """The report of a sanitizer after `rounds` random inputs for each function; empty without a failure."""
    program = header.unit.with_suffix(f".{sanitizer.compiler}.{len(sanitizer.options)}")
    return _report(build(header, sanitizer, program), str(rounds))


def stored(header: Header) -> Path:
    """The file of stored inputs of a header, which need not exist."""
    return CORPUS / header.name.replace("/", "-").replace(".h", ".txt")


def fuzzed(header: Header, seconds: int) -> str:
    """The report of libFuzzer; empty without a failure."""
    program = build(header, FUZZER, header.unit.with_suffix(".fuzzer"))
    inputs = program.with_suffix(".inputs")
    inputs.mkdir()
    text = stored(header)
    for number, line in enumerate(text.read_text("utf-8").splitlines() if text.exists() else ()):
        (inputs / str(number)).write_bytes(bytes.fromhex(line))
    artifacts = f"-artifact_prefix={program.parent}/"
    return _report(program, f"-max_total_time={seconds}", "-verbosity=0", "-max_len=160", artifacts, str(inputs))


def _report(program: Path, *arguments: str) -> str:
    done = subprocess.run([program, *arguments], capture_output=True, text=True, errors="replace", check=False)
    return f"exit status {done.returncode}\n{done.stderr}" if done.returncode else ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the reports; the exit status is 1 with any."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=2000, help="random inputs for each function (default: 2000)")
    parser.add_argument("--seconds", type=int, default=5, help="time of libFuzzer for each header (default: 5)")
    parser.add_argument("specs", nargs="*", type=Path, metavar="SPEC", default=SPECS)
    chosen = parser.parse_args(arguments)
    wrong = []
    with tempfile.TemporaryDirectory() as name:
        headers = write_headers(Path(name), chosen.specs)
        for title, sanitizer in SANITIZERS.items():
            reports = each(lambda header, by=sanitizer: failures(header, by, chosen.rounds), headers)  # type: ignore[misc]
            wrong += [
                f"{header.name}: {title}: {report}" for header, report in zip(headers, reports, strict=True) if report
            ]
        reports = each(lambda header: fuzzed(header, chosen.seconds), headers)
        wrong += [
            f"{header.name}: libFuzzer: {report}" for header, report in zip(headers, reports, strict=True) if report
        ]
    print("\n".join(wrong) or f"{len(headers)} headers, {len(SANITIZERS)} sanitizers and libFuzzer: no failure")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
