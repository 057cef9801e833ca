"""Every command with any encoding, with closed streams, and with texts that a CI system would execute."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from canwright.cli.terminal import json_text, print_text
from canwright.diagnostics.diagnostic import Position

from ..spec_texts import MINIMAL, ROOT

HOSTILE = MINIMAL.replace(
    '    manual: "1"\n', '    manual: "1"\n    about: |\n      设定 →\n      ::error::x\n      ##[error]y\n'
)
COMMANDS = ("diff v1 v2", "show dim", "check --spec spec/lamp/v1.yaml", "--help")


@pytest.fixture(autouse=True)
def specs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "spec" / "lamp"
    folder.mkdir(parents=True)
    (folder / "v1.yaml").write_text(HOSTILE, "utf-8")
    (folder / "v2.yaml").write_text(HOSTILE.replace("edition: v1", "edition: v2").replace("dim:", "dim_to:"), "utf-8")
    (tmp_path / "bus.log").write_text("(1.000) can0 101#1000000000000000\n", "utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "generator"))
    return folder


def shell(line: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    canwright = f"'{sys.executable}' -m canwright"
    done = subprocess.run(
        ["sh", "-c", line.replace("canwright ", f"{canwright} ")],
        env={**os.environ, **environment},
        capture_output=True,
        check=False,
    )
    assert b"Traceback" not in done.stderr + done.stdout, (line, environment, done.stderr)
    assert b"Exception ignored" not in done.stderr, (line, environment, done.stderr)
    return done


def test_output_in_an_encoding_without_its_characters() -> None:
    for encoding in ("cp437", "latin-1"):
        done = shell("canwright diff v1 v2", PYTHONIOENCODING=encoding)
        assert b"C `..._COMMAND_DIM` -> `..._COMMAND_DIM_TO`" in done.stdout
    done = shell("canwright show dim; canwright identify bus.log", PYTHONIOENCODING="cp1252")
    assert b"\\u8bbe\\u5b9a ->" in done.stdout
    ascii_only = {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
    done = shell("canwright diff v1 v2 --format json", **ascii_only)
    assert b"C `\\u2026_COMMAND_DIM` \\u2192 `\\u2026_COMMAND_DIM_TO`" in done.stdout


def test_closed_streams_and_broken_pipes() -> None:
    for command in COMMANDS:
        done = shell(f"canwright {command} >&-")
        assert done.returncode == 0, (command, done.stderr)
    shell("canwright show nothing 2>&-; canwright generate --target c >&- 2>&- <&-")
    assert Path("generated/c/include/lamp/v1.h").is_file()
    done = shell("canwright explain | head -1; canwright diff v1 v2 | true")
    assert done.stderr == b""


def test_texts_that_a_ci_system_would_execute() -> None:
    done = shell("canwright show dim; canwright check --spec spec/lamp/v1.yaml; canwright diff v1 ::error::x")
    lines = (done.stdout + done.stderr).decode("utf-8").split("\n")
    assert "\\::error::x" in "\n".join(lines).replace(" ", "")
    assert not [line for line in lines if line.strip().startswith("::") or "##[" in line]


def test_text_is_escaped(capsys: pytest.CaptureFixture[str]) -> None:
    print_text("a\x1b[31mb\r::c\n \t::d\n##vso[x]\n\u202e", error=True)
    assert capsys.readouterr().err == "a[U+001B][31mb[U+000D]::c\n \t\\::d\n##\\vso[x]\n[U+202E]"
    assert json_text("##[error]") == '"#\\u0023[error]"'


def test_colours_only_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    for is_terminal, shown in ((True, "\x1b[1ma\x1b[0m"), (False, "a")):
        stream = io.StringIO()
        monkeypatch.setattr(stream, "isatty", lambda is_terminal=is_terminal: is_terminal)
        monkeypatch.setattr(sys, "stdout", stream)
        print_text("\x1b[1ma\x1b[0m", styled=True)
        assert stream.getvalue() == shown


def test_one_module_writes_to_the_terminal() -> None:
    folder = ROOT / "generator/canwright"
    writers = [file.name for file in folder.rglob("*.py") if "click.echo(" in file.read_text("utf-8")]
    assert writers == ["terminal.py"]


def test_annotations_are_one_line() -> None:
    from canwright.cli.printers import annotation

    at = Position("a:,\n::error::b", 1, 2, 1, "")
    line = annotation("warning", at, "r,s", "x\n::error::y\r%")
    assert line == ("::warning file=a%3A%2C%0A%3A%3Aerror%3A%3Ab,line=1,col=2,title=r%2Cs::x%0A::error::y%0D%25")
