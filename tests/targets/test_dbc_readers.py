"""The DBC files in readers: both load all of it and agree, and every message crosses cantools unharmed."""

from __future__ import annotations

import dataclasses
import functools
import io
import itertools
import re
import struct
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import cantools
import pytest
from cantools.database import Database
from canwright.conformance.adapter import CanFrame, Cannot, Decoded, Refused
from canwright.conformance.dbc import DbcAdapter
from canwright.model.edition import Edition
from canwright.model.layout import ConstantRole, Element, Field, FixedRole, Layout, Segment, Space, Variant
from canwright.model.message import Direction, KeyRole, Message
from canwright.model.refusal import Refusal
from canwright.model.types import Assignment, Encoding
from canwright.project.loader import specification
from canwright.targets.base import EditionInput
from canwright.targets.dbc.target import DbcTarget
from hypothesis import given, settings, strategies as st

from ..resolve.test_tables import TABLE
from ..spec_texts import SMALL, called, edition
from .test_dbc import CASES, PAGES, SPECS, files


def loaded(text: str) -> Database:
    database = cantools.database.load_string(text, "dbc", strict=True)
    assert isinstance(database, Database)
    return database


def loaded_by_canmatrix(text: str) -> Any:
    """Loads a file afresh: canmatrix keeps ids in its class, which would mix one file with the next."""
    import canmatrix.formats

    matrix: Any = canmatrix.formats.load_flat(io.BytesIO(text.encode("ascii")), "dbc")
    type(matrix)._frames_dict_id_extend.clear()
    return matrix


@pytest.mark.interop("canmatrix")
@pytest.mark.parametrize("spec", [*SPECS, PAGES, *SMALL], ids=called)
def test_cantools_and_canmatrix_agree_on_every_signal(spec: Path) -> None:
    for path, text in files(spec).items():
        first, second = loaded(text), loaded_by_canmatrix(text)
        assert second.load_errors == []
        assert {m.name for m in first.messages} == {f.name for f in second.frames}
        for message in first.messages:
            frame = second.frame_by_name(message.name)
            assert (frame.arbitration_id.id, frame.arbitration_id.extended, frame.size) == (
                message.frame_id,
                message.is_extended_frame,
                message.length,
            )
            assert set(frame.transmitters) == set(message.senders)
            assert {s.name for s in message.signals} == {s.name for s in frame.signals}
            for signal in message.signals:
                matrix_signal = frame.signal_by_name(signal.name)
                mux = signal.multiplexer_ids[0] if signal.multiplexer_ids else None
                start = matrix_signal.get_startbit(bit_numbering=1)
                assert start == signal.start, f"{path} {signal.name}"
                assert (matrix_signal.size, matrix_signal.is_little_endian, matrix_signal.is_float) == (
                    signal.length,
                    signal.byte_order == "little_endian",
                    signal.conversion.is_float,
                )
                assert matrix_signal.is_signed == signal.is_signed
                assert (float(matrix_signal.factor), float(matrix_signal.offset)) == (
                    signal.conversion.scale,
                    signal.conversion.offset,
                )
                assert (
                    matrix_signal.is_multiplexer,
                    None if matrix_signal.is_multiplexer else matrix_signal.mux_val,
                ) == (
                    signal.is_multiplexer,
                    mux,
                )
                assert (matrix_signal.unit or None, set(matrix_signal.receivers)) == (
                    signal.unit,
                    set(signal.receivers),
                )
                assert {int(k): str(v) for k, v in matrix_signal.values.items()} == {
                    int(k): str(v) for k, v in (signal.choices or {}).items()
                }
                assert (matrix_signal.comment or None) == signal.comment


@functools.cache
def adapter(spec: Path) -> DbcAdapter:
    return DbcAdapter(specification(spec))


def every_message() -> Iterator[object]:
    """All that a DBC can say, which leaves out a remote frame and one that is shorter than others of its id."""
    for spec in SPECS:
        edition = specification(spec).edition
        for direction in Direction:
            for message in edition.messages(direction):
                if not message.remote and message.name != "short_request":
                    yield pytest.param(spec, message, id=f"{spec.stem}-{message.name}")


def packed(message: Message, raw: Mapping[str, list[int]]) -> bytes:
    """The data of a message, bit by bit."""
    places = [(bits_of(key.segments), key.value) for key in message.keys if key.space is Space.DATA]
    for field in message.layout.fields:
        values = (
            [field.role.raw] * len(field.elements) if isinstance(field.role, FixedRole) else raw.get(field.name, [])
        )
        places += [(element.bits, value) for element, value in zip(field.elements, values, strict=False)]
    frame = sum(1 << bit for bits, value in places for i, bit in enumerate(bits) if value >> i & 1)
    return frame.to_bytes(message.dlc, "little")


