"""Documents to hand over: complete, self-contained, harmless and reproducible."""

from __future__ import annotations

import csv
import importlib.util
import io
import math
import re
import struct
import zipfile
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from xml.etree import ElementTree

import pytest
from canwright.cli import main
from canwright.model.golden_frames import GoldenFrame
from canwright.project.loader import specification
from canwright.targets.handover import matrix, spreadsheets
from canwright.targets.registry import default_targets
from canwright.templating.data_files import template_texts
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL, ROOT, SPECS as SPECS_OF_ALL, called

LABELS = template_texts("handover/labels.yaml")
SPECS = [ROOT / "spec/mwd_motor/v2.36-2025-03.yaml", ROOT / "tests/specs/press/v1.yaml"]


def handover(specs: Sequence[Path], out: Path, *arguments: str) -> Result:
    given = (part for spec in specs for part in ("--spec", str(spec)))
    return CliRunner().invoke(main, ["handover", *given, "--out", str(out), *arguments], catch_exceptions=False)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("handover") / "out"
    assert handover(SPECS, out).exit_code == 0
    return out


def test_there_is_a_document_for_each_edition_and_language(made: Path) -> None:
    names = {file.name for file in made.iterdir() if not file.name.startswith(".")}
    stems = ("mwd_motor-v2.36-2025-03-en", "mwd_motor-v2.36-2025-03-zh", "press-v1-en")
    assert names == {f"{stem}.{ending}" for stem in stems for ending in ("csv", "html", "xlsx")}


@pytest.mark.parametrize(
    ("spec", "direction", "command", "id_"),
    [
        ("chassis", "request", "steer", "0xA0"),
        ("chassis", "request", "park", "0x1E0"),
        ("cells", "request", "balance", "0x1900FF40 + (node << 16)"),
    ],
)
def test_ids_are_those_on_the_bus(spec: str, direction: str, command: str, id_: str) -> None:
    """With the code, and with the constant bits of an id, such as a priority."""
    edition = specification(ROOT / f"tests/specs/{spec}/v1.yaml").edition
    rows = [
        row
        for row in matrix.rows(matrix.Shown(edition, "en", LABELS["en"]))
        if (row.direction, row.command) == (LABELS["en"][direction], command)
    ]
    assert {row.id for row in rows} == {id_}


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
        assert f'<section id="commands-{command.spec_name}">' in text
        own = [row for row in rows if row["命令"] == command.name]
        layouts = [message.layout for message in (command.request, command.reply) if message]
        fields = {
            field.name
            for layout in layouts
            for field in layout.fields
            if not field.only or set(field.only) & set(command.only.get(layout.parameter or "", field.only))
        }
        assert {re.sub(r"\[.*", "", row["字段"]) for row in own} - {""} == fields - {"index"}
    torque = [row for row in rows if (row["命令"], row["方向"], row["字段"]) == ("set_torque", "请求", "iq")]
    place = {(row["标识符"], row["位置"], row["位数"], row["原始值下限"], row["原始值上限"]) for row in torque}
    assert place == {("0x140 + node", "DATA[4..5]", "16", "-2048", "2048")}
    assert [(row["适用于"], row["分辨率（1 LSB）"], row["分辨率（手册写法）"], row["单位"]) for row in torque] == [
        ("电机系列：MF", "0.008056640625", "× 16.5/2048", "A"),
        ("电机系列：MH", "", "未给出", "A"),
        ("电机系列：MG", "0.01611328125", "× 33/2048", "A"),
    ]
    english = re.compile("[a-z]{3}")
    for column in ("方向", "帧", "含义", "分辨率（1 LSB）", "适用于", "位置", "原始数据类型", "手册章节"):
        assert not [row for row in rows if english.search(row[column])], column


