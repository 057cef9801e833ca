"""`frames`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import click

from ..diagnostics.diagnostic import SpecError
from ..language.notation import BLANK
from ..model.edition import Edition
from ..model.formatting import counted
from ..model.message import Direction, Message
from ..model.types import Assignment
from ..project.golden_file import as_yaml
from ..project.loader import Loaded, frames_file
from ..project.references import UnknownEditionError, find
from ..recordings.directions import Directions
from ..recordings.golden_text import golden_text, skeleton_text
from ..recordings.nodes import Nodes, NodeSetting
from ..recordings.readers import LogError, open_log
from ..semantics.configured import configured
from .common import FINDINGS, SPEC_FOLDER, show_findings, stop
from .node_settings import direction_of, recorder_option
from .settings import assignment
from .terminal import print_data, print_text

_SOURCE = "manual"
_SOURCES = "Examples of the manual."


@click.command()
@click.argument("spec")
@click.option(
    "--from", "log", type=click.Path(exists=True, dir_okay=False, allow_dash=True), help="Propose frames of a log."
)
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="PARAMETER=VALUE",
    help="A parameter that fields depend on.  [default: the first value of each choice]",
)
@recorder_option
def frames(spec: str, log: str | None, settings: Sequence[str], recorder: str) -> None:
    """Print an entry for each request and reply of SPEC without a golden frame.

    SPEC is a file or an edition in spec/. Each entry has values at the ends of their ranges; replace them by those of
    an example of the manual if there is one. Replace each `__` in `data` by the byte of the manual: canwright leaves
    them blank, because a frame that it encodes itself does not prove that the spec is correct.

    \b
      canwright frames lamp.yaml > new.yaml
      canwright frames lamp.yaml --from bus.log

    Save the output as lamp.frames.yaml beside lamp.yaml, or append the entries to `frames:` of that file. With --from,
    an entry has the bytes of the log, and what the spec makes of them as a comment only. It has no `source`, so each run
    counts it as unreviewed: write the values that the device had, and name the source.

    Exit status: 0, or 1 if no entry is printed although golden frames are missing, 2 if it could not run.
    """
    loaded = _loaded(spec)
    given = assignment([loaded.specification], settings)
    golden = loaded.specification.frames
    edition = configured(loaded.specification.edition, given)
    there = {(frame.direction, frame.command) for frame in golden.frames} if golden else set()
    order = {command.name: i for i, command in enumerate(edition.commands)}
    messages = [m for m in edition.all_messages() if (m.direction, m.command) not in there]
    messages.sort(key=lambda message: order[message.command])
    if not messages:
        print_text("every request and reply has a golden frame\n", error=True)
        return
    try:
        entries = (
            _of_log(edition, messages, log, given, direction_of(recorder))
            if log
            else _skeletons(edition, messages, given)
        )
    except (LogError, OSError) as error:
        stop(str(error))
    if entries.texts:
        print_data(_head(edition, log) * (golden is None) + "".join(entries.texts))
    for remark in entries.remarks:
        print_text(f"{remark}\n", error=True)
    if not entries.texts:
        sys.exit(FINDINGS)


class _Entries(NamedTuple):
    texts: Sequence[str]
    remarks: Sequence[str]


def _loaded(spec: str) -> Loaded:
    """The spec with its golden frames, if their file is not empty, as a redirected output is. Errors exit the command."""
    try:
        file = Path(find(spec, SPEC_FOLDER, for_output=False).document.name)
        golden = frames_file(file)
        has_golden = golden.is_file() and bool(golden.read_text("utf-8", "replace").strip())
        return find(spec, SPEC_FOLDER, for_output=has_golden)
    except SpecError as error:
        show_findings(error.diagnostics, "text")
        stop(f"`{spec}` has errors; correct them first")
    except (UnknownEditionError, OSError) as error:
        stop(str(error))


def _head(edition: Edition, log: str | None) -> str:
    """The start of a file of golden frames."""
    sources = "{}" if log else f"\n  {_SOURCE}: {_SOURCES}"
    return (
        f"canwright: 1\nfamily: {edition.family}\nedition: {as_yaml(edition.name)}\n"
        f"sources:{' ' if log else ''}{sources}\nframes:\n"
    )


def _skeletons(edition: Edition, messages: Sequence[Message], given: Assignment) -> _Entries:
    chosen = {p.name: p.values[0].name for p in edition.parameters if p.is_choice} | dict(given)
    by_message = {message: skeleton_text(edition, message, chosen, _SOURCE) for message in messages}
    texts = [text for text in by_message.values() if text is not None]
    left = [message.name for message, text in by_message.items() if text is None]
    remarks = [f"{', '.join(left)}: the fields depend on a parameter; give it with --set"] if left else []
    return _Entries(texts, [*remarks, f"{counted(len(texts), 'frame')}: replace each {BLANK} by a byte of the manual"])


def _of_log(
    edition: Edition, messages: Sequence[Message], log: str, given: Assignment, recorder: Direction | None
) -> _Entries:
    settings = [NodeSetting(None, None, name, str(value)) for name, value in given.items()]
    nodes = Nodes([edition], settings, edition)
    directions = Directions(
        nodes.editions, nodes.default, recorder=recorder, further=nodes.family, changes=nodes.changes
    )
    seen: dict[Message, str] = {}
    with open_log(log) as recording:
        for directed in directions.classify(iter(recording)):
            message = directed.message
            if message is not None and message in messages and message not in seen:
                text = golden_text(edition, message, directed.recorded.frame, given, has_values=False)
                if text:
                    seen[message] = text
    missing = [message.name for message in messages if message not in seen]
    remarks = [
        f"{counted(len(seen), 'frame')} without values and a source, unreviewed: write what the device had, and name the source"
    ]
    remarks += (
        [f"not in the log, or dependent on a parameter that --set gives: {', '.join(missing)}"] if missing else []
    )
    return _Entries([seen[message] for message in messages if message in seen], remarks)
