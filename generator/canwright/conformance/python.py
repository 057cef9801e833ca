"""The generated Python package, driven through its public API."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from enum import IntEnum, IntFlag
from fractions import Fraction
from functools import reduce
from operator import or_
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

from ..model.edition import Edition
from ..model.joined import JoinedText
from ..model.layout import Field
from ..model.message import Direction
from ..model.refusal import Refusal
from ..model.types import NO_PARAMETERS
from ..semantics.decoder import Decoder, Rejection
from ..semantics.plan import message_plan
from ..targets.base import EditionInput
from ..targets.python.target import PythonTarget
from ..targets.python.text import attribute, class_name
from . import modules
from .adapter import (
    Adapter,
    CanFrame,
    Cannot,
    Decoded,
    ExactValue,
    Parameters,
    Raw,
    Refused,
    Value,
    assignment,
    write_files,
)


def load(folder: Path, edition: Edition) -> ModuleType:
    """The module of an edition, freshly imported."""
    return modules.load(folder, f"{edition.family}.{edition.identifier}")[0]


class PythonAdapter(Adapter):
    """Answers through `decode_request`, `decode_reply`, `decode_answer`, `unpack`, constructors and `encode`."""

    name = "python"
    reports_code = True
    cannot: ClassVar[Mapping[str, str]] = {
        "expected": "a frame that is no answer is decoded by itself; no function expects one class and checks for it",
        "not_asked": "the reply of a node that a request to several nodes does not ask is no answer",
    }

    def __init__(self, edition: Edition, module: ModuleType, nodes: ModuleType | None = None) -> None:
        """`nodes` has the class that checks whether a node has the command of a request; without it, nothing does."""
        super().__init__(edition)
        self._module = module
        self._nodes = nodes
        self._decoder = Decoder(edition)
        messages = edition.all_messages()
        self._names = {attribute(f.name): f.name for m in messages for f in m.layout.fields}
        self._fields = {(class_name(m.name), f.name): f for m in messages for f in m.layout.fields}

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> PythonAdapter:
        """Imports the generated package under a name of its own."""
        folder = write_files(PythonTarget().generate([specification], {}), workdir)
        edition = specification.edition
        module, nodes = modules.load(folder, f"{edition.family}.{edition.identifier}", f"{edition.family}.nodes")
        return cls(edition, module, nodes)

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        try:
            message = self._decoded(direction, frame, parameters, expected)
        except ValueError as error:
            return self._refused(error)
        again = message.unpack(node_in_id(message), message.can_id, message.encode_unchecked(), message.parameters)
        if again != message or (message.can_id ^ frame.id) & ~self._reserved(message, direction):
            raise AssertionError(f"{message} does not go back to id 0x{frame.id:X}")
        raw = {self._names[n]: list(v) if isinstance(v, tuple) else int(v) for n, v in message.raw().items()}
        code = message.frame_code if message.CODES else None
        return Decoded(message.COMMAND, message.node, raw, dict(self._values(message)), code)

    def _decoded(self, direction: Direction, frame: CanFrame, given: Parameters, expected: str | None) -> Any:
        """The message of a frame: of any class, of the class that answers a request, or of the class of a request."""
        known = self.parameters(given)
        module, flags = self._module, {"extended": frame.extended, "remote": frame.remote}
        has_request = expected is not None and self.edition.command(expected).request is not None
        is_answer = has_request and direction is Direction.REPLY
        if expected is not None and not is_answer and self._identified(direction, frame, given) != expected:
            raise Cannot("expected")
        if not has_request:
            decode = module.decode_request if direction is Direction.REQUEST else module.decode_reply
            return decode(frame.id, frame.data, known, **flags)
        request = getattr(module, class_name(f"{expected}_request"))
        if is_answer:
            try:
                return module.decode_answer(request, frame.id, frame.data, known, **flags)
            except ValueError as error:
                asks_several = expected is not None and self.edition.command(expected).from_each
                if asks_several and getattr(error, "refusal", "") == Refusal.NOT_ANSWER.value:
                    raise Cannot("not_asked") from None
                raise
        node = module.node_of(direction.value, frame.id, None, known, **flags)
        return request.unpack(node, frame.id, frame.data, known)

    def _identified(self, direction: Direction, frame: CanFrame, parameters: Parameters) -> str | None:
        """The command of a frame by itself; None for a frame that has none."""
        identified = self._decoder.identify(direction, frame, assignment(parameters))
        return None if isinstance(identified, Rejection) else identified.message.command

    def _reserved(self, message: Any, direction: Direction) -> int:
        """The bits of the id that a reader ignores."""
        ours = [m for m in self.edition.messages(direction) if m.command == message.COMMAND]
        return reduce(or_, (message_plan(m).reserved_in_id.mask for m in ours), 0)

    def _check_names(self, message: Any) -> None:
        """The names beside values are those of the spec."""
        named: dict[str, Any] = {}
        for name, raw in message.raw().items():
            type_ = self._field(type(message), self._names[name]).type
            names = tuple(type_.name_of(each) or None for each in (raw if isinstance(raw, tuple) else [raw]))
            if any(names):
                named[name] = names if isinstance(raw, tuple) else names[0]
        assert message.names() == named

    def _values(self, message: Any) -> list[tuple[str, Value]]:
        values: list[tuple[str, Value]] = []
        no_values = message.no_values()
        self._check_names(message)
        for name in message.fields():
            try:
                value = getattr(message, name)
                if name in no_values:
                    values.append((self._names[name], _with_names(value, no_values[name])))
                    continue
                unnamed = not isinstance(value, IntEnum) and self._names[name] in self._enums(message)
                values.append((self._names[name], None if unnamed else _value(value)))
            except ValueError as error:
                if self._refused(error).says is not Refusal.MISSING_PARAMETER:
                    values.append((self._names[name], None))
        return values

    def _enums(self, message: Any) -> set[str]:
        """The fields whose values have names."""
        same = (m for m in self.edition.all_messages() if class_name(m.name) == type(message).__name__)
        return {f.name for m in same for f in m.layout.fields if f.type.enum}

    def encode_raw(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        raw: Mapping[str, Raw],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        try:
            return _encoded(self.message(direction, command, node, raw, parameters, code))
        except ValueError as error:
            return self._refused(error)

    def message(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        raw: Mapping[str, Raw],
        parameters: Parameters,
        code: int | None = None,
    ) -> Any:
        """A message of the package from its raw integers."""
        cls = self._class(direction, command)
        given = {attribute(n): v for n, v in raw.items()}
        known = self.parameters(parameters)
        return cls.from_raw(**self._node(cls, node), parameters=known, frame_code=code, **given)

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        try:
            cls = self._class(direction, command)
            given = {attribute(n): self._given(cls, n, v) for n, v in values.items()}
            extra = {"parameters": self.parameters(parameters)} if self._takes_parameters(cls) else {}
            extra |= {} if code is None else {"frame_code": code}
            return _encoded(cls(**self._node(cls, node), **given, **extra))
        except ValueError as error:
            return self._refused(error)

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        try:
            self._module.check_reply(
                *(request.id, request.data, reply.id, reply.data, self.parameters(parameters)),
                extended=request.extended,
                remote=request.remote,
                reply_extended=reply.extended,
                reply_remote=reply.remote,
            )
        except ValueError as error:
            return self._refused(error)
        return None

    def _refused(self, error: ValueError) -> Refused:
        """A refusal of the package; any other ValueError is a failure of the package and goes on up."""
        refusal = getattr(error, "refusal", None)
        if refusal is None:
            raise error
        field: str | None = getattr(error, "field", None)
        return Refused(Refusal(refusal.value), self._names.get(field, field) if field else None)

    def _class(self, direction: Direction, command: str) -> Any:
        return getattr(self._module, class_name(self.message_of(direction, command).name))

    @staticmethod
    def _takes_parameters(cls: Any) -> bool:
        return "parameters" in cls.__init__.__code__.co_varnames[: cls.__init__.__code__.co_kwonlyargcount + 1]

    @staticmethod
    def _node(cls: Any, node: int | None) -> dict[str, int | None]:
        return {"node": node} if hasattr(cls, "NODES") else {}

    def parameters(self, parameters: Parameters) -> Any:
        """The package's own `Parameters`."""
        given: dict[str, Any] = {}
        for name, value in parameters.items():
            parameter = self.edition.parameter(name)
            if parameter.is_choice and not parameter.is_numeric:
                given[attribute(name)] = getattr(self._module, class_name(name))(value)
            else:
                given[attribute(name)] = int(value) if parameter.is_choice else float(value)
        return self._module.Parameters(**given)

    def _field(self, cls: Any, name: str) -> Field:
        return self._fields[cls.__name__, name]

    def _given(self, cls: Any, name: str, value: ExactValue) -> Any:
        field = self._field(cls, name)
        if isinstance(field.type.joined, JoinedText):
            return value
        if isinstance(value, list):
            if field.type.flags:
                return self._flags(field.type.name, [str(v) for v in value])
            return [self._element(field, v) for v in value]
        return self._element(field, value)

    def _element(self, field: Field, value: ExactValue) -> Any:
        if field.type.is_number and value in [member.name for member in field.type.members]:
            return None if field.type.no_values and value == field.type.no_values[0].name else value
        if isinstance(value, str) and field.type.enum:
            return getattr(self._module, class_name(field.type.name))[value.upper()]
        return _number(value)

    def _flags(self, type_name: str, names: Sequence[str]) -> int:
        enum = getattr(self._module, class_name(type_name))
        return sum(int(enum[name.upper()]) for name in names)


