"""The DBC files, read by cantools in its strict mode as a test engineer would load them.

All bits, scales, limits, codes and ids are the file's. The spec is asked for names, and for what it says that no DBC
can: such a case is a named exception.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from ..model.layout import Space
from ..model.message import Direction, Message
from ..model.refusal import Refusal
from ..model.types import NO_PARAMETERS
from ..semantics.configured import configured
from ..semantics.decoder import Decoder, Identified
from ..semantics.dispatch import dispatch_plan
from ..semantics.frame import has_id, is_message, wrong_constants
from ..semantics.plan import message_plan
from ..targets.base import EditionInput
from ..targets.dbc.files import files
from ..targets.dbc.frames import frames, obstacle
from ..targets.dbc.limits import LIMITS
from ..targets.dbc.printer import printed
from ..targets.dbc.view import File, agree
from ..targets.options import NO_OPTIONS
from .adapter import (
    Adapter,
    CanFrame,
    Cannot,
    Decoded,
    ExactValue,
    Parameters,
    Raw,
    Refused,
    assignment,
    means_another,
)
from .dbc_file import DbcFile

Result = TypeVar("Result", Decoded, CanFrame)


class DbcAdapter(Adapter):
    name = "dbc"
    tolerance = 1e-12
    """A DBC has one factor, a double: raw * 0.01 and raw / 100 differ in the last digit."""
    cannot: ClassVar[Mapping[str, str]] = {
        "joined": "signals are the bytes of a text and the digits of a number; a program joins them",
        "exchanges": "a DBC does not know which reply belongs to which request, nor that a reply echoes it",
        "shared_code": "a code that two commands reply with is read as the reply of the command that has the code",
        "other_value": "the files of a parameter value leave out the commands that it lacks",
        "unknown_range": "a file is for one value of a parameter, so it has a range that is not checked without the parameter",
        "unnamed": "minimum and maximum leave out no single values, so an encoder takes those without a name",
        "reply_limits": "in a reply file minimum and maximum are all that the bits hold",
        "codes_in_id": "a DBC has ids, and does not know which part of them is a code",
        "reserved_in_id": "a DBC has ids as they are sent, and does not know that a part of them is ignored",
        "not_finite": "a float signal takes NaN and infinity, and a reader may change the bits of NaN",
        "rounding": "a reader works in doubles, rounds ties its own way, and compares with limits before it rounds",
        "no_value_ranges": "a DBC names both ends of a long range of raw integers without a value, not those between",
        "several_runs": "each run of bits of a field is a signal: they have no names, and programs divide the value",
        "no_value_numbers": "an encoder takes the number of a raw integer that has a name, also beyond the limits",
        "left_out": "an id that carries a field, a remote frame, and fixed bytes above fields have no form in a DBC",
        "other_code": "a reader takes a frame for the message whose code the multiplexor contains",
        "selectors_apart": "nested multiplexors break readers; selectors that stand apart cannot be read as one",
        "lengths": "all messages of one id have one length",
        **LIMITS,
    }

    def __init__(self, specification: EditionInput) -> None:
        super().__init__(specification.edition)
        self._decoder = Decoder(specification.edition)
        self._made: dict[tuple[tuple[str, str | Fraction], ...], Sequence[File]] = {}
        self._loaded: dict[str, DbcFile] = {}
        self._left_out = {m.name for m in self.edition.all_messages() if obstacle(m)}
        for direction in Direction:
            for frame in frames(self.edition, direction, {}):
                self._left_out |= set(frame.hidden)
        self._routes = {direction: dispatch_plan(self.edition, direction).routes for direction in Direction}
        self._whole = [p.name for p in self.edition.parameters if p.whole]
        self._by_ids: dict[tuple[object, ...], DbcAdapter] = {}
        self._deciding = {name for m in self.edition.all_messages() for f in m.layout.fields for name in f.type.numbers}

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> DbcAdapter:
        """Needs no files: cantools loads texts."""
        return cls(specification)

    def _with_ids(self, parameters: Parameters) -> DbcAdapter:
        """The adapter of the files that are generated for the parameters in ids and constants."""
        known = configured(self.edition, assignment(parameters))
        if known is self.edition or not self._whole:
            return self
        key = tuple(map(parameters.get, self._whole))
        if key not in self._by_ids:
            self._by_ids[key] = DbcAdapter(EditionInput(known, None))
            self._by_ids[key]._whole = []
        return self._by_ids[key]

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        kind = (frame.extended, frame.remote)
        ours = self._with_ids(parameters)
        if any(m.parameters and (m.id.extended, m.remote) == kind for m in ours.edition.messages(direction)):
            raise Cannot("left_out" if any(m.id.parameter for m in ours.edition.messages(direction)) else "constants")
        return ours._decode(direction, frame, parameters, expected)

    def _decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        """Decodes a frame whose id and constants contain no unknown parameter."""
        known = [m for m in self.edition.messages(direction) if has_id(m, frame)]
        if any(obstacle(m) or is_message(m, frame) for m in known if m.name in self._left_out):
            raise Cannot("left_out")
        if not known and self._has_rule(direction, frame):
            raise Cannot("codes_in_id")
        for message in known:
            _refuse_bits_of_id(message, frame)
        if frame.remote:
            return Refused(Refusal.UNKNOWN_ID)
        read = self._read(direction, frame, parameters)
        result = _agreed(_agreed_values(read))
        if isinstance(result, Decoded) and Refused(Refusal.UNKNOWN_CODE) in read:
            decides = self.message_of(direction, result.command).layout.parameter
            if decides is not None and decides not in parameters:
                raise Cannot("other_value")
        unknown = result == Refused(Refusal.UNKNOWN_CODE)
        if unknown and any(isinstance(answer, Decoded) for answer in self._read(direction, frame, {})):
            raise Cannot("other_value")
        if isinstance(result, Decoded):
            fields = self.message_of(direction, result.command).layout.fields
            # A raw integer of 0 has the same value in every file.
            unscaled = {f.name for f in fields if f.type.linear.parameter not in (None, *parameters)}
            values = {n: _names_of(v) if n in unscaled else v for n, v in result.values.items()}
            result = replace(result, values=values)
        if expected is not None and isinstance(result, Decoded):
            message, wanted = (self.message_of(direction, command) for command in (result.command, expected))
            alone = self._decoder.identify(direction, frame)
            if message is not wanted and isinstance(alone, Identified) and alone.message is message:
                raise Cannot("shared_code")
        return result

    def _has_rule(self, direction: Direction, frame: CanFrame) -> bool:
        """Whether an id is one of an address, but for the code in it."""
        alike = (e for e in self._routes[direction] if (e.rule.extended, e.remote) == (frame.extended, frame.remote))
        return any(entry.mask and entry.contains(frame.id) for entry in alike)

    def encode_raw(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        raw: Mapping[str, Raw],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        return self._encode(direction, command, node, raw, parameters, code, scaled=False)

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        return self._encode(direction, command, node, values, parameters, code, scaled=True)

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        raise Cannot("exchanges")

    def _files(self, direction: Direction, parameters: Parameters) -> Iterator[Sequence[DbcFile]]:
        """The files that a node with these parameters may need, for each value of those that are not given.

        Each time these are the files of tables, then the plain one.
        """
        given = {p: value for p in self.edition.parameters if (value := assignment(parameters).get(p.name)) is not None}
        fixed = {
            p.name: given[p]
            for p in given
            if p.is_numeric and not p.whole and (p.is_choice or p.name in self._deciding)
        }
        variant = tuple(fixed.items())
        if variant not in self._made:
            self._made[variant] = files(self.edition, fixed, NO_OPTIONS)
        made = [file for file in self._made[variant] if direction in file.directions]
        choices = {p.name: value for p, value in given.items() if p.is_choice}
        for plain in (file for file in made if not file.table and agree(file.assignment, choices)):
            tables = (file for file in made if file.table and agree(file.assignment, plain.assignment))
            yield [self._file(file) for file in (*tables, plain)]

    def _file(self, file: File) -> DbcFile:
        if file.name not in self._loaded:
            self._loaded[file.name] = DbcFile(self.edition, printed(file), bool(file.table))
        return self._loaded[file.name]

    def _read(self, direction: Direction, frame: CanFrame, parameters: Parameters) -> list[Decoded | Refused]:
        """What the files say, for each combination of parameters that are not given."""
        read = [_read(loaded, direction, frame) for loaded in self._files(direction, parameters)]
        return read or [Refused(Refusal.UNKNOWN_ID)]

    def _encode(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        given: Mapping[str, Raw] | Mapping[str, ExactValue],
        parameters: Parameters,
        code: int | None,
        scaled: bool,
    ) -> CanFrame | Refused:
        if self._with_ids(parameters) is not self:
            return self._with_ids(parameters)._encode(direction, command, node, given, parameters, code, scaled)
        message = self.message_of(direction, command)
        if message.name in self._left_out or message.parameters:
            raise Cannot("left_out")
        written = [
            _first(file.write(message, node, given, parameters, code, scaled) for file in loaded)
            for loaded in self._files(direction, parameters)
        ]
        if all(result is None for result in written):
            raise Cannot("selectors_apart" if len(message.keys) > 1 else "other_value")
        for answer in written:
            if isinstance(answer, Refused) and answer.says is Refusal.OUT_OF_RANGE:
                refused = (f for f in message.layout.fields if f.name == answer.field)
                if any(f.type.raw_range.parameter not in (None, *parameters) for f in refused):
                    raise Cannot("unknown_range")
        result = _agreed([result for result in written if result is not None])
        if result == Refused(Refusal.MISSING_PARAMETER):
            undecided = (
                f.name for f in message.layout.fields if f.name in given and set(f.type.parameters) - set(parameters)
            )
            return Refused(Refusal.MISSING_PARAMETER, next(undecided, None))
        if means_another(message, result):
            raise Cannot("confusion")
        return result


def _refuse_bits_of_id(message: Message, frame: CanFrame) -> None:
    """Raises Cannot for an id whose constants or reserved bits are not those that are sent."""
    if wrong_constants([f for f in message.layout.fields if f.space is Space.ID and not f.is_given], frame):
        raise Cannot("constants")
    reserved = message_plan(message).reserved_in_id
    if frame.id & reserved.mask != reserved.value:
        raise Cannot("reserved_in_id")


def _names_of(value: Any) -> Any:
    """The names of a value for no value, and None for all numbers."""
    if isinstance(value, list):
        return [_names_of(element) for element in value]
    return value if isinstance(value, str) else None


def _read(files: Sequence[DbcFile], direction: Direction, frame: CanFrame) -> Decoded | Refused:
    """What the first of the files that knows the frame says; the last one is the plain one."""
    *joined, plain = files
    for file in joined:
        result = file.read(direction, frame)
        if isinstance(result, Decoded):
            return result
    try:
        return plain.read(direction, frame)
    except Cannot as exception:
        if exception.name == "selectors_apart" and joined:
            return Refused(Refusal.UNKNOWN_CODE)
        raise


def _first(results: Iterable[CanFrame | Refused | None]) -> CanFrame | Refused | None:
    """The first result of a file that has the node and the command; None when no file has the command."""
    lacks = False
    for result in results:
        if result is not None and result != Refused(Refusal.UNKNOWN_NODE):
            return result
        lacks = lacks or result is None
    return None if lacks else Refused(Refusal.UNKNOWN_NODE)


def _agreed(results: Sequence[Result | Refused]) -> Result | Refused:
    """What all files say; what they differ in depends on the parameter that was not given."""
    known = [r for r in results if r != Refused(Refusal.UNKNOWN_CODE)] or list(results)
    agreed = all(result == known[0] for result in known)
    return known[0] if agreed else Refused(Refusal.MISSING_PARAMETER)


def _agreed_values(results: Sequence[Decoded | Refused]) -> Sequence[Decoded | Refused]:
    """The results without the values that the files differ in."""
    read = [result for result in results if isinstance(result, Decoded)]
    differing = {n for r in read for n, v in r.values.items() if any(o.values.get(n, v) != v for o in read)}
    return [
        replace(r, values={n: None if n in differing else v for n, v in r.values.items()})
        if isinstance(r, Decoded)
        else r
        for r in results
    ]
