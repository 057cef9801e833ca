"""Resolver of messages: keys, tables, forms of commands and replies."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ..diagnostics.diagnostic import DocumentPath, nearest
from ..language import edition as schema
from ..language.sending import sending_of
from ..model.layout import Layout
from ..model.message import (
    Address,
    Direction,
    EchoReply,
    FrameSequence,
    Key,
    KeyRole,
    Message,
    OtherReply,
    OwnReply,
    Reply,
    SharedReply,
)
from .layouts import LayoutResolver, segments_at
from .report import Limited, Report
from .titles import titled

LONGEST_CHAIN = 20
"""The maximum length of a chain of commands that use the reply of the next one."""


@dataclass(frozen=True)
class CommandForm:
    """A command, or its variant for one entry of a table."""

    command: str
    entry: str | None
    layout: Layout | None
    keys: tuple[Key, ...]
    kind: str | None = None
    dlc: int | None = None

    @property
    def name(self) -> str:
        return self.command if self.entry is None else f"{self.command}_{self.entry}"


class MessageResolver:
    """Resolver of shared layouts, and of the messages of each command on demand."""

    def __init__(
        self,
        report: Report,
        spec: schema.EditionSpec,
        layouts: LayoutResolver,
        addresses: Mapping[str, Address],
    ) -> None:
        self._report = report
        self._spec = spec
        self._resolver = layouts
        self._addresses = addresses
        self._largest_node = max(map(_largest_node, addresses.values()), default=0)
        self._pending: list[str] = []
        self._lacks_selector = False
        self._done: dict[tuple[str, str | None], tuple[Message | None, tuple[Reply, ...]]] = {}
        self._shared = {
            name: layouts.shared(("layouts", name), name, written, ("layouts", name, "fields"))
            for name, written in spec.layouts.items()
        }
        self._tables = {name: self._entries(name, written) for name, written in spec.tables.items()}

    @property
    def layouts(self) -> tuple[Layout, ...]:
        """The shared layouts, including those of table entries."""
        of_entries = (entry.layout for table in self._tables.values() for entry in table.values())
        own = {layout.name: layout for layout in of_entries if layout}
        return tuple({**self._shared, **own}.values())

    def forms(self, command: str) -> list[CommandForm]:
        """The forms of a command: one, or one for each entry of its table."""
        name = self._spec.commands[command].table
        if name is None:
            return [CommandForm(command, None, None, ())]
        return [
            dataclasses.replace(form, command=command)
            for entry, form in self._tables[name].items()
            if command in (self._spec.tables[name].entries[entry].commands or (command,))
        ]

    def address_of(self, command: str) -> str:
        """The address of a command."""
        return self._spec.commands[command].address or next(iter(self._addresses))

    def of(self, form: CommandForm) -> tuple[Message | None, tuple[Reply, ...]]:
        """Request and replies of a command."""
        request, replies = self._with_reply(form)
        return request, (*replies, *self._further(form)) if request and replies else replies

    def _with_reply(self, form: CommandForm) -> tuple[Message | None, tuple[Reply, ...]]:
        """The request and the first reply."""
        key = (form.command, form.entry)
        if key not in self._done:
            self._pending.append(form.command)
            self._done[key] = self._resolve(form)
            self._pending.pop()
        return self._done[key]

    def _resolve(self, form: CommandForm) -> tuple[Message | None, tuple[Reply, ...]]:
        written = self._spec.commands[form.command]
        echo = written.reply == "echo"
        request = None
        if written.request != "none":
            name = form.name if echo else f"{form.name}_request"
            request = self._message(form, Direction.REQUEST, name, written.request or {})
        return request, self._replies(form, request)

    def _replies(self, form: CommandForm, request: Message | None) -> tuple[Reply, ...]:
        path: DocumentPath = ("commands", form.command, "reply")
        written = self._spec.commands[form.command].reply
        if written is None or written == "none":
            return ()
        if written == "echo" and request is not None:
            reply = self._message(form, Direction.REPLY, form.name, {})
            return (EchoReply(message=dataclasses.replace(reply, layout=request.layout, dlc=request.dlc)),)
        if isinstance(written, schema.MessageSpec) and written.of is not None:
            return self._other((*path, "of"), form, written.of, self._from_each(path, written))
        message = self._message(form, Direction.REPLY, f"{form.name}_reply", written)
        form_of_reply = SharedReply if message.layout.shared else OwnReply
        from_each = self._from_each(path, written) if isinstance(written, schema.MessageSpec) else ()
        return (form_of_reply(message=message, from_each=from_each),)

    def _from_each(self, path: DocumentPath, written: schema.MessageSpec) -> tuple[int, ...]:
        """The nodes that reply."""
        nodes = written.from_each or range(0)
        self._report.count(Limited.REPLIES, len(nodes), (*path, "from_each"))
        return tuple(nodes)

    def _further(self, form: CommandForm) -> Iterator[Reply]:
        """The replies of other commands that follow the reply or come instead; each once, those of the address last."""
        written, path = self._spec.commands[form.command], ("commands", form.command)
        address = self.address_of(form.command)
        shared = self._spec.addresses[address].alternative_replies
        named = [((*path, key, i), of) for key in schema.FURTHER_REPLIES for i, of in enumerate(getattr(written, key))]
        named += [(("addresses", address, "alternative_replies", i), of) for i, of in enumerate(shared)]
        known = {form.command}
        for at, of in named:
            if at[0] == "commands" and of in known:
                itself = of == form.command
                text = "this is the command itself" if itself else f"`{of}` is repeated"
                self._report.finding(at, "circular-reference" if itself else "no-effect", text, "remove it")
            elif self._spec.commands[of].reply in (None, "none"):
                self._report.finding(at, "missing-reply", f"`{of}` has no reply", "name a command with a reply")
            elif of not in known:
                known.add(of)
                replies = self._other(at, form, of, ())
                is_alternative = schema.FURTHER_REPLIES[0] not in at
                yield from (dataclasses.replace(reply, is_alternative=is_alternative) for reply in replies)

    def _other(
        self, path: DocumentPath, form: CommandForm, of: str, from_each: tuple[int, ...]
    ) -> tuple[OtherReply, ...]:
        """The reply of the command `of`, which is named at a path."""
        if of in self._pending:
            in_turn = of != self._pending[-1]
            text = f"`{of}` uses the reply of this command" if in_turn else "this command refers to its own reply"
            hint = "define the reply of one of them" if in_turn else "define the reply"
            self._report.finding(path, "circular-reference", text, hint)
            return ()
        if len(self._pending) > LONGEST_CHAIN:
            text = f"more than {LONGEST_CHAIN} commands in a chain use the reply of the next one"
            self._report.finding(path, "circular-reference", text, "write the command that defines the reply")
            return ()
        other_form = self._other_form(path, form, of)
        if other_form is None:
            return ()
        replies = self._with_reply(other_form)[1]
        return tuple(OtherReply(message=r.message, from_each=from_each, of=other_form.name) for r in replies)

    def _other_form(self, path: DocumentPath, form: CommandForm, of: str) -> CommandForm | None:
        """The form of the command `of` with the reply: if it has a table, the form of the same entry."""
        table = self._spec.commands[of].table
        if table is None:
            return CommandForm(of, None, None, ())
        if table != self._spec.commands[form.command].table:
            hint = f"write `table: {table}` in this command, too, or write the name of a layout"
            self._report.finding(path, "reply-of-table", f"`{of}` has a separate reply for each table entry", hint)
            return None
        same_entry = next((same for same in self.forms(of) if same.entry == form.entry), None)
        if same_entry is None:
            at: DocumentPath = ("tables", table, "entries", form.entry or "", "commands")
            hint = f"add `{of}` to its `commands`, or define the reply of `{form.command}`"
            text = f"`{form.command}` uses the reply of `{of}`, which has no `{form.entry}`"
            self._report.finding(at, "reply-of-table", text, hint)
        return same_entry

    def _message(
        self,
        form: CommandForm,
        direction: Direction,
        layout_name: str,
        written: str | schema.Fields | schema.MessageSpec,
    ) -> Message:
        command = form.command
        path: DocumentPath = ("commands", command, direction.value)
        spec = written if isinstance(written, schema.MessageSpec) else schema.MessageSpec(layout=written)
        address = self._addresses[spec.address or self.address_of(command)]
        if spec.layout == schema.ENTRY and form.layout is not None:
            layout = form.layout
        elif isinstance(spec.layout, str):
            layout = self._shared[spec.layout]
        else:
            at = (*path, "layout") if isinstance(written, schema.MessageSpec) else path
            layout = self._own(at, layout_name, spec.layout or {}, command)
        if spec.fields:
            layout = self._resolver.joined((*path, "fields"), layout_name, layout, spec.fields)
        of_entry = form.dlc if spec.layout == schema.ENTRY else None
        code = self.code_of(form) if spec.code is None else self._code(form, spec.code)
        keys = self._keys(command, code, address.name, direction)
        for i, further in enumerate(spec.accept or ()):
            for key in keys:
                self._fits(further, key.width, (*path, "accept", i))
        return Message(
            name=f"{form.name}_{direction.value}",
            command=form.name,
            direction=direction,
            address=address.name,
            id=address.rule(direction),
            keys=(*keys, *form.keys),
            accepted_codes=tuple(spec.accept or ()),
            identifying_codes=(),
            only={},
            dlc=self._dlc(path, spec, of_entry),
            remote=bool(spec.remote),
            sending=sending_of(
                spec, answers=direction is Direction.REPLY and self._spec.commands[command].request != "none"
            ),
            sequence=next((FrameSequence(field=name, numbers=n) for name, n in (spec.frames or {}).items()), None),
            layout=layout,
            largest_node=_largest_node(address) or self._largest_node,
            path=path,
        )

    def _dlc(self, path: DocumentPath, spec: schema.MessageSpec, of_entry: int | None) -> int:
        return next(dlc for dlc in (of_entry, spec.dlc, self._spec.bus.dlc) if dlc is not None)

    def code_of(self, form: CommandForm) -> int | None:
        """The code of a command, or its code for the kind of an entry."""
        return self._code(form, self._spec.commands[form.command].code)

    def _code(self, form: CommandForm, written: schema.Code | None) -> int | None:
        if not isinstance(written, dict):
            return written
        at: DocumentPath = ("tables", self._spec.commands[form.command].table or "", "entries", form.entry or "")
        if form.kind is None:
            text = f"`{form.entry}` has no `kind`, but the code of `{form.command}` depends on it"
            self._report.finding(at, "missing-key", text, f"write kind: {' or '.join(written)}", key=True)
        elif form.kind not in written:
            text = f"there is no code of `{form.command}` for the kind `{form.kind}`"
            self._report.finding((*at, "kind"), "unknown-reference", text, nearest(form.kind, written))
        return written.get(form.kind or "")

    def _own(self, path: DocumentPath, name: str, fields: schema.Fields, command: str) -> Layout:
        written = self._spec.commands[command]
        return self._resolver.own(path, name, fields, titled(written.title, name), written.manual or "")

    def _keys(self, command: str, code: int | None, address: str, direction: Direction) -> tuple[Key, ...]:
        if code is None:
            return ()
        path: DocumentPath = ("commands", command, "code")
        here = self._spec.addresses[address]
        of_reply = here.reply_selector if direction is Direction.REPLY else None
        selector = of_reply or here.selector or self._spec.selector
        if selector is None:
            if not self._lacks_selector:
                text = "there is a code, but no `selector` for its position"
                self._report.finding(path, "no-selector", text, "write, for example, selector: {at: 0, raw: u8}")
            self._lacks_selector = True
            return ()
        return (self._key("code", KeyRole.CODE, selector, code, path),)

    def _key(self, name: str, role: KeyRole, selector: schema.Selector, value: int, path: DocumentPath) -> Key:
        order = selector.byte_order or self._spec.byte_order
        width = selector.raw.width
        self._fits(value, width, path)
        return Key(
            name=name,
            role=role,
            space=selector.at.space,
            order=order,
            width=width,
            segments=segments_at(selector.at, width, order),
            value=value,
        )

    def _fits(self, value: int, width: int, path: DocumentPath) -> None:
        if value >= 1 << width:
            text = f"0x{value:X} exceeds 0x{(1 << width) - 1:X}, the maximum of the {width}-bit selector"
            self._report.finding(path, "code-width", text, "check the value, and `raw` of the selector")

    def _entries(self, table: str, written: schema.TableSpec) -> dict[str, CommandForm]:
        selectors = written.index if isinstance(written.index, list) else [written.index]
        of_table = [command for command, spec in self._spec.commands.items() if spec.table == table]
        entries = {}
        for name, entry in written.entries.items():
            path: DocumentPath = ("tables", table, "entries", name)
            for i, command in enumerate(entry.commands or ()):
                if command not in of_table:
                    text = f"`{command}` is not a command of the table `{table}`"
                    self._report.finding((*path, "commands", i), "unknown-reference", text, nearest(command, of_table))
            layout = self._entry_layout(path, f"{table}_{name}", written, entry)
            values = entry.index if isinstance(entry.index, list) else [entry.index]
            if len(values) > len(selectors):
                text = f"`{name}` has {len(values)} index values, but the table has {len(selectors)}"
                self._report.finding(
                    (*path, "index"), "too-many-values", text, "write the `index` of the table as a list"
                )
            places = ((*path, "index", i) if isinstance(entry.index, list) else (*path, "index") for i in range(9))
            keys = (
                self._key("index" if i == 0 else f"index_{i + 1}", KeyRole.INDEX, selector, value, place)
                for i, (selector, value, place) in enumerate(zip(selectors, values, places, strict=False))
            )
            entries[name] = CommandForm("", name, layout, tuple(keys), entry.kind, entry.dlc)
        return entries

    def _entry_layout(self, path: DocumentPath, name: str, table: schema.TableSpec, entry: schema.EntrySpec) -> Layout:
        if isinstance(entry.layout, str):
            return self._shared[entry.layout]
        manual = entry.manual or table.manual
        written = schema.LayoutSpec(title=entry.title, about=entry.about, fields=entry.layout, manual=manual)
        return self._resolver.shared(path, name, written, (*path, "layout"))


def _largest_node(address: Address) -> int:
    """The largest node in the ids of an address; 0 if they have no nodes."""
    return max(rule.nodes[-1] if rule.nodes else 0 for rule in (address.request, address.reply))
