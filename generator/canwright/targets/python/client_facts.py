"""What a client knows of an edition besides its frames: effects, harmless reads, the commands that end a motion."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Field
from ...model.message import Command, Direction, Message
from ...model.metadata import Consent, Repeat, State
from ...semantics.exchange import has_node, is_read, reply_differs
from . import code, text


class ClientFactsView:
    """Expressions of the arguments of `ClientFacts`."""

    def __init__(self, edition: Edition) -> None:
        effects = (
            code.tuple_of(
                (
                    text.literal(formatting.english(effect.title)),
                    text.literal(effect.consent.value),
                    str(effect.repeat is Repeat.SAME),
                    text.literal(effect.kept.value if effect.kept else ""),
                ),
                f"{text.literal(effect.name)}: ",
            )
            for effect in edition.effects
        )
        ends: dict[str, Message] = {}
        for command in edition.commands:
            if command.ends_motion and command.request and has_node(command.request):
                ends.setdefault(command.ends_motion.value, command.request)
        reads = [command for command in edition.commands if is_read(edition, command)]
        reads.sort(key=lambda command: command.entry is not None)  # those of measured values first
        self.effects = code.dict_of(effects)
        self.reads = _classes(c.request for c in reads if c.request)
        self.settings = code.dict_of(
            code.dict_of(
                (f"{text.literal(kept)}: {text.class_name(write.name)}" for kept, write in writes.items()),
                f"{text.class_name(read.name)}: ",
            )
            for read, writes in _settings(edition, reads)
        )
        self.ends_motion = code.dict_of(f"{text.literal(kind)}: {text.class_name(m.name)}" for kind, m in ends.items())
        states = sorted(edition.states, key=lambda state: not state.is_initial)
        self.states = code.dict_of(_state(edition, state) for state in states)
        replies = (message for message in edition.all_messages() if message.direction is Direction.REPLY)
        self.cyclic = _classes(m for m in replies if m.sending and m.sending.every_ms is not None)
        self.answers_in_order = edition.bus.answers_in_order


def _classes(messages: Iterable[Message]) -> code.Items:
    return code.tuple_of(text.class_name(message.name) for message in messages)


def _state(edition: Edition, state: State) -> code.Items:
    """A state: the requests that enter it, the effects that it prevents, and the variables that contain it."""
    entering = (command for command in edition.commands if command.spec_name in state.entered_by)
    variables = (f"{text.literal(variable)}: {raw}" for variable, raw in _containing(edition, state).items())
    parts = (
        _classes(command.request for command in entering if command.request),
        code.tuple_of(text.literal(effect.name) for effect in state.prevents),
        code.dict_of(variables),
    )
    return code.tuple_of(parts, f"{text.literal(state.name)}: ")


def class_attributes(edition: Edition, command: Command) -> Iterator[code.Code]:
    """Assignments of the class of a request; what a command does not have is left to the base class."""
    exempt: dict[str, dict[int, list[str]]] = {}
    for effect in command.effects:
        for field, member in command.exemptions(effect):
            exempt.setdefault(text.attribute(field.name), {}).setdefault(member.value, []).append(effect.name)
    if exempt:
        fields = (
            code.dict_of(
                (code.tuple_of(map(text.literal, names), f"{raw}: ") for raw, names in values.items()),
                f"{text.literal(field)}: ",
            )
            for field, values in exempt.items()
        )
        yield code.dict_of(fields, "EXEMPT = ")
    if command.repeat is not None:
        yield f"REPEAT = {command.repeat is Repeat.SAME}"
    if command.reply_frames != 1:
        yield f"REPLIES = {command.reply_frames}"
    if command.from_each:
        yield code.tuple_of(map(str, command.from_each), "REPLIERS = ")
    if is_read(edition, command) and reply_differs(edition, command):
        yield "DIFFERS = True"
    if command.reply_within_ms is not None:
        yield f"REPLY_WITHIN_MS = {float(command.reply_within_ms)!r}"


def _settings(edition: Edition, reads: Iterable[Command]) -> Iterator[tuple[Message, dict[str, Message]]]:
    """The reads of what can be written, and the requests that write it and do nothing else, by how long it is kept."""
    writes: dict[str, list[tuple[str, Message, set[str]]]] = {}
    for command in edition.commands:
        kept = [effect.kept for effect in command.effects if effect.kept]
        stores_only = all(
            effect.kept or effect.consent in (Consent.WEAR, Consent.CONTACT) for effect in command.effects
        )
        if kept and stores_only and command.request and command.reply and command.implemented:
            written = node_variables(command, command.request)
            values = command.request.layout.given
            if values and len(written) == len(values):
                write = kept[0].value, command.request, {*written.values()}
                writes.setdefault(next(iter(written.values())), []).append(write)
    for read in reads:
        readable = [*node_variables(read, read.replies[0].message).values()]
        requests: dict[str, Message] = {}
        for how, request, variables in (write for name in readable for write in writes.get(name, ())):
            if variables.issubset(readable):
                requests.setdefault(how, request)
        if requests and read.request:
            yield read.request, requests


def _containing(edition: Edition, state: State) -> dict[str, int]:
    """The variables whose values are states, each with the raw integer of this one."""
    names = {known.name for known in edition.states}
    raws: dict[str, int] = {}
    for command in edition.commands:
        for reply in command.replies:
            for field, variable in node_variables(command, reply.message).items():
                members = {member.name: member.value for member in field.type.enum}
                if names <= members.keys():
                    raws[variable] = members[state.name]
    return raws


def node_variables(command: Command, message: Message) -> dict[Field, str]:
    """The variable of a node that each field contains, if it has one; in a reply each has one."""
    values = message.layout.given
    entry = f"{command.entry.table}.{command.entry.name}" if command.entry else ""
    own = [field for field in values if field.path[0] != "commands"] if entry else []
    variables = {field: field.name for field in values} if message.direction is Direction.REPLY else {}
    variables |= {field: entry if len(own) == 1 else f"{entry}.{field.name}" for field in own}
    return variables | {field: field.variable for field in values if field.variable}


def state_attributes(command: Command, message: Message) -> Iterator[code.Code]:
    """Assignments of what a simulated node needs: the variables of fields, and raw integers where 0 is implausible."""
    is_reply = message.direction is Direction.REPLY
    states = [
        f"{text.literal(text.attribute(field.name))}: {text.literal(variable)}"
        for field, variable in node_variables(command, message).items()
        if not is_reply or variable != text.attribute(field.name)
    ]
    if states:
        yield code.dict_of(states, "VARIABLES = ")
    plausible = {field.name: _plausible_raw(field) for field in message.layout.given if is_reply}
    raws = [f"{text.literal(text.attribute(name))}: {raw}" for name, raw in plausible.items() if raw]
    if raws:
        yield code.dict_of(raws, "PLAUSIBLE = ")


def _plausible_raw(field: Field) -> int:
    """The plausible raw integer nearest to 0; 0 where that depends on parameters."""
    limits, linear = field.type.plausible, field.type.linear.constant
    if limits is None or linear is None or linear.times is not None or field.is_array:
        return 0
    low, high = ((bound.constant - linear.offset) / linear.scale for bound in (limits.low, limits.high))
    low, high = min(low, high), max(low, high)
    return math.ceil(low) if low > 0 else math.floor(high) if high < 0 else 0
