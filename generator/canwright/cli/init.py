"""`init`."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

import click

from ..diagnostics.diagnostic import SpecError
from ..language import notation
from ..model.formatting import spoken
from ..model.types import Order
from ..project.golden_file import as_yaml
from ..project.loader import frames_file, load
from .common import SPEC_FOLDER, show_findings, stop, write_new_files
from .copy import fits
from .terminal import print_text

_SPEC = """\
# A starter: replace the examples by the facts of your manual, then run `canwright check --spec {file}`.
# `canwright explain KEY` describes a key; `canwright show COMMAND --spec {file}` prints the layout of a command.
canwright: 1
family: {family}
edition: {edition}
title: {title}
byte_order: {byte_order}  # of all numbers; a type can have its own

{parameters}# The CAN id of each node: requests go from the host to a node, replies from a node to the host.
addresses:
  node: {{{address}}}

{selector}# value = raw * scale + offset, in the unit. u16 is unsigned with 16 bits, i16 signed, f32 a float.
types:
  speed: {{raw: i16, unit: rpm, scale: 0.1, raw_range: -30000..30000}}
  state: {{raw: u8, enum: {{idle: 0, running: 1, fault: 2}}}}

# `at: 2` is byte 2 of the data, and `at: 2.3` its bit 3. Bits without a field are sent as 0.
commands:
{commands}"""

_SELECTOR = """\
# The position of the code that identifies a command{note}.
selector: {{at: {at}, raw: {width}}}

"""

_NO_SELECTOR = """\
# There is no code: the id identifies a command, so each further command needs an address of its own.

"""

_FRAMES = """\
# Golden frames: bytes and the values that they mean, from a manual, a log or a program of the manufacturer.
# These belong to the commands of the starter: remove each with its command. Then `canwright frames {file}`
# prints an entry for each new request and reply.
canwright: 1
family: {family}
edition: {edition}
sources:
  starter: Bytes of the starter of canwright. Replace them by examples of the manual.
frames:
{frames}"""

_COMMANDS = {
    "read_state": """\
    reply:
      state: {at: 1, type: state}
      speed: {at: 2, type: speed}
""",
    "set_speed": """\
    request: {speed: {at: 2, type: speed}}
    reply: echo  # the node sends the request back; `none` if it sends nothing
""",
    "state": """\
    request: none  # nodes send it by themselves
    reply:
      every_ms: 100
      fields:
        state: {at: 1, type: state}
        speed: {at: 2, type: speed}
""",
    "speed_limit": """\
    request: none
    reply: {speed: {at: 2, type: speed}}
""",
}
"""The commands of starters by name, without their codes."""

_Bytes = Mapping[str, str]
_ZERO: _Bytes = {"little": "00 00 00 00 00 00 00", "big": "00 00 00 00 00 00 00"}
_RUNNING: _Bytes = {"little": "01 D4 FE 00 00 00 00", "big": "01 FE D4 00 00 00 00"}
_SPEED: _Bytes = {"little": "00 2C 01 00 00 00 00", "big": "00 01 2C 00 00 00 00"}
_EXAMPLES: Mapping[str, Sequence[tuple[str, _Bytes, str]]] = {
    "read_state": (("request", _ZERO, ""), ("reply", _RUNNING, " values: {state: running, speed: -30},")),
    "set_speed": (("request", _SPEED, " values: {speed: 30},"), ("reply", _SPEED, " values: {speed: 30},")),
    "state": (("reply", _RUNNING, " values: {state: running, speed: -30},"),),
    "speed_limit": (("reply", _SPEED, " values: {speed: 30},"),),
}
"""The golden frames of each command: direction, bytes after byte 0 in each byte order, values.

