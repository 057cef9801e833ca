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
from ..model.types import Assignment, Order
from ..semantics.decoder import Decoder, Identified, Rejection, Value, field_value
from ..semantics.encoder import Encoder, Encoders
from ..semantics.frame import CanFrame, Raw, difference, node_in_id, raws, wrong_constants
from . import can_ids
from .golden_entries import KEY, EntryProblem, entry_findings, named
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
        can = CanFrame(frame.id, frame.data, frame.extended, frame.remote)
        alone = self._decoder.identify(direction, can)
        is_expected = isinstance(alone, Identified) and (alone.message.name, alone.node) == (message.name, frame.node)
        if not is_expected:
            problem = _header(message, frame, can)
            if problem:
                return [(*problem[:3], self._length(message)) if len(can.data) != message.dlc else problem]
        encoder = self._encoders.for_parameters(frame.parameters)
        variant = message.layout.variant(encoder.assignment)
        if variant is None:
            text = f"the fields depend on `{message.layout.parameter}`, which is missing"
            return [((), text, f"add parameters: {{{message.layout.parameter}: …}}")]
        wrong = [
            (("data",), f"the constant `{f.name}` is not {f.role.sent_raw}", "check `data`")
            for f in wrong_constants(variant.fields, can)
        ]
        found = raws(variant, can)
        fields = {f.name: f for f in variant.fields}
        if not is_expected and (direction is Direction.REQUEST or not _has_same_fields(alone, encoder, can, found)):
            text = f"rejected: {alone.text}" if isinstance(alone, Rejection) else named(alone.message, alone.node)
            return [(("data",), f"without its request, this frame is {text}", "check the codes in the spec")]
        problems = [*wrong, *_raws(frame, fields, found), *_values(frame, fields, found, encoder.assignment)]
        return problems or ([] if frame.decode_only else list(_encoded(encoder, message, fields, frame, can)))

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
        other = next(one for one in Direction if one is not direction)
        if command in self._messages[other]:
            text = f"`{command}` has no {direction.value}"
            return (direction.value,), text, f"write `{other.value}: {command}`, or remove it"
        hint = nearest(command, self._messages[direction]) or "remove it"
        return (direction.value,), f"there is no command `{command}`", hint


def _messages(edition: Edition, direction: Direction) -> dict[str, Message]:
    """The message of each command in a direction, by command name."""
    both = ((c.name, c.message(direction)) for c in edition.commands)
    return {name: message for name, message in both if message is not None}


def _has_same_fields(alone: Identified | Rejection, encoder: Encoder, can: CanFrame, found: Mapping[str, Raw]) -> bool:
    """Whether a frame has the same fields if it is identified as another message."""
    variant = alone.message.layout.variant(encoder.assignment) if isinstance(alone, Identified) else None
    return variant is not None and raws(variant, can) == found


def _encoded(
    encoder: Encoder, message: Message, fields: Mapping[str, Field], frame: GoldenFrame, can: CanFrame
) -> Iterator[EntryProblem]:
    """Problems of a frame that the encoder rejects or writes differently."""
    for name, raw in frame.raw.items():
        rejection = encoder.rejects_raw(fields[name], raw)
        if rejection:
            limits = f"`{name}` allows {encoder.limits(fields[name].type)}"
            yield ("raw", name), f"this frame cannot be encoded: {rejection.text}", f"{limits}; {_DECODE_ONLY}"
    sent = encoder.encode_raws(message, frame.node, frame.raw)
    if isinstance(sent, Rejection):
        return
    if sent.id != can.id:
        yield ("id",), f"the id is 0x{can.id:X}, but an encoder writes 0x{sent.id:X}", _CHECK_LAYOUT
    if can.remote and can.data:
        yield ("data",), "a remote frame has no data", 'data: ""'
    elif sent.data != can.data:
        at = next(i for i, (one, other) in enumerate(zip(sent.data, can.data, strict=True)) if one != other)
        text = f"DATA[{at}] is 0x{can.data[at]:02X}, but an encoder writes 0x{sent.data[at]:02X}"
        yield ("data",), text, _CHECK_LAYOUT


_DECODE_ONLY = "or add decode_only: true if the frame is never sent"
_CHECK_LAYOUT = f"check the layout and its `reserved` fields; {_DECODE_ONLY}"