def bits_of(segments: tuple[Segment, ...]) -> tuple[int, ...]:
    return Element(None, segments).bits


def raw_integers(field: Field, assignment: Assignment) -> st.SearchStrategy[int]:
    """Raw integers that an encoder must take."""
    type_ = field.type
    if type_.enum:
        return st.sampled_from([member.value for member in type_.enum])
    if type_.flags:
        return st.sets(st.sampled_from([flag.value for flag in type_.flags])).map(lambda on: sum(1 << n for n in on))
    span = type_.raw_range.at(assignment)
    if type_.encoding is Encoding.FLOAT:
        limit = 100 if span else None
        as_int, as_float = (">I", ">f") if type_.width == 32 else (">Q", ">d")
        floats = st.floats(limit and -limit, limit, width=32, allow_nan=False, allow_infinity=False)
        return floats.map(lambda value: int(struct.unpack(as_int, struct.pack(as_float, value))[0]))
    low, high = type_.raw_limits
    if span:
        first, last = span.low.at({}), span.high.at({})
        low = low if first is None else int(first)
        high = high if last is None else int(last)
    return st.integers(low, high)


@pytest.mark.parametrize(("spec", "message"), list(every_message()))
@settings(max_examples=30)
@given(data=st.data())
def test_every_message_crosses_cantools(spec: Path, message: Message, data: st.DataObject) -> None:
    edition = described_once(spec)
    command = edition.command(message.command)
    splits = [p for p in edition.parameters if p.is_choice and not p.is_numeric]
    assignment = {
        p.name: data.draw(st.sampled_from(command.only.get(p.name, [v.name for v in p.values]))) for p in splits
    }
    variant = message.layout.variant(assignment)
    assert variant
    raw = {
        field.name: [data.draw(raw_integers(field, assignment)) for _ in field.elements]
        for field in variant.fields
        if field.is_given
    }
    flat = {f.name: raw[f.name] if f.is_array else raw[f.name][0] for f in variant.fields if f.name in raw}
    node = data.draw(st.sampled_from(message.id.nodes)) if message.id.nodes else None
    keys_in_id = sum(key.value << key.segments[0].low for key in message.keys if key.space is Space.ID)
    id_ = message.id.base + (node or 0) * message.id.node_step + keys_in_id
    frame = CanFrame(id_, packed(message, raw), message.id.extended)

    written = adapter(spec).encode_raw(message.direction, message.command, node, flat, assignment)
    assert written == CanFrame(frame.id, frame.data, frame.extended)
    for code in message.identifying_codes or [None]:
        if code is not None and message.keys[0].space is Space.DATA:
            key = dataclasses.replace(message.keys[0], value=code)
            frame = frame._replace(data=packed(dataclasses.replace(message, keys=(key,)), raw))
        read = adapter(spec).decode(message.direction, frame, assignment, None)
        assert isinstance(read, Decoded)
        assert (read.command, read.node, read.raw) == (message.command, node, flat)


@functools.cache
def described_once(spec: Path) -> Edition:
    return specification(spec).edition


@pytest.mark.parametrize("page", range(256))
def test_a_message_without_a_code_has_the_other_values_of_the_selector(page: int) -> None:
    frame = CanFrame(0x448, bytes([page, 0x05, 0x10, 0x20, 0x30, 0, 0, 0]))
    named, values = {
        0: ("summary", {"r00_voltage": 0x2010}),
        8: ("limits", {"r08_current": 0x1005, "r08_maximum": 0x30}),
    }.get(page, (page, {"r_cell": 0x2010, "r_state": 0x30}))
    (text,) = files(PAGES).values()
    assert loaded(text).decode_message(frame.id, frame.data) == {"r_code": named, **values}
    if page not in (0, 8):
        raw = {"page": page, "cell": 0x2010, "state": 0x30}
        assert adapter(PAGES).decode(Direction.REPLY, frame, {}, None) == Decoded("cells", None, raw, raw)
        sent = CanFrame(0x448, bytes([page, 0, 0x10, 0x20, 0x30, 0, 0, 0]))
        assert adapter(PAGES).encode_raw(Direction.REPLY, "cells", None, raw, {}) == sent


@pytest.mark.interop("canmatrix")
def test_canmatrix_reads_the_ranges_of_a_selector() -> None:
    (text,) = files(PAGES).values()
    frame = loaded_by_canmatrix(text).frame_by_name("Bms_reply")
    for page, names in ((0, {"r00_voltage"}), (1, {"r_cell", "r_state"}), (9, {"r_cell", "r_state"})):
        assert {*frame.decode(bytes([page, *range(7)]))} == {"r_code", *names}


