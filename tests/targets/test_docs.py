"""The pages beyond the golden frames: links, pictures, and what a spec's text can do."""

from __future__ import annotations

import html
import itertools
import json
import posixpath
import re
import shlex
import subprocess
import sys
from pathlib import Path
from urllib.parse import parse_qsl
from xml.etree import ElementTree

import markdown as python_markdown
import pytest
from canwright.model import formatting
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.semantics.decoder import Decoded, Decoder
from canwright.semantics.frame import CanFrame
from canwright.targets.docs.common import Common
from canwright.targets.docs.guides import telling_frames
from canwright.targets.docs.target import DocsTarget
from canwright.templating.data_files import read_data
from canwright.templating.markup import markdown
from canwright.templating.resources import QUESTIONS

from ..node import run
from ..spec_texts import MINIMAL, ROOT

SPEC = ROOT / "spec/mwd_motor/v2.35.yaml"


@pytest.fixture(scope="module")
def pages() -> dict[str, str]:
    return {output.path: output.text for output in DocsTarget().generate([specification(SPEC)], {})}


def test_every_command_has_a_page_in_every_language(pages: dict[str, str]) -> None:
    for language in ("en", "zh"):
        for command in specification(SPEC).edition.commands:
            text = pages[f"{language}/v2.35/commands/{command.name}.md"]
            code = f"0x{command.code:02X} " if command.code is not None else "0x280 "
            comma = ", " if language == "en" else "，"
            assert text.startswith(f"# {code}{markdown(command.title[language])}{comma}v2.35\n")
        for name in ("index", "types", "parameters", "errata", "bus"):
            assert f"{language}/v2.35/{name}.md" in pages


def test_every_link_leads_somewhere(pages: dict[str, str]) -> None:
    anchors = {path: set(re.findall(r'<a id="([^"]+)">', text)) for path, text in pages.items()}
    for path, page in pages.items():
        text = re.sub(r"^```.*?^```", "", page, flags=re.MULTILINE | re.DOTALL)
        for link in re.findall(r"\]\(([^)]+)\)", text):
            file, _, anchor = link.partition("#")
            if file.endswith("/explorer/index.html") and anchor:
                assert re.match(
                    r"frame=[0-9A-F]+%23[0-9A-F]*&edition=v2.35&direction=(request|reply)&command=\w+", anchor
                )
            linked = posixpath.normpath(posixpath.join(posixpath.dirname(path), file)) if file else path
            if linked.startswith("../"):
                assert (ROOT / "generated/docs" / linked).exists(), f"{path}: {link}"
                continue
            assert linked in pages, f"{path}: {link}"
            assert not anchor or anchor in anchors[linked], f"{path}: {link}"


def test_links_to_the_explorer_are_golden_frames_with_their_parameters(pages: dict[str, str]) -> None:
    frames = specification(SPEC).frames
    assert frames is not None
    golden = {
        (formatting.sent(frame), frame.direction.value, *formatting.parameter_values(frame.parameters).items())
        for frame in frames.frames
    }
    linked = set()
    for text in pages.values():
        for query in re.findall(r"explorer/index\.html#([^)]+)\)", text):
            frame, _, direction, _, *parameters = parse_qsl(query)
            given = [(name.removeprefix("parameter."), value) for name, value in parameters]
            assert not {name for name, _ in given} & {name for name, _ in parameters}
            linked.add((frame[1], direction[1], *given))
    assert linked <= golden
    assert any(len(link) > 2 for link in linked)


def test_pictures_are_drawings_that_show_every_field(pages: dict[str, str]) -> None:
    pictures = [text for path, text in pages.items() if path.endswith(".svg")]
    assert len(pictures) > 28
    for text in pictures:
        ElementTree.fromstring(text)
    picture = pages["pictures/v2.35/read_status_1-reply.svg"]
    for label in ("0x9A", "temperature", "DATA[3..4]", "voltage", "DATA[5..6]", "errors"):
        assert f">{label}<" in picture
    assert "pictures/v2.35/read_status_1-request.svg" not in pages, "no field to show"


