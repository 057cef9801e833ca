"""What golden frames say is refused, the spec refuses, and for that reason."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ..diagnostics.diagnostic import DocumentPath, nearest
from ..language.golden_frames import RefusedFrame, RefusedValues, Value
from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Field
from ..model.message import Direction, Message
from ..model.refusal import Refusal
from ..semantics.decoder import Decoder, Rejection
from ..semantics.encoder import SPECIAL, Encoder, Encoders
from ..semantics.frame import CanFrame
from .golden_entries import KEY, Problem, described, judged, named
from .rule import Found, Subject


def check(subject: Subject) -> Found:
    if subject.frames is not None:
        yield from judged(subject.edition, "refused", subject.frames.refused, _Judge(subject.edition).judge)


class _Judge:
    """Judges the entries of an edition; what parameters lead to is worked out once."""

    def __init__(self, edition: Edition) -> None:
        self._commands = {command.name: command for command in reversed(edition.commands)}
        self._decoder = Decoder(edition)
        self._encoders = Encoders()

    def judge(self, entry: RefusedFrame | RefusedValues) -> Iterator[Problem]:
        encoder = self._encoders.under(entry.parameters)
        return self._frame(entry, encoder) if isinstance(entry, RefusedFrame) else self._values(entry, encoder)

    def _frame(self, entry: RefusedFrame, encoder: Encoder) -> Iterator[Problem]:
        frame = CanFrame(entry.id, entry.data, entry.extended, entry.remote)
        found = self._decoder.decode(entry.decode, frame, encoder.assignment)
        if isinstance(found, Rejection):
            yield from _other_reason(entry.says, found)
        else:
            text = f"the spec accepts this, {described(found)}"
            yield ("says",), text, "it belongs into `frames`, if that is right; otherwise check the spec"

    def _values(self, entry: RefusedValues, encoder: Encoder) -> Iterator[Problem]:
        command = self._commands.get(entry.command)
        if command is None:
            hint = nearest(entry.command, self._commands) or "take it out"
            yield ("command",), f"there is no command `{entry.command}`", hint
            return
        message = command.message(entry.encode)
        if message is None:
            other = next(direction for direction in Direction if direction is not entry.encode)
            hint = f"encode: {other.value}" if command.message(other) else "take it out"
            yield ("encode",), f"`{entry.command}` has no {entry.encode.value}", hint
            return
        amiss = list(_amiss(encoder, message, entry))
        if amiss:
            yield from amiss
            return
        if entry.values:
            found = encoder.encode_values(message, entry.node, entry.values)
        else:
            found = encoder.encode_raws(message, entry.node, entry.raw)
        if not isinstance(found, Rejection):
            yield ("says",), f"the spec accepts this, {_accepted(message, entry)}", _beyond(encoder, message, entry)
            return
        yield from _other_reason(entry.says, found)
        if found.reason is entry.says and entry.field is not None and entry.field != found.field:
            hint = f"field: {found.field}" if found.field else "leave `field` out"
            yield ("field",), f"it is not for `{entry.field}` that the spec refuses this: {found.text}", hint


def _other_reason(says: Refusal, found: Rejection) -> Iterator[Problem]:
    if found.reason is not says:
        yield ("says",), f"the spec refuses this as {found.reason.value}: {found.text}", f"says: {found.reason.value}"


def _amiss(encoder: Encoder, message: Message, entry: RefusedValues) -> Iterator[Problem]:
    """What keeps an entry from being asked at all: fields that are not there, or are of another shape."""
    fields = encoder.fields(message)
    if fields is None:
        fields = {f.name: f for f in message.layout.fields if f.fixed is None}
    written = [("raw", name) for name in entry.raw] + [("values", name) for name in entry.values]
    unknown = [path for path in written if path[1] not in fields]
    for path in unknown:
        text = f"there is no field `{path[1]}` in {named(message, None)}"
        yield (*path, KEY), text, nearest(path[1], fields) or "take it out"
    for name, raw in entry.raw.items():
        if name in fields and isinstance(raw, list) is not fields[name].is_array:
            yield ("raw", name), *_shape(fields[name])
    for name, value in entry.values.items():
        misfit = _misfit(fields[name], value) if name in fields else None
        if misfit:
            yield ("values", name), *misfit
    if message.id.nodes is None and entry.node is not None:
        yield ("node",), f"{named(message, None)} has no node", "leave `node` out"
    given = entry.values or entry.raw
    lacking = [name for name in fields if name not in given]
    if lacking and not unknown and encoder.rejects(message, entry.node) is None:
        at: DocumentPath = ("values" if entry.values else "raw",) if given else ()
        yield at, f"`{lacking[0]}` is missing in {named(message, None)}", "write every field of it"


def _misfit(field: Field, value: Value) -> tuple[str, str] | None:
    """What is wrong with the kind of a value: not a list where one is meant, no number, or a name that is not there."""
    if isinstance(value, list) is not (field.is_array or bool(field.type.flags and not isinstance(value, str))):
        return _shape(field)
    members = field.type.enum or field.type.flags
    for one in value if isinstance(value, list) else (value,):
        if isinstance(one, str) and (members or one not in SPECIAL):
            names = [member.name for member in members]
            if one not in names:
                text = f"`{field.name}` has no value `{one}`" if members else f"`{field.name}` is a number"
                return text, nearest(one, names) or "check the type in the spec"
    return None


def _shape(field: Field) -> tuple[str, str]:
    if field.is_array:
        return f"`{field.name}` is an array", f"write a list of {len(field.elements)}"
    if field.type.flags:
        return f"`{field.name}` are flags", "write a list of their names, [] for none"
    return f"`{field.name}` is one number", "write it without brackets"


def _accepted(message: Message, entry: RefusedValues) -> str:
    """What is accepted, in words: `the request of dim, node 1: level raw 1000`."""
    given = [f"{name} {_shown(value)}" for name, value in entry.values.items()]
    given = given or [f"{name} raw {raw}" for name, raw in entry.raw.items()]
    return named(message, entry.node) + (f": {', '.join(given)}" if given else "")


def _shown(value: Value | Fraction) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_shown, value))}]"
    return formatting.exact(value) if isinstance(value, Fraction) else value


def _beyond(encoder: Encoder, message: Message, entry: RefusedValues) -> str:
    """What would be refused in place of what is accepted."""
    field = (encoder.fields(message) or {}).get(entry.field or next(iter(entry.values or entry.raw), ""))
    if entry.says is Refusal.OUT_OF_RANGE and field is not None:
        return f"take it out, or write what is beyond {encoder.limits(field.type)} of `{field.name}`"
    nodes = message.id.nodes
    if entry.says is Refusal.UNKNOWN_NODE and nodes is not None:
        return f"take it out, or write a node beyond {nodes[0]}..{nodes[-1]}"
    return "take it out, or check the spec"