def _encoded(message: Any) -> CanFrame:
    """The frame of a message; the message that is decoded from it must pass the checks of `encode` too."""
    decoded = message.unpack(node_in_id(message), message.can_id, message.encode(), message.parameters)
    return CanFrame(message.can_id, decoded.encode(), message.EXTENDED, message.REMOTE)


def node_in_id(message: Any) -> int | None:
    """The node in the id of a message, which `unpack` takes."""
    return message.node if hasattr(message, "NODES") else None


def _value(value: Any) -> Value:
    if isinstance(value, str):
        return value
    if isinstance(value, tuple):
        return [float(v) for v in value]
    if isinstance(value, IntFlag):
        return [m.name.lower() for m in type(value) if m.name and m in value]
    if isinstance(value, IntEnum):
        return value.name.lower()
    return float(value)


def _with_names(value: Any, names: Any) -> Value:
    """The name of a field without a value; of an array, values and names. What has a name must not have a value."""
    if isinstance(names, tuple):
        assert len(value) == len(names)
        return [_with_names(element, name) for element, name in zip(value, names, strict=True)]  # type: ignore[return-value]
    assert names is None or value is None
    return float(value) if names is None else str(names)


def _number(value: ExactValue | Fraction | str) -> float | Fraction:
    """A number as a float where that is exact, and as a fraction otherwise."""
    number = float(str(value)) if isinstance(value, str) else float(value)  # type: ignore[arg-type]
    return value if isinstance(value, Fraction) and math.isfinite(number) and number != value else number