def test_replies_to_a_broadcast_are_on_the_ids_of_the_nodes(pages: dict[str, str]) -> None:
    rows = [line for line in pages["en/v2.35/bus.md"].splitlines() if line.startswith("| Motors 1 to 4")]
    assert [row.split(" | ")[1:3] for row in rows] == [["`0x280`", "`0x140 + node`"]]


def test_the_calculator_needs_no_network_and_agrees_with_the_lengths(pages: dict[str, str]) -> None:
    page = pages["en/bus-load-calculator.html"]
    assert not re.search(r"https?:|src=|@import", page)
    data = json.loads(page.partition('id="data">')[2].partition("</script>")[0])
    command = next(entry for entry in data[0]["commands"] if entry["name"] == "broadcast_torque")
    assert (command["request"], command["reply"], command["replies"]) == ([111, 135], [111, 135], 4)
    assert (data[0]["replyMs"], data[0]["nodes"], data[0]["rates"][0]) == (0.25, 32, 1000)
    assert "| 11-bit id | 8 | 111 | 135 |" in pages["en/bus-load.md"]
    usual = data[0]["commands"][data[0]["usual"]]
    assert (usual["name"], usual["perNode"], command["perNode"]) == ("set_power", True, False)


LOADS = """
import { createRequire } from "node:module";
const { busLoad } = createRequire(process.cwd() + "/")("./bus_load.js");
const single = { perNode: true, request: [111, 135], reply: [111, 135], replies: 1 };
const broadcast = { perNode: false, request: [111, 135], reply: [111, 135], replies: 4 };
const silent = { perNode: true, request: [44, 52], reply: null, replies: 0 };
const rows = [[single], [broadcast], [single, silent]];
const loads = rows.map((commands) => busLoad(commands.map((command) => ({ command, rateHz: 100 })), 4, 1000, 0.25, []));
loads.push(busLoad([], 4, 500, 0, [{ bits: [111, 135], everyMs: 2.5, perNode: true }, { bits: [44, 52], everyMs: 10, perNode: false }]));
console.log(JSON.stringify(loads.map(({ load, cycleMs, maximumHz }) => [load, cycleMs, Math.round(maximumHz)])));
"""


def test_loads_are_those_of_the_formulas() -> None:
    """4 nodes at 100 Hz and 1 Mbit/s: 4 x 270 bits, 5 x 135 bits, and 4 x 52 bits more than the first.

    Cyclic frames at 500 kbit/s: 4 x 135 bits in 2.5 ms, 43.2 %, and 52 bits in 10 ms, 1.04 %; they are not polled.
    """
    loads = json.loads(run(LOADS, cwd=ROOT / "generator/canwright/targets/docs/runtime"))
    assert loads == [
        [pytest.approx(10.8), pytest.approx(2.08), 481],
        [pytest.approx(6.75), pytest.approx(0.925), 1081],
        [pytest.approx(12.88), pytest.approx(2.288), 437],
        [pytest.approx(44.24), 0, 0],
    ]


def test_the_first_steps_are_frames_of_the_manual(pages: dict[str, str]) -> None:
    """Off and on, 90 degrees in steps of 0.01 at 90 degrees per second, written from the manual."""
    for language in ("en", "zh"):
        steps = re.findall(r"^\| \d \| `cansend can0 ([^`]+)`", pages[f"{language}/quickstart.md"], re.MULTILINE)
        codes = ("9A00000000000000", "8800000000000000", "A8005A0028230000", "9C00000000000000")
        assert steps == [f"141#{data}" for data in (*codes, "8100000000000000", "8000000000000000")]


