"""Rows of a log and their summary as text for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..diagnostics.unicode_safety import visible
from ..model.formatting import counted, sent
from ..recordings.exports import bus_name, milliseconds, seconds
from ..recordings.nodes import Choice, Nodes
from ..recordings.recorded import Counts, Part
from ..recordings.rows import CellValue, Row
from ..recordings.summary import NodeSummary, Summary
from .settings import known_values

SHOWN = 4
"""How many foreign ids are printed."""
_COLUMNS = ("number", "time", "bus", "node", "edition", "direction", "by", "command")


class Table:
    """A table whose columns are as wide as the first rows need; it is printed line by line."""

    def __init__(self, first: Sequence[Row]) -> None:
        cells = [_COLUMNS, *map(_cells, first)]
        self._widths = [max(len(row[i]) for row in cells) for i in range(len(_COLUMNS))]
        self.header = self._line(_COLUMNS, "fields")

    def line(self, row: Row) -> str:
        """A row as a line."""
        return self._line(_cells(row), _fields(row))

    def _line(self, cells: Sequence[str], fields: str) -> str:
        padded = (
            cell.rjust(w) if i < 2 else cell.ljust(w)
            for i, (cell, w) in enumerate(zip(cells, self._widths, strict=True))
        )
        return f"{'  '.join(padded)}  {fields}".rstrip() + "\n"


def _cells(row: Row) -> Sequence[str]:
    judged = row.judged
    return (
        f"#{judged.number}",
        seconds(judged.recorded.time, 6) or "-",
        bus_name(judged.recorded.bus) or "-",
        "-" if judged.node is None else str(judged.node),
        judged.edition.name if judged.edition else "-",
        judged.direction.value if judged.direction else "-",
        judged.decided_by.value,
        judged.message.command if judged.message else "-",
    )


def _fields(row: Row) -> str:
    """The values, or why there are none, and the request that was answered."""
    judged = row.judged
    if judged.edition is None:
        return f"foreign: {sent(judged.recorded.frame)}"
    if judged.rejection is not None:
        return f"rejected: {judged.rejection.text} ({sent(judged.recorded.frame)})"
    values = ", ".join(f"{c.column.name} {value_text(c.value, c.raw, c.column.unit)}" for c in row.cells)
    if judged.request is None:
        return values
    latency = f" after {milliseconds(judged.latency, 3)} ms" if judged.latency is not None else ""
    return f"{values}{'; ' if values else ''}answers #{judged.request}{latency}"


def value_text(value: CellValue, raw: int, unit: str) -> str:
    """A value with its unit: `2.5 A`, `[hot, clipping]`; a raw integer without a value as `raw 155`."""
    if value is None:
        return f"raw {raw}"
    text = f"[{', '.join(value)}]" if isinstance(value, list) else str(value)
    return f"{text} {unit}" if unit else text


def summary_text(summary: Summary, nodes: Nodes, counts: Counts) -> str:
    """The summary of each node, and everything that was not decoded."""
    return "\n" + "".join(f"{line}\n" for line in (*_nodes(summary, nodes), *_skipped(summary, counts)))


def _nodes(summary: Summary, nodes: Nodes) -> Iterator[str]:
    for (bus, node), one in sorted(summary.nodes.items(), key=lambda item: (item[0][0], item[0][1] or -1)):
        editions = ", ".join(edition.name for edition in one.editions)
        place = ", ".join(filter(None, (bus_name(bus), "no node" if node is None else f"node {node}")))
        how = _origin(nodes.identified.get((bus, node)))
        yield f"{place}, {editions}{how}: {counted(one.requests, 'request')}, {_replies(one)}"
        yield from _findings(one)
    for (bus, node), choice in nodes.identified.items():
        if choice.edition is None:
            where = "frames without a node" if node is None else f"node {node}"
            yield (
                f"{bus_name(bus) + ', ' if bus else ''}{where}: no edition fits, so its frames count as foreign;"
                f" `canwright identify` shows why, --set {'' if node is None else f'{node}:'}edition=NAME selects one"
            )


def _origin(choice: Choice | None) -> str:
    if choice is None:
        return ""
    if not choice.others:
        return " (identified)"
    return f" ({', '.join(one.name for one in choice.others)} fit as well; --set edition=NAME decides)"


def _replies(one: NodeSummary) -> str:
    replies = f"{one.replies} {'reply' if one.replies == 1 else 'replies'}"
    if not one.timed:
        return replies
    return (
        f"{replies} after {milliseconds(one.mean_latency, 3)} ms on average, at most {milliseconds(one.longest, 3)} ms"
    )


def _findings(one: NodeSummary) -> Iterator[str]:
    if one.missing:
        yield f"  {one.missing} missing: {counted(one.missing, 'request')} without an answer"
    if one.late:
        within = ", ".join(f"{float(e.bus.reply_within_ms or 0):g} ms" for e in one.editions)
        yield f"  {one.late} late: answered after more than {within}"
    if one.unexpected:
        yield f"  {one.unexpected} unexpected: without a request"
    for reason, rejected in one.rejected.items():
        yield f"  {rejected.count} rejected, {reason.value}: {rejected.rejection.text}, as in {sent(rejected.example)}"
    for name in one.without:
        yield f"  values depend on `{name}`: --set {known_values(one.editions, name)}"


def _skipped(summary: Summary, counts: Counts) -> Iterator[str]:
    foreign = summary.foreign.total() + summary.other_foreign
    if foreign:
        ids = ", ".join(f"0x{id_:X} ({count})" for id_, count in summary.foreign.most_common(SHOWN))
        more = ", ..." if len(summary.foreign) > SHOWN else ""
        yield f"{counted(foreign, 'frame')} with foreign ids: {ids}{more}"
    if counts.remote:
        yield f"{counted(counts.remote, 'remote frame')} among all frames"
    for part in Part:
        if counts.skipped[part]:
            lines = [
                f"line {n}: `{visible(text)}`" if n else visible(text) for n, text in counts.examples.get(part, ())
            ]
            yield f"skipped, {part.value}: {counts.skipped[part]}" + (f" ({'; '.join(lines)})" if lines else "")
