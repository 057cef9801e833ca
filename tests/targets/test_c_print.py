"""Printing and filters in C: golden frames of all specs against the reference decoder, and short buffers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction

import pytest
from canwright.conformance.adapter import CanFrame, Refused, assignment
from canwright.model.golden_frames import GoldenFrame, RefusedFrame
from canwright.model.joined import JoinedText
from canwright.model.layout import Field
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.model.types import Encoding
from canwright.project.loader import load
from canwright.semantics.decoder import Decoded, Decoder, Rejection
from canwright.semantics.encoder import Encoder
from canwright.semantics.frame import required_raw
from canwright.targets.base import EditionInput
from canwright.targets.c.target import CTarget

from ..conformance.adapters.c import EXTENDED, REMOTE, CAdapter
from ..spec_texts import SPECS, called

Made = tuple[EditionInput, CAdapter]


@pytest.fixture(scope="module", params=SPECS, ids=called)
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Made:
    edition_input = load(request.param).specification
    return edition_input, CAdapter.create(edition_input, tmp_path_factory.mktemp("print"))


def frames(edition_input: EditionInput) -> Iterator[tuple[Direction, CanFrame, GoldenFrame | RefusedFrame]]:
    assert edition_input.frames is not None
    for golden in (*edition_input.frames.frames, *edition_input.frames.refused):
        if isinstance(golden, (GoldenFrame, RefusedFrame)):
            direction = golden.direction if isinstance(golden, GoldenFrame) else golden.decode
            yield direction, CanFrame(golden.id, golden.data, golden.extended, golden.remote), golden


def test_golden_frames_as_text(made: Made) -> None:
    edition_input, target = made
    decoder = Decoder(edition_input.edition)
    for direction, frame, golden in frames(edition_input):
        known = golden.parameters
        length, text = target.text(direction, frame, known)
        assert length == len(text) and text.isascii()
        decoded = decoder.decode(direction, frame, assignment(known))
        if isinstance(decoded, Rejection):
            assert text.startswith(f"{decoded.reason.value}: {frame.id:0{8 if frame.extended else 3}X} ["), text
            continue
        head, _, rest = text.partition(":")
        node = "" if decoded.node is None else f", node {decoded.node}"
        assert head == f"{decoded.message.command} {direction.value}{node}"
        printed = dict(re.findall(r" ([\w\[\]]+)=(.*?)(?= [\w\[\]]+=|$)", rest))
        for field in decoded.variant.fields:
            if field.is_given:
                check_field(printed, field, decoded, Encoder(known))
        assert not printed


def check_field(printed: dict[str, str], field: Field, decoded: Decoded, encoder: Encoder) -> None:
    """Removes the texts of a field and compares them with its raw integers and values."""
    raws, values = decoded.raws[field.name], decoded.values.get(field.name)
    if field.type.joined is not None:
        text = printed.pop(field.name)
        assert isinstance(raws, list)
        if isinstance(field.type.joined, JoinedText):
            content = bytes(raws).partition(b"\0")[0].rstrip(bytes([field.type.joined.padding]))
            assert text == "".join(chr(byte) if 32 <= byte < 127 else "?" for byte in content)
        else:
            assert text == ("".join(f"{raw:X}" for raw in raws) if values is None else str(values))
        return
    elements = raws if isinstance(raws, list) else [raws]
    each = values if isinstance(raws, list) else [values]
    assert isinstance(each, list)
    for element, raw, value in zip(field.elements, elements, each, strict=True):
        text = printed.pop(field.name if element.index is None else f"{field.name}[{element.index}]")
        if field.type.flags:
            names = value if isinstance(value, list) else []
            unknown = [part for part in text.split("|") if part not in names]
            assert (
                sum(int(part, 16) for part in unknown if part != "none")
                + sum(1 << flag.value for flag in field.type.flags if flag.name in text.split("|"))
                == raw
            )
        elif field.type.enum:
            assert text == (value or str(raw))
        elif field.type.no_value(raw):
            assert text == value
        elif value is None:
            assert text == f"{raw} raw" or field.type.encoding is Encoding.FLOAT
        else:
            number, _, unit = text.partition(" ")
            assert unit == (field.type.unit.dbc if field.type.unit else "")
            if number.startswith(("<-", ">")):
                assert abs(Fraction(str(value))) > int(number.lstrip("<->")) == (1 << 64) - 1
            elif field.type.encoding is Encoding.FLOAT:
                assert abs(Fraction(number) - Fraction(str(value))) <= Fraction(1, 2 * 10**6)
            else:
                assert encoder.nearest_raw(field, Fraction(number)) == raw, (text, raw)


def test_a_short_buffer_cuts_the_end(made: Made) -> None:
    edition_input, target = made
    direction, frame, golden = next(frames(edition_input))
    length, text = target.text(direction, frame, golden.parameters)
    for size in range(1, length + 3):
        assert target.text(direction, frame, golden.parameters, size) == (length, text[: size - 1].strip())
    assert target.text(direction, frame, golden.parameters, 0) == (length, "")


def _macros(edition_input: EditionInput) -> dict[str, int]:
    header = next(
        o.text
        for o in CTarget().generate([edition_input], {})
        if o.path.endswith(f"/{edition_input.edition.identifier}.h")
    )
    prefix = f"{edition_input.edition.family}_{edition_input.edition.identifier}_".upper()
    filters = re.findall(rf"#define {prefix}(\w+_FILTER_(?:ID|MASK)) +0x(\w+)u", header)
    return {name: int(number, 16) for name, number in filters}


def _accepts(filter_: tuple[int, int] | Refused, id_: int) -> bool:
    assert not isinstance(filter_, Refused), filter_
    return not (id_ ^ filter_[0]) & filter_[1]


def test_filters_accept_golden_frames_and_no_other_node(made: Made) -> None:
    edition_input, target = made
    macros, decoder = _macros(edition_input), Decoder(edition_input.edition)
    for direction, frame, golden in frames(edition_input):
        decoded = decoder.decode(direction, frame, assignment(golden.parameters))
        if isinstance(decoded, Rejection):
            continue
        id_ = frame.id | EXTENDED * frame.extended | REMOTE * frame.remote
        address, rule, known = decoded.message.address, decoded.message.id, golden.parameters
        stem = f"{address}_{direction.value}_filter".upper()
        if rule.parameter is None:
            assert _accepts((macros[f"{stem}_ID"], macros[f"{stem}_MASK"]), id_), golden
        else:
            node = decoded.node if rule.nodes and decoded.node is not None else 0
            assert _accepts(target.filter(address, direction, node, known), id_), golden
            assert target.filter(address, direction, node) == Refused(Refusal.MISSING_PARAMETER)
            changed = {**known, rule.parameter: str(int(str(known[rule.parameter])) - 1)}
            filter_ = target.filter(address, direction, node, changed)
            assert filter_ == Refused(Refusal.OUT_OF_RANGE) or not _accepts(filter_, id_), (golden, changed)
        if rule.nodes is None:
            continue
        for node in rule.nodes[:40]:
            filter_ = target.filter(address, direction, node, known)
            assert _accepts(filter_, id_) == (node == decoded.node), (golden, node)
        assert target.filter(address, direction, rule.nodes[-1] + 1, known) == Refused(Refusal.UNKNOWN_NODE)


def test_filters_compare_every_bit_that_is_the_same_in_all_ids(made: Made) -> None:
    """No bit can be added to a mask: frames of every message are built here, with all values of fields in the id."""
    edition_input, target = made
    macros = _macros(edition_input)
    known = {name: value for _, _, golden in frames(edition_input) for name, value in golden.parameters.items()}
    for direction in Direction:
        ids: dict[str, set[int]] = {}
        of_node: dict[tuple[str, int], set[int]] = {}
        for message in edition_input.edition.messages(direction):
            rule = message.id.at(assignment(known))
            assert rule is not None
            free = [
                s.low + bit
                for f in message.layout.fields
                if required_raw(f) is None
                for e in f.elements
                for s in e.segments
                for bit in range(s.width)
                if f.space.value == "id"
            ]
            keyed = {0}
            for place, key in enumerate(message.keys):
                values = (key.value, *message.accepted_codes) if place == 0 else (key.value,)
                if key.space.value == "id":
                    keyed = {
                        k | sum((value >> s.raw_low & (1 << s.width) - 1) << s.low for s in key.segments)
                        for k in keyed
                        for value in values
                    }
            flags = EXTENDED * message.id.extended | REMOTE * message.remote
            nodes = rule.nodes or range(1)
            for node in nodes:
                starts = [rule.base + node * rule.node_step | k | flags for k in keyed]
                built = {*starts, *(start | 1 << bit for start in starts for bit in free)}
                ids.setdefault(message.address, set()).update(built)
                if node in (nodes[0], nodes[-1]):
                    of_node.setdefault((message.address, node), set()).update(built)
        for address, address_ids in ids.items():
            mask = f"{address}_{direction.value}_filter_mask".upper()
            if edition_input.edition.address(address).rule(direction).parameter is None:
                assert macros[mask] == _common_bits(address_ids), (address, direction)
            else:
                assert mask not in macros, "a filter for all values of a parameter"
        for (address, node), node_ids in of_node.items():
            rule = edition_input.edition.address(address).rule(direction)
            if rule.nodes is not None or rule.parameter is not None:
                filter_ = target.filter(address, direction, node, known)
                assert not isinstance(filter_, Refused), (address, direction, filter_)
                assert filter_[1] == _common_bits(node_ids), (address, direction, node)


def _common_bits(ids: set[int]) -> int:
    """The mask of the bits that are the same in all ids, with the flags."""
    first = next(iter(ids))
    differing = 0
    for id_ in ids:
        differing |= id_ ^ first
    return (0xC0000000 | (0x1FFFFFFF if first & EXTENDED else 0x7FF)) & ~differing
