"""The DBC files: which there are, what they say, and the rules that keep every reader right."""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import cantools
import pytest
from canwright.model.golden_frames import GoldenFrame, GoldenFrames
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.targets.base import EditionInput
from canwright.targets.dbc.frames import obstacle
from canwright.targets.dbc.selection import COMMENTS, NODES
from canwright.targets.dbc.target import DbcTarget
from canwright.targets.options import Options

from ..spec_texts import MINIMAL, SMALL, SPECS as ALL, called

ROOT = Path(__file__).parents[2]
CASES = Path(__file__).parent / "dbc"
MAIN = ROOT / "spec" / "mwd_motor" / "v2.35.yaml"
SPECS = [MAIN, CASES / "tiny.yaml", CASES / "packed.yaml"]
PAGES = CASES / "pages.yaml"

SERIES = ("MS", "MF", "MH", "MG")

SECTIONS = [
    "VERSION",
    "NS_",
    "BS_",
    "BU_",
    "BO_",
    "BO_TX_BU_",
    "CM_",
    "BA_DEF_",
    "BA_DEF_DEF_",
    "BA_",
    "VAL_",
    "SIG_VALTYPE_",
    "SG_MUL_VAL_",
]


def made(spec: Path, **set_parameters: str) -> dict[str, str]:
    return {output.path: output.text for output in DbcTarget().generate([specification(spec)], set_parameters)}


def files(spec: Path, **set_parameters: str) -> dict[str, str]:
    return {path: text for path, text in made(spec, **set_parameters).items() if path.endswith(".dbc")}


@pytest.fixture(scope="module", params=[*SPECS, PAGES, *SMALL], ids=called)
def texts(request: pytest.FixtureRequest) -> Mapping[str, str]:
    return files(request.param)


@pytest.mark.parametrize(
    ("name", "nodes"), [("lamp-v1-small-reply-node1.dbc", (1,)), ("lamp-v1-small-command.dbc", ())]
)
def test_text_of_a_small_spec(name: str, nodes: tuple[int, ...]) -> None:
    texts = {
        o.path: o.text for o in DbcTarget().generate([specification(CASES / "tiny.yaml")], {}, Options({NODES: nodes}))
    }
    assert texts[name] == (CASES / name).read_text("ascii")


