"""Replays the golden frames of an edition through one target, in both directions, and compares."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

from ..model.edition import Edition
from ..model.golden_frames import (
    Exchange,
    GoldenFrame,
    GoldenFrames,
    RefusedFrame,
    RefusedValues,
    Sourced,
)
from ..model.message import Message
from ..model.refusal import Refusal
from ..model.types import Assignment, Type
from ..semantics.decoder import Decoder, Rejection, value_of
from ..semantics.frame import can_frame, code_of, has_usual_code
from .adapter import Adapter, CanFrame, Cannot, Decoded, ExactValue, Refused, assignment

DOUBLE_IS_EXACT = 1 << 50
"""Below this, raw -> value -> raw survives the two roundings of a double. Above, values are only decoded."""


class Failure(NamedTuple):
    """What a target does wrong with an entry of the golden frames; None for all of them."""

    target: str
    kind: str
    entry: Sourced | None
    wrong: str

    def __str__(self) -> str:
        return f"{self.target} {self.kind}: {_named(self.entry)}: {self.wrong}"


@dataclass
class Report:
    """What a replay came to: cases by kind, exceptions by name, and what went wrong.

    `asked` is the number of entries of which the target is asked anything, `failed` of those with a failure.
    """

    target: str
    edition: str
    passed: Counter[str] = field(default_factory=Counter)
    exceptions: Counter[str] = field(default_factory=Counter)
    failures: list[Failure] = field(default_factory=list)
    asked: int = 0
    failed: int = 0


class Runner:
    """One edition and one target."""

    def __init__(
        self, edition: Edition, frames: GoldenFrames, adapter: Adapter, *, stop_at_first: bool = False
    ) -> None:
        self._decoder = Decoder(edition)
        self._frames = frames
        self._adapter = adapter
        self._stop_at_first = stop_at_first
        self.report = Report(adapter.name, f"{edition.family} {edition.name}")

    def run(self) -> Report:
        """Replays everything; with `stop_at_first`, up to the first failure."""
        asked, failed = set(), set()
        for kind, case, entry in self._cases():
            try:
                wrong = case()
            except Cannot as exception:
                assert exception.name in self._adapter.cannot, f"{exception.name} is not a listed exception"
                self.report.exceptions[exception.name] += 1
                continue
            except Exception as error:  # of generated code
                wrong = f"raises {type(error).__name__}: {error}"
            asked.add(id(entry))
            if wrong:
                failed.add(id(entry))
                self.report.failures.append(Failure(self._adapter.name, kind, entry, wrong))
                if self._stop_at_first:
                    break
            else:
                self.report.passed[kind] += 1
        self.report.asked, self.report.failed = len(asked), len(failed)
        return self.report

    def _cases(self) -> Iterator[tuple[str, Callable[[], str], Sourced]]:
        """Every case: its kind, what says what is wrong with it, and the entry it comes from."""
        for frame in self._frames.frames:
            yield "decode", partial(self._decode, frame), frame
            yield "decode alone", partial(self._decode_alone, frame), frame
            if not frame.decode_only:
                yield "encode raw", partial(self._encode_raw, frame), frame
                if self._has_all_values(frame) and _beyond_double(frame):
                    self.report.exceptions["beyond_double"] += 1
                elif self._has_all_values(frame):
                    yield "encode values", partial(self._encode_values, frame), frame
        for refused in self._frames.refused:
            if isinstance(refused, RefusedFrame):
                yield "refuse", partial(self._refused_frame, refused), refused
            else:
                yield "refuse", partial(self._refused_values, refused), refused
        for exchange in self._frames.exchanges:
            yield "answer", partial(self._exchange, exchange), exchange

    def _decode(self, frame: GoldenFrame) -> str:
        """As the message that it is expected to be."""
        answer = self._adapter.decode(frame.direction, can_frame(frame), frame.parameters, frame.command)
        return self._compare(frame, answer, self._adapter.message_of(frame.direction, frame.command))

    def _decode_alone(self, frame: GoldenFrame) -> str:
        """By itself it means the same, though a reply may be the message of another command that has its code."""
        answer = self._adapter.decode(frame.direction, can_frame(frame), frame.parameters, None)
        wanted = self._decoder.identify(frame.direction, can_frame(frame), assignment(frame.parameters))
        if isinstance(wanted, Rejection):
            return f"no message of the spec: {wanted.text}"
        return self._compare(frame, answer, wanted.message)

    def _compare(self, frame: GoldenFrame, answer: Decoded | Refused, message: Message) -> str:
        if not isinstance(answer, Decoded):
            return _shown(answer)
        if self._adapter.message_of(frame.direction, answer.command) is not message:
            return f"decoded as {answer.command}, not as {message.name}"
        in_data = message.node_in_data
        if self._adapter.reports_code and answer.code != code_of(message, can_frame(frame)):
            return f"code {answer.code}, not {code_of(message, can_frame(frame))}"
        node = frame.node if in_data is None else frame.raw[in_data.name]
        if answer.node != node:
            return f"node {answer.node}, not {node}"
        if dict(answer.raw) != dict(frame.raw):
            return f"raw {_shown(answer.raw)}, not {_shown(frame.raw)}"
        types = {field.name: field.type for field in message.layout.fields}
        for name, wanted in frame.values.items():
            got = answer.values.get(name)
            raw = frame.raw[name]
            one_ulp = 2.0**-52 if isinstance(raw, int) and abs(raw) > 1 << 53 else 0.0
            wanted = as_number(types[name], wanted, raw, assignment(frame.parameters))
            if not self._same(wanted, got, max(one_ulp, self._adapter.tolerance)):
                return f"{name} is {_shown(got)}, not {_shown(wanted)}"
        return ""

    def _same(self, wanted: ExactValue, got: object, tolerance: float) -> bool:
        """Equal, or as near as a double of a raw integer that no double holds can be."""
        if isinstance(wanted, list):
            if not isinstance(got, list) or len(got) != len(wanted):
                return False
            return all(self._same(w, g, tolerance) for w, g in zip(wanted, got, strict=True))
        if isinstance(wanted, str):
            return got is None if wanted == "none" else got == wanted
        if not isinstance(got, (int, float)):
            return False
        return abs(got - float(wanted)) <= tolerance * abs(float(wanted))

    def _has_all_values(self, frame: GoldenFrame) -> bool:
        return set(frame.values) == set(frame.raw) and "none" not in frame.values.values()

    def _encode_raw(self, frame: GoldenFrame) -> str:
        return self._encoded(
            frame,
            self._adapter.encode_raw(
                frame.direction, frame.command, frame.node, frame.raw, frame.parameters, self._code(frame)
            ),
        )

    def _encode_values(self, frame: GoldenFrame) -> str:
        return self._encoded(
            frame,
            self._adapter.encode_values(
                frame.direction, frame.command, frame.node, frame.values, frame.parameters, self._code(frame)
            ),
        )

    def _code(self, frame: GoldenFrame) -> int | None:
        """The code to encode; None where it need not be given."""
        message = self._adapter.message_of(frame.direction, frame.command)
        return None if has_usual_code(message, can_frame(frame)) else code_of(message, can_frame(frame))

    def _encoded(self, frame: GoldenFrame, answer: CanFrame | Refused) -> str:
        wanted = can_frame(frame)
        return "" if answer == wanted else f"{_shown(answer)}, not {_shown(wanted)}"

    def _refused_frame(self, entry: RefusedFrame) -> str:
        answer = self._adapter.decode(entry.decode, can_frame(entry), entry.parameters, None)
        return (
            ""
            if isinstance(answer, Refused) and answer.says is entry.says
            else f"{_shown(answer)}, not {entry.says.value}"
        )

    def _refused_values(self, entry: RefusedValues) -> str:
        if entry.values:
            answer = self._adapter.encode_values(
                entry.encode, entry.command, entry.node, entry.values, entry.parameters
            )
        else:
            answer = self._adapter.encode_raw(entry.encode, entry.command, entry.node, entry.raw, entry.parameters)
        if not isinstance(answer, Refused) or answer.says is not entry.says:
            return f"{_shown(answer)}, not {entry.says.value}"
        if entry.field_name is not None and answer.field != entry.field_name:
            return f"names {answer.field}, not {entry.field_name}"
        return ""

    def _exchange(self, entry: Exchange) -> str:
        answer = self._adapter.answers(can_frame(entry.request), can_frame(entry.reply), entry.parameters)
        says = answer.says if answer else None
        return "" if says is entry.says else f"{_reason(says)}, not {_reason(entry.says)}"


REASONS = {"beyond_double": "no double represents the value exactly, so it is only decoded"}
"""What no target can express."""


def as_number(type_: Type, wanted: ExactValue, raw: int | list[int], known: Assignment) -> Any:
    """What a frame with a raw integer is decoded as, if it is written as the name of a number: the number."""
    if isinstance(wanted, list) and isinstance(raw, list):
        return [as_number(type_, *each, known) for each in zip(wanted, raw, strict=True)]
    if isinstance(raw, int) and wanted in [member.name for member in type_.names]:
        return value_of(type_, raw, known)
    return wanted


def _beyond_double(frame: GoldenFrame) -> bool:
    """Whether a double cannot tell the value of some field from that of the next raw integer."""
    raws = [r for raw in frame.raw.values() for r in (raw if isinstance(raw, list) else [raw])]
    return any(abs(raw) >= DOUBLE_IS_EXACT for raw in raws)


def _named(entry: Sourced | None) -> str:
    if isinstance(entry, GoldenFrame):
        given = f" {_shown(entry.parameters)}" if entry.parameters else ""
        return f"{entry.direction.value} {entry.command} {_shown(can_frame(entry))}{given}"
    if isinstance(entry, RefusedFrame):
        return f"{entry.decode.value} {_shown(can_frame(entry))}"
    if isinstance(entry, RefusedValues):
        shown = _shown(entry.values or entry.raw)
        return f"{entry.encode.value} {entry.command} node {entry.node} {shown} {_shown(entry.parameters)}"
    if isinstance(entry, Exchange):
        return f"{entry.request.data.hex(' ')} then {entry.reply.data.hex(' ')}"
    return "all entries"


def _reason(says: Refusal | None) -> str:
    return says.value if says else "accepted as the reply"


def _shown(value: object) -> str:
    if isinstance(value, Refused):
        return f"rejected with {value.says.value}" + (f", field {value.field}" if value.field else "")
    if isinstance(value, Decoded):
        return f"decoded as {value.command}: {_shown(value.raw)}"
    if isinstance(value, CanFrame):
        flags = " extended" * value.extended + " remote" * value.remote
        return f"0x{value.id:X}{flags} {value.data.hex(' ').upper()}".strip()
    if isinstance(value, Fraction):
        return str(float(value))
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{k}: {_shown(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_shown, value)) + "]"
    return str(value)
