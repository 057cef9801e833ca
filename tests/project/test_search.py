"""The search of the site, without a browser: what it finds in the committed specs."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import canwright
import pytest
import yaml

from ..node import run
from ..spec_texts import ROOT

PACKAGE = Path(canwright.__file__).parent
SCRIPT = PACKAGE / "project/site/theme/static/search.js"
FRAMES = PACKAGE / "targets/javascript/explorer/frames.js"

PLAIN = re.compile(r"<!--.*?-->|<[^>]+>|\(\S+\)|[`*\[\]\\\\]", re.DOTALL)
"""Marks of Markdown and HTML."""

MANUAL = {
    "v2.35": {
        "set_power": ("开环控制值", "开环控制命令"),
        "set_torque": ("转矩闭环控制命令", "力矩闭环控制", "转矩电流控制值"),
        "read_status_1": ("读取电机状态 1 和错误标志命令", "电压"),
        "read_encoder": ("读取编码器数据命令", "编码器原始位置", "编码器零偏"),
        "read_pid": ("位置环 P 参数", "转矩环", "读取 PID 参数命令"),
        "write_encoder_offset_rom": ("写入编码器值到 ROM 作为电机零点命令",),
        "motor_off": ("电机关闭命令",),
        "motor_on": ("电机运行命令", "开启电机"),
    },
    "v2.35-2024-02": {
        "read_status_1": ("母线电压", "母线电流"),
        "brake": ("抱闸器控制命令", "刹车释放", "抱闸器状态字节"),
        "read_control_parameter": ("力矩限制", "加速度限制", "控制参数"),
        "set_speed": ("速度闭环控制命令1",),
        "set_speed_limited": ("速度闭环控制命令2",),
        "set_angle": ("设置多圈角度到当前位置（写入RAM）",),
    },
    "v2.36-2024-11": {
        "read_control_parameter": ("最大力矩电流", "最大速度", "电流环", "角度环pid", "电流斜率"),
        "set_angle": ("设置当前位置为任意角度（写入RAM）",),
        "errata": ("瓴控", "lktech"),
        "types": ("输入信号丢失超时",),
    },
    "v2.36-2025-03": {
        "read_control_parameter": ("力矩电流限制", "速度限制", "电流环PID", "位置环PID", "角度上限"),
        "read_stored_setting": ("最大功率", "最大速度", "最大角度", "读取设定参数命令"),
        "save_stored_settings": ("保存设定参数命令", "保存标志"),
        "types": ("参数保存失败",),
        "brake": ("抱闸器控制和状态读取命令",),
        "calibrate_encoder": ("校准编码器命令", "校准比例值"),
        "index": ("上位机中的 Max Power",),
    },
}
"""Words of the manuals, by edition and page; of commands whose pages have a table, the page of one of them."""


def guides(language: str) -> dict[str, object]:
    """The pages that are not of commands, as the site describes them to the search."""
    docs = ROOT / "generated/docs" / language
    texts = {file.relative_to(docs).with_suffix("").as_posix(): file.read_text("utf-8") for file in docs.rglob("*.md")}
    return {
        name: {
            "title": PLAIN.sub("", text.partition("\n")[0]).strip("# "),
            "headings": [[PLAIN.sub("", heading), ""] for heading in re.findall("^##+ (.*)$", text, re.MULTILINE)],
            "text": PLAIN.sub("", text) if "/" not in name or name.endswith("/bus") else "",
        }
        for name, text in sorted(texts.items())
        if "/commands/" not in name
    }


Hit = Mapping[str, Any]


def hits_of(folder: Path, language: str, queries: Mapping[str, Iterable[str]]) -> dict[str, list[Hit]]:
    """The first five hits of each query; queries by the edition that is open."""
    index = {**json.loads((ROOT / "generated/docs/site.json").read_text("utf-8")), "pages": guides(language)}
    asked = [(query, edition) for edition, words in queries.items() for query in words]
    expression = (
        f"{json.dumps(asked)}.map(([query, edition]) => [`${{edition}} ${{query}}`, "
        "search(query, edition, { kinds: {}, node: '' }).slice(0, 5)])"
    )
    setup = f"const search = createSearch({json.dumps(index)}, {json.dumps(language)});\n"
    return dict(evaluated(folder, expression, setup))


def evaluated(folder: Path, expression: str, setup: str = "") -> Any:
    """The value of an expression beside the scripts of the search."""
    scripts = f"const canwright = {{}};\n{FRAMES.read_text('utf-8')}\n{SCRIPT.read_text('utf-8')}\n{setup}"
    program = folder / "search.cjs"
    program.write_text(f"{scripts}console.log(JSON.stringify({expression}));\n", "utf-8")
    return json.loads(run(program))


def first_pages(folder: Path, language: str, queries: Mapping[str, Iterable[str]]) -> dict[str, list[str]]:
    """The pages of the first five hits of each query; queries by the edition that is open."""
    hits = hits_of(folder, language, queries)
    return {query: [hit["page"] for hit in of_query] for query, of_query in hits.items()}


@pytest.mark.parametrize("language", ["en", "zh"])
def test_words_of_the_manual_find_the_page(language: str, tmp_path: Path) -> None:
    queries = {edition: [word for words in pages.values() for word in words] for edition, pages in MANUAL.items()}
    hits = first_pages(tmp_path, language, queries)
    failed = [
        f"{edition}: {word}: {hits[f'{edition} {word}']} instead of {name}"
        for edition, pages in MANUAL.items()
        for name, words in pages.items()
        for word in words
        if not {f"{edition}/{name}", f"{edition}/commands/{name}"} & set(hits[f"{edition} {word}"])
    ]
    assert failed == []


def test_the_word_command_in_a_query_excludes_no_page(tmp_path: Path) -> None:
    """Headings of manuals contain it, titles do not."""
    hits = first_pages(tmp_path, "en", {"v2.35": ["read encoder", "read encoder command"]})
    assert hits["v2.35 read encoder"][0] == hits["v2.35 read encoder command"][0] == "v2.35/commands/read_encoder"


@pytest.mark.parametrize("language", ["en", "zh"])
def test_queries_of_readers(language: str, tmp_path: Path) -> None:
    """Codes with editions, pasted frames, names of the vendor, units, typos and questions, without an open edition."""
    queries = yaml.safe_load((Path(__file__).parent / "search_queries.yaml").read_text("utf-8"))
    hits = first_pages(tmp_path, language, {"": queries})
    failed = [
        f"{query}: {hits[f' {query}'][:2]} instead of {pages}"
        for query, pages in queries.items()
        if not any(page in pages or page.partition("/")[2] in pages for page in hits[f" {query}"][:2])
    ]
    assert failed == []


@pytest.mark.parametrize("language", ["en", "zh"])
def test_numbers_that_are_no_codes(language: str, tmp_path: Path) -> None:
    """Numbers with a unit, of a range or beside other words; written as a code, they are codes."""
    numbers = ("-33A~33A", "18 bit encoder", "90 degrees", "33 A", "temperature 33", "24 V 19 motors", "最大 34 度")
    codes = ("33", "0x33", "33h", "command 33", "33命令", "33 v2.35", "function code 33", "0x33 acceleration")
    hits = first_pages(tmp_path, language, {"": [*numbers, *codes]})
    of_codes = (
        "calibrate_encoder",
        "read_encoder",
        "read_acceleration",
        "write_acceleration_ram",
        "write_position_as_zero_rom",
    )
    for query in numbers:
        assert not hits[f" {query}"][0].endswith(of_codes), query
    for query in codes:
        assert hits[f" {query}"][0] == "v2.35/commands/read_acceleration", query


@pytest.mark.parametrize("language", ["en", "zh"])
def test_a_hit_has_each_other_edition_once_in_their_order(language: str, tmp_path: Path) -> None:
    """Also of a query with typos, which is compared in several spellings."""
    editions = [
        edition["name"] for edition in json.loads((ROOT / "generated/docs/site.json").read_text("utf-8"))["editions"]
    ]
    queries = ("torqe loop comand", "2048 = how many amps MG", "相对位移 限速", "types")
    hits = [hit for of_query in hits_of(tmp_path, language, {"": queries}).values() for hit in of_query]
    named = [[further["edition"] for further in hit["others"]] for hit in hits]
    assert max(map(len, named)) == len(editions) - 1
    for hit, names in zip(hits, named, strict=True):
        assert names == [name for name in editions if name in names]
        assert hit["edition"] not in names


FRAMES_OF = {
    ("143#9A1E00E0", "can0 143#9A1E00E0", "143 # 9A 1E 00 E0"): (0x143, [0x9A, 0x1E, 0, 0xE0]),
    ("(1716900000.123456) can0 143#9A1E00E0", "143 9A 1E 00 E0"): (0x143, [0x9A, 0x1E, 0, 0xE0]),
    ("can0  143   [4]  9A 1E 00 E0", "143 9A1E00E0"): (0x143, [0x9A, 0x1E, 0, 0xE0]),
    ("9a 1e 00 e0", "0x9A,0x1E,0x00,0xE0"): (None, [0x9A, 0x1E, 0, 0xE0]),
    ("9A1E00E001000008", "{0x9A, 0x1E, 0, 0xE0, 1, 0, 0, 8}"): (None, [0x9A, 0x1E, 0, 0xE0, 1, 0, 0, 8]),
    ("１４３ ９Ａ １Ｅ", "143 9A 1E"): (0x143, [0x9A, 0x1E]),
    ("280#",): (0x280, []),
}
WORDS = (
    "facade",
    "9A",
    "0x9A",
    "A4 命令",
    "100000",
    "2048",
    "20241115",
    "32A multi motor 2000",
    "360 rpm 120000",
    "-33A~33A",
)


def test_pasted_frames_are_those_that_the_explorer_reads(tmp_path: Path) -> None:
    wanted = {text: {"id": number, "data": data} for texts, (number, data) in FRAMES_OF.items() for text in texts}
    asked = [*wanted, *WORDS]
    shown = "map(frame => frame && { id: frame.id, data: frame.data })"
    read = evaluated(tmp_path, f"{json.dumps(asked)}.map(pastedFrame).{shown}")
    assert dict(zip(asked, read, strict=True)) == {**wanted, **dict.fromkeys(WORDS)}


@pytest.mark.parametrize("language", ["en", "zh"])
def test_names_of_the_manual_find_their_pages(language: str, tmp_path: Path) -> None:
    index = json.loads((ROOT / "generated/docs/site.json").read_text("utf-8"))
    wanted: dict[tuple[str, str], set[str]] = {}
    by_edition: dict[str, list[str]] = {}
    for edition in index["editions"]:
        for record in edition["records"]:
            for name in filter(None, record.get("printed", "").split(", ")):
                by_edition.setdefault(edition["folder"], []).append(name)
                pages = wanted.setdefault((edition["folder"], _spelled(name)), set())
                pages |= {f"{edition['folder']}/{page.partition('#')[0]}" for page in record["pages"]}
    assert len(wanted) > 150
    hits = first_pages(tmp_path, language, by_edition)
    failed = [
        f"{folder}: {name}: {hits[f'{folder} {name}']}"
        for folder, names in by_edition.items()
        for name in names
        if not wanted[folder, _spelled(name)] & {*hits[f"{folder} {name}"][:2]}
    ]
    assert failed == []


@pytest.mark.parametrize("language", ["en", "zh"])
def test_a_field_leads_to_its_row(language: str, tmp_path: Path) -> None:
    """Each row that the search knows is in its page; a row of an entry is that of the entry."""
    index = json.loads((ROOT / "generated/docs/site.json").read_text("utf-8"))
    rows = [
        (ROOT / "generated/docs" / language / edition["folder"] / f"{page}.md", anchor)
        for edition in index["editions"]
        for record in edition["records"]
        if record["kind"] == "field"
        for page, _, anchor in (place.partition("#") for place in record["pages"])
    ]
    assert len(rows) > 400
    assert [anchor for page, anchor in rows if f'| <a id="{anchor}"></a>`' not in page.read_text("utf-8")] == []
    (hit, *_), (of_entry, *_) = hits_of(
        tmp_path, language, {"v2.35": ["angleIncrement"], "v2.36-2024-11": ["input speed limit"]}
    ).values()
    assert (hit["page"], hit["anchor"]) == ("v2.35/commands/move_by_angle", "request.increment")
    assert (of_entry["page"], of_entry["anchor"]) == (
        "v2.36-2024-11/commands/read_control_parameter",
        "entries.max_speed.reply.max_speed",
    )


def _spelled(name: str) -> str:
    """An edition has `maxSpeed` and `Max Speed`, which are the same words."""
    return name.lower().replace(" ", "")