def test_of_very_many_nodes_the_first_are_listed(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    spec.write_text(MINIMAL.replace("nodes: 1..4}", "nodes: 1..65535, extended: true}"), "utf-8")
    written = made(spec)
    assert written["lamp-v1-command.dbc"].count("\nBO_ ") == 256
    sentence = "the DBC files list the nodes up to 256 of 65535; select others with `--nodes 257..65535`"
    assert sentence in written["README.md"]
    (further,) = DbcTarget().notices([specification(spec).edition], Options({}))
    assert further == f"lamp v1: {sentence}"
    assert not [*DbcTarget().notices([specification(spec).edition], Options({NODES: (300,)}))]


def test_a_choice_among_names_splits_the_files() -> None:
    expected = {
        f"mwd_motor-v2.35-{series}-{kind}.dbc" for series in ("MS", "MF", "MH", "MG") for kind in ("reply", "command")
    }
    assert set(made(MAIN)) == {*expected, "README.md"}
    assert set(made(CASES / "packed.yaml")) == {"drive-v1-reply.dbc", "drive-v1-command.dbc", "README.md"}


def test_directions_without_a_shared_id_are_in_one_file() -> None:
    paths = set(files(ROOT / "spec/mwd_motor/v2.36-2025-03.yaml"))
    prefix = "mwd_motor-v2.36-2025-03"
    tables = {
        f"{prefix}-{series}-{table}.dbc" for series in SERIES for table in ("control-parameters", "stored-settings")
    }
    assert paths == {f"{prefix}-{series}.dbc" for series in SERIES} | tables | {f"{prefix}-stored-settings-pid.dbc"}


def test_files_of_both_directions_have_no_warning_about_a_shared_id() -> None:
    for path, text in files(ROOT / "spec/mwd_motor/v2.36-2025-03.yaml").items():
        assert "same id" not in text and "meaningless" not in text, path
        assert " Motor7_reply: 8 Motor7\n" in text and " Motor7_command: 8 Master\n" in text, path


def test_codes_of_tables_have_names_in_the_plain_file() -> None:
    text = files(ROOT / "spec/mwd_motor/v2.36-2025-03.yaml")["mwd_motor-v2.36-2025-03-MG.dbc"]
    assert ' 192 "read_control_parameter" 193 "write_control_parameter_ram" ' in text


@pytest.mark.parametrize("nodes", [(5, 7), (32,)])
def test_selected_nodes_are_the_only_ones(nodes: tuple[int, ...]) -> None:
    outputs = {
        o.path: o.text for o in DbcTarget().generate([specification(MAIN)], {"series": "MG"}, Options({NODES: nodes}))
    }
    listed = "_".join(map(str, nodes))
    reply, command = (outputs[f"mwd_motor-v2.35-MG-{kind}-node{listed}.dbc"] for kind in ("reply", "command"))
    assert re.findall(r"^BO_ (\d+)", reply, re.MULTILINE) == [str(0x140 + node) for node in nodes]
    assert re.findall(r"^BO_ (\d+)", command, re.MULTILINE) == [*(str(0x140 + node) for node in nodes), "640"]


def test_comments_in_chinese_are_utf_8_and_change_nothing_else() -> None:
    main = specification(MAIN)
    chinese = {o.path: o.text for o in DbcTarget().generate([main], {"series": "MG"}, Options({COMMENTS: "zh"}))}
    for path, text in files(MAIN, series="MG").items():
        translated = chinese[path.replace(".dbc", "-zh.dbc")].replace('-zh";', '";')
        assert [x for x in translated.splitlines() if x[:3] != "CM_"] == [
            x for x in text.splitlines() if x[:3] != "CM_"
        ]
    text = chinese["mwd_motor-v2.35-MG-command-zh.dbc"]
    assert 'CM_ "mwd_motor v2.35。由 canwright 生成，请勿修改。参数：MG。' in text
    assert (
        'CM_ SG_ 321 cA1_iq "转矩闭环控制：转矩电流控制值。手册名称：iqControl。电机会转动。手册 2.5, 转矩闭环控制命令。";'
        in text
    )
    comments = " ".join(re.findall(r'CM_ (?:BO|SG)_ .*?"(.*)";', text))
    assert not re.search(r"[a-z]{4}", re.sub("canwright|手册名称：[^。]*", "", comments))


def test_a_set_choice_among_names_leaves_only_its_files() -> None:
    assert {path.split("-")[2] for path in files(CASES / "tiny.yaml", size="big")} == {"big"}


def test_set_numbers_make_a_variant_with_its_own_name_and_scale() -> None:
    plain = files(CASES / "tiny.yaml")["lamp-v1-big-command.dbc"]
    variant = files(CASES / "tiny.yaml", steps="12", rating="7/2")["lamp-v1-big-steps_12-rating_3.5-command.dbc"]
    assert '48|16@1+ (1,0) [0|65535] "raw"' in plain
    assert '48|16@1+ (0.087890625,0) [0|5759.912109375] "deg"' in variant
    assert '32|16@1+ (0.1,-10) [-10|6543.5] "W"' in plain
    assert '32|16@1+ (0.1,-10) [-10|24.9] "W"' in variant


def test_a_multiple_of_a_number_that_is_not_set_stays_raw_and_says_so() -> None:
    arm = next(spec for spec in SMALL if spec.parent.name == "arm")
    plain = files(arm)["arm-v1-star-command.dbc"]
    assert ' SG_ c_position : 7|16@0+ (1,0) [0|65535] "raw" Arm1' in plain
    assert (
        'CM_ SG_ 1 c_position "Move: Position. Raw integer: resolution (1 LSB) 2/65535*p_max rad, offset -p_max rad. Manual 2.";'
        in plain
    )
    texts = files(arm, p_max="12.5", t_max="18")
    made = texts["arm-v1-star-p_max_12.5-t_max_18-command.dbc"]
    assert ' SG_ c_position : 7|16@0+ (0.00038147554741741054,-12.5) [-12.5|12.5] "rad" Arm1' in made
    assert ' SG_ c_speed : 23|12@0+ (1,0) [0|4095] "raw" Arm1' in made
    assert ' SG_ c_torque : 51|12@0+ (0.008791208791208791,-18) [-16.197802197802197|16.197802197802197] "Nm"' in made
    assert 'c_position "Move: Position. Manual 2."' in made
    reply = texts["arm-v1-star-p_max_12.5-t_max_18-reply.dbc"]
    assert "Current. Raw integer: resolution (1 LSB) 1/32767*i_max A." in reply
    assert "Raw integer" not in texts["arm-v1-delta-p_max_12.5-t_max_18-reply.dbc"].split("r_current")[-1]


def test_the_guide_says_how_to_set_numbers() -> None:
    text = made(next(spec for spec in SMALL if spec.parent.name == "arm"))["README.md"]
    assert "`p_max`, `v_max`, `t_max`, `i_max`: fields that are multiples of these parameters" in text
    assert "--set p_max=12.5 --set v_max=65 --set t_max=18 --set i_max=40 --out out" in text


def test_the_guide_of_a_variant_lists_what_is_not_set_and_editions_without_files() -> None:
    items = [specification(ROOT / f"spec/mwd_motor/{name}.yaml") for name in ("v2.35", "v2.35-2024-02")]
    texts = {
        o.path: o.text
        for o in DbcTarget().generate(items, {"series": "MG", "encoder_bits": "18"}, Options({NODES: (5, 7)}))
    }
    assert (
        "This edition has no files with series=MG, encoder_bits=18."
        in texts["README.md"].split("## mwd_motor v2.35-2024-02")[1]
    )
    assert texts["README.md"].count("This edition has no files") == 1
    assert "raw integers with the unit" not in texts["README.md"]


def test_commands_that_a_value_lacks_are_left_out_but_their_reply_stays_where_another_command_has_it() -> None:
    texts = files(CASES / "tiny.yaml")
    assert "c1A_" in texts["lamp-v1-small-command.dbc"]
    assert "c1A_" not in texts["lamp-v1-big-command.dbc"]
    assert "r1A_turn" in texts["lamp-v1-big-reply.dbc"]


def test_an_accepted_code_is_defined_beside_the_printed_one() -> None:
    reply = files(MAIN)["mwd_motor-v2.35-MG-reply.dbc"]
    for code, name in (("m154", "r9A_voltage"), ("m155", "r9B_voltage")):
        assert f" SG_ {name} {code} : 24|16@1+ (0.1,0)" in reply


def test_every_code_that_only_this_reply_takes_is_defined() -> None:
    reply = files(CASES / "tiny.yaml")["lamp-v1-small-reply.dbc"]
    assert " SG_ r1E_dim m30 : " in reply
    assert " SG_ r1F_dim m31 : " in reply
    assert ' 30 "gauge" 31 "gauge_1F" ' in reply


@pytest.mark.parametrize(
    "hostile",
    [
        '";\nBO_ 1 Evil: 8 Desk\n SG_ evil : 0|8@1+ (1,0) [0|0] "" Desk',
        'a\\"; BA_ "DBName" "evil";',
        "CM_ */ {{ 7 * 7 }} {% raw %}",
        "电机",
        "'\"`;\\",
    ],
)
def test_no_text_of_a_spec_changes_more_than_comments(tmp_path: Path, hostile: str) -> None:
    spec = (CASES / "tiny.yaml").read_text("utf-8")
    for title in ("Too hot", "Dazzles", "Switch off", "Shine"):
        spec = spec.replace(f"title: {title}", f"title: {json.dumps(hostile)}")
    (tmp_path / "hostile.yaml").write_text(spec, "utf-8")
    changed, kept = files(tmp_path / "hostile.yaml"), files(CASES / "tiny.yaml")
    for path, text in kept.items():
        assert [line for line in changed[path].splitlines()[1:] if not line.startswith("CM_")] == [
            line for line in text.splitlines()[1:] if not line.startswith("CM_")
        ]
        assert changed[path].isascii()
        comments = [line for line in changed[path].splitlines() if line.startswith("CM_")]
        assert all(re.fullmatch(r'CM_ [^"]*"[^"\\]+";', line) for line in comments)


def test_scale_of_each_series_and_of_the_broadcast() -> None:
    texts = files(MAIN)
    current = {series: texts[f"mwd_motor-v2.35-{series}-command.dbc"] for series in ("MS", "MF", "MH", "MG")}
    assert '32|16@1- (0.01611328125,0) [-33|33] "A"' in current["MG"]
    assert '32|16@1- (0.008056640625,0) [-16.5|16.5] "A"' in current["MF"]
    assert '32|16@1- (1,0) [-2048|2048] "raw"' in current["MH"]
    assert "cA1_" not in current["MS"]
    assert all('0|16@1- (0.016,0) [-32|32] "A"' in text for text in current.values())
    assert "BO_ 640" not in texts["mwd_motor-v2.35-MG-reply.dbc"]


def test_files_are_plain_ascii_lines(texts: Mapping[str, str]) -> None:
    for text in texts.values():
        assert text.isascii()
        assert "\r" not in text
        assert text.endswith("\n")
        assert text.startswith("VERSION ")


def test_sections_stand_in_canonical_order(texts: Mapping[str, str]) -> None:
    for path, text in texts.items():
        words = [re.split(r"[ :]", line)[0] for line in text.splitlines() if line and not line.startswith(" ")]
        places = [SECTIONS.index(word) for word in words]
        assert places == sorted(places), path


def test_names_are_short_and_unique_in_their_message(texts: Mapping[str, str]) -> None:
    for path, text in texts.items():
        messages = re.findall(r"^BO_ (\d+) (\w+):(.*\n(?: SG_ .*\n)*)", text, re.MULTILINE)
        assert messages, path
        ids, names = [m[0] for m in messages], [m[1] for m in messages]
        assert len(set(ids)) == len(ids)
        for group in (names, *(re.findall(r" SG_ (\w+)", body) for _, _, body in messages)):
            assert len(set(group)) == len(group)
            assert all(re.fullmatch(r"[A-Za-z]\w{0,31}", name) for name in group)


def test_long_names_do_not_depend_on_other_names(tmp_path: Path) -> None:
    """A name of 42 characters ends in a hash of it, here that of `sha256sum`; the file has the whole name, too."""
    name = "c10_failure_cell_overvoltage_warning_index"
    spec, names = tmp_path / "v1.yaml", set()
    for further in ("", "failure_cell_overvoltage_warning_index_0: {at: 1, raw: u8}, "):
        fields = f"{{{further}failure_cell_overvoltage_warning_index: {{at: 2, raw: u16}}}}"
        spec.write_text(MINIMAL.replace("request: {level: {at: 2, type: level}}", f"request: {fields}"), "utf-8")
        text = files(spec)["lamp-v1-command.dbc"]
        (short,) = {*re.findall(r"SG_ (\w+) m16 : 16\|16@", text)}
        names.add(short)
        assert 'BA_DEF_ SG_ "SystemSignalLongSymbol" STRING;\n' in text
        assert 'BA_DEF_DEF_ "SystemSignalLongSymbol" "";\n' in text
        assert f'BA_ "SystemSignalLongSymbol" SG_ 257 {short} "{name}";\n' in text
    assert names == {"c10_failure_cell_overvolt_126859"}


def test_the_second_of_two_equal_names_gets_a_number(tmp_path: Path) -> None:
    (tmp_path / "v1.yaml").write_text(
        MINIMAL.replace("{level: {at: 2, type: level}}", "{a_1: {at: 1, raw: u8}, a: {at: 2, raw: u8, array: 1..2}}"),
        "utf-8",
    )
    text = files(tmp_path / "v1.yaml")["lamp-v1-command.dbc"]
    signals = re.findall(r"SG_ (c10_\w+) m16 : (\d+)\|", text)
    assert {*signals} == {("c10_a_1", "8"), ("c10_a_1_2", "16"), ("c10_a_2", "24")}


def test_named_numbers_are_numbers_with_a_value_table(tmp_path: Path) -> None:
    spec = MINIMAL.replace("raw_range: 0..1000", "raw_range: 0..1000, names: {most: 1000, least: {value: 0}}")
    (tmp_path / "v1.yaml").write_text(spec, "utf-8")
    text = files(tmp_path / "v1.yaml")["lamp-v1-command.dbc"]
    assert re.search(r'^ SG_ c10_level m16 : 16\|16@1\+ \(0.1,0\) \[0\|100\] "%"', text, re.MULTILINE)
    assert re.search(r'^VAL_ \d+ c10_level 0 "least" 1000 "most" ;$', text, re.MULTILINE)


def test_numbers_have_no_exponent(texts: Mapping[str, str]) -> None:
    for text in texts.values():
        for line in re.findall(r"^ SG_ .*", text, re.MULTILINE):
            assert re.search(r" \(-?[\d.]+,-?[\d.]+\) \[-?[\d.]+\|-?[\d.]+\] \"", line), line


def test_comments_are_on_one_line_without_quotes(texts: Mapping[str, str]) -> None:
    for text in texts.values():
        for line in text.splitlines():
            if line.startswith("CM_"):
                assert re.fullmatch(r'CM_ (BO_ \d+ |SG_ \d+ \w+ )?"[^"\\]+";', line), line


def test_every_code_has_a_signal(texts: Mapping[str, str]) -> None:
    for text in texts.values():
        for id_, selector, table in re.findall(r"^VAL_ (\d+) ([rc]_code) (.*) ;", text, re.MULTILINE):
            body = re.search(rf"^BO_ {id_} .*\n((?: SG_ .*\n)*)", text, re.MULTILINE)
            assert body and selector
            codes = re.findall(r"(\d+) \"", table)
            codes += re.findall(rf"^SG_MUL_VAL_ {id_} \w+ \w+ (\d+)-\d+, ", text, re.MULTILINE)
            assert set(codes) == set(re.findall(r" m(\d+) :", body.group(1)))


def test_ids_of_29_bits_are_marked() -> None:
    text = files(CASES / "packed.yaml")["drive-v1-command.dbc"]
    assert f"BO_ {1 << 31 | 2 << 5 | 0x0C} Axis2_move: 8 Tester" in text
    assert f'BA_ "VFrameFormat" BO_ {1 << 31 | 2 << 5 | 0x0C} 1;' in text


def test_frames_of_can_fd_are_marked() -> None:
    for spec, frame_format, rate in (("servo", 15, 1), ("tank", 14, 0)):
        (text,) = files(ROOT / f"tests/specs/{spec}/v1.yaml").values()
        assert 'BA_ "BusType" "CAN FD";' in text and f'BA_DEF_DEF_ "CANFD_BRS" "{rate}";' in text
        assert {*re.findall(r'BA_ "VFrameFormat" BO_ \d+ (\d+);', text)} == {str(frame_format)}
        database = cantools.database.load_string(text, "dbc")
        assert isinstance(database, cantools.database.Database)
        assert {message.is_fd for message in database.messages} == {True}


def test_constants_and_floats_are_marked() -> None:
    texts = files(CASES / "packed.yaml")
    id_ = 1 << 31 | 1 << 5 | 0x0C
    assert f'BA_ "GenSigStartValue" SG_ {id_} r0C_magic 90;' in texts["drive-v1-reply.dbc"]
    assert " SG_ c0C_magic : 63|8@0+ (1,0) [165|165]" in texts["drive-v1-command.dbc"]
    assert f"SIG_VALTYPE_ {id_} r0C_position : 1;" in texts["drive-v1-reply.dbc"]
    assert f"SIG_VALTYPE_ {id_ + 1} r0D_precise : 2;" in texts["drive-v1-reply.dbc"]


def test_flags_have_the_byte_order_of_their_field() -> None:
    text = files(CASES / "packed.yaml")["drive-v1-reply.dbc"]
    orders = dict(re.findall(r"SG_ r01_(\w+) (?:\w+ )?: \d+\|\d+@(\d)", text))
    assert (orders.pop("level"), orders["state_ready"], orders["state_on"]) == ("1", "0", "0")
    assert [*orders.values()] == ["0"] * 4


def test_an_id_that_both_directions_use_is_said_to_be_one() -> None:
    text = files(CASES / "packed.yaml")["drive-v1-command.dbc"]
    assert '"Move: command. A reply has the same id.";' in text
    assert '"Stop: command.";' in text


def test_what_has_no_form_is_left_out_and_named() -> None:
    texts = made(CASES / "packed.yaml")
    assert "read_precise" not in texts["drive-v1-command.dbc"]
    assert "- `read_precise` (command): omitted: a remote frame" in texts["README.md"]


def test_a_message_that_is_shorter_than_others_of_its_id_is_named() -> None:
    assert "- `short` (command): it has 2 bytes, but the file lists 8," in made(CASES / "tiny.yaml")["README.md"]
    assert " SG_ c1D_reserved m29 : 8|8@1+ " in files(CASES / "tiny.yaml")["lamp-v1-small-command.dbc"]


def test_several_senders_of_one_id_are_all_named() -> None:
    assert "BO_TX_BU_ 1408 : Probe4,Probe5;" in files(CASES / "packed.yaml")["drive-v1-reply.dbc"]


def example() -> EditionInput:
    """The edition with golden frames, so that the guide has examples; only one of each direction is fit for it."""
    plain = specification(MAIN)
    parameters = {"series": "MG"}
    reply = GoldenFrame(
        source="by_hand",
        parameters=parameters,
        direction=Direction.REPLY,
        command="read_status_1",
        id=0x142,
        node=2,
        data=bytes.fromhex("9A E2 00 E0 01 00 00 08"),
        raw={"temperature": -30, "voltage": 480, "errors": 8},
        values={"temperature": Fraction(-30), "voltage": Fraction(48), "errors": ["over_temperature"]},
    )
    request = GoldenFrame(
        source="by_hand",
        parameters=parameters,
        direction=Direction.REQUEST,
        command="turn_to_angle",
        id=0x143,
        node=3,
        data=bytes.fromhex("A5 01 00 00 39 30 00 00"),
        raw={"spin_direction": 1, "angle": 12345},
        values={"spin_direction": "counterclockwise", "angle": Fraction("123.45")},
    )
    longer = GoldenFrame(
        source="by_hand",
        parameters=parameters,
        direction=Direction.REPLY,
        command="read_status_3",
        id=0x141,
        node=1,
        data=bytes.fromhex("9D 1E 40 00 80 00 C0 00"),
        raw={"temperature": 30, "phase_a": 64, "phase_b": 128, "phase_c": 192},
        values={"temperature": Fraction(30), "phase_a": Fraction(1), "phase_b": Fraction(2), "phase_c": Fraction(3)},
        decode_only=True,
    )
    incomplete = replace(request, node=1, id=0x141, values={"angle": Fraction("123.45")})
    frames = GoldenFrames(
        sources={"by_hand": "By hand"},
        frames=[longer, reply, incomplete, request],
    )
    return EditionInput(plain.edition, frames)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dbc")
    for output in DbcTarget().generate([example()], {}):
        (folder / output.path).write_text(output.text, "ascii" if output.path.endswith(".dbc") else "utf-8")
    return folder


def test_the_guide_shows_how_to_select_nodes_where_there_are_several(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    for addresses, shown in (("nodes: 1..4", True), ("nodes: 1..1", False)):
        spec.write_text(MINIMAL.replace("nodes: 1..4", addresses), "utf-8")
        assert ("canwright generate --target dbc --nodes 1,2 --out out" in made(spec)["README.md"]) == shown


@pytest.mark.parametrize("fields_first", [False, True])
def test_of_messages_with_one_code_the_one_with_fields_is_shown(fields_first: bool, tmp_path: Path) -> None:
    short = "  ask: {code: 0x20, request: {dlc: 1, layout: {}}, reply: none}\n"
    long = "  set: {code: 0x20, request: {dlc: 4, layout: {level: {at: 2, type: level}}}, reply: none}\n"
    spec = tmp_path / "v1.yaml"
    spec.write_text(MINIMAL + (long + short if fields_first else short + long), "utf-8")
    written = made(spec)
    assert " SG_ c20_level m32 : 16|16@1+ " in written["lamp-v1-command.dbc"]
    assert "- `ask` (command): omitted: only its length distinguishes it" in written["README.md"]


def test_version_is_short_and_without_a_comma(texts: Mapping[str, str]) -> None:
    for text in texts.values():
        assert re.match(r'VERSION "[^",]{1,32}"\n', text), text[:60]


def test_start_values_are_in_range(texts: Mapping[str, str]) -> None:
    for path, text in texts.items():
        starts = dict(re.findall(r'^BA_ "GenSigStartValue" SG_ (\d+ \w+) (-?\d+);$', text, re.MULTILINE))
        for id_, body in re.findall(r"^BO_ (\d+) .*\n((?: SG_ .*\n)*)", text, re.MULTILINE):
            for name, *words in re.findall(r" SG_ (\w+) .*\((.*),(.*)\) \[(.*)\|(.*)\]", body):
                factor, offset, low, high = map(Fraction, words)
                start = starts.get(f"{id_} {name}")
                value = Fraction(0) if start is None else Fraction(start) * factor + offset
                assert low <= value <= high, f"{path} {name}"


def test_each_comment_is_printed_once(texts: Mapping[str, str]) -> None:
    for path, text in texts.items():
        comments = re.findall(r'^CM_ (?:BO_ \d+|SG_ \d+ (\w+)) "(.*)";$', text, re.MULTILINE)
        assert len(comments) == len(set(comments)), path


def test_links_of_the_guide_lead_to_all_files(folder: Path) -> None:
    links = re.findall(r"\]\(([^)]+)\)", (folder / "README.md").read_text("utf-8"))
    assert sorted(links) == sorted(file.name for file in folder.glob("*.dbc"))


def guide_of(spec: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The guide of a spec; its files are in the current folder."""
    for path, text in made(spec).items():
        (folder / path).write_text(text, "utf-8")
    monkeypatch.chdir(folder)
    return (folder / "README.md").read_text("utf-8")


def standard_input(monkeypatch: pytest.MonkeyPatch, lines: Sequence[str]) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("".join(f"{line}\n" for line in lines)))


def golden_of(spec: Path, file: str) -> list[GoldenFrame]:
    """The golden frames of the directions of a file that no DBC has to leave out, for the parameters in its name."""
    edition_input = specification(spec)
    assert edition_input.frames
    kinds = {Direction.REPLY} if file.endswith("reply.dbc") else {*Direction}
    messages = {m.name for m in edition_input.edition.all_messages() if not obstacle(m)}
    known = {
        p.name: v.name
        for p in edition_input.edition.parameters
        for v in p.values
        if v.name in file.removesuffix(".dbc").split("-")
    }
    of_command = (
        (f, edition_input.edition.command(f.command)) for f in edition_input.frames.frames if f.direction in kinds
    )
    described = ((f, c.message(f.direction)) for f, c in of_command if c.available(known) and not f.decode_only)
    return [f for f, m in described if m and m.name in messages]


def id_text(frame: GoldenFrame) -> str:
    return f"{frame.id:0{8 if frame.extended else 3}X}"


@pytest.mark.parametrize("spec", ALL, ids=called)
def test_commands_of_the_guide_decode_the_golden_frames(
    spec: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    guide = guide_of(spec, tmp_path, monkeypatch)
    commands = re.findall(
        r"^(candump [^|\n]*|echo '.*') \| (?:sed -un '(.*?)' \| )?(cantools decode .*)$", guide, re.MULTILINE
    )
    programs = re.findall(r"python3 -c '\n(.*?)^'$", guide, re.MULTILINE | re.DOTALL)
    assert bool(commands) is not bool(programs)
    for source, _, command in commands:
        frames = golden_of(spec, command.split()[-1])
        logged = [f"  can0  {id_text(f)}   [{len(f.data)}]  {f.data.hex(' ').upper()}" for f in frames]
        lines = [source.split("'")[1]] if source.startswith("echo") else logged
        standard_input(monkeypatch, lines)
        monkeypatch.setattr(sys, "argv", command.split())
        cantools._main()  # type: ignore[no-untyped-call]
        shown = capsys.readouterr().out
        assert len(re.findall(r" ::\s+\w+\(", shown)) == len(lines) > 0, shown
    for program in programs:
        (file,) = re.findall(r'load_file\("(.*)"\)', program)
        frames = golden_of(spec, file)
        standard_input(monkeypatch, [f"(1.0) can0 {id_text(f)}#{f.data.hex()}" for f in frames])
        exec(program, {})
        shown = capsys.readouterr().out
        assert len(re.findall(r"^\w+ {", shown, re.MULTILINE)) == len(frames) > 0, shown


@pytest.mark.parametrize("spec", [MAIN, *(s for s in SMALL if s.parent.name in ("pump", "blower"))], ids=called)
def test_python_of_the_guide_works_as_printed(
    spec: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code = re.search(r"```python\n(.*?)```", guide_of(spec, tmp_path, monkeypatch), re.DOTALL)
    assert code
    exec(code[1], {})
    shown = capsys.readouterr().out.splitlines()
    sent = re.search(r"  # (.*#.*)$", code[1], re.MULTILINE)
    assert len(shown) == code[1].count("print(") > 0
    assert not sent or shown[-1] == sent[1]


def test_the_sed_commands_of_the_guide_select_the_frames_of_nodes(folder: Path) -> None:
    guide = (folder / "README.md").read_text("utf-8")
    (script,) = re.findall(r"^candump -x can0 \| sed -un '(.*?)'", guide, re.MULTILINE)
    log = "  can0  RX - -  142   [1]  9A\n  can0  TX - -  142   [1]  9A\n"
    run = subprocess.run(["sed", "-un", script], input=log, capture_output=True, text=True, check=True)
    assert run.stdout == "  can0  142   [1]  9A\n"


def test_example_of_the_guide_is_complete(folder: Path) -> None:
    guide = (folder / "README.md").read_text("utf-8")
    assert "cantools decode mwd_motor-v2.35-MG-reply.dbc" in guide
    assert "# 143#a501000039300000" in guide


def test_the_file_of_a_table_has_its_read_only_entries_too(tmp_path: Path) -> None:
    """The index alone identifies the request of such an entry, the opcode is a constant."""
    spec = tmp_path / "v1.yaml"
    spec.write_text(
        """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: node << 5, nodes: 1..4}}
selector: {at: id.0, raw: u5}
tables:
  values:
    index: {at: 1, raw: u16}
    entries:
      supply: {index: 1, commands: [read], layout: {value: {at: 4, raw: f32}}}
      limit: {index: 2, layout: {value: {at: 4, raw: f32}}}
commands:
  read: {code: 4, table: values, request: {opcode: {at: 0, raw: u8, constant: 0}}, reply: {code: 5, layout: entry}}
  write: {code: 4, table: values, request: {layout: entry, fields: {opcode: {at: 0, raw: u8, constant: 1}}}, reply: none}
""",
        "utf-8",
    )
    text = made(spec)["lamp-v1-values.dbc"]
    assert set(re.findall(r"SG_ \w+ m(\d+) ", text)) == {"256", "512", "513"}
