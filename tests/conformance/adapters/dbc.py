"""The DBC files, read by cantools in its strict mode as a test engineer would load them.

All bits, scales, limits, codes and ids are the file's. The spec is asked for names, and for what it says that no DBC
can: such a case is a named exception.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from canwright.golden import Refusal
from canwright.model import Assignment, Direction, Space
from canwright.targets import Described, dbc

from ..adapter import Cannot, CanFrame, Decoded, Encoded, ExactValue, Parameters, Raw, Refused

from .dbc_file import KIND, DbcFile, message_of

Result = TypeVar("Result", Decoded, Encoded)


def adapter(described: Described, workdir: Path) -> DbcAdapter:
    """An adapter that needs no files: cantools loads texts."""
    return DbcAdapter(described)


class DbcAdapter:
    name = "dbc"
    tolerance = 1e-12
    """A DBC has one factor, a double: raw * 0.01 and raw / 100 differ in the last digit."""
    cannot: Mapping[str, str] = {
        "exchanges": "a DBC does not know which reply belongs to which request, nor that a reply echoes it",
        "shared_code": "a code that two commands reply with is read as the reply of the command that has the code",
        "other_value": "the files of a parameter value leave out the commands that it lacks",
        "unnamed": "minimum and maximum leave out no single values, so an encoder takes those without a name",
        "reply_limits": "in a reply file minimum and maximum are all that the bits hold",
        "constants": "no reader checks what a constant signal holds",
        "not_finite": "a float signal takes NaN and infinity",
        "rounding": "a reader works in doubles, rounds ties its own way, and compares with limits before it rounds",
        "left_out": "an id that carries a field, and a remote frame, have no form in a DBC",
        "selectors_apart": "nested multiplexors break readers; selectors that stand apart cannot be read as one",
        "lengths": "all messages of one id have one length",
    }

    def __init__(self, described: Described) -> None:
        self._described = described
        self._edition = described.edition
        self._texts: dict[tuple[tuple[str, str], ...], dict[str, str]] = {}
        self._loaded_files: dict[str, list[DbcFile]] = {}

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, answering: str | None
    ) -> Decoded | Refused:
        if frame.remote:
            return Refused(Refusal.UNKNOWN_ID)
        read = [self._read(files, direction, frame) for files in self._files(direction, parameters)]
        result = _agreed(_agreed_values(read))
        if result == Refused(Refusal.UNKNOWN_CODE):
            elsewhere = (self._read(files, direction, frame) for files in self._files(direction, {}))
            if any(isinstance(other, Decoded) for other in elsewhere):
                raise Cannot("other_value")
        if answering is None or isinstance(result, Refused):
            return result
        expected = self._edition.command(answering).reply
        if expected is None or expected.command != result.command:
            raise Cannot("shared_code")
        return Decoded(answering, result.node, result.raw, result.values)

    def encode_raw(
        self, direction: Direction, command: str, node: int | None, raw: Mapping[str, Raw], parameters: Parameters
    ) -> Encoded | Refused:
        return self._encode(direction, command, node, raw, parameters, scaled=False)

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
    ) -> Encoded | Refused:
        return self._encode(direction, command, node, values, parameters, scaled=True)

    def answers(self, request: CanFrame, reply: CanFrame) -> Refused | None:
        raise Cannot("exchanges")

    def _files(self, direction: Direction, parameters: Parameters) -> Iterator[list[DbcFile]]:
        """The files that a node with these parameters may need: one, or several where a parameter is not given."""
        choices: list[list[str]] = []
        fixed: dict[str, str] = {}
        for parameter in self._edition.parameters:
            given = parameters.get(parameter.name)
            if not parameter.is_numeric:
                choices.append([str(given)] if given is not None else [value.name for value in parameter.values])
            elif given is not None:
                fixed[parameter.name] = str(given)
        words = [f"{name}_{value}" for name, value in fixed.items()]
        for combination in itertools.product(*choices):
            names = (self._edition.family, self._edition.name, *combination, *words, KIND[direction])
            yield self._loaded("-".join(names), fixed)

    def _loaded(self, name: str, fixed: Assignment) -> list[DbcFile]:
        """The file of a name, after those that read its selectors as one."""
        variant = tuple(fixed.items())
        if variant not in self._texts:
            self._texts[variant] = {output.path: output.text for output in dbc.generate([self._described], fixed)}
        if name not in self._loaded_files:
            texts = self._texts[variant]
            joined = [path for path in texts if path.startswith(f"{name}-") and "-node" not in path]
            self._loaded_files[name] = [DbcFile(self._edition, texts[path]) for path in (*joined, f"{name}.dbc")]
        return self._loaded_files[name]

    def _read(self, files: Sequence[DbcFile], direction: Direction, frame: CanFrame) -> Decoded | Refused:
        """What the first file that knows the frame says."""
        for file in files[:-1]:
            result = file.read(direction, frame)
            if isinstance(result, Decoded):
                return result
        try:
            return files[-1].read(direction, frame)
        except Cannot as exception:
            if exception.name == "selectors_apart" and len(files) > 1:
                return Refused(Refusal.UNKNOWN_CODE)
            raise

    def _encode(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        given: Mapping[str, Raw] | Mapping[str, ExactValue],
        parameters: Parameters,
        scaled: bool,
    ) -> Encoded | Refused:
        message = message_of(self._edition.command(command), direction)
        if message.remote or any(f.space is Space.ID and f.constant is None for f in message.layout.fields):
            raise Cannot("left_out")
        written = []
        for files in self._files(direction, parameters):
            results = [file.write(message, node, given, parameters, scaled) for file in files]
            written.append(next((result for result in results if result is not None), None))
        if all(result is None for result in written):
            raise Cannot("selectors_apart" if len(message.keys) > 1 else "other_value")
        result = _agreed([result for result in written if result is not None])
        if result == Refused(Refusal.MISSING_PARAMETER):
            undecided = (
                f.name for f in message.layout.fields if f.name in given and set(f.type.parameters) - set(parameters)
            )
            return Refused(Refusal.MISSING_PARAMETER, next(undecided, None))
        return result


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
