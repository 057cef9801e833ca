"""The dispatch plan as `Route` and `Select` expressions, and the answers to requests."""

from __future__ import annotations

from collections.abc import Iterator

from ...model.edition import Edition
from ...model.message import BitRun, Direction
from ...semantics.dispatch import Entry, Found, Length, MaskedId, Node, Reject, Subject, dispatch_plan
from . import bits, text
from .imports import Imports


class Readers:
    """The functions that read selectors: each expression once, with a name."""

    def __init__(self) -> None:
        self.names: dict[str, str] = {}

    def of(self, key: BitRun, shortest: int) -> str:
        """The name of the function that reads a key in data of that length or more."""
        return self.named(bits.read_key(key, shortest))

    def named(self, expression: str) -> str:
        """The name of the function that returns an expression of `can_id` and `data`."""
        return self.names.setdefault(expression, f"_key_{len(self.names) + 1}")


class Routes:
    """Prints the entries of a dispatch plan as `Route(...)` expressions."""

    def __init__(self, readers: Readers, imports: Imports) -> None:
        self._readers, self._imports = readers, imports

    def of(self, edition: Edition, direction: Direction) -> Iterator[str]:
        """The routes of one direction, in the order in which they are tried."""
        return map(self._route, dispatch_plan(edition.messages(direction)).entries)

    def _route(self, entry: Entry) -> str:
        rule = entry.rule
        nodes = f"range({rule.nodes[0]}, {rule.nodes[-1] + 1})" if rule.nodes is not None else "None"
        shortest = min(0 if message.remote else message.dlc for message in entry.messages)
        arguments = [f"0x{rule.base:X}", str(rule.node_step), nodes, self._node(entry.then, shortest, 4)]
        if entry.mask:
            arguments.append(f"mask=0x{entry.mask:X}")
        if rule.extended:
            arguments.append("extended=True")
        if entry.remote:
            arguments.append("remote=True")
        only_answers = [text.class_name(m.name) for m in entry.messages if m.keys and not m.claims]
        if only_answers:
            arguments.append(f"answers=({', '.join(only_answers)},)")
        return f"{self._imports.use('Route')}({', '.join(arguments)})"

    def _node(self, node: Node, shortest: int, indent: int) -> str:
        """A node of the plan: a message class, a refusal, or a `Select(...)` expression, in data of `shortest` or more."""
        if isinstance(node, Found):
            return text.class_name(node.message.name)
        if isinstance(node, Reject):
            return f"{self._imports.use('Refusal')}.{node.reason.name}"
        read, form = self._read(node.subject, shortest)
        otherwise = self._node(node.otherwise, shortest, indent)
        if len(node.cases) == 1:
            values, then = node.cases[0]
            written = ", ".join(form.format(value) for value in values)
            alone = self._node(then, shortest, indent)
            cases = f"{{{written}: {alone}}}" if len(values) == 1 else f"dict.fromkeys(({written}), {alone})"
        else:
            margin = " " * indent
            lines = (
                f"\n{margin}    {form.format(value)}: {self._node(case.then, shortest, indent + 4)},"
                for case in node.cases
                for value in case.values
            )
            cases = f"{{{''.join(lines)}\n{margin}}}"
        return f"{self._imports.use('Select')}({read}, {cases}, {otherwise})"

    def _read(self, subject: Subject, shortest: int) -> tuple[str, str]:
        """The name of the function that reads a subject, and the format of its values."""
        if isinstance(subject, Length):
            return self._imports.use("data_length"), "{}"
        if isinstance(subject, MaskedId):
            return self._readers.named(f"can_id & 0x{subject.mask:X}"), "0x{:X}"
        return self._readers.of(subject, shortest), "0x{:02X}"


def answers(edition: Edition, readers: Readers, imports: Imports) -> Iterator[str]:
    """One `request: answer` entry for every command that has both."""
    entries = dispatch_plan(edition.messages(Direction.REPLY)).entries
    masks = {(entry.rule, entry.remote): entry.mask for entry in entries}
    for command in edition.commands:
        if command.request is None or command.reply is None:
            continue
        reply = command.reply
        length = 0 if reply.remote else reply.dlc
        selectors = text.tuple_of(
            f"({readers.of(k, length)}, {text.tuple_of(f'0x{v:02X}' for v in (k.value, *(reply.accept if i == 0 else ())))})"
            for i, k in enumerate(reply.keys)
        )
        nodes = text.tuple_of(map(str, command.from_each))
        echo = command.is_echoed
        names = text.class_name(command.request.name), text.class_name(reply.name)
        held = "".join(
            f", {word}=({readers.of(key, 0 if m.remote else m.dlc)}, 0x{(1 << key.width) - 1:X})"
            for word, m in (("asked", command.request), ("told", reply))
            if (key := m.node_bits) is not None
        )
        unused = masks[reply.id, reply.remote] & ~reply.id_mask
        if unused:
            held += f", unused=0x{unused:X}"
        yield f"{names[0]}: {imports.use('Answer')}({names[1]}, {selectors}, {nodes}, {echo}{held})"
