"""The frame explorer in a browser: both directions, keyboard, languages, themes, widths, and hostile texts."""

from __future__ import annotations

import functools
import itertools
import threading
from collections.abc import Callable, Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from canwright.conformance.adapter import write_files
from canwright.model import formatting
from canwright.project.loader import specification
from canwright.targets.javascript.page import FOLDER, explorer

from ..project.browser import PACKAGES, accessibility_violations, browser
from ..spec_texts import MINIMAL, SPECS
from ..untrusted.everything import filled
from ..untrusted.hostile import HOSTILE

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.machine(*PACKAGES)

TORQUE = "#frame=141%23A1329B00F4010080&edition=v2.35&direction=reply&parameter.series=MG&parameter.encoder_bits=15"
Open = Callable[..., "Page"]


class _Quiet(SimpleHTTPRequestHandler):
    """A server without messages."""

    def log_message(self, format: str, *args: object) -> None:
        pass


@pytest.fixture(scope="module")
def page_of_motors(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page with the editions of the motor protocol."""
    items = [specification(spec) for spec in SPECS[:4]]
    return write_files(explorer(items), tmp_path_factory.mktemp("explorer")) / FOLDER / "index.html"


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    with browser() as launched:
        yield launched


@pytest.fixture
def opened(chromium: Browser) -> Iterator[Open]:
    """Opens a page from its folder. At the end, nothing was reported and no other file than its own was asked for."""
    problems: list[str] = []
    contexts = []

    def open_page(file: Path, state: str = "", **options: Any) -> Page:
        root = options.pop("root", file.parent.as_uri())
        context = chromium.new_context(**{"viewport": {"width": 1280, "height": 900}, "locale": "en-US", **options})
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: problems.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("dialog", lambda dialog: problems.append(f"dialog: {dialog.message}"))
        allowed = (root, "data:")
        page.on("request", lambda request: None if request.url.startswith(allowed) else problems.append(request.url))
        page.goto(f"{root}/{file.name}{state}")
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert problems == [], problems


REPLAY = """
(questions) => questions.map(([line, edition, direction, command, parameters]) => {
  const all = canwright.meaning.interpret(canwright.frames.parseLine(line), parameters);
  const found = all.find((one) => one.edition.name === edition && one.decoded.direction === direction && one.decoded.command === command);
  if (!found) { return null; }
  const { codec } = found.edition;
  const encode = direction === "request" ? codec.encodeRequest : codec.encodeReply;
  const raw = Object.entries(found.decoded.raw).map(([name, one]) => [name, [one].flat().map(String)]);
  let written = "";
  try {
    const { node, code, fields } = found.decoded;
    const isCoarse = ({ raw }) => [raw].flat().some((one) => one >= 2 ** 50 || one <= -(2 ** 50));
    const values = Object.fromEntries(fields.map(({ name, value }) => [name, value]));
    const content = fields.some((one) => one.reason || isCoarse(one)) ? { raw: found.decoded.raw } : { values };
    written = canwright.frames.format(encode(command, { node: node ?? undefined, code: code ?? undefined, ...content, parameters: found.assumed[0] }).frame);
  } catch (error) {
    written = error.refusal;
  }
  return { raw: Object.fromEntries(raw), written };
})
"""


def test_golden_frames_in_both_directions(page_of_motors: Path, opened: Open) -> None:
    """Each is found with its raw integers; its values, or raw integers without exact values, are encoded to the same bytes."""
    page = opened(page_of_motors)
    golden = []
    for item in map(specification, SPECS[:4]):
        assert item.frames is not None
        for frame in item.frames.frames:
            message = item.edition.command(frame.command).message(frame.direction)
            if message is not None and message.command == frame.command:
                golden.append((item.edition.name, frame))
    questions = [
        [formatting.sent(f), name, f.direction.value, f.command, {n: str(v) for n, v in f.parameters.items()}]
        for name, f in golden
    ]
    answers = page.evaluate(REPLAY, questions)
    for (_, frame), question, answer in zip(golden, questions, answers, strict=True):
        raw = {name: [str(element) for element in (r if isinstance(r, list) else [r])] for name, r in frame.raw.items()}
        assert answer and answer["raw"] == raw, question
        assert frame.decode_only or answer["written"] == question[0], (question, answer)
    assert len(answers) > 2000


def test_frames_are_typed_and_values_entered(page_of_motors: Path, opened: Open) -> None:
    page = opened(page_of_motors)
    box = page.get_by_label("Frame, or bytes")
    for line in ("141#A100000064000000", "can0  141   [8]  9C 00 00 00 00 00 00 00"):
        box.fill(line)
        assert page.locator("#found li").count() >= 4
    page.get_by_label("Motor series").select_option("MG")
    box.fill("(1.2) can0 141#A100000064000000")
    page.get_by_label("Value of iq", exact=True).fill("2.5")
    page.get_by_label("Value of iq", exact=True).press("Enter")
    assert box.input_value() == "141#A10000009B000000"
    assert "iq = 155" in page.locator("#c").inner_text()
    page.get_by_label("Raw integer of iq").fill("-1")
    page.get_by_label("Raw integer of iq").press("Tab")
    assert page.locator("#bytes").inner_text() == "A1 00 00 00 FF FF 00 00"
    page.get_by_label("Value of iq", exact=True).fill("1e9")
    page.get_by_label("Value of iq", exact=True).press("Enter")
    assert "iq: outside the range (" in page.locator("#field-problem").inner_text()
    assert "frame=141%23A1000000FFFF0000" in page.url and "parameter.series=MG" in page.url
    box.fill("nonsense")
    assert "no CAN frame" in page.locator("#problem").inner_text()
    box.fill("7FF#00")
    assert "No message has this id" in page.locator("#problem").inner_text()


def test_a_value_out_of_range_has_no_code(page_of_motors: Path, opened: Open) -> None:
    """Nothing is copied while a field shows a value that is not in the frame; the problem states the limits."""
    page = opened(page_of_motors, "#frame=141%23A100000064000000&edition=v2.35&direction=request&parameter.series=MF")
    ampere = page.get_by_label("Value of iq", exact=True)
    for value, reason in (("40", "outside the range (-16.5..16.5 A · raw -2048..2048)"), ("x", "not a number")):
        ampere.fill(value)
        ampere.press("Enter")
        problem = page.locator("#field-problem").inner_text()
        assert problem == f"iq: {reason}. There is no frame with this value."
        assert ampere.get_attribute("aria-invalid") == "true"
        assert page.locator("[data-copy]:visible, pre:visible").count() == 0
        assert page.locator("#frame").input_value() == ""
    page.get_by_role("button", name="中文").click()
    assert page.locator("#cansend").inner_text() == "cansend can0 141#A100000064000000"
    assert page.locator("#frame").input_value() == "141#A100000064000000"
    assert page.locator("#field-problem").inner_text() == ""
    page.get_by_role("button", name="English").click()
    ampere.fill("16.5")
    ampere.press("Enter")
    assert page.locator("#bytes").inner_text() == "A1 00 00 00 00 08 00 00"
    page.get_by_label("Motor series").select_option("")
    page.get_by_label("Raw integer of iq").fill("3000")
    page.get_by_label("Raw integer of iq").press("Enter")
    assert "(raw -2048..2048)" in page.locator("#field-problem").inner_text()


REASONS = {
    "en": {
        "141#A132": ["request: 0x141 has 2 data bytes, not 8 (", "reply: no reply has the id 0x141 ("],
        "00000141#A1": ["request: no request has the id 0x00000141 (", "reply: no reply has the id 0x00000141 ("],
        "141#EE00000000000000": ["request: no request on 0x141 has the code 0xEE ("],
    },
    "zh": {
        "141#A132": ["请求：0x141 有 2 个数据字节，应为 8 个（", "回复：没有标识符为 0x141 的回复（"],
        "00000141#A1": ["请求：没有标识符为 0x00000141 的请求（", "回复：没有标识符为 0x00000141 的回复（"],
        "141#EE00000000000000": ["请求：0x141 上没有命令码为 0xEE 的请求（"],
    },
}


@pytest.mark.parametrize("language", ["en", "zh"])
def test_reasons_are_in_the_language_of_the_page(page_of_motors: Path, opened: Open, language: str) -> None:
    page = opened(page_of_motors, f"#lang={language}")
    for frame, reasons in REASONS[language].items():
        page.locator("#frame").fill(frame)
        for reason in reasons:
            assert reason in page.locator("#problem").inner_text()


def test_a_frame_of_no_message_says_whose_it_is_and_how_its_id_was_read(page_of_motors: Path, opened: Open) -> None:
    page = opened(page_of_motors)
    item = specification(SPECS[0])
    neighbour = next(n for n in item.edition.bus.neighbours if 0x241 in n.ids)
    for language, name in (("en", "English"), ("zh", "中文")):
        page.get_by_role("button", name=name).click()
        page.locator("#frame").fill("241#9C00000000000000")
        problem = page.locator("#problem").inner_text()
        assert neighbour.title[language] in problem
        page.locator("#frame").fill("00000241#9C00000000000000")
        assert neighbour.title[language] not in page.locator("#problem").inner_text()
        for line in ("00000141 A1 00 00 00 64 00 00 00", "0x00000141 A1 00 00 00 64 00 00 00"):
            page.locator("#frame").fill(line)
            problem = page.locator("#problem").inner_text()
            assert "0x00000141" in problem and "141#A100000064000000" in problem and "29" in problem
        page.locator("#frame").fill("18FF0141 A1 00")
        assert "18FF0141" in page.locator("#problem").inner_text()
        assert "29" not in page.locator("#problem").inner_text()
    page.evaluate(PASTE, "(1.0) can0 241#9C00000000000000\n(2.0) can0 7FF#00")
    page.wait_for_selector("#log-rows tr:nth-child(2)")
    rows = page.locator("#log-rows tr").all_inner_texts()
    assert neighbour.title["zh"] in rows[0] and "没有报文" in rows[1]


def test_no_series_is_assumed(page_of_motors: Path, opened: Open) -> None:
    """Without the series, there is a value for each, no input of amperes, and no program; invalid parameters are named."""
    page = opened(
        page_of_motors, "#frame=141%23A1329B00F4010080&edition=v2.35&parameter.series=XX&parameter.gear_ratio=0.5"
    )
    assert "Motor series cannot be XX" in page.locator("#parameter-problem").inner_text()
    assert "Gear ratio cannot be 0.5" in page.locator("#parameter-problem").inner_text()
    assert page.locator("#parameters [aria-invalid=true]").count() == 2
    current = page.locator("#fields tr[data-field=iq]")
    assert current.locator(".case").all_inner_texts() == [
        "MF: 1.248779296875 A",
        "MH: the manual gives no scale",
        "MG: 2.49755859375 A",
    ]
    assert page.get_by_label("Value of iq", exact=True).count() == 0
    assert (
        page.locator("#c").inner_text()
        == page.locator("#python").inner_text()
        == "depends on Motor series: set it above"
    )
    assert page.locator("[data-copy]:disabled").evaluate_all("all => all.map(b => b.dataset.copy)") == ["c", "python"]
    page.get_by_label("Raw integer of iq").fill("310")
    page.get_by_label("Raw integer of iq").press("Enter")
    assert page.get_by_label("Frame, or bytes").input_value() == "141#A1323601F4010080"
    page.get_by_label("Motor series").select_option("MG")
    assert page.get_by_label("Value of iq", exact=True).input_value() == str(310 * 33 / 2048)
    assert (
        "SERIES_MG" in page.locator("#c").inner_text()
        and "Gear ratio" in page.locator("#parameter-problem").inner_text()
    )


def test_a_message_is_composed(page_of_motors: Path, opened: Open) -> None:
    page = opened(page_of_motors)
    page.get_by_label("Edition").select_option("v2.35")
    page.get_by_label("Or enter values for a message").select_option("request turn_to_angle")
    page.get_by_label("Value of spin_direction", exact=True).select_option("counterclockwise")
    page.get_by_label("Value of angle", exact=True).fill("90")
    page.get_by_label("Value of angle", exact=True).press("Enter")
    assert page.locator("#cansend").inner_text() == "cansend can0 141#A501000028230000"
    page.get_by_label("Node", exact=True).fill("7")
    page.get_by_label("Node", exact=True).press("Enter")
    assert page.locator("#cansend").inner_text() == "cansend can0 147#A501000028230000"
    assert "_encode(&frame, 7u, &message)" in page.locator("#c").inner_text()
    page.get_by_label("Node", exact=True).fill("33")
    page.get_by_label("Node", exact=True).press("Enter")
    assert page.locator("#field-problem").inner_text().startswith("node: no such node (1..32).")
    assert not page.locator("#cansend").is_visible()


def test_it_works_below_a_sub_path(page_of_motors: Path, opened: Open) -> None:
    folder = page_of_motors.parents[1]
    with ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(_Quiet, directory=str(folder))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        page = opened(page_of_motors, TORQUE, root=f"http://127.0.0.1:{server.server_port}/{FOLDER}")
        assert page.locator("#chosen-facts").inner_text() == "set_torque · reply · v2.35"
        server.shutdown()


def test_an_address_selects_edition_and_direction(page_of_motors: Path, opened: Open) -> None:
    page = opened(page_of_motors, TORQUE)
    assert page.locator("#chosen-facts").inner_text() == "set_torque · reply · v2.35"
    assert page.get_by_label("Value of encoder", exact=True).input_value() == "360"
    page.evaluate("location.hash = 'frame=141%239C00000000000000&edition=v2.36-2025-03&direction=request&lang=zh'")
    page.wait_for_selector("h1:text('帧解析器')")
    assert page.locator("#chosen-facts").inner_text() == "read_status_2 · 请求 · v2.36-2025-03"


def test_parameters_can_have_the_names_of_other_keys_of_the_address(opened: Open, tmp_path: Path) -> None:
    """A parameter has a prefix in addresses; in old ones it had none."""
    names = ("frame", "edition", "direction", "command", "lang")
    parameters = ", ".join(f"{name}: {{number: {{}}}}" for name in (*names, "problem"))
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace("types:", f"parameters: {{{parameters}}}\ntypes:"), "utf-8")
    made = explorer([specification(tmp_path / "lamp.yaml")])
    page = opened(
        write_files(made, tmp_path) / FOLDER / "index.html", "#frame=101%231000E80300000000&direction=reply&problem=2"
    )
    for name in names:
        assert page.locator(f"[id='parameter.{name}']").input_value() == ""
        page.locator(f"[id='parameter.{name}']").fill("2")
        page.keyboard.press("Enter")
    page.reload()
    assert page.locator("#chosen-facts").inner_text() == "dim · reply · v1"
    shown = [page.locator(f"[id='parameter.{name}']").input_value() for name in (*names, "problem")]
    assert shown == ["2"] * 6


def test_an_address_without_a_frame_shows_no_message(page_of_motors: Path, opened: Open) -> None:
    """Also while the value of a field is being entered."""
    page = opened(page_of_motors, TORQUE)
    for start in ("", "frame=142%239C00000000000000"):
        page.get_by_label("Raw integer of iq").fill("310")
        page.evaluate("(start) => { location.hash = start; }", start)
        page.wait_for_function("(start) => document.getElementById('chosen').hidden === !start", arg=start)
        page.evaluate("document.activeElement.blur()")
        assert page.get_by_label("Frame, or bytes").input_value() == start.partition("=")[2].replace("%23", "#")
        page.evaluate("(start) => { location.hash = start; }", TORQUE)
        page.wait_for_selector("#chosen-facts:text('set_torque')")


def test_fields_and_bits_with_the_keyboard_alone(page_of_motors: Path, opened: Open) -> None:
    page = opened(page_of_motors)
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    page.keyboard.type("141#A1329B00F4010080")
    page.locator("#found button").nth(1).focus()
    page.keyboard.press("Enter")
    for _ in range(20):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.closest('#bits') !== null"):
            break
    page.keyboard.press("ArrowDown")
    assert page.locator("#field-says").inner_text() == "iq: DATA[2..3]"
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowRight")
    assert page.locator("#bits button.on").count() == 16
    assert page.locator("#fields tr.on th button").inner_text() == "iq"
    page.get_by_role("button", name="speed", exact=True).focus()
    page.keyboard.press("Enter")
    assert page.locator("#field-says").inner_text() == ""
    page.keyboard.press("Enter")
    assert page.locator("#field-says").inner_text() == "speed: DATA[4..5]"
    marked = page.locator("#bits button.on").evaluate_all("(all) => all.map((one) => one.ariaLabel)")
    assert len(marked) == 16 and marked[0] == "DATA[4] bit 7: 1, speed"


def test_a_log_is_listed(page_of_motors: Path, opened: Open, tmp_path: Path) -> None:
    log = tmp_path / "bus.log"
    lines = [f"(1.{n:03}) can0 141#9C{n % 100:02d}640000000000 R" for n in range(250)]
    log.write_text("\n".join(["damaged", "(1.0) can0 141#9C00000000000000 T", *lines]), "utf-8")
    page = opened(page_of_motors)
    page.locator("#file").set_input_files(log)
    page.wait_for_selector("#log-rows tr:nth-child(100)")
    assert page.locator("#log-summary").inner_text() == "bus.log: 251 frames, 1 lines without a frame"
    assert page.locator("#log-rows tr").first.inner_text().split("\t")[0:3:2] == ["1.0", "141#9C00000000000000"]
    page.get_by_role("button", name="Next").click()
    page.get_by_role("button", name="Next").click()
    page.wait_for_selector("#log-position:text-is('201–251 / 251')")
    page.wait_for_selector("#log-rows tr:nth-child(51)")
    assert page.locator("#log-rows tr").count() == 51
    page.locator("#log-rows button").last.click()
    assert page.get_by_label("Frame, or bytes").input_value() == "141#9C49640000000000 R"


def test_a_log_without_frames_clears_the_page(page_of_motors: Path, opened: Open, tmp_path: Path) -> None:
    """It states what was expected."""
    log = tmp_path / "bus.blf"
    page = opened(page_of_motors, TORQUE)
    for content in (b"LOGG\x90\x00 no text", b"", b"time,speed\n1.0,500\n"):
        page.locator("#frame").fill("141#9C00000000000000")
        log.write_bytes(content)
        page.locator("#file").set_input_files(log)
        page.wait_for_selector("#log-summary.problem:has-text('canwright decode')")
        page.wait_for_selector("#chosen", state="hidden")
        assert "time,id,data" in page.locator("#log-summary").inner_text()
        assert page.locator("#found li, #log-rows tr").count() == 0 and page.locator("#frame").input_value() == ""
        page.get_by_role("button", name="中文").click()
        assert "未找到帧" in page.locator("#log-summary").inner_text()
        page.get_by_role("button", name="English").click()
    for text in ("time,speed\n1.0,500\n", "stamp,address,bytes\n1.5,0x141,nAAAAAAAAAA=\n"):
        page.locator("#frame").fill("141#9C00000000000000")
        page.evaluate(PASTE, text)
        page.wait_for_selector("#log-summary.problem:has-text('Pasted text: No frame was found')")
        page.wait_for_selector("#chosen", state="hidden")
    page.evaluate(PASTE, "{\n0xA1,\n0x1G}")
    assert "0x1G is not a byte" in page.locator("#problem").inner_text()
    page.evaluate(PASTE, "(1.0) can0 20000004#0004000000000000\n(1.0) can0 141#9C00000000000000")
    page.wait_for_selector(
        "#log-summary.note:text-is('Pasted text: 1 frames, 0 lines without a frame, 1 error frames')"
    )
    log.write_text("(1.0) can0 20000004#0004000000000000\n", "utf-8")
    page.locator("#file").set_input_files(log)
    page.wait_for_selector("#log-summary.note:text-is('bus.blf: 0 frames, 0 lines without a frame, 1 error frames')")


def test_a_table_is_a_log(page_of_motors: Path, opened: Open, tmp_path: Path) -> None:
    """As python-can writes it, opened and pasted."""
    table = "timestamp,arbitration_id,extended,remote,error,dlc,data\n1.5,0x141,0,0,0,8,nDNkAAAAAQA=\n"
    (tmp_path / "bus.csv").write_text(table, "utf-8")
    page = opened(page_of_motors)
    page.locator("#file").set_input_files(tmp_path / "bus.csv")
    for name in ("bus.csv", "Pasted text"):
        page.wait_for_selector(f"#log-summary:text-is('{name}: 1 frames, 0 lines without a frame')")
        page.wait_for_selector("#chosen-facts:has-text('read_status_2 · reply')")
        page.locator("#frame").fill("")
        page.evaluate(PASTE, f"\n{table}")


def test_rows_of_a_log_have_values(page_of_motors: Path, opened: Open) -> None:
    """In the language of the page, as the list below; the column of marks is there if frames have marks."""
    page = opened(page_of_motors, "#edition=v2.35&parameter.series=MG&parameter.encoder_bits=15")
    lines = "(1.0) can0 141#9C3364000A000080\n(2.0) can0 141#A501000028230000"
    values = {
        "English": "temperature 51 °C, iq 1.611328125 A, speed 10 °/s, encoder 360 °",
        "中文": "电机温度 51 °C、转矩电流 1.611328125 A、电机转速 10 °/s、编码器位置 360 °",
    }
    members = {"English": "spin_direction counterclockwise, angle 90 °", "中文": "转动方向 逆时针、目标单圈角度 90 °"}
    for language in values:
        page.get_by_role("button", name=language).click()
        page.evaluate(PASTE, lines)
        page.wait_for_selector("#log-rows tr:nth-child(2)")
        rows = [row.split("\t") for row in page.locator("#log-rows tr").all_inner_texts()]
        assert [row[-1] for row in rows] == [values[language], members[language]]
        assert [len(row) for row in rows] == [4, 4]
        page.locator("#log-rows button").first.click()
        assert page.locator("#found small").first.inner_text() == values[language]
    assert page.locator("#log th:visible").count() == 4
    page.evaluate(PASTE, lines.replace("\n", " R\n"))
    page.wait_for_selector("#log th:nth-child(2):visible")
    assert page.locator("#log th:visible").count() == 5


def test_marks_decide_in_a_log_with_both(page_of_motors: Path, opened: Open) -> None:
    """A recorder that listens marks every frame as received, requests too."""
    page = opened(page_of_motors)
    zeros, next_line = "(1.0) can0 141#9C00000000000000 R", "(2.0) can0 142#9C00000000000000"
    for mark, direction in ((" R", "request"), (" T", "reply")):
        page.evaluate(PASTE, f"{zeros}\n{next_line}{mark}")
        page.wait_for_selector(f"#log-rows tr:first-child:has-text('· {direction}')")
        page.wait_for_selector("#log-rows tr:nth-child(2):has-text('· request')")
        page.locator("#log-rows button").first.click()
        assert page.locator("#found button").first.get_attribute("aria-pressed") == "true"
        assert page.locator("#chosen-facts").inner_text().startswith(f"read_status_2 · {direction}")


def test_a_row_of_a_log_and_the_list_agree(page_of_motors: Path, opened: Open, tmp_path: Path) -> None:
    """Also after another message, another edition or a parameter was chosen; a mark decides where both directions fit."""
    datas = ("8000000000000000", "A3000000A08C0000", "9C33640000000100", "A1329B00F4010080")
    log = tmp_path / "bus.asc"
    spaced = (" ".join(data[i : i + 2] for i in range(0, 16, 2)) for data in datas)
    rows = [f"{n}.5 1  141  Rx  d 8 {data}\n" for n, data in enumerate(spaced)]
    log.write_text("".join([*rows, "9.5 1  141  Tx  d 8 9C 00 00 00 00 00 00 00\n"]), "utf-8")
    page = opened(page_of_motors)
    page.locator("#file").set_input_files(log)
    page.wait_for_selector("#log-rows tr:nth-child(4)")

    def check() -> None:
        for i in range(4):
            page.locator("#log-rows button").nth(i).click()
            title = page.locator("#found [aria-pressed=true] strong").inner_text()
            direction = page.locator("#found [aria-pressed=true] span").inner_text().split(" · ")[0]
            assert f"{title} · {direction}" in page.locator("#log-rows tr").nth(i).inner_text()
            assert page.locator("#found button").first.get_attribute("aria-pressed") == "true"

    check()
    assert " · reply" in page.locator("#log-rows tr").first.inner_text()
    for edition in ("v2.36-2025-03", "v2.35"):
        page.get_by_label("Edition").select_option(edition)
        page.wait_for_timeout(300)
        check()
    page.locator("#found button").last.click()
    page.get_by_label("Motor series").select_option("MS")
    page.wait_for_timeout(300)
    check()


def test_a_long_log_is_read_in_parts(page_of_motors: Path, opened: Open, tmp_path: Path) -> None:
    """Each line ends somewhere else in a part: with a line end of two characters, after a character of three bytes."""
    log = tmp_path / "long.log"
    lines = [f"({n}.0) can0 141#9C{n % 100:02d}640000000000 ; {'测' * (n % 40)}" for n in range(20_000)]
    log.write_bytes("\r\n".join([*lines, "damaged"]).encode())
    page = opened(page_of_motors)
    page.evaluate(
        """() => {
          window.shown = new Set();
          const summary = document.getElementById("log-summary");
          new MutationObserver(() => window.shown.add(summary.textContent)).observe(summary, { childList: true });
        }"""
    )
    page.locator("#file").set_input_files(log)
    page.wait_for_selector("#log-summary:text-is('long.log: 20000 frames, 1 lines without a frame')")
    assert any("(reading, 50 %)" in summary for summary in page.evaluate("() => [...window.shown]"))
    assert page.locator("#log-position").inner_text() == "1–100 / 20000"
    page.wait_for_selector("#log-rows tr:nth-child(100)")
    assert page.locator("#log-rows tr").last.inner_text().split("\t")[:2] == ["99.0", "141#9C99640000000000"]


def test_the_log_that_was_opened_last_is_shown(page_of_motors: Path, opened: Open, tmp_path: Path) -> None:
    for name, count in (("first.log", 20_000), ("second.log", 3)):
        (tmp_path / name).write_text(f"({count}.0) can0 141#9C{count % 100:02d}640000000000\n" * count, "utf-8")
    page = opened(page_of_motors)
    page.locator("#file").set_input_files(tmp_path / "first.log")
    page.locator("#file").set_input_files(tmp_path / "second.log")
    page.wait_for_selector("#log-summary:has-text('second.log')")
    page.wait_for_timeout(500)
    assert page.locator("#log-summary").inner_text() == "second.log: 3 frames, 0 lines without a frame"
    assert page.locator("#log-rows tr").count() == 3


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("language", ["en", "zh"])
def test_it_is_accessible_and_fits_a_phone(language: str, scheme: Any, page_of_motors: Path, opened: Open) -> None:
    page = opened(
        page_of_motors, f"{TORQUE}&lang={language}", color_scheme=scheme, viewport={"width": 390, "height": 844}
    )
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    assert page.evaluate("document.documentElement.lang") == {"en": "en", "zh": "zh-Hans"}[language]
    page.locator("#fields button").first.click()
    violations = accessibility_violations(page, {"preload": False})
    assert [(violation["id"], [node["html"] for node in violation["nodes"]][:3]) for violation in violations] == []
    page.emulate_media(media="print")
    assert page.locator("#bits-table").is_visible() and not page.locator("#frame").is_visible()


def test_the_code_is_copied(page_of_motors: Path, opened: Open) -> None:
    page = opened(page_of_motors, TORQUE.replace("0080&", "0040&"))
    page.locator("[data-copy=cansend]").click()
    assert page.locator("#copied").inner_text() == "Copied"
    page.get_by_label("Frame, or bytes").focus()
    page.keyboard.press("Control+A")
    page.keyboard.press("Control+V")
    assert page.get_by_label("Frame, or bytes").input_value() == "cansend can0 141#A1329B00F4010040"
    for name in ("bytes", "c", "python", "link"):
        page.locator(f"[data-copy={name}]").click()
        assert page.evaluate("getSelection().toString()").strip() == page.locator(f"#{name}").inner_text().strip()
    assert page.locator("#link").inner_text() == page.url


def test_problems_name_the_column_and_bytes_need_no_id(page_of_motors: Path, opened: Open) -> None:
    page = opened(page_of_motors, "#lang=zh")
    page.locator("#frame").fill("１４１＃Ａ１Ｇ０")
    assert page.locator("#problem").inner_text() == "第 7 列：G 不是字节。请写两位十六进制数，例如 0A。"
    page.get_by_role("button", name="English").click()
    assert page.locator("#problem").inner_text().startswith("Column 7: G is not a byte.")
    page.locator("#frame").fill("{0x9C, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00}")
    assert page.locator("#no-id").is_visible()
    assert page.locator("#cansend").inner_text() == "cansend can0 141#9C00000000000000"
    page.locator("#frame").fill("141#9C00000000000000")
    assert not page.locator("#no-id").is_visible()


PASTE = """(text) => {
  const data = new DataTransfer();
  data.setData("text", text);
  document.getElementById("frame").dispatchEvent(new ClipboardEvent("paste", { clipboardData: data, cancelable: true }));
}"""


def test_pasted_lines_are_a_log_or_one_frame(page_of_motors: Path, opened: Open) -> None:
    page = opened(page_of_motors)
    page.evaluate(PASTE, "uint8_t data[8] = {\n  0xA1, 0x00, 0x00, 0x00,\n  0x64, 0x00, 0x00, 0x00,\n};")
    assert page.locator("#bytes").inner_text() == "A1 00 00 00 64 00 00 00"
    page.evaluate(PASTE, "time,id,dlc,data\n0.5,0x141,8,9C 00 00 00 00 00 00 00\n0.6,0x142,8,9C 00 00 00 00 00 00 00")
    page.wait_for_selector("#log-summary:text-is('Pasted text: 2 frames, 0 lines without a frame')")
    assert page.locator("#frame").input_value() == "141#9C00000000000000"


def test_the_same_frame_is_compared_in_two_editions(page_of_motors: Path, opened: Open) -> None:
    """What differs is marked with a sign too; the address keeps the comparison."""
    page = opened(page_of_motors, TORQUE)
    assert not page.locator("#compared").is_visible()
    page.get_by_label("The same frame in").select_option("v2.36-2025-03")
    page.reload()
    assert page.locator("#compare-head th").all_inner_texts() == ["Field", "v2.35", "v2.36-2025-03"]
    rows = {row.split("\t")[0]: row.split("\t")[1:] for row in page.locator("#compare-rows tr").all_inner_texts()}
    assert rows["Message ≠"] == ["0xA1 Torque control · reply", "0xA1 Torque control · request"]
    assert rows["speed ≠"] == ["500 °/s · DATA[4..5] · °/s", "–"] and len(rows) == 5
    assert page.locator("#compare-rows .differs").count() == 5
    page.get_by_label("The same frame in").select_option("v2.35-2024-02")
    texts = [row.split("\t") for row in page.locator("#compare-rows tr").all_inner_texts()]
    assert ["Message", *["0xA1 Torque control · reply"] * 2] in texts
    assert all(name.endswith("≠") == (left != right) for name, left, right in texts)
    page.evaluate("location.hash = 'frame=141%23A300000010270000&edition=v2.35&direction=request&compare=v2.35'")
    page.wait_for_selector("#chosen-facts:has-text('request')")
    assert not page.locator("#compared").is_visible()


def test_a_command_links_to_its_page(opened: Open, tmp_path: Path) -> None:
    """On a site, which writes the folder of the pages into the page; an entry of a table is a section."""
    made = write_files(explorer([specification(SPECS[3])]), tmp_path) / FOLDER / "index.html"
    page = opened(made, TORQUE.replace("v2.35", "v2.36-2025-03"))
    assert not page.locator("#page").is_visible()
    assert not page.locator("#documents").is_visible()
    made.write_text(made.read_text("utf-8").replace('data-pages=""', 'data-pages="../"'), "utf-8")
    page = opened(made, TORQUE.replace("v2.35", "v2.36-2025-03") + "&lang=zh")
    edition = specification(SPECS[3]).edition
    entry = next(command for command in edition.commands if command.entry and command.request)
    assert page.locator("#page").get_attribute("href") == f"../zh/{edition.name}/commands/set_torque.html"
    assert page.get_by_role("link", name="文档").get_attribute("href") == "../zh/index.html"
    page.get_by_label("或选择报文并填写数值").select_option(f"request {entry.name}")
    assert entry.entry is not None
    wanted = f"../zh/{edition.name}/commands/{entry.spec_name}.html#entries.{entry.entry.name}"
    assert page.locator("#page").get_attribute("href") == wanted


def test_hostile_texts_are_shown_as_text(opened: Open, tmp_path: Path) -> None:
    texts = itertools.cycle(text for text in HOSTILE if "<" in text)
    item = filled(lambda: next(texts), tmp_path)
    file = write_files(explorer([item]), tmp_path) / FOLDER / "index.html"
    page = opened(file)
    scripts = page.locator("script").count()
    messages = page.locator("#message option").evaluate_all("(all) => all.map((one) => one.value)")
    for message in filter(None, messages):
        page.locator("#message").select_option(message)
        assert page.locator("#chosen").is_visible()
        assert page.locator("script").count() == scripts and page.locator("img, style, svg").count() == 0
    titles = page.locator("#message option").all_inner_texts()
    assert (
        len(titles) == len(messages)
        and len(set(titles)) > len(titles) - 3
        and all("<" in title for title in titles[1:])
    )
