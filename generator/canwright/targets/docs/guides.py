"""Pages that help to start: quick start, editions by one frame, bus load, words."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame
from ...model.message import Direction
from ...semantics.bus_load import message_bits
from ...semantics.decoder import Decoder, Rejection
from ...semantics.frame import can_frame
from ...templating.markup import code, markdown, script_text
from .common import Common, Sheet
from .links import COMMANDS


def first_sheet(common: Common) -> Sheet | None:
    """The command for the quick start: without effects where there is one, and with most values in its reply."""
    candidates = [sheet for sheet in common.sheets if sheet.programs and sheet.forms[0].command.entry is None]
    return max(candidates, key=_helpfulness, default=None)


def _helpfulness(sheet: Sheet) -> tuple[bool, bool, int]:
    exchange = sheet.exchange
    values = len(exchange.reply.values) if exchange and exchange.reply else 0
    return not sheet.forms[0].command.effects, exchange is not None and exchange.is_answered, values


class Start(NamedTuple):
    """The quick start of an edition: its programs by target."""

    edition: Edition
    folder: str
    sheet: Sheet


def starts(listed: Sequence[tuple[str, Common]]) -> Iterator[Start]:
    """One for each family, with its newest edition; `listed` are the editions with their folders, oldest first."""
    newest = {common.edition.family: (folder, common) for folder, common in listed}
    for folder, common in newest.values():
        sheet = first_sheet(common)
        if sheet is not None:
            yield Start(common.edition, folder, sheet)


class Telling(NamedTuple):
    """A golden frame that only one edition of a family explains; the cells are Markdown."""

    edition: Edition
    folder: str
    frame: str
    command: str


def telling_frames(listed: Sequence[tuple[str, Common]]) -> Iterator[Telling]:
    """For each edition the first shown reply that no other edition of its family decodes, also not as a request."""
    for folder, common in listed:
        edition = common.edition
        of_family = [member.edition for _, member in listed if member.edition.family == edition.family]
        decoders = [Decoder(member) for member in of_family if member is not edition]
        for sheet in common.sheets if decoders else ():
            frames = [x.golden for form in sheet.forms for d, side in form.sides if side for x in side.examples]
            own = [f for f in frames if f.direction is Direction.REPLY]
            telling = next((f for f in own if all(_is_rejected(decoder, f) for decoder in decoders)), None)
            if telling:
                yield Telling(
                    edition,
                    folder,
                    code(formatting.sent(telling)),
                    f"[{markdown(sheet.name)}]({folder}/{COMMANDS}{sheet.name}.md)",
                )
                break


def _is_rejected(decoder: Decoder, frame: GoldenFrame) -> bool:
    return all(isinstance(decoder.decode(way, can_frame(frame), frame.parameters), Rejection) for way in Direction)


class Length(NamedTuple):
    """Frames of one length: the kind of id and of frame, the number of data bytes, and the bits on the bus."""

    extended: bool
    is_fd: bool
    data_bytes: int
    least: int
    most: int


def lengths(editions: Sequence[Edition]) -> Sequence[Length]:
    """The lengths of the frames of some editions."""
    messages = [(message, edition.bus.frame_format) for edition in editions for message in edition.all_messages()]
    return sorted({Length(m.id.extended, form.is_fd, m.length, *message_bits(m, form)) for m, form in messages})


def load_data(listed: Sequence[tuple[str, Edition]], language: str) -> str:
    """The data of the calculator as JSON that HTML can contain."""
    data = [_load(edition, language) for _, edition in listed]
    return script_text(json.dumps(data, separators=(",", ":")))


def _load(edition: Edition, language: str) -> Mapping[str, Any]:
    within = edition.bus.reply_within_ms
    rates = sorted({rate for mode in edition.bus.modes for rate in mode.bit_rates_kbps}, reverse=True)
    listed = [forms[0] for forms in edition.groups.values()]
    first = next((c for c in listed if all(m and m.layout.fields for m in (c.request, c.reply))), None)
    return {
        "edition": f"{edition.family} {edition.name}",
        "usual": listed.index(first) if first else 0,
        "rates": rates or [1000, 500, 250, 125],
        "replyMs": None if within is None else float(within),
        "nodes": edition.bus.max_nodes or 1,
        "cyclic": [
            {
                "name": message.name,
                "everyMs": float(message.sending.every_ms),
                "perNode": message.id.nodes is not None or message.node_bits is not None,
                "bits": message_bits(message, edition.bus.frame_format),
            }
            for message in edition.all_messages()
            if message.sending is not None and message.sending.every_ms is not None
        ],
        "commands": [
            {
                "name": command.spec_name,
                "title": command.spec_title[language],
                "perNode": command.request is None or command.request.id.nodes is not None,
                "request": message_bits(command.request, edition.bus.frame_format) if command.request else None,
                "reply": message_bits(command.reply, edition.bus.frame_format) if command.reply else None,
                "replies": (len(command.from_each) or 1) if command.reply else 0,
            }
            for command in listed
        ],
    }


def words(edition: Edition) -> Iterator[tuple[str, Any]]:
    """The named items of an edition, each with its kind."""
    kinds: Sequence[tuple[str, Sequence[Any]]] = (
        ("type", [t for t in edition.types if t.path[0] == "types"]),
        ("parameter", edition.parameters),
        ("setting", edition.settings),
        ("effect", edition.effects),
        ("state", edition.states),
        ("mode", edition.bus.modes),
        ("neighbour", edition.bus.neighbours),
    )
    return ((kind, item) for kind, items in kinds for item in items)