MATRIX_SPEC = """\
canwright: 1
family: lamp
edition: v1
date: 2024-01
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
parameters: {model: {values: [A, B]}, size: {number: {}}}
types:
  level: {raw: u16, unit: "%", scale: 0.1, offset: -10, raw_range: 0..1000}
  third: {raw: u8, scale: 1/3*size}
  errors: {raw: u8, flags: {low: {bit: 0}, hot: {bit: 3}}}
layouts:
  status:
    fields:
      level: {at: 2, type: level, only: {model: [A]}}
      third: {at: 2, type: third, only: {model: [B]}}
      errors: {at: 1, type: errors}
commands:
  dim: {code: 0x10, request: {level: {at: 2, type: level}}, reply: echo}
  read: {code: 0x11, only: {model: [A]}, request: {}, reply: {layout: status, accept: [0x91]}}
  stop: {code: 0x12, request: {trim: {at: 1, raw: i8, constant: -5}}, reply: none}
"""


def _cells(spec: Path, language: str) -> list[dict[str, str]]:
    """The matrix, read back from CSV; columns by the names of the model."""
    item = specification(spec)
    text = spreadsheets.csv_text(
        list(matrix.rows(matrix.Shown(item.edition, language, LABELS[language]))),
        {name: name for name in matrix.Row._fields},
    )
    return list(csv.DictReader(io.StringIO(text.decode("utf-8-sig"))))


@pytest.mark.parametrize("spec", SPECS_OF_ALL, ids=called)
def test_golden_frames_are_decoded_with_the_matrix_alone(spec: Path) -> None:
    """Every field once under its parameters, at its place, with its resolution; and nothing that no node has."""
    item = specification(spec)
    assert item.frames is not None
    language = next(iter(item.edition.languages), "en")
    listed = _cells(spec, "en" if "en" in item.edition.languages else language)
    titles = {p.title[language]: p.name for p in item.edition.parameters}
    decoded = 0
    for frame in item.frames.frames:
        _lists_no_other_field(frame, listed, titles)
        rows = [r for r in listed if (r["command"], r["direction"]) == (frame.command, frame.direction.value)]
        known = {name: str(value) for name, value in frame.parameters.items()}
        assert frame.node is None or str(frame.node) in _expanded(rows[0]["nodes"]), frame
        for name, raw in frame.raw.items():
            for index, element_raw in enumerate(raw) if isinstance(raw, list) else [(None, raw)]:
                elements = [r for r in rows if re.sub(r"\[\d+\]", "", r["field"]) == name]
                elements = [r for r in elements if _applies(r["only"], titles, known)]
                places = list(dict.fromkeys(r["position"] for r in elements))
                own = [r for r in elements if r["position"] == places[index or 0]]
                assert own and {_raw(frame, r) for r in own} == {element_raw}, (frame, own)
                assert len(own) == 1 or not all(_is_decided(r["only"], titles, known) for r in own), (frame, own)
                value = frame.values.get(name)
                value = value[index] if isinstance(value, list) and index is not None else value
                if isinstance(value, Fraction) and len(own) == 1:
                    decoded += _has_value(own[0], element_raw, value)
    assert decoded or not any(frame.values for frame in item.frames.frames)


def _lists_no_other_field(frame: GoldenFrame, listed: Sequence[Mapping[str, str]], titles: Mapping[str, str]) -> None:
    """Checks that the fields that exist under the parameters of a frame, as far as these decide that, are in the frame."""
    known = {name: str(value) for name, value in frame.parameters.items()}
    rows = [r for r in listed if (r["command"], r["direction"]) == (frame.command, frame.direction.value)]
    rows = [r for r in rows if r["field"] and not r["fixed"] and _is_decided(r["only"], titles, known)]
    names = {re.sub(r"\[\d+\]", "", r["field"]) for r in rows if _applies(r["only"], titles, known)}
    assert names <= set(frame.raw), frame


def _is_decided(only: str, titles: Mapping[str, str], known: Mapping[str, str]) -> bool:
    """Whether the parameters that a condition names are known."""
    return all(titles[part.partition(": ")[0]] in known for part in only.split("; ") if part)