The bytes are written by hand: they prove that the starter is correct.
"""


@click.command()
@click.argument("family")
@click.option("--edition", default="v1", show_default=True, help="The label of the protocol version.")
@click.option("--id", "id_rule", metavar="RULE", help="The id of requests: '0x300 + node', 'node << 5', 0x200.")
@click.option("--reply-id", metavar="RULE", help="The id of replies.  [default: that of requests]")
@click.option("--nodes", default="1..32", show_default=True, help="The first and the last node.")
@click.option("--extended", is_flag=True, help="The ids have 29 bits instead of 11.")
@click.option(
    "--code",
    type=click.Choice(["data", "id", "none"]),
    default="data",
    show_default=True,
    help="Where the command code is: in byte 0 of the data, in the id, so that each command has its own, or nowhere.",
)
@click.option("--broadcast", is_flag=True, help="Nodes send frames without a request, such as a status every 100 ms.")
@click.option(
    "--byte-order",
    type=click.Choice([order.value for order in Order]),
    default=Order.LITTLE.value,
    show_default=True,
    help="Whether the low or the high byte of a number is sent first.",
)
@click.option("--folder", type=click.Path(path_type=Path), help="The folder for both files.  [default: spec/FAMILY]")
def init(
    family: str,
    edition: str,
    id_rule: str | None,
    reply_id: str | None,
    nodes: str,
    extended: bool,
    code: str,
    broadcast: bool,
    byte_order: str,
    folder: Path | None,
) -> None:
    """Start the spec of a new protocol FAMILY, with golden frames.

    \b
      canwright init lamp --id '0x300 + node' --nodes 1..32
      canwright init pump --id '0x600 + node' --reply-id '0x580 + node' --nodes 1..127
      canwright init axis --code id --id 'node << 5' --nodes 0..62
      canwright init wheel --code id --id node --nodes 0..254 --extended
      canwright init arm --id node --reply-id master_id --nodes 1..8
      canwright init battery --code none --broadcast --id '0x180 + node' --byte-order big

    It writes FAMILY/EDITION.yaml and its golden frames to spec/, with one or two commands as examples. Both files are valid:
    `canwright generate` works at once. Replace the examples by the facts of the manual. A name in a rule is a setting of the device. A rule without `node` is one id
    for all. With --code id, the lowest bits of the id are the code, as many as the rule leaves free: 5 for 'node << 5'. If it leaves none
    in a 29-bit id, the next byte above the node is the code. With --code none, the id identifies a command.

    Exit status: 0, or 2 if nothing was written: a file exists, or an option does not fit.
    """
    fits("family", family)
    fits("edition", edition)
    if broadcast and reply_id:
        stop("--broadcast: nodes send frames with the id of --id; remove --reply-id")
    rule = id_rule or ("node << 5" if code == "id" else "0x100 + node")
    target = (folder or SPEC_FOLDER / family) / f"{edition}.yaml"
    reply_rule = reply_id or rule
    first_node = f" node: {nodes.partition('..')[0]},"
    has_node = "node" in rule or "node" in reply_rule
    start, bits = _code_in_id(rule, reply_id, extended=extended) if code == "id" else (0, 8)
    settings = dict.fromkeys(filter(None, map(_setting, (rule, reply_rule))))
    ids = f"request: {rule}, reply: {reply_id}" if reply_id else f"id: {rule}"
    commands = (("state", "speed_limit") if broadcast else ("read_state", "set_speed"))[: 1 if code == "none" else 2]
    entry = {
        "request": first_node * ("node" in rule) + _known(settings, rule),
        "reply": first_node * ("node" in reply_rule) + _known(settings, reply_rule),
    }
    position = {"data": {"note": "", "at": "0"}, "id": {"note": ": bits of the id", "at": f"id.{start}"}}
    facts = {
        "file": target.as_posix(),
        "family": family,
        "edition": as_yaml(edition),
        "title": as_yaml(family.replace("_", " ").capitalize()),
        "address": ids + f", nodes: {nodes}" * has_node + ", extended: true" * extended,
        "byte_order": byte_order,
        "parameters": _parameters(settings),
        "selector": _NO_SELECTOR if code == "none" else _SELECTOR.format(**position[code], width=f"u{bits}"),
        "commands": "".join(
            f"  {name}:\n" + f"    code: 0x{number:02X}\n" * (code != "none") + _COMMANDS[name]
            for number, name in enumerate(commands, start=1)
        ),
        "frames": "".join(
            f"  - {{{direction}: {name},{entry[direction]} "
            f'data: "{number if code == "data" else 0:02X} {data[byte_order]}",{values} source: starter}}\n'
            for number, name in enumerate(commands, start=1)
            for direction, data, values in _EXAMPLES[name]
        ),
    }
    texts = {target: _SPEC.format(**facts), frames_file(target): _FRAMES.format(**facts)}
    _check(texts, target)
    try:
        write_new_files(texts)
    except OSError as error:
        stop(str(error))
    print_text(
        "Replace the commands by those of the manual, and remove the golden frames of each command that you remove.\n"
        f"Then run: canwright frames {target.as_posix()}, and canwright test --spec {target.as_posix()}\n",
        error=True,
    )


def _setting(rule: str) -> str | None:
    """The parameter in a rule; None without one."""
    try:
        return notation.id_expression(rule).parameter
    except ValueError:
        return None  # `_check` reports it


def _parameters(names: Collection[str]) -> str:
    """The definitions of parameters in ids."""
    if not names:
        return ""
    lines = "".join(f"  {name}: {{number: {{}}, title: {as_yaml(spoken(name))}}}\n" for name in names)
    return (
        f"# Settings of the device that ids contain; `canwright decode` takes them with --set.\nparameters:\n{lines}\n"
    )


def _known(names: Collection[str], rule: str) -> str:
    """The value of the parameter in a rule, for a golden frame."""
    name = _setting(rule)
    return f" parameters: {{{name}: 1}}," if name in names else ""


def _code_in_id(rule: str, reply_rule: str | None, *, extended: bool) -> tuple[int, int]:
    """The first bit and the width of a code in the id: the low bits that both rules leave free, or a byte above. Stops without any."""
    free, shifts = [], []
    for text in filter(None, (rule, reply_rule)):
        shift = re.search(r"node\s*<<\s*(\d{1,2})", text)
        shifts.append(int(shift[1]) if shift else 0)
        free.append(
            (29 if extended else 11) if "node" not in text else 0 if extended and _setting(text) else shifts[-1]
        )
    if min(free):
        return 0, min(free)
    if not extended:
        stop(
            f"--code id: `{reply_rule if free[0] else rule}` leaves no bits for the code; shift the node, for example --id 'node << 5'"
        )
    return 8 * (max(shifts) // 8 + 1), 8


def _check(texts: dict[Path, str], target: Path) -> None:
    """Stops unless the files are valid; they are read in a temporary folder, so that nothing is written before."""
    with tempfile.TemporaryDirectory() as folder:
        for file, text in texts.items():
            (Path(folder) / file.name).write_text(text, "utf-8")
        try:
            load(Path(folder) / target.name, target.as_posix())
        except SpecError as error:
            show_findings(error.diagnostics, "text")
            stop("these options do not give a valid spec; nothing was written")
