"""The search of the site, without a browser: what it finds in the committed specs."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

import canwright
import pytest
import yaml

from ..node import run
from ..spec_texts import ROOT

SCRIPT = Path(canwright.__file__).parent / "project/site/theme/static/search.js"

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


def first_pages(folder: Path, language: str, queries: Mapping[str, Iterable[str]]) -> dict[str, list[str]]:
    """The first five pages that each query finds; queries by the edition that is open."""
    index = {**json.loads((ROOT / "generated/docs/site.json").read_text("utf-8")), "pages": guides(language)}
    asked = [(query, edition) for edition, words in queries.items() for query in words]
    program = folder / "search.cjs"
    program.write_text(
        f"{SCRIPT.read_text('utf-8')}\n"
        f"const search = createSearch({json.dumps(index)}, {json.dumps(language)});\n"
        f"const found = {json.dumps(asked)}.map(([query, edition]) => [`${{edition}} ${{query}}`, "
        "search(query, edition, { kinds: {}, node: '' }).slice(0, 5).map(({ page }) => page)]);\n"
        "console.log(JSON.stringify(Object.fromEntries(found)));\n",
        "utf-8",
    )
    return dict(json.loads(run(program)))


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


def _spelled(name: str) -> str:
    """An edition has `maxSpeed` and `Max Speed`, which are the same words."""
    return name.lower().replace(" ", "")
