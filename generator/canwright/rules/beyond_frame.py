"""Every field lies within the data bytes or the bits of the id."""

from __future__ import annotations

from ..diagnostics.diagnostic import DocumentPath
from ..model.layout import Field, Segment, Space
from ..model.message import KeyRole, Message
from ..model.types import Order
from .byte_order import highest_byte
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    most = subject.edition.bus.frame_format.max_data_bytes
    seen: set[DocumentPath | str | tuple[str, tuple[Segment, ...]]] = set()
    for message in subject.edition.all_messages():
        limit = {Space.DATA: 0 if message.remote else message.dlc * 8, Space.ID: 29 if message.id.extended else 11}
        for field in message.layout.fields:
            last = max(s.byte * 8 + s.low + s.width for e in field.elements for s in e.segments)
            if last > limit[field.space] and field.path not in seen:
                seen.add(field.path)
                yield _beyond(message, field, limit[field.space], most)
        for key in message.keys:
            last = max(s.byte * 8 + s.low + s.width for s in key.segments)
            if last <= limit[key.space]:
                continue
            is_code, address = key.role is KeyRole.CODE, subject.spec.addresses[message.address]
            if is_code and not (address.selector or address.reply_selector) and last > _bits(key.space, most):
                if "selector" not in seen:
                    yield Finding(
                        ("selector", "at"),
                        "this selector is beyond the end of every frame",
                        f"`at` counts bytes: write 0 to {most - 1}",
                    )
                seen.add("selector")
            else:
                name = "selector" if is_code else key.name
                if key.space is Space.ID:
                    if (message.address, key.segments) not in seen:
                        yield _short_id(message, name, limit[Space.ID])
                    seen.add((message.address, key.segments))
                    continue
                text = f"the frame has only {message.dlc} data bytes; its {name} is beyond them"
                if message.remote:
                    text = f"a remote frame has no data bytes for a {name}"
                hint = "remove `code` or `remote`" if message.remote else "check `dlc`"
                yield Finding((*message.path, "remote" if message.remote else "dlc"), text, hint)


def _bits(space: Space, most: int) -> int:
    """The maximum number of bits of a frame."""
    return 8 * most if space is Space.DATA else 29


def _short_id(message: Message, name: str, bits: int) -> Finding:
    text = f"the ids of `{message.address}` have only {bits} bits; the {name} is beyond them"
    longer = "" if message.id.extended else "; `extended: true` has 29 bits"
    return Finding(("addresses", message.address), text, f"check `at` and `raw` of the {name}{longer}", key=True)


def _beyond(message: Message, field: Field, limit: int, most: int) -> Finding:
    bits = [bit for e in field.elements for bit in e.bits]
    at: DocumentPath = (*field.path, "at")
    if field.space is Space.ID:
        text = f"`{field.name}` uses bits {min(bits)} to {max(bits)} of the id, but the id has {limit}"
        longer = "" if message.id.extended else "; `extended: true` of the address has 29 bits"
        return Finding(at, text, f"check `at` and the type{longer}")
    first, last = min(bits) // 8, max(bits) // 8
    used = f"byte {first}" if first == last else f"bytes {first} to {last}"
    available = f"has bytes 0 to {message.dlc - 1}" if message.dlc else "has no data"
    available = "is a remote frame without data" if message.remote else available
    hint = "check `at`, the type and `dlc`"
    if most <= first < most * 8:
        hint = f"`at` counts bytes from 0 to {most - 1}; bit {first} is in byte {first // 8}"
    elif (start := highest_byte(field)) is not None and first < message.dlc:
        hint = f"`at` is the first, highest byte of a big-endian field: write at: {start} for bytes {start} to {first}"
    elif (
        field.type.order is Order.BIG and field.elements[0].segments[-1].low + field.elements[0].segments[-1].width < 8
    ):
        hint = "`at` is the highest bit of a big-endian field; check it, the type and `dlc`"
    return Finding(at, f"`{field.name}` uses {used}, but the frame {available}", hint)
