"""`canwright init`: a spec and golden frames to start from."""

from __future__ import annotations

from pathlib import Path

import pytest
from canwright.cli import main
from canwright.project.loader import load
from click.testing import CliRunner, Result

SPEC = Path("spec/lamp/v1.yaml")


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def init(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["init", *arguments])


@pytest.mark.parametrize(
    ("options", "ids"),
    [
        ((), [0x101, 0x101, 0x101, 0x101]),
        (("--id", "0x140 + node", "--nodes", "3..4"), [0x143] * 4),
        (("--id", "0x600 + node", "--reply-id", "0x580 + node", "--nodes", "1..127"), [0x601, 0x581] * 2),
        (("--id", "0x200"), [0x200] * 4),
        (("--id", "0x200", "--reply-id", "0x280 + node"), [0x200, 0x281] * 2),
        (("--code", "id", "--id", "node << 5", "--nodes", "0..62"), [1, 1, 2, 2]),
        (("--code", "id", "--id", "0"), [1, 1, 2, 2]),
        (("--id", "node", "--reply-id", "master_id + 0x100"), [1, 0x101] * 2),
        (("--id", "base_id + node"), [2] * 4),
        (("--byte-order", "big"), [0x101] * 4),
        (("--broadcast",), [0x101] * 2),
        (("--broadcast", "--code", "id", "--byte-order", "big"), [0x21, 0x22]),
        (("--broadcast", "--code", "none", "--id", "0x180 + node"), [0x181]),
        (("--code", "none", "--id", "0x10", "--reply-id", "0x18", "--byte-order", "big"), [0x10, 0x18]),
        (("--code", "id", "--extended", "--id", "node", "--nodes", "0..254"), [0x100, 0x100, 0x200, 0x200]),
        (
            ("--code", "id", "--extended", "--id", "node", "--reply-id", "host_id + (node << 8)"),
            [0x10001, 0x10101, 0x20001, 0x20101],
        ),
        (("--code", "id", "--extended", "--id", "node << 8", "--edition", "2.0"), [0x101, 0x101, 0x102, 0x102]),
    ],
)
def test_what_it_writes_is_valid_without_a_warning(options: tuple[str, ...], ids: list[int]) -> None:
    result = init("lamp", *options)
    assert result.exit_code == 0, result.output
    (spec,) = (Path(line.removeprefix("wrote ")) for line in result.stdout.splitlines() if ".frames" not in line)
    loaded = load(spec)
    assert loaded.warnings == ()
    assert loaded.specification.frames is not None
    assert [frame.id for frame in loaded.specification.frames.frames] == ids
    assert spec.parent == Path("spec/lamp")


def test_what_it_writes_generates_at_once() -> None:
    assert init("lamp").exit_code == 0
    result = CliRunner().invoke(main, ["generate"])
    assert (result.exit_code, result.stderr) == (0, ""), result.output
    assert Path("generated/c/include/lamp/v1.h").is_file()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("Lamp",), "`Lamp` is not a valid family"),
        (("lamp", "--edition", "../v1"), "`../v1` is not a valid edition"),
        (("lamp", "--id", "0x7F0 + node"), "the id 0x810 exceeds the maximum of 0x7FF"),
        (("lamp", "--nodes", "all"), "`all` is not a range of whole numbers"),
        (("lamp", "--code", "id", "--id", "0x100 + node"), "leaves no bits for the code"),
        (("lamp", "--broadcast", "--reply-id", "0x180 + node"), "remove --reply-id"),
    ],
)
def test_invalid_options_write_nothing(arguments: tuple[str, ...], says: str) -> None:
    result = init(*arguments)
    assert (result.exit_code, says in result.output) == (2, True), result.output
    assert not Path("spec").exists()


@pytest.mark.parametrize("name", ["v1.yaml", "v1.frames.yaml"])
def test_existing_files_are_not_overwritten(name: str) -> None:
    SPEC.parent.mkdir(parents=True)
    (SPEC.parent / name).write_text("mine", "utf-8")
    result = init("lamp")
    assert (result.exit_code, "exists already; nothing was written" in result.stderr) == (2, True)
    assert [file.name for file in SPEC.parent.iterdir()] == [name]
    assert (SPEC.parent / name).read_text("utf-8") == "mine"