def _has_value(row: Mapping[str, str], raw: int, value: Fraction) -> bool:
    """Checks a value, unless its resolution depends on a number parameter."""
    try:
        resolution, offset = float(row["resolution"]), float(row["offset"])
    except ValueError:
        return False
    codes = {"f32": ("<I", "<f"), "f64": ("<Q", "<d")}.get(row["raw"].split()[0])
    number = struct.unpack(codes[1], struct.pack(codes[0], raw))[0] if codes else raw
    assert math.isclose(number * resolution + offset, value, rel_tol=1e-9, abs_tol=1e-12), (row, raw, value)
    return True


def _expanded(nodes: str) -> set[str]:
    runs = (run.partition("..") for run in nodes.split(", "))
    return {str(node) for low, _, high in runs for node in range(int(low), int(high or low) + 1)}


def _applies(only: str, titles: Mapping[str, str], known: Mapping[str, str]) -> bool:
    conditions = (part.partition(": ") for part in only.split("; ") if part)
    return all(known.get(titles[title], "") in ("", *values.split(", ")) for title, _, values in conditions)


def _raw(frame: GoldenFrame, row: Mapping[str, str]) -> int:
    """The raw integer at the place of a row."""
    raw, width = 0, 0
    encoding = re.match(r"([uif])(\d+)( big-endian)?", row["raw"])
    assert encoding
    parts = re.findall(r"DATA\[(\d+)(?:\.\.(\d+))?\](?: bits? (\d)(?:\.\.(\d))?)?", row["position"])
    if row["position"].startswith("id"):
        low, _, high = row["position"].split()[-1].partition("..")
        raw, width = frame.id >> int(low) & (1 << int(high or low) - int(low) + 1) - 1, int(encoding[2])
    bytes_ = [
        (byte, low, high) for first, last, low, high in parts for byte in range(int(first), int(last or first) + 1)
    ]
    runs = re.findall(r"DATA\[(\d+)(?:\.\.(\d+))?\](?: bits? (\d)(?:\.\.(\d))?)? \[(?:\d+:)?(\d+)\]", row["position"])
    if runs:
        return _of_runs(frame, runs, encoding)
    lengths = [int(high or low) - int(low) + 1 if low else 8 for _, low, high in bytes_]
    is_shared = not row["position"].startswith("id") and sum(lengths) < int(
        encoding[2]
    )  # numbers are in a word of flags
    for byte, low, high in reversed(bytes_) if encoding[3] else bytes_:
        bits = int(high or low) - int(low) + 1 if low else 8
        part = frame.data[byte] >> int(low or 0) & (1 << bits) - 1
        raw |= part << (8 * (int(byte) - int(bytes_[0][0])) + int(low or 0) if is_shared else width)
        width += bits
    assert int(encoding[2]) == int(row["bits"]) and (is_shared or width == int(encoding[2]))
    return raw - (1 << width) if encoding[1] == "i" and raw >> width - 1 else raw


def _of_runs(frame: GoldenFrame, runs: Sequence[Sequence[str]], encoding: re.Match[str]) -> int:
    """The raw integer of a field in several runs, each with the number of its lowest bit in that integer."""
    raw = 0
    for first, last, low, high, lowest in runs:
        bits = int(high or low) - int(low) + 1 if low else 8
        numbers = range(int(first), int(last or first) + 1)
        for place, byte in enumerate(reversed(numbers) if encoding[3] else numbers):
            part = frame.data[byte] >> int(low or 0) & (1 << bits) - 1
            raw |= part << (int(lowest) + bits * place)
    width = int(encoding[2])
    return raw - (1 << width) if encoding[1] == "i" and raw >> width - 1 else raw


