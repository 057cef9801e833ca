"""Layouts and messages of a spec, resolved: fields with their bits, keys, reply forms."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from . import schema
from .model import (
    Address,
    Command,
    Direction,
    Element,
    Field,
    Key,
    Layout,
    Message,
    Order,
    Parameter,
    Path,
    ReplyForm,
    Segment,
    Space,
    Type,
    Variant,
)
from .notation import At, frame_bits
from .resolve_types import Context, bare_type


@dataclass(frozen=True)
class Reply:
    """What a command gets back."""

    message: Message | None
    form: ReplyForm
    of: str | None = None
    from_each: tuple[int, ...] = ()


class MessageResolver:
    """Resolves the layouts of an edition at once, and the messages of its commands on demand."""

    def __init__(
        self,
        context: Context,
        spec: schema.EditionSpec,
        parameters: Mapping[str, Parameter],
        types: Mapping[str, Type],
        addresses: Mapping[str, Address],
    ) -> None:
        self._context = context
        self._spec = spec
        self._parameters = parameters
        self._types = types
        self._addresses = addresses
        self._pending: list[str] = []
        self._done: dict[str, tuple[Message | None, Reply]] = {}
        self.bare_types: dict[str, Type] = {}
        self.shared_layouts = {
            name: self._layout(("layouts", name), name, written.fields, written)
            for name, written in spec.layouts.items()
        }

    def only(self, path: Path, written: Mapping[str, Sequence[str]] | None) -> dict[str, tuple[str, ...]]:
        """A condition on parameters, checked."""
        for name, values in (written or {}).items():
            parameter = self._context.find((*path, "only", name), "parameter", name, self._parameters, key=True)
            known = {value.name: value for value in parameter.values} if parameter else dict.fromkeys(values)
            for i, value in enumerate(values):
                self._context.find((*path, "only", name, i), f"value of `{name}`:", value, known)
        return {name: tuple(values) for name, values in (written or {}).items()}

    def address_of(self, command: str) -> str:
        """The address that a command is sent to."""
        name = self._spec.commands[command].address or next(iter(self._addresses))
        self._context.find(("commands", command, "address"), "address", name, self._addresses)
        return name

    def of(self, command: str) -> tuple[Message | None, Reply]:
        """Request and reply of a command."""
        if command not in self._done:
            self._pending.append(command)
            self._done[command] = self._resolve(command)
            self._pending.pop()
        return self._done[command]

    def _resolve(self, command: str) -> tuple[Message | None, Reply]:
        written = self._spec.commands[command]
        echo = written.reply == "echo"
        request = None
        if written.request != "none":
            name = command if echo else f"{command}_request"
            request = self._message(command, Direction.REQUEST, name, written.request or {})
        return request, self._reply(command, request)

    def _reply(self, command: str, request: Message | None) -> Reply:
        path: Path = ("commands", command, "reply")
        written = self._spec.commands[command].reply
        if written is None:
            hint = "write fields, the name of a layout, `echo`, or `none`"
            self._context.report(
                path[:-1], "missing-reply", f"`{command}` does not say what it replies", hint, key=True
            )
            return Reply(None, ReplyForm.NONE)
        if written == "none":
            return Reply(None, ReplyForm.NONE)
        if written == "echo":
            return self._echo(command, request)
        if isinstance(written, schema.MessageSpec) and written.of is not None:
            return self._other(path, written, written.of)
        message = self._message(command, Direction.REPLY, f"{command}_reply", written)
        form = ReplyForm.LAYOUT if message.layout.shared else ReplyForm.OWN
        from_each = tuple(written.from_each or ()) if isinstance(written, schema.MessageSpec) else ()
        return Reply(message, form, None, from_each)

    def _echo(self, command: str, request: Message | None) -> Reply:
        path: Path = ("commands", command, "reply")
        if request is None:
            self._context.report(path, "echo-of-nothing", f"`{command}` has no request that could come back")
            return Reply(None, ReplyForm.NONE)
        reply = self._message(command, Direction.REPLY, command, {})
        return Reply(dataclasses.replace(reply, layout=request.layout, dlc=request.dlc), ReplyForm.ECHO)

    def _other(self, path: Path, written: schema.MessageSpec, of: str) -> Reply:
        if self._context.find((*path, "of"), "command", of, self._spec.commands) is None:
            return Reply(None, ReplyForm.NONE)
        if of in self._pending:
            self._context.report((*path, "of"), "circular-reference", f"`{of}` takes its reply from here in turn")
            return Reply(None, ReplyForm.NONE)
        _, reply = self.of(of)
        return Reply(reply.message, ReplyForm.OTHER, of, tuple(written.from_each or ()))

    def _message(
        self, command: str, direction: Direction, layout_name: str, written: str | schema.Fields | schema.MessageSpec
    ) -> Message:
        path: Path = ("commands", command, direction.value)
        spec = written if isinstance(written, schema.MessageSpec) else schema.MessageSpec(layout=written)
        address = self._addresses.get(spec.address or self.address_of(command))
        if spec.address is not None:
            self._context.find((*path, "address"), "address", spec.address, self._addresses)
        address = address or next(iter(self._addresses.values()))
        if isinstance(spec.layout, str):
            layout = self._context.find(path, "layout", spec.layout, self.shared_layouts)
        else:
            layout = None
        if layout is None:
            fields = spec.layout if isinstance(spec.layout, dict) else {}
            at = (*path, "layout") if isinstance(written, schema.MessageSpec) else path
            layout = self._layout(at, layout_name, fields, None, command)
        code = spec.code if spec.code is not None else self._spec.commands[command].code
        return Message(
            f"{command}_{direction.value}",
            command,
            direction,
            address.name,
            address.request if direction is Direction.REQUEST else address.reply,
            self._keys(command, code),
            tuple(spec.accept or ()),
            (),
            self._spec.bus.dlc if spec.dlc is None else spec.dlc,
            bool(spec.remote),
            layout,
            path,
        )

    def _keys(self, command: str, code: int | None) -> tuple[Key, ...]:
        if code is None:
            return ()
        selector = self._spec.selector
        if selector is None:
            path: Path = ("commands", command, "code")
            self._context.report(path, "no-selector", "there is a code, but no `selector` that says where it stands")
            return ()
        order = selector.byte_order or self._spec.byte_order
        _, width = selector.raw
        if code >= 1 << width:
            self._context.report(
                ("commands", command, "code"), "code-width", f"0x{code:X} does not fit the selector's {width} bits"
            )
        return (Key("code", selector.at.space, order, width, _segments(selector.at, width, order), code),)

    def _layout(
        self, path: Path, name: str, fields: schema.Fields, shared: schema.LayoutSpec | None, command: str = ""
    ) -> Layout:
        owner: schema.LayoutSpec | schema.Command = shared or self._spec.commands[command]
        manual = owner.manual or ""
        where = (*path, "fields") if shared else path
        resolved = tuple(self._field((*where, n), n, f, manual) for n, f in fields.items())
        conditions = dict.fromkeys(p for f in fields.values() for p in f.only or {})
        if len(conditions) > 1:
            names = ", ".join(conditions)
            self._context.report(path, "two-parameters", f"the fields of one layout depend on {names}; one is allowed")
        parameter = next(iter(conditions), None)
        return Layout(
            name,
            resolved,
            parameter,
            self._variants(resolved, parameter),
            shared is not None,
            self._context.title(path if shared else ("commands", command), owner.title, name),
            self._context.text((*path, "about"), shared.about if shared else None),
            manual,
            path,
        )

    def _variants(self, fields: tuple[Field, ...], parameter: str | None) -> tuple[Variant, ...]:
        if parameter is None or parameter not in self._parameters:
            return (Variant((), fields),)
        groups: dict[tuple[str, ...], tuple[list[str], tuple[Field, ...]]] = {}
        for value in self._parameters[parameter].values:
            present = tuple(f for f in fields if not f.only or value.name in f.only)
            names, _ = groups.setdefault(tuple(f.name for f in present), ([], present))
            names.append(value.name)
        return tuple(Variant(tuple(names), present) for names, present in groups.values())

    def _field(self, path: Path, name: str, written: schema.FieldSpec, manual: str) -> Field:
        type_ = self._type(path, written)
        start, count = written.at, len(written.array) if written.array else 1
        elements = []
        for i in range(count):
            bits = frame_bits(start, type_.width * count, type_.order)
            offset = i * type_.width if type_.order is Order.LITTLE or start.space is Space.ID else None
            first = offset if offset is not None else type_.width * (count - 1 - i)
            elements.append(
                Element(
                    written.array[i] if written.array else None,
                    segments_of(bits[first : first + type_.width], start.space),
                )
            )
        title = type_.title if written.title is None else self._context.text((*path, "title"), written.title)
        if not any(title.values()):
            title = self._context.title(path, None, name)
        return Field(
            name,
            type_,
            start.space,
            tuple(elements),
            written.array is not None,
            tuple(v for values in self.only(path, written.only).values() for v in values),
            written.constant,
            title,
            self._context.text((*path, "about"), written.about),
            written.manual or manual,
            path,
        )

    def _type(self, path: Path, written: schema.FieldSpec) -> Type:
        if (written.type is None) == (written.raw is None):
            self._context.report(path, "field-type", "a field must have either `type` or `raw`", key=True)
        if written.raw is not None:
            bare = bare_type(self._context, written.raw, self._spec.byte_order, path)
            return self.bare_types.setdefault(bare.name, bare)
        found = self._context.find((*path, "type"), "type", written.type, self._types) if written.type else None
        return found or bare_type(self._context, schema.EMPTY_RAW, self._spec.byte_order, path)

    def with_claims(self, commands: Sequence[Command]) -> tuple[Command, ...]:
        """The commands with `claims` filled in: which codes stand for which message when nothing else is known."""
        claims: dict[str, list[int]] = {}
        for direction in Direction:
            messages = [(c, c.request if direction is Direction.REQUEST else c.reply) for c in commands]
            own = [(c.code, m) for c, m in messages if m is not None and m.command == c.name and m.keys]
            taken: set[tuple[object, ...]] = set()
            by_right = [(m.keys[0].value, m) for code, m in own if code == m.keys[0].value]
            by_sending = [(m.keys[0].value, m) for _, m in own]
            by_accepting = [(value, m) for _, m in own for value in m.accept]
            for value, message in by_right + by_sending + by_accepting:
                place = (message.id, message.remote, tuple((k.segments, k.value) for k in message.keys[1:]), value)
                if place not in taken:
                    taken.add(place)
                    claims.setdefault(message.name, []).append(value)

        def claimed(message: Message | None) -> Message | None:
            return message and dataclasses.replace(message, claims=tuple(claims.get(message.name, ())))

        return tuple(dataclasses.replace(c, request=claimed(c.request), reply=claimed(c.reply)) for c in commands)


def _segments(start: At, width: int, order: Order) -> tuple[Segment, ...]:
    return segments_of(frame_bits(start, width, order), start.space)


def segments_of(bits: Sequence[int], space: Space) -> tuple[Segment, ...]:
    """Runs of frame bits, from the least significant raw bit up, as segments within one byte each."""
    if space is Space.ID:
        return (Segment(0, bits[0], len(bits), 0),)
    segments: list[Segment] = []
    for raw, bit in enumerate(bits):
        last = segments[-1] if segments else None
        if last and last.byte == bit // 8 and last.low + last.width == bit % 8:
            segments[-1] = dataclasses.replace(last, width=last.width + 1)
        else:
            segments.append(Segment(bit // 8, bit % 8, 1, raw))
    return tuple(segments)
