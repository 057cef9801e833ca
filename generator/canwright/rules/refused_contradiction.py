"""Golden frames and values listed under `refused` are rejected for the listed reason."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ..diagnostics.diagnostic import DocumentPath, nearest
from ..model import formatting
from ..model.edition import Edition
from ..model.golden_frames import RefusedFrame, RefusedValues, Value
from ..model.layout import Field
from ..model.message import Direction, Message
from ..model.refusal import Refusal
from ..semantics.decoder import Decoder, Rejection
from ..semantics.encoder import SPECIAL, Encoder, Encoders
from ..semantics.frame import can_frame
from .golden_entries import KEY, EntryProblem, described, entry_findings, named, unknown_name
from .rule import CheckInput, Findings


def check(subject: CheckInput) -> Findings:
    if subject.frames is not None:
        yield from entry_findings(
            subject.edition, "refused", subject.frames.refused, _RejectionChecker(subject.edition).problems
        )


class _RejectionChecker:
    """Checks the `refused` entries of an edition; encoders are cached by their parameters."""

    def __init__(self, edition: Edition) -> None:
        self._commands = {command.name: command for command in reversed(edition.commands)}
        self._decoder = Decoder(edition)
        self._encoders = Encoders()

    def problems(self, entry: RefusedFrame | RefusedValues) -> Iterator[EntryProblem]:
        encoder = self._encoders.for_parameters(entry.parameters)
        return self._frame(entry, encoder) if isinstance(entry, RefusedFrame) else self._values(entry, encoder)

    def _frame(self, entry: RefusedFrame, encoder: Encoder) -> Iterator[EntryProblem]:
        frame = can_frame(entry)
        outcome = self._decoder.decode(entry.decode, frame, encoder.assignment)
        if isinstance(outcome, Rejection):
            yield from _other_reason(entry.says, outcome)
        else:
            text = f"the spec accepts this frame: {described(outcome)}"
            yield ("says",), text, "move it to `frames`, or check the spec"

    def _values(self, entry: RefusedValues, encoder: Encoder) -> Iterator[EntryProblem]:
        command = self._commands.get(entry.command)
        if command is None:
            hint = nearest(entry.command, self._commands) or "remove it"
            yield ("command",), f"there is no command `{entry.command}`", hint
            return
        message = command.message(entry.encode)
        if message is None:
            opposite = next(direction for direction in Direction if direction is not entry.encode)
            hint = f"encode: {opposite.value}" if command.message(opposite) else "remove it"
            yield ("encode",), f"`{entry.command}` has no {entry.encode.value}", hint
            return
        problems = list(_entry_problems(encoder, message, entry))
        if problems:
            yield from problems
            return
        if entry.values:
            outcome = encoder.encode_values(message, entry.node, entry.values)
        else:
            outcome = encoder.encode_raws(message, entry.node, entry.raw)
        if not isinstance(outcome, Rejection):
            yield (
                ("says",),
                f"the spec accepts these values: {_accepted(message, entry)}",
                _beyond(encoder, message, entry),
            )
            return
        yield from _other_reason(entry.says, outcome)
        if outcome.reason is entry.says and entry.field_name is not None and entry.field_name != outcome.field:
            hint = f"field: {outcome.field}" if outcome.field else "remove `field`"
            yield ("field",), f"the spec rejects this, but not because of `{entry.field_name}`: {outcome.text}", hint


def _other_reason(says: Refusal, outcome: Rejection) -> Iterator[EntryProblem]:
    if outcome.reason is not says:
        yield (
            ("says",),
            f"the spec rejects this with {outcome.reason.value}: {outcome.text}",
            f"says: {outcome.reason.value}",
        )


def _entry_problems(encoder: Encoder, message: Message, entry: RefusedValues) -> Iterator[EntryProblem]:
    """Problems that prevent an encoding: unknown or missing fields, and values of a wrong kind."""
    fields = encoder.fields(message)
    if fields is None:
        fields = {f.name: f for f in message.layout.given}
    written = [("raw", name) for name in entry.raw] + [("values", name) for name in entry.values]
    unknown = [path for path in written if path[1] not in fields]
    for path in unknown:
        text = f"there is no field `{path[1]}` in {named(message, None)}"
        yield (*path, KEY), text, nearest(path[1], fields) or "remove it"
    for name, raw in entry.raw.items():
        if name in fields and isinstance(raw, list) is not fields[name].is_array:
            yield ("raw", name), *_shape(fields[name])
    for name, value in entry.values.items():
        mismatch = _mismatch(fields[name], value) if name in fields else None
        if mismatch:
            yield ("values", name), *mismatch
    if message.id.nodes is None and entry.node is not None:
        yield ("node",), f"{named(message, None)} has no node", "remove `node`"
    given = entry.values or entry.raw
    missing = [name for name in fields if name not in given]
    if missing and not unknown and encoder.rejects(message, entry.node) is None:
        at: DocumentPath = ("values" if entry.values else "raw",) if given else ()
        yield at, f"`{missing[0]}` is missing in {named(message, None)}", "write all of its fields"


def _mismatch(field: Field, value: Value) -> tuple[str, str] | None:
    """Text and hint for a value of a wrong kind: no list for an array, an unknown name; else None."""
    if field.type.joined is not None:
        return (f"`{field.name}` is one value", "write it without brackets") if isinstance(value, list) else None
    if isinstance(value, list) is not (field.is_array or bool(field.type.flags and not isinstance(value, str))):
        return _shape(field)
    return unknown_name(field, value, SPECIAL if field.type.is_number else ())


def _shape(field: Field) -> tuple[str, str]:
    if field.is_array:
        return f"`{field.name}` is an array", f"write a list of {len(field.elements)}"
    if field.type.flags:
        return f"`{field.name}` has flags", "write a list of their names, [] for none"
    return f"`{field.name}` is one number", "write it without brackets"


def _accepted(message: Message, entry: RefusedValues) -> str:
    """The accepted message as text: `the request of dim, node 1: level raw 1000`."""
    given = [f"{name} {_shown(value)}" for name, value in entry.values.items()]
    given = given or [f"{name} raw {raw}" for name, raw in entry.raw.items()]
    return named(message, entry.node) + (f": {', '.join(given)}" if given else "")


def _shown(value: Value | Fraction) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_shown, value))}]"
    return formatting.exact(value) if isinstance(value, Fraction) else value


def _beyond(encoder: Encoder, message: Message, entry: RefusedValues) -> str:
    """The hint for accepted values: values that would be rejected."""
    field = (encoder.fields(message) or {}).get(entry.field_name or next(iter(entry.values or entry.raw), ""))
    if entry.says is Refusal.OUT_OF_RANGE and field is not None:
        return f"remove it, or write a value of `{field.name}` outside {encoder.limits(field.type)}"
    nodes = message.id.nodes
    if entry.says is Refusal.UNKNOWN_NODE and nodes is not None:
        return f"remove it, or write a node outside {nodes[0]}..{nodes[-1]}"
    return "remove it, or check the spec"
