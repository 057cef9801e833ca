"""Documents to hand over: complete, self-contained, harmless and reproducible."""

from __future__ import annotations

import csv
import io
import re
import zipfile
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.output.paths import OutputError
from canwright.project import matrix
from canwright.project.handover import build
from canwright.project.loader import specification
from canwright.project.words import LABELS
from click.testing import CliRunner

from ..spec_texts import MINIMAL, ROOT

SPECS = [ROOT / "spec/mwd_motor/v2.36-2025-03.yaml", ROOT / "tests/specs/press/v1.yaml"]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("handover") / "out"
    build([specification(spec) for spec in SPECS], out)
    return out


def test_there_is_a_document_for_each_edition_and_language(made: Path) -> None:
    names = {file.name for file in made.iterdir() if not file.name.startswith(".")}
    stems = ("mwd_motor-v2.36-2025-03-en", "mwd_motor-v2.36-2025-03-zh", "press-v1-en")
    assert names == {f"{stem}.{ending}" for stem in stems for ending in ("csv", "html", "xlsx")}


def test_documents_need_no_network_and_their_links_lead_somewhere(made: Path) -> None:
    for file in made.glob("*.html"):
        text = file.read_text("utf-8")
        assert not re.search(r"""(?:src|href)=["'](?!#|data:)|@import|url\(""", text), file.name
        anchors = set(re.findall(r' id="([^"]+)"', text))
        links = set(re.findall(r'href="#([^"]+)"', text))
        assert len(links) > 20
        assert links <= anchors, file.name
        assert "[!" not in text
        assert "Not on the site" not in text
        assert "also in" not in text


def test_every_command_is_in_the_document_and_the_matrix(made: Path) -> None:
    edition = specification(SPECS[0]).edition
    text = (made / "mwd_motor-v2.36-2025-03-zh.html").read_text("utf-8")
    data = (made / "mwd_motor-v2.36-2025-03-zh.csv").read_bytes().decode("utf-8-sig")
    rows = list(csv.DictReader(io.StringIO(data)))
    for command in edition.commands:
        assert f'<section id="commands-{command.group}">' in text
        own = [row for row in rows if row["命令"] == command.name]
        fields = {
            field.name for message in (command.request, command.reply) if message for field in message.layout.fields
        }
        assert {re.sub(r"\[.*", "", row["字段"]) for row in own} - {""} == fields - {"index"}
    torque = next(row for row in rows if (row["命令"], row["方向"], row["字段"]) == ("set_torque", "请求", "iq"))
    assert (torque["标识符"], torque["位置"], torque["位数"], torque["原始值范围"]) == (
        "0x140 + node",
        "DATA[4..5]",
        "16",
        "-2048..2048",
    )
    assert "MH: 未给出; MF: 16.5/2048 A; MG: 33/2048 A" in torque["分辨率（1 LSB）"]
    english = re.compile("[a-z]{3}")
    for column in ("方向", "帧", "含义", "分辨率（1 LSB）"):
        assert not [row for row in rows if english.search(row[column])], column


def test_equal_specs_make_equal_files(made: Path, tmp_path: Path) -> None:
    build([specification(spec) for spec in SPECS], tmp_path / "again")
    for file in made.iterdir():
        assert (tmp_path / "again" / file.name).read_bytes() == file.read_bytes(), file.name
    with zipfile.ZipFile(made / "press-v1-en.xlsx") as book:
        assert {entry.date_time for entry in book.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert b"2000-01-01T00:00:00Z" in book.read("docProps/core.xml")


def test_texts_of_a_spec_are_texts(tmp_path: Path) -> None:
    hostile = '=HYPERLINK("x") <script>alert(1)</script> </style>'
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace('    manual: "1"\n', f"    title: '{hostile}'\n"), "utf-8")
    item = specification(tmp_path / "lamp.yaml")
    build([item], tmp_path / "out")
    text = (tmp_path / "out/lamp-v1-en.html").read_text("utf-8")
    assert text.count("<script") == 1
    assert text.count("</style>") == 1
    found = list(matrix.rows(item.edition, "en"))
    assert "'=HYPERLINK" in matrix.csv_text(found, LABELS["en"]).decode("utf-8-sig")
    with zipfile.ZipFile(tmp_path / "out/lamp-v1-en.xlsx") as book:
        assert b"<f>" not in book.read("xl/worksheets/sheet1.xml")


def test_other_files_are_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine", "utf-8")
    with pytest.raises(OutputError, match=r"mine"):
        build([specification(SPECS[1])], tmp_path)


def test_the_command(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    arguments = ["handover", "--spec", str(tmp_path / "lamp.yaml"), "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(main, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "out/lamp-v1-en.html").is_file()