def _header(message: Message, frame: GoldenFrame, can: CanFrame) -> EntryProblem | None:
    wrong = difference(message, can)
    if wrong is None:
        node = node_in_id(message, can)
        if node is None and frame.node is not None:
            return ("node",), f"the id 0x{frame.id:X} has no node", "remove `node`"
        if node != frame.node:
            return ("node",), f"the id 0x{frame.id:X} belongs to node {node}", f"check `id`, or write `node: {node}`"
        return None
    if wrong.part in ("extended", "remote"):
        return (), wrong.text, f"{wrong.part}: {str(not getattr(frame, wrong.part)).lower()}"
    if wrong.part == "id":
        from_hex = int(str(frame.id), 16) if str(frame.id).isdigit() else 0
        is_decimal = difference(message, can._replace(id=from_hex)) is None
        hint = f"did you mean 0x{from_hex:X}?" if is_decimal else _id_of(message, frame)
        return ("id",), wrong.text, hint
    if wrong.part == "length":
        return ("data",), wrong.text, f"write {message.dlc} bytes, or change `dlc`"
    return ("data",), wrong.text, "check `data` and the code in the spec"


def _id_of(message: Message, frame: GoldenFrame) -> str:
    """The hint for a wrong id, with the id of the node if no field is a part of it."""
    hint, nodes = "check the id and the address in the spec", message.id.nodes
    node = frame.node
    if nodes is None or node is None or node not in nodes or any(f.space is Space.ID for f in message.layout.fields):
        return hint
    return f"the id of node {node} is 0x{can_ids.of_message(message)[nodes.index(node)]:X}; {hint}"


def _raws(frame: GoldenFrame, fields: Mapping[str, Field], found: Mapping[str, Raw]) -> list[EntryProblem]:
    unknown = [name for name in frame.raw if name not in found]
    if unknown:
        return [(("raw", name, KEY), *_no_field(name, fields, found)) for name in unknown]
    missing = [name for name in found if name not in frame.raw]
    if missing:
        names = ", ".join(f"`{name}`" for name in missing)
        return [(("raw",), f"`raw` lacks {names}", "write the raw integer of every field; `values` may have fewer")]
    return [
        (
            ("raw", name),
            f"`{name}` is {raw} in `data`",
            f"check `data` and the layout in the spec{_where(fields[name])}",
        )
        for name, raw in found.items()
        if raw != frame.raw[name]
    ]


def _values(
    frame: GoldenFrame, fields: Mapping[str, Field], found: Mapping[str, Raw], assignment: Assignment
) -> list[EntryProblem]:
    problems: list[EntryProblem] = []
    for name, wanted in frame.values.items():
        if name not in fields or name not in found:
            problems.append((("values", name, KEY), *_no_field(name, fields, found)))
            continue
        if name in frame.raw and frame.raw[name] != found[name]:
            continue  # already reported: the value follows from the raw integer
        value = field_value(fields[name], found[name], assignment)
        if not _same(wanted, value):
            problems.append((("values", name), *_other_value(fields[name], value, assignment)))
    return problems


def _no_field(name: str, fields: Mapping[str, Field], found: Mapping[str, Raw]) -> tuple[str, str]:
    """The text and hint for a name that is not a field with a value."""
    if name in fields:
        return f"`{name}` is a constant", "remove it; golden frames list only fields with a value"
    return f"there is no field `{name}`", nearest(name, found) or "remove it"


def _other_value(field: Field, value: Value | list[Value], assignment: Assignment) -> tuple[str, str]:
    """The text and hint for a value that differs from that of the spec."""
    type_, none = field.type, (None, [None] * len(field.elements))
    missing = [name for name in (type_.linear.parameter, *type_.times) if name and name not in assignment]
    if value in none and missing:
        text = f"the value of `{field.name}` depends on `{missing[0]}`, which is missing"
        return text, f"add parameters: {{{missing[0]}: …}}"
    by = "names" if type_.enum or type_.flags else "scale"
    hint = f"check the value and the type in the spec{_where(field)}"
    return f"`{field.name}` is {_shown(value)} according to the {by} in the spec", hint


def _where(field: Field) -> str:
    """A note on the bits of a big-endian field narrower than a byte, whose `at` is the highest; else empty."""
    one = field.elements[0].segments
    if field.space is not Space.DATA or field.type.order is not Order.BIG or len(one) > 1 or one[0].width == 8:
        return ""
    return f"; it is in {formatting.place(field.space, one)}, since `at` is the highest bit of a big-endian field"


def _same(wanted: object, value: object) -> bool:
    if isinstance(wanted, list) and isinstance(value, list):
        return len(wanted) == len(value) and all(map(_same, wanted, value))
    return wanted == ("none" if value is None else value)


def _shown(value: Value | list[Value]) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_shown, value))}]"
    return formatting.exact(value) if isinstance(value, Fraction) else "none" if value is None else str(value)