def test_matrix_has_ranges_codes_flags_and_forms_of_replies(tmp_path: Path) -> None:
    """Flags are bits, replies of some nodes come from these; numbers, other codes, forms of replies, edition and date."""
    (tmp_path / "lamp.yaml").write_text(MATRIX_SPEC, "utf-8")
    rows = _cells(tmp_path / "lamp.yaml", "en")
    assert {(row["edition"], row["date"]) for row in rows} == {("v1", "2024-01")}
    level, status = (
        rows[1],
        {row["field"]: row for row in rows if row["command"] == "read" and row["direction"] == "reply"},
    )
    columns = ("raw_minimum", "raw_maximum", "resolution", "offset", "unit", "minimum", "maximum")
    assert [level[name] for name in columns] == ["0", "1000", "0.1", "-10", "%", "-10", "90"]
    assert status["errors"]["values"] == "bit 0 (0x01) = low (Low); bit 3 (0x08) = hot (Hot)"
    assert list(status) == ["", "level", "errors"]
    assert status[""]["meaning"] == "command code; also accepted: 0x91"
    forms = {(row["command"], row["direction"]): row["answer"] for row in rows}
    assert forms == {
        ("dim", "request"): "",
        ("dim", "reply"): "the request, unchanged",
        ("read", "request"): "",
        ("read", "reply"): "",
        ("stop", "request"): "no reply",
    }
    assert [(row["field"], row["fixed"]) for row in rows if row["command"] == "stop"] == [("", "0x12"), ("trim", "-5")]
    motor = _cells(ROOT / "spec/mwd_motor/v2.35.yaml", "zh")
    replies = [row for row in motor if row["command"] == "broadcast_torque" and row["direction"] == "回复"]
    assert {(row["nodes"], row["answer"]) for row in replies} == {
        ("1..4", "与 set_torque 的回复相同；节点 1..4 各回复一帧")
    }
    speed = next(row for row in motor if row["field"] == "speed" and row["direction"] == "回复")
    assert (speed["resolution"], speed["offset"], speed["unit"]) == ("1", "0", "°/s")


def test_excel_has_sheets_for_commands_fields_types_errata_and_sources(made: Path) -> None:
    """Their names in the language of the file; every command, type, erratum and source; numbers are numbers."""
    item = specification(SPECS[0])
    edition = item.edition
    assert item.frames is not None
    english = _sheets(made / "mwd_motor-v2.36-2025-03-en.xlsx")
    chinese = _sheets(made / "mwd_motor-v2.36-2025-03-zh.xlsx")
    assert list(english) == ["Commands", "Fields", "Types", "Errata", "Sources"]
    assert list(chinese) == ["命令", "字段", "类型", "勘误", "来源"]
    title = f"mwd_motor v2.36-2025-03 (2025-03): {edition.title['en']}"
    assert {rows[0][0] for rows in english.values()} == {title}
    tables = {name: [dict(zip(rows[1], row, strict=True)) for row in rows[2:]] for name, rows in english.items()}
    assert [row["Command"] for row in tables["Commands"]] == [command.name for command in edition.commands]
    torque = next(row for row in tables["Commands"] if row["Command"] == "set_torque")
    assert (torque["Code"], torque["Id"], torque["Nodes"]) == ("0xA1", "0x140 + node", "1..32")
    assert list(dict.fromkeys(row["Type"] for row in tables["Types"])) == [type_.name for type_ in edition.types]
    assert [row["Erratum"] for row in tables["Errata"]] == [erratum.id for erratum in edition.errata]
    assert tables["Sources"][4]["Description"] == edition.hash
    assert {row["Source"] for row in tables["Sources"]} >= set(item.frames.sources)
    assert all(isinstance(row["Golden frames"], float) for row in tables["Sources"][5:])
    current = [row for row in tables["Fields"] if (row["Command"], row["Direction"]) == ("set_torque", "request")]
    columns = ("Raw minimum", "Raw maximum", "Resolution (1 LSB)", "Minimum value", "Maximum value")
    assert [[row[column] for column in columns] for row in current if row["Field"] == "iq"] == [
        [-2048, 2048, 0.008056640625, -16.5, 16.5],
        [-2048, 2048, "", "", ""],
        [-2048, 2048, 0.01611328125, -33, 33],
    ]


def test_a_field_without_a_range_has_the_physical_range_of_its_raw_format() -> None:
    """`speed` is a 16-bit integer of 1 °/s; a column of numbers has no text where a number is not known."""
    rows = _cells(ROOT / "spec/mwd_motor/v2.35.yaml", "en")
    speed = next(row for row in rows if row["field"] == "speed" and row["direction"] == "reply")
    assert (speed["minimum"], speed["maximum"]) == ("-32768", "32767")
    assert not [row for row in rows if re.search("[a-z]", row["resolution"])]


