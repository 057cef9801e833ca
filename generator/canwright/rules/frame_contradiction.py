"""Golden frames mean what the spec says they mean."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from .. import words
from ..diagnostics import nearest
from ..given import number
from ..golden import Frame, RefusedValues
from ..interpret import CanFrame, Raw, Value, has_id, is_message, node_of, raws, value_of, wrong_constants
from ..model import Direction, Edition, Field, Message, Path
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    messages = {direction: _messages(subject.edition, direction) for direction in Direction}
    for i, frame in enumerate(subject.frames.frames if subject.frames else ()):
        for path, text, hint in _frame(messages[frame.direction], frame):
            yield Finding(("frames", i, *path), text, hint, in_frames=True)
    for i, refused in enumerate(subject.frames.refused if subject.frames else ()):
        if isinstance(refused, RefusedValues):
            for path, text, hint in _refused(subject.edition, refused):
                yield Finding(("refused", i, *path), text, hint, in_frames=True)

    for key in ("frames", "refused", "exchanges"):
        for i, entry in enumerate(getattr(subject.frames, key, ())):
            for path, text, hint in _parameters(subject.edition, entry.parameters):
                yield Finding((key, i, *path), text, hint, in_frames=True)


Problem = tuple[Path, str, str]


def _parameters(edition: Edition, given: Mapping[str, int | str]) -> Iterator[Problem]:
    known = {parameter.name: parameter for parameter in edition.parameters}
    for name, value in given.items():
        path: Path = ("parameters", name)
        if name not in known:
            yield path, f"there is no parameter `{name}`", nearest(name, known) or "leave it out"
        elif known[name].is_choice and str(value) not in (names := [v.name for v in known[name].values]):
            yield path, f"`{name}` has no value `{value}`", nearest(str(value), names)
        elif not known[name].is_choice:
            try:
                number(edition, known[name], str(value))
            except ValueError as error:
                yield path, str(error), "write what the source gives"


def _messages(edition: Edition, direction: Direction) -> dict[str, Message]:
    """What each command sends in a direction, by its name."""
    both = ((c.name, c.message(direction)) for c in edition.commands)
    return {name: message for name, message in both if message is not None}


def _frame(messages: Mapping[str, Message], frame: Frame) -> list[Problem]:
    direction = frame.direction.value
    if not frame.command or (frame.request and frame.reply):
        text = "this is no frame of a command" if not frame.command else "a frame is a request or a reply, not both"
        return [((), text, "write `request: COMMAND` or `reply: COMMAND`")]
    message = messages.get(frame.command)
    if message is None:
        return [((direction,), f"no command `{frame.command}` has a {direction}", nearest(frame.command, messages))]
    can = CanFrame(frame.id, frame.data, frame.extended, frame.remote)
    problem = _header(message, frame, can)
    if problem:
        return [problem]
    variant = message.layout.variant({name: str(value) for name, value in frame.parameters.items()})
    if variant is None:
        text = f"the fields depend on `{message.layout.parameter}`, which is not given"
        return [((), text, f"add parameters: {{{message.layout.parameter}: …}}")]
    wrong = [((), f"`{f.name}` should hold {f.constant}", "check `data`") for f in wrong_constants(variant, can)]
    found = raws(variant, can)
    return [*wrong, *_raws(frame, found), *_values(frame, {f.name: f for f in variant.fields}, found)]


def _refused(edition: Edition, refused: RefusedValues) -> list[Problem]:
    """What is refused has to be refused for its values, not for names that are not there."""
    commands = {c.name: c for c in edition.commands}
    command = commands.get(refused.command)
    if command is None:
        return [(("command",), f"there is no command `{refused.command}`", nearest(refused.command, commands))]
    message = command.message(refused.encode)
    known = [f.name for f in message.layout.fields] if message else []
    return [
        ((key, name), f"there is no field `{name}`", nearest(name, known))
        for key, told in (("raw", refused.raw), ("values", refused.values))
        for name in told
        if name not in known
    ]


def _header(message: Message, frame: Frame, can: CanFrame) -> Problem | None:
    for key, wanted in (("extended", message.id.extended), ("remote", message.remote)):
        if getattr(frame, key) is not wanted:
            text = f"{message.name} is {'' if wanted else 'no '}{'frame with a 29-bit id' if key == 'extended' else 'remote frame'}"
            return (), text, f"{key}: {str(wanted).lower()}"
    if not has_id(message, can):
        return ("id",), f"0x{frame.id:X} is no id of {message.name}", "check the id, and the address in the spec"
    if len(frame.data) != (0 if message.remote else message.dlc):
        return ("data",), f"{len(frame.data)} bytes, but {message.name} has {message.dlc}", "check `data` and `dlc`"
    if not is_message(message, can):
        keys = ", ".join(f"{words.place(k.space, k.segments)} 0x{k.value:02X}" for k in message.keys)
        return ("data",), f"these bytes do not select {message.name}", f"check the code: it has {keys}"
    if node_of(message, can) != frame.node:
        return ("node",), f"the id 0x{frame.id:X} is that of node {node_of(message, can)}", "check `id` and `node`"
    return None


def _raws(frame: Frame, found: Mapping[str, Raw]) -> list[Problem]:
    if set(found) != set(frame.raw):
        return [(("raw",), f"the fields are {', '.join(found) or 'none'}", "write every field and no other")]
    return [
        (("raw", name), f"the bytes hold {raw} in `{name}`", "check `data` by hand, and the layout in the spec")
        for name, raw in found.items()
        if raw != frame.raw[name]
    ]


def _values(frame: Frame, fields: Mapping[str, Field], found: Mapping[str, Raw]) -> list[Problem]:
    problems: list[Problem] = []
    assignment = {name: str(value) for name, value in frame.parameters.items()}
    for name, wanted in frame.values.items():
        if name not in fields or name not in found:
            problems.append((("values", name), f"there is no field `{name}`", nearest(name, found)))
            continue
        raw, type_ = found[name], fields[name].type
        value = (
            [value_of(type_, r, assignment) for r in raw] if isinstance(raw, list) else value_of(type_, raw, assignment)
        )
        if not _same(wanted, value):
            text = f"`{name}` is {_shown(value)} by the spec's scale"
            problems.append((("values", name), text, "check the value by hand, and the type in the spec"))
    return problems


def _same(wanted: object, value: object) -> bool:
    if isinstance(wanted, list) and isinstance(value, list):
        return len(wanted) == len(value) and all(map(_same, wanted, value))
    return wanted == ("none" if value is None else value)


def _shown(value: Value | list[Value]) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_shown, value))}]"
    return words.exact(value) if isinstance(value, Fraction) else "none" if value is None else str(value)
