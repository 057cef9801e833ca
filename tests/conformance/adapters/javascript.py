"""The generated JavaScript module of an edition, in a process of Node."""

from __future__ import annotations

import json
import subprocess
import weakref
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from canwright.conformance.adapter import (
    Adapter,
    CanFrame,
    Decoded,
    ExactValue,
    Parameters,
    Raw,
    Refused,
    Value,
    write_files,
)
from canwright.model import formatting
from canwright.model.edition import Edition
from canwright.model.joined import JoinedText
from canwright.model.layout import Field
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.model.types import NO_PARAMETERS
from canwright.targets.base import EditionInput
from canwright.targets.javascript.package import module_path
from canwright.targets.javascript.target import JavaScriptTarget

from ...node import NODE

HARNESS = Path(__file__).parent / "javascript_harness.mjs"


class JavaScriptAdapter(Adapter):
    """Answers through the exported functions: every kind of question."""

    name = "javascript"
    reports_code = True

    def __init__(self, edition: Edition, module: Path) -> None:
        super().__init__(edition)
        self._fields = {
            (message.direction, message.command, field.name): field
            for message in edition.all_messages()
            for field in message.layout.fields
        }
        pipe = subprocess.PIPE
        self._node = subprocess.Popen([NODE, HARNESS, module], stdin=pipe, stdout=pipe, text=True, encoding="utf-8")
        weakref.finalize(self, _end, self._node)

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> JavaScriptAdapter:
        folder = write_files(JavaScriptTarget().generate([specification], {}), workdir)
        return cls(specification.edition, folder / f"{module_path(specification.edition)}.js")

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        question = {"direction": direction.value, "frame": _frame(frame), "parameters": _plain(parameters)}
        task = "decode" if expected is None else "decodeAs"
        answer = self.ask(task, command=expected, **question)
        if isinstance(answer, Refused):
            return answer
        values: dict[str, Value] = {}
        for entry in answer["fields"]:
            field = self._field(direction, answer["command"], entry["name"])
            assert entry["unit"] == (field.type.unit.symbol if field.type.unit else None)
            if entry["reason"] != Refusal.MISSING_PARAMETER.value:
                value = _names(field, entry["raw"], entry["value"]) if field.type.flags else entry["value"]
                values[entry["name"]] = _or_names(_value(value), entry["noValue"])
            named = [field.type.name_of(raw) or None for raw in (entry["raw"] if field.is_array else [entry["raw"]])]
            assert entry["valueName"] == (named[0] if not field.is_array else named if any(named) else None)
        return Decoded(answer["command"], answer["node"], answer["raw"], values, answer.get("code"))

    def encode_raw(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        raw: Mapping[str, Raw],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        return self._encode(
            direction, command, node, parameters, code, raw={name: _given(value) for name, value in raw.items()}
        )

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        message = self.message_of(direction, command)
        fields = {field.name: field for field in message.layout.fields}
        given = {name: _content(fields[name], value) for name, value in values.items()}
        return self._encode(direction, command, node, parameters, code, values=given)

    def _encode(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        parameters: Parameters,
        code: int | None,
        **content: Any,
    ) -> CanFrame | Refused:
        content |= {"node": node, "parameters": _plain(parameters), **({} if code is None else {"code": code})}
        answer = self.ask("encode", direction=direction.value, command=command, content=content)
        if isinstance(answer, Refused):
            return answer
        return CanFrame(answer["id"], bytes(answer["data"]), answer["extended"], answer["remote"])

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        answer = self.ask("answers", request=_frame(request), reply=_frame(reply), parameters=_plain(parameters))
        return answer if isinstance(answer, Refused) else None

    def refusal(self, task: str, **question: Any) -> str:
        """The name of the refusal; empty for an answer, or for a wrong argument."""
        return str(self._answer(task, question).get("refusal", ""))

    def _answer(self, task: str, question: Mapping[str, Any]) -> dict[str, Any]:
        assert self._node.stdin is not None and self._node.stdout is not None
        self._node.stdin.write(json.dumps({"task": task, **question}) + "\n")
        self._node.stdin.flush()
        answer: dict[str, Any] = json.loads(self._node.stdout.readline(), object_hook=_bigint)
        return answer

    def ask(self, task: str, **question: Any) -> Any:
        """The answer of the process, or the refusal."""
        answer = self._answer(task, question)
        if "refusal" in answer:
            return Refused(Refusal(answer["refusal"]), answer.get("field"))
        if "error" in answer:
            raise AssertionError(answer["error"])
        return answer["answer"]

    def _field(self, direction: Direction, command: str, name: str) -> Field:
        return self._fields[direction, command, name]


def _end(process: subprocess.Popen[str]) -> None:
    process.communicate()


def _bigint(table: dict[str, Any]) -> Any:
    return int(table["bigint"]) if "bigint" in table else table


def _frame(frame: CanFrame) -> dict[str, Any]:
    return {"id": frame.id, "data": list(frame.data), "extended": frame.extended, "remote": frame.remote}


def _given(given: Any) -> Any:
    """A raw integer, a name, or several of them; integers that are no exact double as BigInt."""
    if isinstance(given, list):
        return [_given(element) for element in given]
    if isinstance(given, Fraction):
        return _number(given)
    return {"bigint": str(given)} if isinstance(given, int) and abs(given) >= 1 << 53 else given


def _number(value: Any) -> Any:
    """A number as the nearest double; an integer that is none as BigInt."""
    if isinstance(value, list):
        return [_number(element) for element in value]
    if not isinstance(value, (Fraction, int)):
        return {"special": value}
    if value.denominator == 1 and float(value) != value:
        return {"bigint": str(value)}
    return float(value)


def _content(field: Field, value: ExactValue) -> Any:
    """A value as a program gives it: null for the first name without a value."""
    if isinstance(value, list) and field.is_array:
        return [_content(field, element) for element in value]
    if isinstance(field.type.joined, JoinedText):
        return _given(value)
    if field.type.no_values and value == field.type.no_values[0].name:
        return None
    if field.type.is_number and value in [member.name for member in field.type.members]:
        return value
    return _number(value) if field.type.is_number else _given(value)


def _names(field: Field, raw: Any, flags: Any) -> Any:
    """The names of flags; what follows are all other bits, so that nothing is lost."""
    if field.is_array:
        return [_names(field, number, each) for number, each in zip(raw, flags, strict=True)]
    names = [name for name in flags if isinstance(name, str)]
    rest = raw & ~sum(1 << flag.value for flag in field.type.flags)
    assert flags == [*names, *([rest] if rest else [])]
    return names


def _value(value: Any) -> Value:
    """A value with its numbers as floats."""
    if isinstance(value, list):
        return [_value(element) for element in value]  # type: ignore[return-value]
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _or_names(value: Any, names: Any) -> Value:
    """A value, or the name for no value; of an array, for each element. What has a name must not have a value."""
    if isinstance(names, list) and isinstance(value, list):
        return [_or_names(*pair) for pair in zip(value, names, strict=True)]  # type: ignore[return-value]
    assert names is None or value is None
    return value if names is None else str(names)


def _plain(parameters: Parameters) -> Mapping[str, int | str]:
    """Parameters without fractions, which JSON does not have."""
    return {n: formatting.exact(value) if isinstance(value, Fraction) else value for n, value in parameters.items()}