@pytest.mark.parametrize("spec", SPECS_OF_ALL, ids=called)
def test_excel_has_the_rows_of_the_matrix(spec: Path, tmp_path: Path) -> None:
    """Below the title and the headings; integers that Excel would round are texts."""
    listed = list(matrix.rows(matrix.Shown(specification(spec).edition, "en", LABELS["en"])))
    listed.append(listed[0]._replace(raw_minimum=Fraction(1 - 10**15), raw_maximum=Fraction(2**63 - 1)))
    sheet = spreadsheets.Sheet("sheet", list(matrix.Row._fields), listed)
    (tmp_path / "matrix.xlsx").write_bytes(spreadsheets.excel([sheet], "title"))
    title, names, *rows = _sheets(tmp_path / "matrix.xlsx")["sheet"]
    assert (title, names) == (["title"], list(matrix.Row._fields))
    for row, wanted in zip(rows, listed, strict=True):
        for cell, exact in zip(row, wanted, strict=True):
            if isinstance(exact, Fraction) and abs(exact) < 10**15:
                assert isinstance(cell, float) and math.isclose(cell, exact, rel_tol=1e-15), (row, exact)
            else:
                assert cell == str(exact), row


def _sheets(file: Path) -> dict[str, list[list[str | float]]]:
    """The cells of the sheets of an Excel file, by the names of the sheets."""
    space = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
    with zipfile.ZipFile(file) as book:
        strings = ElementTree.fromstring(book.read("xl/sharedStrings.xml"))
        texts = ["".join(part.text or "" for part in string.iter(f"{space}t")) for string in strings]
        listed = ElementTree.fromstring(book.read("xl/workbook.xml")).iter(f"{space}sheet")
        sheets = {
            sheet.attrib["name"]: ElementTree.fromstring(book.read(f"xl/worksheets/sheet{number}.xml"))
            for number, sheet in enumerate(listed, 1)
        }

    def cells(row: ElementTree.Element) -> list[str | float]:
        typed = ((cell.get("t"), cell.findtext(f"{space}v", "")) for cell in row)
        return [texts[int(value)] if kind == "s" else float(value) if value else "" for kind, value in typed]

    return {name: [cells(row) for row in sheet.iter(f"{space}row")] for name, sheet in sheets.items()}


@pytest.mark.parametrize("language", ["en", "zh"])
def test_a_spreadsheet_changes_no_text(language: str) -> None:
    """A program that opens the CSV reads no text as a number, a date or a truth value: `2.10` would be 2.1, `1/3` a day."""
    read_otherwise = re.compile(r"[-+]?\d*\.?\d+(e[-+]?\d+)?%?|\d+ ?[-/:] ?\d+( ?[-/:] ?\d+)?|true|false", re.I)
    numbers = {"bits", "fixed", "raw_minimum", "raw_maximum", "resolution", "offset", "minimum", "maximum"}
    for spec in (spec for spec in SPECS_OF_ALL if language in specification(spec).edition.languages):
        for row in _cells(spec, language):
            texts = {name: cell for name, cell in row.items() if name not in numbers and read_otherwise.fullmatch(cell)}
            assert set(texts) <= {"nodes", "date"} and texts.get("nodes", "1").isdigit(), (spec, row)


def test_equal_specs_make_equal_files(made: Path, tmp_path: Path) -> None:
    handover(SPECS, tmp_path / "again")
    for file in made.iterdir():
        assert (tmp_path / "again" / file.name).read_bytes() == file.read_bytes(), file.name
    with zipfile.ZipFile(made / "press-v1-en.xlsx") as book:
        assert {entry.date_time for entry in book.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert b"2000-01-01T00:00:00Z" in book.read("docProps/core.xml")


def test_texts_of_a_spec_are_escaped(tmp_path: Path) -> None:
    hostile = '=HYPERLINK("x") <script>alert(1)</script> </style>'
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace('    manual: "1"\n', f"    title: '{hostile}'\n"), "utf-8")
    item = specification(tmp_path / "lamp.yaml")
    handover([tmp_path / "lamp.yaml"], tmp_path / "out")
    text = (tmp_path / "out/lamp-v1-en.html").read_text("utf-8")
    assert text.count("<script") == 1
    assert text.count("</style>") == 1
    rows = list(matrix.rows(matrix.Shown(item.edition, "en", LABELS["en"])))
    assert "'=HYPERLINK" in spreadsheets.csv_text(rows, LABELS["en"]).decode("utf-8-sig")
    with zipfile.ZipFile(tmp_path / "out/lamp-v1-en.xlsx") as book:
        assert not any(b"<f>" in book.read(name) for name in book.namelist())