@pytest.mark.parametrize(
    "page",
    [
        "{at: 0.0, raw: u4}",
        "{at: 0, raw: u16}",
        "{at: 0, raw: i8}",
        "{at: 0, type: half}",
        "{at: 0, type: level}",
    ],
)
def test_a_multiplexor_cannot_overlap_a_signal(page: str, tmp_path: Path) -> None:
    """The file has the message without a code alone, and the guide says what it lacks."""
    types = "types: {half: {raw: u8, scale: 0.5}, level: {raw: u8, enum: {low: 1, high: 2}}}\n"
    text = types + PAGES.read_text("utf-8").replace("{at: 0, raw: u8}, cell", f"{page}, cell")
    texts = {o.path: o.text for o in DbcTarget().generate([EditionInput(edition(tmp_path, text), None)], {})}
    assert "m0" not in texts["pack-v1-reply.dbc"]
    assert "- `summary` (reply): omitted: only the data at other positions" in texts["README.md"]


def test_a_selector_of_more_than_8_bits_has_no_ranges(tmp_path: Path) -> None:
    """cantools lists every value of a range."""
    text = PAGES.read_text("utf-8").replace("{at: 0, raw: u8}", "{at: 0, raw: u16}").replace("{at: 1,", "{at: 2,")
    (output, _) = DbcTarget().generate([EditionInput(edition(tmp_path, text), None)], {})
    assert " SG_ r_page : 0|16@1+ " in output.text and "SG_MUL_VAL_" not in output.text


def with_second_selector(at: int, constant: int | None = None) -> EditionInput:
    """A small edition whose code 0x1B has two forms, told apart by byte `at`; byte 1 is constant where it is given."""
    small = specification(CASES / "tiny.yaml")
    commands = []
    for name, value in (("shine", 0x0A), ("turn", 0x0B)):
        command = small.edition.command(name)
        (form,) = command.replies
        reply = form.message
        code = dataclasses.replace(reply.keys[0], value=0x1B)
        index = dataclasses.replace(
            code, name="index", role=KeyRole.INDEX, segments=(Segment(at, 0, 8, 0),), value=value
        )
        layout = moved(reply.layout, constant)
        moved_reply = dataclasses.replace(
            reply, keys=(code, index), accepted_codes=(), identifying_codes=(0x1B,), layout=layout
        )
        commands.append(dataclasses.replace(command, replies=(dataclasses.replace(form, message=moved_reply),)))
    return EditionInput(dataclasses.replace(small.edition, commands=tuple(commands)), None)


def moved(layout: Layout, constant: int | None) -> Layout:
    """The layout with its first field out of the second selector's way, and a constant in byte 1."""
    first, *rest = layout.fields
    away = dataclasses.replace(first, elements=(Element(None, (Segment(4, 0, 8, 0), Segment(5, 0, 8, 8))),))
    byte = (Element(None, (Segment(1, 0, 8, 0),)),)
    fixed = (
        ()
        if constant is None
        else (dataclasses.replace(rest[-1], name="fixed", elements=byte, role=ConstantRole(constant)),)
    )
    fields = (*fixed, away, *rest)
    return dataclasses.replace(layout, fields=fields, variants=(Variant(values=(), fields=fields),))


def shown(database: Database, data: bytes) -> dict[str, object]:
    """The signals of a reply that are not 0."""
    decoded: Any = database.decode_message(0x101, data)
    return {name: value for name, value in decoded.items() if value}


def test_selectors_side_by_side_have_a_file_that_reads_them_as_one() -> None:
    texts = {o.path: o.text for o in DbcTarget().generate([with_second_selector(1)], {})}
    plain, joined = loaded(texts["lamp-v1-small-reply.dbc"]), loaded(texts["lamp-v1-small-reply-index.dbc"])
    frame = bytes.fromhex("1B 0B 00 00 34 12 00 21")
    assert plain.decode_message(0x101, frame) == {"r_code": 0x1B, "r1B_index": "turn", "r1B_data": 0x2100_1234_0000}
    assert shown(joined, frame) == {
        "r_code_index": "turn",
        "r1B_0B_turn": 0x1234,
        "r1B_0B_faults_hot": 1,
        "r1B_0B_faults_dead": 1,
    }
    assert "- `index`, `shine`, `turn`: [small reply](" in texts["README.md"]
    comment = plain.get_message_by_frame_id(0x101).get_signal_by_name("r1B_data").comment
    assert comment == "Bits whose meaning depends on the other selector; a separate file shows them as fields."


