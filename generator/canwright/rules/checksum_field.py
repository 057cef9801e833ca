"""A message has at most one checksum: an unsigned number in the data that always exists, over bytes of the frame."""

from __future__ import annotations

from collections.abc import Iterator

from ..model.checksum import MAX_WIDTH, DataBytes, IdBytes
from ..model.edition import Edition
from ..model.layout import ChecksumRole, Field, Space
from ..model.message import Message
from ..model.types import Encoding
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    reported = set()
    for message in subject.edition.all_messages():
        fields = [(f, f.checksum) for f in message.layout.fields if f.checksum]
        for i, (field, role) in enumerate(fields):
            problems = _problems(subject.edition, message, field, role)
            first = (f"`{fields[0][0].name}` is already a checksum", "a frame has one") if i else next(problems, None)
            if first is not None and field.path not in reported:
                reported.add(field.path)
                yield Finding((*field.path, ChecksumRole.key), *first, key=True)


def _problems(edition: Edition, message: Message, field: Field, role: ChecksumRole) -> Iterator[tuple[str, str]]:
    """What is wrong, and what to write."""
    name, width = field.name, field.type.width
    if field.is_array or field.only or field.space is Space.ID:
        text = f"`{name}` cannot be a checksum: it is in the id, an array, or depends on a parameter"
        yield text, "use a number in the data that always exists"
    if not field.type.is_plain or field.type.encoding is not Encoding.UNSIGNED or width > MAX_WIDTH:
        text = (
            f"`{name}` cannot be a checksum: it is not an unsigned number of at most {MAX_WIDTH} bits without a scale"
        )
        yield text, "write, for example, raw: u8"
    if role.algorithm.width != width:
        text = f"`{role.name}` has {role.algorithm.width} bits, but `{name}` has {width}"
        yield text, f"write raw: u{role.algorithm.width}, or another algorithm"
    numbers = {"poly": role.algorithm.poly, "init": role.algorithm.init, "xor_out": role.algorithm.xor_out}
    for key in (key for key, number in numbers.items() if number >> width):
        yield f"`{key}` is 0x{numbers[key]:X}, more than the {width} bits of `{name}`", f"check `{key}` and the width"
    last = max((part.last for part in role.inputs if isinstance(part, DataBytes)), default=-1)
    if last >= message.dlc:
        yield (
            f"{message.name} has no data byte {last}, which the checksum includes",
            f"its last byte is {message.dlc - 1}",
        )
    if any(isinstance(part, IdBytes) for part in role.inputs):
        yield from _id_problems(edition, message, field)


def _id_problems(edition: Edition, message: Message, field: Field) -> Iterator[tuple[str, str]]:
    if len({sharing.id.extended for sharing in edition.of_layout(message.layout)}) > 1:
        text = f"`{field.name}` includes the id, but is in messages with ids of 11 and of 29 bits"
        yield text, "define a separate layout for each"
    command = edition.command(message.command)
    if command.is_echoed and command.request and command.reply and command.request.id != command.reply.id:
        text = f"the reply of {command.name} is an echo, but its id differs, and `{field.name}` includes the id"
        yield text, "write the layout of the reply instead of `echo`"