def test_other_files_are_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine", "utf-8")
    result = handover(SPECS[1:], tmp_path)
    assert (result.exit_code, "mine" in result.stderr) == (2, True)


def test_handover_command_writes_documents(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    result = handover([tmp_path / "lamp.yaml"], tmp_path / "out")
    assert result.exit_code == 0, result.output
    names = [f"lamp-v1-en.{ending}" for ending in ("csv", "html", "xlsx")]
    assert result.stdout == "".join(f"{(tmp_path / 'out' / name).as_posix()}\n" for name in names)


def test_the_documents_are_a_target_that_has_to_be_named(made: Path, tmp_path: Path) -> None:
    """`generate --target handover` writes and `check` compares the same files, in a folder of the target."""
    given = [
        *(part for spec in SPECS for part in ("--spec", str(spec))),
        "--out",
        str(tmp_path),
        "--target",
        "handover",
    ]
    assert "handover" not in default_targets()
    assert CliRunner().invoke(main, ["generate", *given], catch_exceptions=False).exit_code == 0
    for file in made.glob("[a-z]*"):
        assert (tmp_path / "handover" / file.name).read_bytes() == file.read_bytes(), file.name
    assert CliRunner().invoke(main, ["check", *given], catch_exceptions=False).exit_code == 0
    book = tmp_path / "handover/press-v1-en.xlsx"
    book.write_bytes(book.read_bytes()[:-1])
    result = CliRunner().invoke(main, ["check", *given], catch_exceptions=False)
    assert result.exit_code == 1
    assert result.stdout == f"Binary files {book.as_posix()} and handover/press-v1-en.xlsx as generated differ\n"


@pytest.mark.parametrize("command", [["handover"], ["generate", "--target", "handover"]])
def test_missing_packages_are_named_where_the_target_is_asked_for(
    command: Sequence[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    given = ["--spec", str(tmp_path / "lamp.yaml"), "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(main, [*command, *given], catch_exceptions=False)
    message = "canwright: required packages are not installed; run: pip install markdown-it-py XlsxWriter\n"
    assert (result.exit_code, result.stderr.endswith(message)) == (2, True)
    assert not (tmp_path / "out").exists()
    assert CliRunner().invoke(main, ["generate", *given], catch_exceptions=False).exit_code == 0


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("printed") / "out"
    assert handover([ROOT / "spec/mwd_motor/v2.35.yaml", *SPECS], out, "--pdf").exit_code == 0
    return out


@pytest.mark.interop
def test_pdf_is_short_and_has_contents_with_the_pages_of_commands(printed: Path) -> None:
    """At most 40 pages; each command is in the contents with the number of the page that contains its heading."""
    from pypdf import PdfReader

    for language in ("en", "zh"):
        edition = specification(ROOT / "spec/mwd_motor/v2.35.yaml").edition
        pages = [_plain(page.extract_text()) for page in PdfReader(printed / f"mwd_motor-v2.35-{language}.pdf").pages]
        assert len(pages) <= 40
        start = next(number for number, page in enumerate(pages) if _plain("motor_off") in page)
        contents = "".join(pages[:start])
        for command in edition.commands:
            code = "" if command.code is None else f"0x{command.code:02X}"
            title = _plain(f"{code}{command.title[language]}")
            entry = re.search(rf"{re.escape(title)}\.+(\d+?)(?!\d*\.\d)(?=0x|\D|$)", contents)
            assert entry and title in pages[int(entry[1]) - 1], title


@pytest.mark.interop
def test_pdf_has_family_edition_date_and_hash_on_every_page(printed: Path) -> None:
    from pypdf import PdfReader

    edition = specification(SPECS[0]).edition
    for language in ("en", "zh"):
        reader = PdfReader(printed / f"mwd_motor-v2.36-2025-03-{language}.pdf")
        for number, page in enumerate(reader.pages, 1):
            text = _plain(page.extract_text())
            assert text.startswith(_plain("mwd_motor v2.36-2025-03 (2025-03)")), (language, number)
            assert edition.hash[:12] in text and f"{number}/{len(reader.pages)}" in text, (language, number)


@pytest.mark.interop
def test_pdf_contains_its_fonts_with_a_glyph_for_every_character(printed: Path) -> None:
    """All fonts are embedded; Chinese texts can be read back, and no character has the glyph of a missing one."""
    from pypdf import PdfReader

    edition = specification(ROOT / "spec/mwd_motor/v2.35.yaml").edition
    reader = PdfReader(printed / "mwd_motor-v2.35-zh.pdf")
    text = _plain("".join(page.extract_text() for page in reader.pages))
    for command in edition.commands:
        assert _plain(command.title["zh"]) in text, command.name
    names = set()
    for page in reader.pages:
        for reference in page["/Resources"]["/Font"].values():
            font = reference.get_object()["/DescendantFonts"][0].get_object()
            names.add(str(font["/BaseFont"]))
            assert {"/FontFile2", "/FontFile3"} & set(font["/FontDescriptor"].get_object()), font["/BaseFont"]
    assert any("NotoSansSC" in name for name in names), names
    assert not any("Libertinus" in name for name in names), names
    assert not re.search("[\0\ufffd]", text)


@pytest.mark.interop
def test_equal_specs_make_equal_pdfs_with_the_bus_and_each_shared_layout_once(printed: Path, tmp_path: Path) -> None:
    from pypdf import PdfReader

    handover([ROOT / "spec/mwd_motor/v2.35.yaml"], tmp_path / "again", "--pdf")
    for file in (tmp_path / "again").glob("*.pdf"):
        assert (printed / file.name).read_bytes() == file.read_bytes(), file.name
    reader = PdfReader(printed / "mwd_motor-v2.35-en.pdf")
    text = _plain("".join(page.extract_text() for page in reader.pages))
    assert "1000,500,250,125,100kbit/s;default1000" in text and "0x140+node" in text
    assert text.count("fieldsoflayoutmotion_feedback") == 10
    assert text.count("Torquecurrent;Motorseries:MG") == 1


@pytest.mark.interop
def test_texts_of_a_spec_are_no_markup_of_the_pdf(tmp_path: Path) -> None:
    from pypdf import PdfReader

    hostile = '#read("/etc/passwd") *bold* $x$ @nowhere <label> // = `raw` \\ #set page(width: 1pt)'
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace('    manual: "1"\n', f"    title: '{hostile}'\n"), "utf-8")
    assert handover([tmp_path / "lamp.yaml"], tmp_path / "out", "--pdf").exit_code == 0
    text = "".join(page.extract_text() for page in PdfReader(tmp_path / "out/lamp-v1-en.pdf").pages)
    assert _plain(text).count(_plain(hostile)) >= 2


def test_missing_packages_of_the_pdf_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    result = handover([tmp_path / "lamp.yaml"], tmp_path / "out", "--pdf")
    packages = "pip install markdown-it-py XlsxWriter typst pylopdf-fonts-zh-cn\n"
    assert (result.exit_code, result.stderr.endswith(packages)) == (2, True)


def test_documents_contain_no_program(made: Path) -> None:
    for file in made.glob("mwd_motor*.html"):
        text = file.read_text("utf-8")
        assert "#include" not in text and "import " not in text, file.name


def _plain(text: str) -> str:
    """A text without spaces and marks of possible line breaks."""
    return re.sub(r"[\s\u200b\u2060]", "", text)
