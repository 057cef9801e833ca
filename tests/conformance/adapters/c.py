"""The generated C headers, compiled into a small program and driven through their public functions."""

from __future__ import annotations

import subprocess
import weakref
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import ClassVar

from canwright.conformance.adapter import (
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
from canwright.model.edition import Edition
from canwright.model.joined import Joined, JoinedText
from canwright.model.layout import Field, Layout
from canwright.model.message import Direction, Message
from canwright.model.refusal import Refusal
from canwright.model.types import NO_PARAMETERS, Encoding
from canwright.semantics.exchange import exchange_plans
from canwright.semantics.frame import code_of
from canwright.targets.base import EditionInput
from canwright.targets.c.target import CTarget

from ...compilers import build
from .c_facts import Facts
from .c_harness import harness, header_text

EXTENDED = 1 << 31
REMOTE = 1 << 30


class CAdapter(Adapter):
    """Answers through `decode_request`, `decode_reply`, the functions of each message, and the conversions."""

    name = "c"
    reports_code = True
    cannot: ClassVar[Mapping[str, str]] = {
        "joined": "functions take texts without 0, in UTF-8 without a check, and unsigned integers",
        "exchanges": "no request has a reply, so there is no `check_reply`",
    }
    reports_absent = False
    """Whether the value of a field that a node lacks is the reason; C has functions for types, not for fields."""

    def __init__(self, edition: Edition, program: Path, header: str = "") -> None:
        super().__init__(edition)
        self.header = header
        self._process = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        weakref.finalize(self, _end, self._process)

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> CAdapter:
        """Compiles a program around the generated headers."""
        folder = write_files(CTarget().generate([specification], {}), workdir)
        source = folder / "harness.c"
        source.write_text(harness(specification.edition, folder / "include"), "utf-8")
        program = build([source], folder / "include", folder / "harness")
        return cls(specification.edition, program, header_text(specification.edition, folder / "include"))

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        wanted = f"any_{direction.value}" if expected is None else self.message_of(direction, expected).name
        answer = self._ask("decode", wanted, *self._known(parameters), *_frame(frame))
        if isinstance(answer, Refused):
            return answer
        command, node, *words = answer
        message = self.message_of(direction, command)
        variant = message.layout.variant(assignment(parameters))
        assert variant is not None
        raw: dict[str, Raw] = {}
        values: dict[str, Value] = {}
        items = [words[i : i + 3] for i in range(0, len(words), 3)]
        assert words[-2:] != ["not", "clear"], f"{command}: fields of other commands are not 0"
        present = {field.name for field in variant.fields}
        absent = [(number, value) for name, number, value in items if name not in present and name[-1] != "="]
        assert all(number == "0" for number, _ in absent), f"{command}: absent fields are not 0"
        assert not self.reports_absent or all(
            value in (f"?{Refusal.NOT_AVAILABLE.value}", "+") for _, value in absent
        ), command
        for field in (f for f in variant.fields if f.is_given):
            mine = [(int(number), value) for name, number, value in items if name == field.name]
            if field.type.joined is not None:
                raw[field.name] = [number for number, _ in mine]
                (joined,) = (value for name, _, value in items if name == f"{field.name}=")
                values[field.name] = _joined(field.type.joined, joined)
                continue
            raw[field.name] = [number for number, _ in mine] if field.is_array else mine[0][0]
            if any(value == f"?{Refusal.MISSING_PARAMETER.value}" for _, value in mine):
                continue
            if field.is_array and all(value[0] != "?" for _, value in mine):
                values[field.name] = [_value(value) for _, value in mine]  # type: ignore[assignment]
            else:
                values[field.name] = _value(mine[0][1])
        has_node = message.id.nodes is not None or message.node_in_data is not None
        given = next((int(number) for name, number, _ in items if name == "frame_code="), 0)
        code = code_of(message, frame) and given % (1 << message.keys[0].width)
        assert bool(given) is (code is not None), f"{command}: the code is {given}"
        return Decoded(command, int(node) if has_node else None, raw, values, code)

    def encode_raw(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        raw: Mapping[str, Raw],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        message = self.message_of(direction, command)
        words = _code(message, code)
        for field, index, number in _items(message.layout, raw):
            low, high = _container(field)
            if not low <= int(str(number)) <= high:
                return Refused(Refusal.OUT_OF_RANGE, field.name)
            words += [field.name, str(index), str(number)]
        return self._encode(message, node, parameters, False, words)

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
        words = _code(message, code)
        for field, index, value in _items(message.layout, values):
            if field.type.joined is not None:
                words += [f"{field.name}=", "0", _given(field.type.joined, value)]
                continue
            words += [field.name, str(index), _written(value)]
        return self._encode(message, node, parameters, True, words)

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        if not any(exchange_plans(self.edition).values()):
            raise Cannot("exchanges")
        answer = self._ask("answers", *self._known(parameters), *_frame(request), *_frame(reply))
        return answer if isinstance(answer, Refused) else None

    def identify(self, direction: Direction, frame: CanFrame) -> tuple[str, int] | Refused:
        """The command and the node of a frame, 0 without a node."""
        answer = self._ask("identify", direction.value, *self._known({}), *_frame(frame))
        return answer if isinstance(answer, Refused) else (answer[0], int(answer[1]))

    def text(self, direction: Direction, frame: CanFrame, parameters: Parameters, size: int = 1000) -> tuple[int, str]:
        """A frame as text in a buffer of `size` bytes, and the length of the complete text."""
        answer = self._ask("print", direction.value, *self._known(parameters), *_frame(frame), str(size))
        assert not isinstance(answer, Refused)
        length, is_intact, *words = answer
        assert is_intact == "1", "bytes behind the buffer were written"
        return int(length), " ".join(words)

    def filter(
        self, address: str, direction: Direction, node: int, parameters: Parameters = NO_PARAMETERS
    ) -> tuple[int, int] | Refused:
        """The id and the mask of the filter for one node; an address without nodes ignores `node`."""
        answer = self._ask("filter", f"{address}_{direction.value}_filter", *self._known(parameters), str(node))
        return answer if isinstance(answer, Refused) else (int(answer[0], 16), int(answer[1], 16))

    def accepted(self, address: str, direction: Direction, node: int, ids: Sequence[int]) -> list[bool]:
        """Whether the filter for one node accepts each of some ids."""
        words = [*self._known({}), str(node), *(f"{id_:X}" for id_ in ids)]
        answer = self._ask("filter", f"{address}_{direction.value}_filter", *words)
        assert not isinstance(answer, Refused)
        return [word == "1" for word in answer[2:]]

    def constant(self, name: str) -> int:
        """The value of a macro."""
        answer = self._ask("macro", name, *self._known({}))
        assert not isinstance(answer, Refused)
        return int(answer[0])

    def check(self, direction: Direction, frame: CanFrame, parameters: Parameters) -> Refused | None:
        """Why a frame is not decoded, or why its fields are invalid, with the field; None for a valid frame."""
        answer = self._ask("check", f"any_{direction.value}", *self._known(parameters), *_frame(frame))
        return answer if isinstance(answer, Refused) else None

    def pack(self, layout: Layout, raw: Mapping[str, Raw], parameters: Parameters) -> tuple[int, int]:
        """The id and the data, as little-endian numbers, of fields that are written without a check."""
        items = ((f"{field.name} {index} {number}") for field, index, number in _items(layout, raw))
        answer = self._ask("pack", layout.name, *self._known(parameters), *items)
        assert not isinstance(answer, Refused)
        return int(answer[0], 16), int.from_bytes(bytes.fromhex(answer[1]), "little")

    def has_command(self, message: Message, parameters: Parameters) -> bool:
        """Whether a message whose fields are 0 is encoded, or rejected for another reason than the parameters."""
        node = message.id.nodes[0] if message.id.nodes else None
        return self._encode(message, node, parameters, False, []) != Refused(Refusal.NOT_AVAILABLE)

    def milli(self, type_name: str, direction: str, number: int, parameters: Parameters) -> int | Refused:
        """`to` thousandths of the unit, or `from` them."""
        answer = self._ask("milli", type_name, *self._known(parameters), direction, str(number))
        return answer if isinstance(answer, Refused) else int(answer[0])

    def single(self, type_name: str, direction: str, number: int, parameters: Parameters) -> int | Refused:
        """`to` the bits of a float, or `from` them."""
        answer = self._ask("single", type_name, *self._known(parameters), direction, str(number))
        return answer if isinstance(answer, Refused) else int(answer[0])

    def wrong_facts(self) -> list[str]:
        """What the program says of the header besides frames, where it differs from the model."""
        wrong = []
        for fact in Facts(self.edition, self.header).all():
            answer = self._ask(fact.kind, fact.name, *self._known(fact.parameters), *fact.rest)
            words = " ".join(filter(None, (answer.says.value, answer.field)) if isinstance(answer, Refused) else answer)
            if words != fact.answer:
                wrong.append(f"{fact.kind} {fact.name} {dict(fact.parameters)} {fact.rest}: {words}, not {fact.answer}")
        return wrong

    def _encode(
        self, message: Message, node: int | None, parameters: Parameters, is_value: bool, words: list[str]
    ) -> CanFrame | Refused:
        start = [*self._known(parameters), str(node or 0), str(int(is_value))]
        answer = self._ask("encode", message.name, *start, *words)
        if isinstance(answer, Refused):
            return answer
        id_, data = int(answer[0], 16), bytes.fromhex(answer[1] if len(answer) > 1 else "")
        is_remote = bool(id_ & REMOTE)
        return CanFrame(id_ & 0x1FFFFFFF, b"" if is_remote else data, bool(id_ & EXTENDED), is_remote)

    def _known(self, parameters: Parameters) -> Iterator[str]:
        """For each parameter of the edition the place of its value, or numerator and denominator; 0 is not known."""
        for parameter in self.edition.parameters:
            given = parameters.get(parameter.name)
            if parameter.is_choice:
                names = [value.name for value in parameter.values]
                yield "0" if given is None else str(names.index(str(given)) + 1)
            else:
                number = Fraction(0) if given is None else Fraction(str(given))
                yield from (str(number.numerator), "0" if given is None else str(number.denominator))

    def _ask(self, *words: str) -> list[str] | Refused:
        to, answers = self._process.stdin, self._process.stdout
        assert to is not None and answers is not None
        print(*words, file=to, flush=True)
        line = answers.readline().split()
        assert line, f"the program has no answer to: {' '.join(words)}"
        if line[0] == "ok":
            return line[1:]
        return Refused(Refusal(line[1]), line[2].removesuffix("=") if len(line) > 2 else None)


def _end(process: subprocess.Popen[str]) -> None:
    process.communicate()


def _code(message: Message, code: int | None) -> list[str]:
    """The member with a code: 0 is the usual one, and the code 0 is the bit above the largest one."""
    usual = message.keys[0] if message.keys else None
    if code is None or usual is None:
        return []
    return ["frame_code=", "0", str(1 << usual.width if code == 0 and usual.value else code)]


def _items(layout: Layout, given: Mapping[str, Raw] | Mapping[str, ExactValue]) -> Iterator[tuple[Field, int, object]]:
    """Every element of every given field; flags are one value, though they are a list."""
    fields = {field.name: field for field in layout.fields}
    for name, value in given.items():
        elements = value if isinstance(value, list) and fields[name].is_array else [value]
        yield from ((fields[name], index, element) for index, element in enumerate(elements))


def _container(field: Field) -> tuple[int, int]:
    """What the member of the struct holds; beyond it, a C compiler refuses the number."""
    width = next(w for w in (8, 16, 32, 64) if field.type.width <= w)
    if field.type.encoding is Encoding.SIGNED:
        return -(1 << (width - 1)), (1 << (width - 1)) - 1
    return 0, (1 << width) - 1


def _joined(joined: Joined, word: str) -> Value:
    """The value of a field whose elements are joined."""
    if isinstance(joined, JoinedText):
        return bytes.fromhex(word[1:]).decode(joined.codec, "replace")
    return None if word.startswith("?") else float(word)


def _given(joined: Joined, value: object) -> str:
    """A value of such a field as the program reads it. Raises Cannot for one that C cannot pass."""
    if isinstance(joined, JoinedText):
        try:
            content = str(value).encode("utf-8")
        except UnicodeEncodeError:
            raise Cannot("joined") from None
        if b"\0" in content:
            raise Cannot("joined")
        return "x" + content.hex()
    if not isinstance(value, Fraction) or value.denominator != 1 or value < 0:
        raise Cannot("joined")
    return str(value)


def _written(value: object) -> str:
    if isinstance(value, list):
        return "+" + "".join(f"{name}+" for name in value)
    return repr(float(value)) if isinstance(value, (int, float, Fraction)) else str(value)


def _frame(frame: CanFrame) -> list[str]:
    flags = (EXTENDED if frame.extended else 0) | (REMOTE if frame.remote else 0)
    return [f"{frame.id | flags:X}", str(len(frame.data)), *(f"{byte:02X}" for byte in frame.data), "-"]


def _value(word: str) -> Value:
    if word.startswith("+"):
        return [name for name in word.split("+") if name]
    if word.startswith("'"):
        return word[1:] or None
    return None if word == f"?{Refusal.NO_SCALE.value}" else float(word)