def test_the_quick_start_shows_a_command_that_only_reads(pages: dict[str, str]) -> None:
    page = pages["en/quickstart.md"].partition("## C and Python: ")[2]
    link = re.search(r"v2.35/commands/(\w+).md", page)
    assert link is not None
    assert not specification(SPEC).edition.command(link[1]).effects
    for language in ("c", "python", "sh"):
        *essence, program = re.findall(rf"^```{language}\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
        assert program in pages[f"en/{link[0]}"]
        lines = (essence or [program])[0].splitlines()
        assert len(lines) == (1 if language == "sh" else 3)
        assert all(line in program for line in lines)
    line = re.search(r"^echo .*$", page, re.MULTILINE)
    assert line is not None
    command = re.sub(r"\bcantools\b", f"{shlex.quote(sys.executable)} -m cantools", line[0])
    done = subprocess.run(command, shell=True, cwd=ROOT / "generated/dbc", capture_output=True, text=True, check=True)
    assert "Motor1_reply(" in done.stdout


def test_pictures_are_legible_on_a_phone(pages: dict[str, str]) -> None:
    for path, text in pages.items():
        if path.endswith(".svg"):
            assert int(re.findall(r'width="([0-9]+)"', text)[0]) <= 360, path


def test_few_members_are_listed_in_the_row_of_their_field(pages: dict[str, str]) -> None:
    text = pages["en/v2.35/commands/read_status_1.md"]
    assert "| Errors (Manual errorState)<br>bits `0` `low_voltage` · `3` `over_temperature` |" in text


def test_effects_are_warnings_and_examples_are_golden_frames(pages: dict[str, str]) -> None:
    text = pages["en/v2.35/commands/write_position_as_zero_rom.md"]
    assert "> [!WARNING]\n> - The zero of the angle changes\n" in text
    assert "> - Takes effect after a power cycle\n" in text
    assert "> [!CAUTION]\n> The motor moves (consent: motion)\n" in pages["en/v2.35/commands/set_torque.md"]
    lines = pages["en/v2.35/index.md"].splitlines()
    assert "| never sent again |" in next(line for line in lines if line.startswith("| `adds_up` |"))
    assert "Do not send this command again" in pages["en/v2.35/commands/turn_to_angle.md"]
    assert "A client sends this command" in pages["en/v2.35/commands/motor_stop.md"]
    assert "that of the requests" in pages["en/v2.35/bus.md"]
    assert "`141#A100000064000000`" in pages["en/v2.35/commands/set_torque.md"]
    assert "not implemented" in pages["en/v2.35/commands/clear_angle.md"]


def test_values_without_an_effect_are_beside_it() -> None:
    mixer = specification(ROOT / "tests/specs/mixer/v2-2024-02.yaml")
    made = {output.path: output.text for output in DocsTarget().generate([mixer], {})}
    assert "The lamp blinks (not with `lamp` = `off`) (consent: motion)" in made["en/v2-2024-02/commands/set_lamp.md"]
    assert "指示灯闪烁（`lamp` = `off` 时除外）" in made["zh/v2-2024-02/commands/set_lamp.md"]


IN_THE_ID = """\
canwright: 1
family: axis
edition: v1
addresses: {axis: {id: node << 8, nodes: 1..15, extended: true}}
selector: {at: id.0, raw: u8}
commands:
  set:
    code: 0x21
    manual: "1"
    request: {part: {at: id.12, raw: u6}, level: {at: 0.4, raw: u8}}
    reply: {layout: {index: {at: 0, raw: u8, constant: 7}}, code: 0x22, accept: [0x23]}
"""


def test_states_have_a_page_if_there_are_any() -> None:
    mixer = specification(ROOT / "tests/specs/mixer/v2-2024-02.yaml")
    made = {output.path: output.text for output in DocsTarget().generate([mixer], {})}
    page = made["en/v2-2024-02/states.md"]
    assert '| <a id="states.live"></a>Live (`live`) | power-up, [set_lamp](commands/set_lamp.md) |  |  |' in page
    muted = "| [mute_group](commands/mute_group.md) | Silent. | Can be loud: [set_volume](commands/set_volume.md) |"
    assert f'<a id="states.muted"></a>Muted (`muted`) {muted}' in page
    assert "`writes_rom`" in page and "`loud`" not in page
    command = made["en/v2-2024-02/commands/set_volume.md"]
    assert "While [Muted](../states.md#states.muted): Silent." in command
    assert "执行后的状态：[静音](../states.md#states.muted)" in made["zh/v2-2024-02/commands/mute_group.md"]
    press = specification(ROOT / "tests/specs/press/v1.yaml")
    assert not [output.path for output in DocsTarget().generate([press], {}) if output.path.endswith("states.md")]


def test_fields_in_the_id_are_in_table_and_picture(tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    spec.write_text(IN_THE_ID, "utf-8")
    pages = {output.path: output.text for output in DocsTarget().generate([specification(spec)], {})}
    text = pages["en/v1/commands/set.md"]
    assert "| `id bits 0..7` |  | `u8`<br>`0x21` |" in text
    assert "`id bits 12..17` | `part` |" in text
    assert "command code; also accepted `0x23`" in text
    picture = re.findall(r"<text[^>]*>([^<]*)</text>", pages["pictures/v1/set-request.svg"])
    assert picture[8:12] == ["id 28..24", "0", "0", "0"]
    assert {"0x21", "node", "part [3:0]", "[5:4]", "level [3:0]", "level [7:4]"} <= set(picture)


def test_an_id_that_contains_the_code_is_shown_as_it_is_on_the_bus(tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    spec.write_text(IN_THE_ID, "utf-8")
    text = {output.path: output.text for output in DocsTarget().generate([specification(spec)], {})}[
        "en/v1/commands/set.md"
    ]
    request, reply = text.split("## Reply")
    assert "Id as sent" not in request, "a field varies it"
    assert "| Id | Id as sent | Nodes |" in reply
    assert "| `node << 8` | `0x22 + (node << 8)` | `1..15` |" in reply


HOSTILE = (
    "a | b | c",
    "[link](javascript:alert(1)) ![x](y)",
    "<script>alert(1)</script> <!-- --> &amp;",
    "`code` **bold** _em_ ~~del~~",
    "# heading",
    "- list",
    "1. list",
    "{{ 7 * 7 }} {% if %} {: .x }",
    "http://example.test/x https://example.test",
    "back\\slash \\| \\[x\\]",
)


@pytest.mark.parametrize("text", HOSTILE)
def test_markdown_in_texts_is_escaped(tmp_path: Path, text: str) -> None:
    assert _shown(markdown(text)) == text
    cell = _shown(f"| a | b |\n| --- | --- |\n| {markdown(text)} | x |\n")
    assert text in cell
    quoted = "'" + text.replace("'", "''") + "'"
    spec = tmp_path / "spec.yaml"
    extra = f"    title: {quoted}\n    about: {quoted}\n    notes: [{quoted}]\n"
    spec.write_text(f"title: {quoted}\n" + MINIMAL.replace('    manual: "1"\n', extra), "utf-8")
    for output in DocsTarget().generate([specification(spec)], {}):
        assert output.text.count("<script") == (2 if output.path.endswith(".html") else 0)
        if output.path.endswith(".svg"):
            ElementTree.fromstring(output.text)


def _shown(text: str) -> str:
    """What a reader sees of Markdown, by a Markdown library."""
    rendered = python_markdown.markdown(text, extensions=["tables", "attr_list", "md_in_html"])
    assert "<a " not in rendered
    assert "<script" not in rendered
    return html.unescape(re.sub(r"<[^>]*>", "", rendered)).replace("\u200b", "").strip()


def test_pages_of_commands_that_get_the_remaining_frames() -> None:
    joint = specification(ROOT / "tests/specs/joint/v1.yaml")
    pages = {output.path: output.text for output in DocsTarget().generate([joint], {})}
    said = "matches no other command"
    left_over = [path.rpartition("/")[2] for path, text in pages.items() if said in text]
    assert left_over == ["enable.md", "disable.md", "control.md"]  # the reply of all three is what `read_word` is not


def test_a_multiple_of_a_number_is_shown_as_one() -> None:
    pages = {
        output.path: output.text
        for output in DocsTarget().generate([specification(ROOT / "tests/specs/arm/v1.yaml")], {})
    }
    assert "| `u16 big-endian` | `rad` radian | `2/65535*p_max rad, offset -p_max rad` |" in pages["en/v1/types.md"]
    assert "| `0..1000` | `0..t_max N·m` |" in pages["en/v1/types.md"]
    assert "star: `-i_max..i_max A`<br>delta: `-327.67..327.67 A`" in pages["en/v1/types.md"]
    assert pages["en/v1/parameters.md"].count("so it must be greater than 0") == 4
    worked = "| `p_max = 0.3`, `v_max = 45.7`, `t_max = 5.5` | `node = 15`<br>`position = ≈0.0375051 rad`"
    assert worked in pages["en/v1/commands/move.md"]


def test_the_front_page_tells_editions_apart(tmp_path: Path) -> None:
    old = (
        MINIMAL.replace("edition: v1\n", "edition: v1\ndate: '2023-01'\n")
        + "  glow: {code: 0x11, manual: '2', reply: none}\n"
    )
    new = (
        old.replace("v1", "v2")
        .replace("2023", "2024")
        .replace("0x11", "0x12")
        .replace("{id: 0x100", "{request: 0x100 + node, reply: 0x180")
    )
    for name, text in (("a", new), ("b", old)):
        (tmp_path / f"{name}.yaml").write_text(text, "utf-8")
    made = DocsTarget().generate([specification(tmp_path / f"{name}.yaml") for name in "ab"], {})
    pages = {output.path: output.text for output in made}
    rows = [line for line in pages["en/index.md"].splitlines() if line.startswith("| [")]
    assert rows == [
        "| [lamp `v1`](v1/index.md) | `2023-01` | `0x100 + node` | `0x11` | | Lamp |",
        "| [lamp `v2`](v2/index.md) | `2024-01` | `0x180 + node` | `0x12` | [Changes](v2/changes.md) | Lamp |",
    ]
    assert "Edition [v1](../index.md) · also in [v2](../../v2/commands/dim.md)\n" in pages["en/v1/commands/dim.md"]


def test_pages_about_several_families_name_the_family_of_each_edition(tmp_path: Path) -> None:
    items = []
    for family, edition in itertools.product(("lamp", "torch"), ("v1", "v2")):
        text = MINIMAL.replace("edition: v1\n", f"edition: {edition}\ndate: '202{edition[1]}-01'\n")
        text += "  read_level: {code: 0x11, reply: {level: {at: 2, type: level}}}\n"
        file = tmp_path / f"{family}-{edition}.yaml"
        file.write_text(text.replace("family: lamp", f"family: {family}"), "utf-8")
        items.append(specification(file))
    pages = {output.path: output.text for output in DocsTarget().generate(items, {}) if output.path.endswith(".md")}
    own = "compare-editions.md", "logs.md", "new-edition.md", "own-protocol.md", "questions.md"
    about = {path: text for path, text in pages.items() if not path.endswith(own)}
    rest = {path: re.subn(r"(?:lamp|torch) `?v[12]\b", "", text) for path, text in about.items()}
    assert [path for path, (text, _) in rest.items() if re.search(r"(?<![\w/.-])v[12]\b", text)] == []
    assert pages["en/torch-v2/changes.md"].startswith("# Changes: torch v1 → torch v2\n")
    assert all(rest[f"en/{path}.md"][1] >= 2 for path in ("support", "which-edition", "torch-v1/commands/dim"))


def test_questions_of_a_family_do_not_link_commands_of_another_one(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace("  dim:\n", "  motor_stop:\n"), "utf-8")
    both = [specification(file) for file in (SPEC, tmp_path / "lamp.yaml")]
    pages = {output.path: output.text for output in DocsTarget().generate(both, {})}
    assert "en/lamp-v1/commands/motor_stop.md" in pages
    links = re.findall(r"\(([^()]*/motor_stop\.md)\)", pages["en/questions.md"])
    assert {*links} == {"mwd_motor-v2.35/commands/motor_stop.md"}


def test_a_question_links_a_command_with_its_code_in_each_edition() -> None:
    text = (ROOT / "generated/docs/en/questions.md").read_text("utf-8")
    assert (
        "- `0xB0` `read_control_parameter`: [v2.35-2024-02](v2.35-2024-02/commands/read_control_parameter.md)\n" in text
    )
    assert "- `0xC0` `read_control_parameter`: [v2.36-2024-11](v2.36-2024-11/commands/" in text


def test_a_frame_of_one_edition_is_no_frame_of_another_one() -> None:
    """`141#8C00000000000000` is a reply of one edition and the request of two others."""
    text = (ROOT / "generated/docs/en/which-edition.md").read_text("utf-8").partition("## Frames of one edition")[2]
    rows = re.findall(r"^\| \[(v[^]]+)\]\S+ \| `(\w+)#(\w+)` \|", text, re.MULTILINE)
    editions = {name: specification(ROOT / f"spec/mwd_motor/{name}.yaml").edition for name, _, _ in rows}
    assert len(rows) == len(editions) == 4
    devices = [{}, *({"series": "MG", "encoder_bits": bits} for bits in ("14", "15", "16", "18"))]
    for name, number, data in rows:
        frame = CanFrame(int(number, 16), bytes.fromhex(data))
        ways = itertools.product(editions.items(), Direction, devices)
        decoding = {
            (decoder, direction)
            for (decoder, edition), direction, device in ways
            if isinstance(Decoder(edition).decode(direction, frame, device), Decoded)
        }
        assert {decoder for decoder, _ in decoding} == {name}
        assert (name, Direction.REPLY) in decoding


def test_frames_of_one_edition_do_not_depend_on_other_families() -> None:
    specs = [ROOT / "tests/specs/pump/v1.yaml", SPEC, SPEC.with_name("v2.36-2025-03.yaml")]
    listed = [(item.edition.name, Common(item.edition, item.frames)) for item in map(specification, specs)]
    assert {frame.folder for frame in telling_frames(listed)} == {"v2.35", "v2.36-2025-03"}


def test_questions_are_texts_in_each_language() -> None:
    """Unquoted, YAML reads `0x240` as a number, and a comma ends a text."""
    for question in (question for family in read_data(QUESTIONS).values() for question in family):
        assert {*question["ask"]} == {*question["answer"]} == {"en", "zh"}, question["name"]
        texts = [*question["ask"].values(), *question["answer"].values(), *question["words"]]
        assert [text for text in texts if not isinstance(text, str)] == []


def test_a_frame_is_written_as_can_utils_take_it() -> None:
    """They recognise a 29-bit id by its eight digits."""
    page_of_frame: dict[tuple[str, str], str] = {}
    for name in ("cells", "blower"):
        for page in DocsTarget().generate([specification(ROOT / f"tests/specs/{name}/v1.yaml")], {}):
            page_of_frame |= dict.fromkeys(
                re.findall(r"^\| \[`([0-9A-F]+)#([0-9A-F]*|R)`\]", page.text, re.MULTILINE), page.path
            )
    assert {len(id_) for id_, _ in page_of_frame} == {3, 8}
    assert ("0D05FF41", "64FFFE0000000000") in page_of_frame
    assert any(data == "R" for _, data in page_of_frame)


SENTENCES = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
parameters:
  model: {values: {A: {title: Model A}, B: {title: Model B}, C: {}}}
effects: {glows: {level: warning, title: Glows}}
states: {lit: {entered_by: [dim]}, dark: {entered_by: [b], prevents: [glows]}}
types: {byte: {raw: u8}}
layouts:
  shared: {fields: {level: {at: 1, type: byte}}}
  alone: {fields: {level: {at: 1, type: byte}}}
commands:
  dim: {code: 0x10, effects: [glows], only: {model: [A, B]}, request: {level: {at: 2, type: byte}}, reply: echo}
  b: {code: 0x20, only: {model: [A, C]}, request: {}, reply: {layout: shared}}
  c: {code: 0x21, request: {}, reply: {layout: shared}}
  d: {code: 0x22, request: {}, reply: {layout: shared}}
  e: {code: 0x30, request: {}, reply: {layout: shared}}
  f: {code: 0x40, request: {}, reply: {layout: alone}}
"""


def test_sentences_on_pages_of_commands(tmp_path: Path) -> None:
    """Availability by the titles of values if all have one; shared fields by codes; what does not occur in a state."""
    (tmp_path / "spec.yaml").write_text(SENTENCES, "utf-8")
    pages = {output.path: output.text for output in DocsTarget().generate([specification(tmp_path / "spec.yaml")], {})}
    expected = {
        "dim": ("\nAvailable on Model A, Model B\n", "| The request is returned unchanged |", "\nOther bits: 0\n"),
        "b": ("\nAvailable on `model A, C`\n", "| Same fields as the replies of `0x21` to `0x22`, `0x30` |"),
        "c": ("| Same fields as the replies of `0x20`, `0x22`, `0x30` |", "| command code |"),
        "f": ("| Fields of this reply only |",),
    }
    for name, sentences in expected.items():
        for sentence in sentences:
            assert sentence in pages[f"en/v1/commands/{name}.md"], (name, sentence)
    state = "While [Dark](../states.md#states.dark), this does not occur: Glows"
    assert state in pages["en/v1/commands/dim.md"]


@pytest.mark.parametrize("language", ["en", "zh"])
def test_a_procedure_that_only_reads_decides_on_the_edition(language: str) -> None:
    """A reply to 0x9A decides between three; only one of the others has 0x40. Written from the manuals."""
    page = (ROOT / f"generated/docs/{language}/which-edition.md").read_text("utf-8").partition("## ")[0]
    assert re.findall(r"`([0-9A-F]{3}#[0-9A-F]{16})` ?[(（]", page) == ["141#9A00000000000000", "141#40050A0000000000"]
    decisions = re.findall(r"\| `(0x\w+) \+ node` \| (?:`(DATA\[\d\])` ([^|]+))? ?\| (\[v.*) \|", page)
    zero, nonzero = {"en": ("is 0 ", "is not 0 "), "zh": ("为 0 ", "不为 0 ")}[language]
    assert [(*row[:3], re.findall(r"\[(.*?)\]", row[3])) for row in decisions] == [
        ("0x140", "DATA[2]", zero, ["v2.35"]),
        ("0x140", "DATA[2]", nonzero, ["v2.35-2024-02"]),
        ("0x180", "", "", ["v2.36-2024-11", "v2.36-2025-03"]),
    ]
    assert {"en": "The id of the reply and `DATA[2]` decide:", "zh": "由回复的标识符和`DATA[2]`即可判断："}[
        language
    ] in page
    assert page.count("`0x241..0x260`") == 1
    rows = [line for line in page.splitlines() if line.strip().startswith("| [v2")]
    assert [re.findall(r"`voltage` `([^`]+)`", row)[0] for row in rows] == [
        "DATA[3..4] × 0.1 V",
        *["DATA[2..3] × 0.01 V"] * 3,
    ]
    assert [re.findall(r"`(0x\w+) \+ node`", row)[0] for row in rows] == ["0x140", "0x140", "0x180", "0x180"]
