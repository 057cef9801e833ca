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
from ..semantics.decoder import CanFrame
from ..semantics.encoder import SPECIAL, Sender, Senders
from ..semantics.receiver import Receiver, Refused
from .golden_entries import KEY, Problem, judged, named, told
from .rule import Found, Subject


def check(subject: Subject) -> Found:
    if subject.frames is not None:
        yield from judged(subject.edition, "refused", subject.frames.refused, _Judge(subject.edition).judge)


class _Judge:
    """Judges the entries of an edition; what parameters lead to is worked out once."""

    def __init__(self, edition: Edition) -> None:
        self._commands = {command.name: command for command in reversed(edition.commands)}
        self._receiver = Receiver(edition)
        self._senders = Senders()

    def judge(self, entry: RefusedFrame | RefusedValues) -> Iterator[Problem]:
        sender = self._senders.under(entry.parameters)
        return self._frame(entry, sender) if isinstance(entry, RefusedFrame) else self._values(entry, sender)

    def _frame(self, entry: RefusedFrame, sender: Sender) -> Iterator[Problem]:
        frame = CanFrame(entry.id, entry.data, entry.extended, entry.remote)
        found = self._receiver.decode(entry.decode, frame, sender.assignment)
        if isinstance(found, Refused):
            yield from _other_reason(entry.says, found)
        else:
            text = f"the spec accepts this, {told(*found, frame, sender.assignment)}"
            yield ("says",), text, "it belongs into `frames`, if that is right; otherwise check the spec"

    def _values(self, entry: RefusedValues, sender: Sender) -> Iterator[Problem]:
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
        amiss = list(_amiss(sender, message, entry))
        if amiss:
            yield from amiss
            return
        refused = sender.refuses(message, entry.node) or _refused(sender, message, entry)
        if refused is None:
            yield ("says",), f"the spec accepts this, {_accepted(message, entry)}", _beyond(sender, message, entry)
            return
        yield from _other_reason(entry.says, refused)
        if refused.says is entry.says and entry.field is not None and entry.field != refused.field:
            hint = f"field: {refused.field}" if refused.field else "leave `field` out"
            yield ("field",), f"it is not for `{entry.field}` that the spec refuses this: {refused.text}", hint


def _other_reason(says: Refusal, refused: Refused) -> Iterator[Problem]:
    if refused.says is not says:
        yield ("says",), f"the spec refuses this as {refused.says.value}: {refused.text}", f"says: {refused.says.value}"


def _amiss(sender: Sender, message: Message, entry: RefusedValues) -> Iterator[Problem]:
    """What keeps an entry from being asked at all: fields that are not there, or are of another shape."""
    fields = sender.fields(message)
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
    if lacking and not unknown and sender.refuses(message, entry.node) is None:
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


def _refused(sender: Sender, message: Message, entry: RefusedValues) -> Refused | None:
    """Why the spec refuses the first field that it refuses."""
    fields = sender.fields(message) or {}
    if entry.values:
        refusals = (sender.refuses_value(field, entry.values[name]) for name, field in fields.items())
    else:
        refusals = (sender.refuses_raw(fields[name], raw) for name, raw in entry.raw.items())
    return next((refused for refused in refusals if refused), None)


def _accepted(message: Message, entry: RefusedValues) -> str:
    """What is accepted, in words: `the request of dim, node 1: level raw 1000`."""
    given = [f"{name} {_shown(value)}" for name, value in entry.values.items()]
    given = given or [f"{name} raw {raw}" for name, raw in entry.raw.items()]
    return named(message, entry.node) + (f": {', '.join(given)}" if given else "")


def _shown(value: Value | Fraction) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_shown, value))}]"
    return formatting.exact(value) if isinstance(value, Fraction) else value


def _beyond(sender: Sender, message: Message, entry: RefusedValues) -> str:
    """What would be refused in place of what is accepted."""
    field = (sender.fields(message) or {}).get(entry.field or next(iter(entry.values or entry.raw), ""))
    if entry.says is Refusal.OUT_OF_RANGE and field is not None:
        return f"take it out, or write what is beyond {sender.limits(field.type)} of `{field.name}`"
    nodes = message.id.nodes
    if entry.says is Refusal.UNKNOWN_NODE and nodes is not None:
        return f"take it out, or write a node beyond {nodes[0]}..{nodes[-1]}"
    return "take it out, or check the spec"
