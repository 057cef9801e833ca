"""Golden frames decode and encode as listed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from ..diagnostics.diagnostic import nearest
from ..language.edition import EditionSpec, MessageSpec
from ..model import formatting
from ..model.edition import Edition
from ..model.golden_frames import GoldenFrame
from ..model.layout import Field, Space
from ..model.message import Direction, Message
from ..model.refusal import Refusal
from ..model.types import Assignment, Order, Type
from ..semantics.decoder import Decoder, Identified, Rejection, Value, field_value, rejects_checked
from ..semantics.encoder import SPECIAL, Encoder, Encoders
from ..semantics.frame import CanFrame, Raw, can_frame, code_of, difference, node_in_id, raws, sent_id
from .golden_entries import KEY, EntryProblem, entry_findings, named, unknown_name
from .rule import CheckInput, Findings, RelatedItem


def check(subject: CheckInput) -> Findings:
    if subject.frames is not None:
        yield from entry_findings(
            subject.edition, "frames", subject.frames.frames, _FrameChecker(subject.edition, subject.spec).problems
        )


class _FrameChecker:
    """Checks the golden frames of an edition; encoders are cached by their parameters."""

    def __init__(self, edition: Edition, spec: EditionSpec) -> None:
        self._edition, self._spec = edition, spec
        self._messages = {direction: _messages(edition, direction) for direction in Direction}
        self._encoders = Encoders()
        self._decoder = Decoder(edition)

    def problems(self, frame: GoldenFrame) -> list[EntryProblem]:
        direction = frame.direction
        if not frame.command:
            return [((), "a frame is either a request or a reply", "write `request: COMMAND` or `reply: COMMAND`")]
        message = self._messages[direction].get(frame.command)
        if message is None:
            return [self._unknown(frame.command, direction)]
        can = can_frame(frame)
        encoder = self._encoders.for_parameters(frame.parameters)
        assignment = encoder.assignment
        alone = self._decoder.identify(direction, can, assignment)
        is_expected = isinstance(alone, Identified) and (alone.message.name, alone.node) == (message.name, frame.node)
        if not is_expected:
            problem = _header(message, frame, can, assignment)
            if problem:
                return [(*problem[:3], self._length(message)) if len(can.data) != message.dlc else problem]
        variant = message.layout.variant(assignment)
        if variant is None:
            text = f"the fields depend on `{message.layout.parameter}`, which is missing"
            return [((), text, f"add parameters: {{{message.layout.parameter}: …}}")]
        missing = [name for name in message.parameters if name not in assignment]
        if missing:
            return [((), f"a constant is `{missing[0]}`, which is missing", f"add parameters: {{{missing[0]}: …}}")]
        rejection = rejects_checked(message, can, assignment)
        wrong = [(("data",), rejection.text, _CHECKED[rejection.reason])] if rejection else []
        in_data = raws(variant, can)
        fields = {f.name: f for f in variant.fields}
        if not is_expected and (direction is Direction.REQUEST or not _has_same_fields(alone, encoder, can, in_data)):
            text = f"rejected: {alone.text}" if isinstance(alone, Rejection) else named(alone.message, alone.node)
            return [(("data",), f"without its request, this frame is {text}", "check the codes in the spec")]
        problems = [*wrong, *_raws(frame, fields, in_data, assignment), *_values(frame, fields, in_data, assignment)]
        is_complete = frame.raw.keys() == in_data.keys()
        return problems or (
            [] if frame.decode_only or not is_complete else list(_encoded(encoder, message, fields, frame, can))
        )

    def _length(self, message: Message) -> RelatedItem:
        """The definition of the length of a message, which the spec may leave to the default."""
        item = f"the length of {message.name}"
        command = self._edition.command(message.command)
        written = getattr(self._spec.commands[command.spec_name], message.direction.value)
        if isinstance(written, MessageSpec) and written.dlc is not None:
            return RelatedItem((*message.path, "dlc"), item)
        entry = command.entry
        if entry is not None and self._spec.tables[entry.table].entries[entry.name].dlc is not None:
            return RelatedItem((*entry.path, "dlc"), item)
        return RelatedItem(("bus", "dlc"), item, may_be_missing=True)

    def _unknown(self, command: str, direction: Direction) -> EntryProblem:
        """The problem of a frame whose command is unknown, or has no message of this direction."""
        opposite = next(candidate for candidate in Direction if candidate is not direction)
        if command in self._messages[opposite]:
            text = f"`{command}` has no {direction.value}"
            return (direction.value,), text, f"write `{opposite.value}: {command}`, or remove it"
        near = nearest(command, self._messages[direction])
        hint = f"{near}; or remove the entry" if near else "remove the entry"
        return (direction.value,), f"there is no command `{command}`", hint


def _messages(edition: Edition, direction: Direction) -> dict[str, Message]:
    """The message of each command in a direction, by command name."""
    both = ((c.name, c.message(direction)) for c in edition.commands)
    return {name: message for name, message in both if message is not None}


def _has_same_fields(
    alone: Identified | Rejection, encoder: Encoder, can: CanFrame, in_data: Mapping[str, Raw]
) -> bool:
    """Whether a frame has the same fields if it is identified as another message."""
    variant = alone.message.layout.variant(encoder.assignment) if isinstance(alone, Identified) else None
    return variant is not None and raws(variant, can) == in_data


def _encoded(
    encoder: Encoder, message: Message, fields: Mapping[str, Field], frame: GoldenFrame, can: CanFrame
) -> Iterator[EntryProblem]:
    """Problems of a frame that the encoder rejects or writes differently."""
    for name, raw in frame.raw.items():
        rejection = encoder.rejects_raw(fields[name], raw)
        if rejection:
            limits = f"`{name}` allows {encoder.limits(fields[name].type)}"
            yield ("raw", name), f"this frame cannot be encoded: {rejection.text}", f"{limits}; {_DECODE_ONLY}"
    sent = encoder.encode_raws(message, frame.node, frame.raw, code_of(message, can))
    if isinstance(sent, Rejection):
        if sent.reason is Refusal.NOT_AVAILABLE:
            yield (
                ("parameters",),
                f"this frame cannot be encoded: {sent.text}",
                f"check `only` of the command; {_DECODE_ONLY}",
            )
        return
    if sent.id != can.id:
        yield ("id",), f"the id is 0x{can.id:X}, but an encoder writes 0x{sent.id:X}", _CHECK_LAYOUT
    if can.remote and can.data:
        yield ("data",), "a remote frame has no data", 'data: ""'
    elif sent.data != can.data:
        at = next(i for i, (encoded, listed) in enumerate(zip(sent.data, can.data, strict=True)) if encoded != listed)
        text = f"DATA[{at}] is 0x{can.data[at]:02X}, but an encoder writes 0x{sent.data[at]:02X}"
        yield ("data",), text, _CHECK_LAYOUT
    elif frame.values.keys() == frame.raw.keys():
        yield from _sent_otherwise(fields, frame)


def _sent_otherwise(fields: Mapping[str, Field], frame: GoldenFrame) -> Iterator[EntryProblem]:
    """Names without a value that have several raw integers, of which an encoder writes another one than the frame has."""
    for name, raw in frame.raw.items():
        for element in raw if isinstance(raw, list) else [raw]:
            no_value = fields[name].type.no_value(element)
            if no_value is not None and element != no_value.value:
                own, written = formatting.constant(element), formatting.constant(no_value.value)
                text = f"`{name}` is {own} in `data`, but an encoder writes {written} for `{no_value.name}`"
                yield ("values", name), text, "add decode_only: true"


_CHECKED = {
    Refusal.WRONG_CONSTANT: "check `data`",
    Refusal.WRONG_CHECKSUM: "check `data`, and the algorithm and `over` in the spec",
}
_DECODE_ONLY = "or add decode_only: true if the frame is never sent"
_CHECK_LAYOUT = f"check the layout and its `reserved` fields; {_DECODE_ONLY}"


def _header(message: Message, frame: GoldenFrame, can: CanFrame, assignment: Assignment) -> EntryProblem | None:
    wrong = difference(message, can, assignment)
    if wrong is None:
        node = node_in_id(message, can, assignment)
        if node is None and frame.node is not None:
            return ("node",), f"the id 0x{frame.id:X} has no node", _WITHOUT_NODE
        if node != frame.node:
            return ("node",), f"the id 0x{frame.id:X} belongs to node {node}", f"check `id`, or write `node: {node}`"
        return None
    if wrong.part == "parameter":
        return (), wrong.text, f"add parameters: {{{message.id.parameter}: …}}"
    if wrong.part in ("extended", "remote"):
        return (), wrong.text, f"{wrong.part}: {str(not getattr(frame, wrong.part)).lower()}"
    if wrong.part == "id":
        if frame.node is not None and message.id.nodes is not None and frame.node not in message.id.nodes:
            nodes = f"{message.id.nodes[0]}..{message.id.nodes[-1]}"
            return ("node",), f"the address `{message.address}` has no node {frame.node}", f"its nodes are {nodes}"
        if frame.node is not None and message.id.nodes is None:
            known = message.id.at(assignment) or message.id
            fixed = f": the id of all its frames is 0x{known.base:X}" if _has_whole_id(message) else ""
            return ("node",), f"the address `{message.address}` has no node{fixed}", _WITHOUT_NODE
        from_hex = int(str(frame.id), 16) if str(frame.id).isdigit() else 0
        is_decimal = difference(message, can._replace(id=from_hex), assignment) is None
        hint = f"did you mean 0x{from_hex:X}?" if is_decimal else _id_of(message, frame, assignment)
        return ("id",), wrong.text, hint
    if wrong.part == "length":
        return ("data",), wrong.text, f"write {message.dlc} bytes, or change `dlc`"
    return ("data",), wrong.text, "check `data` and the code in the spec"


_WITHOUT_NODE = (
    "remove `node`, or write the id of the address with `node` in the spec; "
    "if a field contains the node, write `holds: node` in it"
)


def _has_whole_id(message: Message) -> bool:
    """Whether the address alone decides the id: there are no fields or keys in it."""
    spaces = {field.space for field in message.layout.fields} | {key.space for key in message.keys}
    return Space.ID not in spaces


def _id_of(message: Message, frame: GoldenFrame, assignment: Assignment) -> str:
    """The hint for a wrong id, with the id of the node if no field is a part of it."""
    hint, nodes = "check the id and the address in the spec", message.id.nodes
    node = frame.node
    if nodes is None or node is None or node not in nodes or any(f.space is Space.ID for f in message.layout.fields):
        return hint
    return f"the id of node {node} is 0x{sent_id(message, node, assignment) or 0:X}; {hint}"


def _raws(
    frame: GoldenFrame, fields: Mapping[str, Field], in_data: Mapping[str, Raw], assignment: Assignment
) -> list[EntryProblem]:
    unknown = [name for name in frame.raw if name not in in_data]
    if unknown:
        return [(("raw", name, KEY), *_no_field(name, fields, in_data)) for name in unknown]
    missing = [name for name in in_data if name not in frame.raw]
    if missing and frame.source:
        names = _listed(dict.fromkeys(missing))
        return [((), f"neither `raw` nor `values` has {names}", "write the raw integer or the value of every field")]
    return [
        (("raw", name), f"`{name}` is {raw} in `data`", _raw_hint(fields[name], raw, frame.raw[name], assignment))
        for name, raw in in_data.items()
        if raw != frame.raw.get(name, raw)
    ]


def _raw_hint(field: Field, raw: Raw, wanted: Raw, assignment: Assignment) -> str:
    """The hint for a raw integer that differs from that in the data."""
    if field.is_node:
        return f"this field contains the node: write `node: {raw}`, or check `data`"
    if _is_swapped(raw, wanted, field.type.width):
        return f"the other byte order gives {wanted}: check `data`, and `byte_order` in the spec"
    if field_value(field, raw, assignment) == wanted:
        return f"{wanted} is its value{_unit(field)}; `raw` is an integer, and `values` has the value"
    return f"check `data` and the layout in the spec{_where(field)}"


def _unit(field: Field) -> str:
    return f" in {field.type.unit.symbol}" if field.type.unit else ""


def _is_swapped(raw: Raw, wanted: Raw, width: int) -> bool:
    """Whether two raw integers have the same bytes in opposite order."""
    if isinstance(raw, list) or isinstance(wanted, list) or width % 8 or width == 8:
        return False
    mask = (1 << width) - 1
    return int.from_bytes((raw & mask).to_bytes(width // 8, "little"), "big") == wanted & mask


def _values(
    frame: GoldenFrame, fields: Mapping[str, Field], in_data: Mapping[str, Raw], assignment: Assignment
) -> list[EntryProblem]:
    problems: list[EntryProblem] = []
    for name, wanted in frame.values.items():
        if name not in fields or name not in in_data:
            problems.append((("values", name, KEY), *_no_field(name, fields, in_data)))
            continue
        if name in frame.raw and frame.raw[name] != in_data[name]:
            continue  # already reported: the value follows from the raw integer
        value = field_value(fields[name], in_data[name], assignment)
        if not _same(wanted, _as_written(fields[name].type, wanted, in_data[name], value)):
            unknown = unknown_name(fields[name], wanted, ("none", *SPECIAL)) if fields[name].type.members else None
            is_raw = wanted == in_data[name]
            said = unknown or _other_value(fields[name], wanted, is_raw, value, assignment)
            problems.append((("values", name), *said))
    return problems


def _as_written(type_: Type, wanted: object, raw: object, value: object) -> object:
    """The value, in place of which a golden frame can have the name of a number."""
    if isinstance(wanted, list) and isinstance(raw, list) and isinstance(value, list) and len(wanted) == len(value):
        return [_as_written(type_, *each) for each in zip(wanted, raw, value, strict=True)]
    return wanted if isinstance(raw, int) and wanted and wanted == type_.name_of(raw) else value


def _no_field(name: str, fields: Mapping[str, Field], in_data: Mapping[str, Raw]) -> tuple[str, str]:
    """The text and hint for a name that is not a field with a value."""
    if name in fields:
        text = f"`{name}` is `{fields[name].role.key}` in this spec: it is in `data` only"
        return text, f"remove it from this entry; the fields to list are {_listed(in_data)}"
    return f"there is no field `{name}`", nearest(name, in_data) or "remove it"


def _listed(names: Mapping[str, object]) -> str:
    return ", ".join(f"`{name}`" for name in names) or "none"


def _other_value(
    field: Field, wanted: object, is_raw: bool, value: Value | list[Value], assignment: Assignment
) -> tuple[str, str]:
    """The text and hint for a value that differs from that of the spec; it may be the raw integer."""
    type_, none = field.type, (None, [None] * len(field.elements))
    missing = [name for name in (type_.linear.parameter, *type_.times) if name and name not in assignment]
    if value in none and missing:
        text = f"the value of `{field.name}` depends on `{missing[0]}`, which is missing"
        return text, f"add parameters: {{{missing[0]}: …}}"
    by = "names" if type_.enum or type_.flags else "scale"
    hint = f"check the value and the type in the spec{_where(field)}"
    if is_raw:
        hint = f"this is the raw integer; `values` has the value{_unit(field)}"
    elif _is_rounded(wanted, value):
        hint = f"if the manual rounds it, write {_shown(value)}; otherwise {hint}"
    return f"`{field.name}` is {_shown(value)} according to the {by} in the spec", hint


def _is_rounded(wanted: object, value: object) -> bool:
    """Whether numbers may be the exact ones, rounded or cut to fewer decimals."""
    if isinstance(wanted, list) and isinstance(value, list):
        return len(wanted) == len(value) and all(map(_is_rounded, wanted, value))
    if not isinstance(wanted, (int, Fraction)) or not isinstance(value, (int, Fraction)):
        return False
    decimals = formatting.exact(Fraction(wanted)).partition(".")[2]
    return abs(Fraction(value) - Fraction(wanted)) < Fraction(1, 10 ** len(decimals))


def _where(field: Field) -> str:
    """A note on the bits of a big-endian field narrower than a byte, whose `at` is the highest; else empty."""
    segments = field.elements[0].segments
    if (
        field.space is not Space.DATA
        or field.type.order is not Order.BIG
        or len(segments) > 1
        or segments[0].width == 8
    ):
        return ""
    return f"; it is in {formatting.place(field.space, segments)}, since `at` is the highest bit of a big-endian field"


def _same(wanted: object, value: object) -> bool:
    if isinstance(wanted, list) and isinstance(value, list):
        return len(wanted) == len(value) and all(map(_same, wanted, value))
    return wanted == ("none" if value is None else value)


def _shown(value: Value | list[Value]) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_shown, value))}]"
    return formatting.exact(value) if isinstance(value, Fraction) else "none" if value is None else str(value)
