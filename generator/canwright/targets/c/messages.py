"""Addresses and messages: ids, and the forms of frames, which are what tells one message from another."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Space
from ...model.message import Address, Direction, IdRule, Key, Message
from . import bits
from .forms import Form, address_mask, form_of, named_forms
from .names import Names
from .numbers import working
from .text import english
from .values import MacroView

EXTENDED = 1 << 31


class RuleView(NamedTuple):
    """The ids of one direction of an address. A fixed id has a macro, the others two functions."""

    direction: str
    id_macro: str
    id_function: str
    node_function: str
    base: str
    mask: str
    times: str
    """What a node is multiplied with, as C writes it; empty where it is 1."""
    over: str
    """What the id less its base is divided by, as C writes it."""
    beside: str
    """The bits or the rest that are 0 in the id of a node, as C writes it."""
    has_nodes: bool
    refused: str
    besides: str
    """That more goes into the id, where it does."""


class CodeView(NamedTuple):
    """A parameter for the value of a key: how it is read from a frame, and how it is written."""

    kind: str
    name: str
    read: str
    lines: tuple[str, ...]


class FormView(NamedTuple):
    """A form of frames: `match` tells whether a frame has it, `stamp` gives it to a frame."""

    name: str
    rule: RuleView
    remote: bool
    frame_id: str
    other_id: str
    codes: tuple[CodeView, ...]

    @property
    def code_arguments(self) -> list[str]:
        return [f"{code.kind} {code.name}" for code in self.codes]

    @property
    def same_codes(self) -> str:
        """A condition that holds when a frame has the codes."""
        return " && ".join(f"{code.read} == {code.name}" for code in self.codes)


class AddressView(NamedTuple):
    heading: str
    doc: str
    rules: tuple[RuleView, ...]
    forms: tuple[FormView, ...]
    nodes: tuple[MacroView, ...]


class MessageView(NamedTuple):
    """A message. `matches` are the conditions on its codes, any of which it meets; `other_constant` is one to refuse."""

    name: str
    struct: str
    direction: str
    form: FormView
    dlc: int
    codes: tuple[tuple[str, ...], ...]
    other_constant: str


class Forms:
    """The messages of an edition, and their forms."""

    def __init__(self, names: Names, edition: Edition) -> None:
        self._names, self._edition = names, edition
        by_form: dict[Form, list[Message]] = {}
        for message in edition.all_messages():
            by_form.setdefault(form_of(message), []).append(message)
        self._at: dict[str, list[FormView]] = {}
        self._messages: dict[str, MessageView] = {}
        for form, parts in named_forms(by_form).items():
            view = self._view(form, parts, by_form[form][0])
            self._at.setdefault(form.address, []).append(view)
            self._messages |= {message.name: self._message(message, view) for message in by_form[form]}

    def at(self, address: Address) -> tuple[FormView, ...]:
        return tuple(self._at.get(address.name, ()))

    def message(self, message: Message) -> MessageView:
        return self._messages[message.name]

    def _message(self, message: Message, form: FormView) -> MessageView:
        return MessageView(
            self._names.lower(message.name),
            self._names.lower(message.name, "t"),
            message.direction.value,
            form,
            message.dlc,
            tuple(_codes(message)),
            _constant_mismatch(message),
        )

    def rule(self, address: Address, direction: Direction) -> RuleView:
        return rule_view(self._names, self._edition, address, direction)

    def _view(self, form: Form, name: tuple[str, ...], message: Message) -> FormView:
        mask = address_mask(self._edition, form.address, form.direction) & ~form.id_mask
        return FormView(
            self._names.lower(*name),
            self.rule(self._edition.address(form.address), form.direction),
            form.remote,
            frame_id(message),
            f"(frame->id & 0x{mask:X}u) != 0u" if mask else "",
            tuple(_code(key, i) for i, key in enumerate(message.keys)),
        )


def addresses(names: Names, edition: Edition, forms: Forms) -> list[AddressView]:
    """The addresses that messages use, each with the directions that they use."""
    found = []
    for address in edition.addresses:
        used = forms.at(address)
        nodes = address.request.nodes or address.reply.nodes
        rules = dict.fromkeys(form.rule for form in used)
        ends = (("node_min", nodes[0], "First node."), ("node_max", nodes[-1], "Last node.")) if nodes else ()
        heading = english(address.title) + (f" ({address.manual})" if address.manual else "")
        if used:
            macros = tuple(MacroView(names.upper(address.name, ending), f"{node}u", doc) for ending, node, doc in ends)
            found.append(AddressView(heading, english(address.about), tuple(rules), used, macros))
    return found


def rule_view(names: Names, edition: Edition, address: Address, direction: Direction) -> RuleView:
    rule = address.rule(direction)
    mask = address_mask(edition, address.name, direction)
    base = names.lower(address.name, direction.value)
    return RuleView(
        direction.value,
        names.upper(address.name, direction.value, "id"),
        f"{base}_id",
        f"{base}_node",
        f"0x{rule.base | (EXTENDED if rule.extended else 0):X}u",
        f" & 0x{0xFFFFFFFF & ~mask:08X}u" if mask else "",
        *_step(rule.node_step),
        rule.nodes is not None,
        _refused_nodes(rule),
        ", less the bits of code and fields" if mask else "",
    )


def _step(step: int) -> tuple[str, str, str]:
    """How C multiplies a node with the step from one to the next, divides by it, and finds what is beside it."""
    if step == 1:
        return "", "", ""
    if step.bit_count() > 1:
        return f" * {step}u", f" / {step}u", f" % {step}u"
    shift = step.bit_length() - 1
    return f" << {shift}", f" >> {shift}", f" & 0x{step - 1:X}u"


def frame_id(message: Message, frame: str = "frame") -> str:
    """The id of a frame as far as the address tells it."""
    return f"({frame}->id ^ CANWRIGHT_REMOTE)" if message.remote else f"{frame}->id"


def _constant_mismatch(message: Message) -> str:
    """A condition that holds when a constant of this message is another value; empty when it has none."""
    constants = [f for f in message.layout.fields if f.demanded is not None and not f.only]
    return " || ".join(c.replace(" == ", " != ") for f in constants for c in bits.constant_holds(f))


def _codes(message: Message) -> Iterator[tuple[str, ...]]:
    """The values of all keys of a message, then again with each value that a receiver takes for the first."""
    if not message.keys:
        yield ()
        return
    rest = [bits.labels(key, [key.value])[0] for key in message.keys[1:]]
    for value in dict.fromkeys((message.keys[0].value, *message.accept)):
        yield (*bits.labels(message.keys[0], [value]), *rest)


def _code(key: Key, index: int) -> CodeView:
    name = "code" if index == 0 else f"code_{index + 1}"
    kind = working(key.width)
    lines = []
    for s in key.segments:
        if key.space is Space.ID:
            lines.append(f"frame->id |= {bits.piece(name, kind, s)};")
        elif s.width == 8:
            value = f"({name} >> {s.raw_low})" if s.raw_low else name
            lines.append(f"frame->data[{s.byte}] = (uint8_t){value};")
        else:
            lines.append(f"frame->data[{s.byte}] = (uint8_t)(frame->data[{s.byte}] | {bits.piece(name, kind, s)});")
    return CodeView(kind.name, name, bits.operand(bits.key_value(key)), tuple(lines))


def _refused_nodes(rule: IdRule) -> str:
    """The condition under which `node` is none of the address; one that an unsigned number cannot meet is left out."""
    if rule.nodes is None:
        return ""
    low = [f"node < {rule.nodes[0]}u"] if rule.nodes[0] else []
    return " || ".join([*low, f"node > {rule.nodes[-1]}u"])