@pytest.mark.parametrize("spec", [*SPECS, *SMALL], ids=called)
def test_no_comment_says_a_thing_twice(spec: Path) -> None:
    for text in files(spec).values():
        for comment in re.findall(r'^CM_ SG_ .*?"(.*)";$', text, re.MULTILINE):
            words = comment.split(". ")[0].rstrip(".").lower().split(": ")
            assert not any(first == second for first, second in itertools.pairwise(words)), comment


def test_a_constant_between_selectors_is_read_with_them() -> None:
    texts = {o.path: o.text for o in DbcTarget().generate([with_second_selector(2, constant=0x05)], {})}
    joined = loaded(texts["lamp-v1-small-reply-index.dbc"])
    read = shown(joined, bytes.fromhex("1B 05 0B 00 34 12 00 20"))
    assert read == {"r_code_index": "turn", "r1B_0B_turn": 0x1234, "r1B_0B_faults_dead": 1}


def test_a_message_with_two_selectors_crosses_cantools() -> None:
    both = DbcAdapter(with_second_selector(1))
    frame = CanFrame(0x101, bytes.fromhex("1B 0B 00 00 34 12 00 21"))
    read = both.decode(Direction.REPLY, frame, {}, None)
    assert isinstance(read, Decoded)
    assert (read.command, read.raw) == ("turn", {"turn": 0x1234, "faults": 0x21})
    assert both.encode_raw(Direction.REPLY, "turn", 1, read.raw, {}) == CanFrame(frame.id, frame.data)
    unknown = CanFrame(0x101, bytes.fromhex("1B 0C 00 00 34 12 00 21"))
    assert both.decode(Direction.REPLY, unknown, {}, None) == Refused(Refusal.UNKNOWN_CODE)


def test_selectors_apart_leave_the_bits_between_undecided() -> None:
    texts = {o.path: o.text for o in DbcTarget().generate([with_second_selector(2)], {})}
    assert not any("index" in path for path in texts)
    read = loaded(texts["lamp-v1-small-reply.dbc"]).decode_message(0x101, bytes.fromhex("1B 01 0A 02 00 00 00 80"))
    assert read == {"r_code": 0x1B, "r1B_index": "shine", "r1B_data": 1, "r1B_data_2": 0x80_0000_0002}
    assert "`turn` (reply): its fields are shown as raw bits" in texts["README.md"]
    with pytest.raises(Cannot, match="selectors_apart"):
        DbcAdapter(with_second_selector(2)).encode_raw(Direction.REPLY, "turn", 1, {"turn": 0, "faults": 0}, {})


@pytest.mark.parametrize("longer_first", [False, True])
def test_a_selector_that_not_all_entries_have_is_left_to_the_joined_files(longer_first: bool, tmp_path: Path) -> None:
    head, gains, rest = TABLE.partition("      gains:")
    gains, level = (gains + rest).splitlines(keepends=True)
    text = head + (level + gains if longer_first else gains + level)
    texts = {o.path: o.text for o in DbcTarget().generate([EditionInput(edition(tmp_path, text), None)], {})}
    plain, settings, settings_and_level = (
        loaded(texts[f"lamp-v1-command{which}.dbc"]) for which in ("", "-settings", "-settings-level")
    )
    short, long = bytes.fromhex("42 A0 07 00 09 00 00 00"), bytes.fromhex("42 05 0A 00 03 00 00 00")
    name = "write_setting_gains"
    assert plain.decode_message(0x101, short) == {
        "c_code": "write_setting",
        "c42_index": name,
        "c42_data": 0x0000_0009_0007,
    }
    assert plain.decode_message(0x101, long) == {
        "c_code": "write_setting",
        "c42_index": "write_setting_level",
        "c42_data": 0x0000_0003_000A,
    }
    assert settings.decode_message(0x101, short) == {"c_code_index": name, "c42_A0_kp": 7, "c42_A0_ki": 9}
    read = settings_and_level.decode_message(0x101, long)
    assert read == {"c_code_index_index_2": "write_setting_level", "c42_05_0A_level": pytest.approx(0.3)}


def test_no_name_is_given_to_a_selector_that_does_not_decide(tmp_path: Path) -> None:
    text = TABLE + "      hue: {index: [5, 0x0B], layout: {hue: {at: 4, raw: u8}}}\n"
    texts = {o.path: o.text for o in DbcTarget().generate([EditionInput(edition(tmp_path, text), None)], {})}
    read = loaded(texts["lamp-v1-command.dbc"]).decode_message(0x101, bytes.fromhex("42 05 0B 00 03 00 00 00"))
    assert read == {"c_code": "write_setting", "c42_index": 5, "c42_data": 0x0000_0003_000B}
