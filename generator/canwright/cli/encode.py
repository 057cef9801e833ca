"""`encode`."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path

import click

from ..diagnostics.diagnostic import nearest
from ..diagnostics.unicode_safety import visible
from ..language import notation
from ..model import formatting
from ..model.edition import Edition
from ..model.golden_frames import Value
from ..model.joined import JoinedText
from ..model.layout import Field
from ..model.message import Direction, Message
from ..model.refusal import Refusal
from ..model.types import Assignment, Bound, Encoding, Range, Type
from ..recordings.explain import meanings
from ..semantics.configured import configured
from ..semantics.decoder import Rejection, linear_of
from ..semantics.encoder import SPECIAL, Encoder
from ..semantics.frame import CanFrame, Raw
from .command_view import find
from .common import FINDINGS, of_edition, read, spec_option, stop
from .explain_view import edition_names, meaning_text
from .settings import assignment, known_values
from .terminal import print_text

_RAW = "raw:"


@click.command()
@click.argument("command")
@click.argument("values", nargs=-1, metavar="[FIELD=VALUE]...")
@spec_option
@click.option("--node", type=int, help="The node that the frame is sent to, or that a reply comes from.")
@click.option("--edition", help="The edition.  [default: all with this command]")
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="PARAMETER=VALUE",
    help="A parameter that ids or fields depend on.",
)
@click.option("--reply", is_flag=True, help="Encode the reply of the node, not the request.")
def encode(
    command: str,
    values: Sequence[str],
    specs: Sequence[Path],
    node: int | None,
    edition: str | None,
    settings: Sequence[str],
    reply: bool,
) -> None:
    """Print the frame of a COMMAND, ready for cansend, and what it means.

    COMMAND is a name or a code (0x10). A VALUE is a number in the unit of its field (2.5, -3, 33/2048), a name, or a list
    of them (1,2,3); `raw:155` is the integer in the frame. A value is rounded to what the frame can hold; the table
    shows what is sent. Nothing is sent.

    \b
      canwright encode dim level=50 --node 1
      canwright encode dim level=raw:500 --node 1 --set size=12

    Exit status: 0 if every edition encodes the frame, 1 if one refuses it, 2 if the command could not run.
    """
    specifications = read(specs, packaged=True)
    given = assignment(specifications, settings)
    chosen = of_edition(specifications, edition)
    pairs, hint = find([configured(item.edition, given) for item in chosen], command)
    if not pairs:
        stop(f"there is no command `{command}`; {hint}")
    direction = Direction.REPLY if reply else Direction.REQUEST
    try:
        written = written_values(values)
    except ValueError as error:
        stop(str(error))
    sent: dict[tuple[str, str], list[Edition]] = {}
    refused: dict[str, list[Edition]] = {}
    for having, shown in pairs:
        message = shown.reply if reply else shown.request
        if message is None:
            refused.setdefault(f"{shown.name} has no {direction.value}", []).append(having)
            continue
        result = encoded(having, message, node, written, given)
        if isinstance(result, CanFrame):
            sent.setdefault((meaning_of(having, message, result, given), formatting.sent(result)), []).append(having)
        else:
            refused.setdefault(result, []).append(having)
    blocks = []
    for (meaning, frame), encoding in sent.items():
        head, _, table = meaning.partition("\n")
        blocks.append(f"{head}\n  in {edition_names(encoding)}\n{table}  cansend can0 {frame}\n")
    print_text("\n".join(blocks))
    for text, refusing in refused.items():
        print_text(f"canwright: {text}\n  in {edition_names(refusing)}\n", error=True)
    if refused:
        sys.exit(FINDINGS)


def meaning_of(edition: Edition, message: Message, frame: CanFrame, given: Assignment) -> str:
    """What a frame means that was encoded as this message."""
    return next(meaning_text(m) for m in meanings(edition, frame, given) if m.message is message)


def written_values(values: Sequence[str]) -> dict[str, str]:
    """The values as they are written, by field. Raises ValueError for one that is none, or is given twice."""
    result: dict[str, str] = {}
    for item in values:
        name, equals, value = item.partition("=")
        if not equals:
            raise ValueError(f"`{visible(item)}` is not a value; write FIELD=VALUE, for example {visible(item)}=0")
        if result.setdefault(name, value) != value:
            raise ValueError(f"`{visible(name)}` is given twice; remove one")
    return result


def encoded(
    edition: Edition, message: Message, node: int | None, written: Mapping[str, str], given: Assignment
) -> CanFrame | str:
    """The frame, or the reason why there is none."""
    encoder = Encoder(given)
    if node is None and message.id.nodes is not None:
        nodes = f"{message.id.nodes[0]}..{message.id.nodes[-1]}"
        return f"{message.name} needs a node, {nodes}; give it as --node {message.id.nodes[-1]}"
    rejection = encoder.rejects(message, node)
    if rejection:
        return advice(edition, rejection, None, given)
    fields = encoder.fields(message)
    assert fields is not None  # decided by `rejects`
    unknown = next((name for name in written if name not in fields), None)
    if unknown is not None:
        hint = nearest(unknown, fields) or f"its fields are {', '.join(fields) or 'none'}"
        return f"{message.name} has no field `{visible(unknown)}`; {hint}"
    known = {name: node for name, field in fields.items() if field.is_node and node is not None}
    missing = [name for name in fields if name not in written and name not in known]
    if missing:
        listed = "; ".join(f"{name}={_allowed(fields[name], given)}" for name in missing)
        return f"{message.name} lacks {formatting.counted(len(missing), 'value')}: {listed}"
    raws: dict[str, Raw] = {}
    for name, field in fields.items():
        raw = written_raw(encoder, field, written[name]) if name in written else known[name]
        if isinstance(raw, Rejection):
            return f"{name}={visible(written[name])}: {advice(edition, raw, field, given)}"
        if isinstance(raw, str):
            return f"{name}={visible(written[name])}: {raw}"
        raws[name] = raw
    frame = encoder.encode_raws(message, node, raws)
    if isinstance(frame, Rejection):
        return advice(edition, frame, fields.get(frame.field or ""), given)
    return frame


def written_raw(encoder: Encoder, field: Field, text: str) -> Raw | Rejection | str:
    """The raw integer of a value as it is written, or the reason why it is none."""
    try:
        if text.startswith(_RAW):
            raws = [_whole(item) for item in text.removeprefix(_RAW).split(",")]
            return raws if field.is_array else raws[0] if len(raws) == 1 else "write one raw integer"
        return encoder.field_raw(field, _value(field, text))
    except ValueError as error:
        return visible(str(error))


def _whole(text: str) -> int:
    number = notation.number(text.strip())
    if number.denominator != 1:
        raise ValueError(f"`{text}` is not a raw integer; write a whole number, for example raw:155")
    return number.numerator


def _value(field: Field, text: str) -> Value:
    """The value of a field as it is written."""
    type_ = field.type
    if isinstance(type_.joined, JoinedText):
        return text
    if type_.flags:
        return [item.strip() for item in text.split(",") if item.strip()]
    if field.is_array and type_.joined is None:
        return [_single(type_, item.strip()) for item in text.split(",")]
    return _single(type_, text.strip())


def _single(type_: Type, text: str) -> Fraction | str:
    """A name as it is, or else a number."""
    names = [] if type_.flags else [member.name for member in type_.members]
    if text in names or text in SPECIAL:
        return text
    try:
        return notation.rational(text)
    except ValueError:
        if not names:
            raise
        hint = nearest(text, names) or f"its names are {', '.join(names)}"
        raise ValueError(f"there is no value `{text}`; {hint}") from None


def advice(edition: Edition, rejection: Rejection, field: Field | None, given: Assignment) -> str:
    """Why a frame is refused, and what to write."""
    text = visible(rejection.text)
    if rejection.reason is Refusal.MISSING_PARAMETER:
        needed = [p.name for p in edition.parameters if f"`{p.name}`" in text]
        return f"{text}; give --set {' or '.join(known_values([edition], name) for name in needed)}"
    if rejection.reason is Refusal.NO_SCALE and field is not None:
        return f"{text}; give the integer in the frame, for example {field.name}={_RAW}1"
    if rejection.reason is Refusal.OUT_OF_RANGE and field is not None and (allowed := _allowed(field, given)):
        return f"{text}; it takes {allowed}"
    return text


def _allowed(field: Field, given: Assignment) -> str:
    """The values that a field takes: names, or a range in its unit."""
    type_ = field.type
    names = [member.name for member in type_.enum or type_.flags]
    if names:
        return "|".join(names)
    if isinstance(type_.joined, JoinedText):
        return "TEXT"
    limits, linear = type_.raw_range.at(given), linear_of(type_, given)
    unit = f" {type_.unit.symbol}" if type_.unit else ""
    if type_.encoding is Encoding.FLOAT:
        return (_span(limits) if limits else "NUMBER") + unit
    if limits is None:
        low, high = type_.number_limits
        limits = Range(Bound(Fraction(low)), Bound(Fraction(high)))
    if linear is None:
        return f"{_RAW}{_span(limits)}"
    return _span(formatting.in_unit(limits, linear)) + unit


def _span(limits: Range) -> str:
    return formatting.span(limits, formatting.decimal)
