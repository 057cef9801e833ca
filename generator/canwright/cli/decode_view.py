"""Rows of a log and their summary as text for the terminal."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from ..diagnostics.unicode_safety import visible
from ..model import formatting
from ..model.formatting import bus_id, counted, numbers, sent
from ..model.refusal import Refusal
from ..model.types import Type
from ..recordings.effects import NodeEffects
from ..recordings.explain import meanings
from ..recordings.exports import bus_name, milliseconds, seconds
from ..recordings.gaps import CounterGaps, Periods
from ..recordings.log_frame import Counts, SkippedPart
from ..recordings.neighbours import neighbours
from ..recordings.nodes import Choice, Nodes
from ..recordings.results import Place
from ..recordings.rows import CellValue, Row
from ..recordings.summary import NodeSummary, Summary
from ..semantics.floats import shortest
from .settings import known_values

SHOWN = 4
"""How many foreign ids are printed."""
_COLUMNS = ("number", "time", "bus", "node", "edition", "direction", "by", "command")


class AlignedTable:
    """A table that is printed in blocks; its columns become wider where rows need it, and a text follows them."""

    def __init__(self, columns: Sequence[str], text: str, right: Collection[int]) -> None:
        """A table with some columns on the right."""
        self._columns, self._text, self._right = columns, text, right
        self._widths = [0] * len(columns)

    def lines(self, rows: Sequence[tuple[Sequence[str], str]]) -> str:
        """The rows, each with its text, as lines; before the first ones, the header."""
        is_first = not any(self._widths)
        columns = zip(self._widths, self._columns, *(cells for cells, _ in rows), strict=True)
        self._widths = [max(width, *map(len, column)) for width, *column in columns]
        header = self._line(self._columns, self._text) if is_first else ""
        return header + "".join(self._line(*row) for row in rows)

    def _line(self, cells: Sequence[str], text: str) -> str:
        padded = (
            cell.rjust(w) if i in self._right else cell.ljust(w)
            for i, (cell, w) in enumerate(zip(cells, self._widths, strict=True))
        )
        return f"{'  '.join(padded)}  {text}".rstrip() + "\n"


class RowTable(AlignedTable):
    """The rows of a log as a table."""

    def __init__(self) -> None:
        super().__init__(_COLUMNS, "fields", (0, 1))

    def __call__(self, rows: Sequence[Row]) -> str:
        """The rows as lines; before the first ones, the header."""
        return self.lines([(_cells(row), _fields(row)) for row in rows])


def _cells(row: Row) -> Sequence[str]:
    judged = row.judged
    return (
        f"#{judged.number}",
        seconds(judged.recorded.time, 6) or "-",
        bus_name(judged.recorded.bus) or "-",
        "-" if judged.node is None else str(judged.node),
        row.form.label or "-",
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
    values = ", ".join(f"{c.column.name} {value_text(c.value, c.raw, c.column.field.type)}" for c in row.cells)
    if judged.request is None:
        return values
    latency = f" after {milliseconds(judged.latency, 3)} ms" if judged.latency is not None else ""
    return f"{values}{'; ' if values else ''}answers #{judged.request}{latency}"


def value_text(value: CellValue, raw: int, type_: Type) -> str:
    """A value with unit and name: `2.5 A`, `100 % (maximum)`, `[hot, clipping]`; without a scale `raw 155`."""
    name = f" ({named})" if (named := type_.name_of(raw)) else ""
    if value is None:
        return f"raw {raw}{name}"
    if isinstance(value, str):  # a name, also for no value of a number with a unit
        return value
    if isinstance(value, float) and type_.is_bare_float and type_.width == 32:
        value = shortest(value)
    text = f"[{', '.join(value)}]" if isinstance(value, list) else str(value)
    return (f"{text} {type_.unit.symbol}" if type_.unit else text) + name


def summary_text(summary: Summary, nodes: Nodes, counts: Counts) -> str:
    """The summary of each node, and everything that was not decoded."""
    return "\n" + "".join(
        f"{line}\n"
        for line in (
            *_nodes(summary, nodes),
            *_missing_settings(summary),
            *_unidentified(nodes),
            *_foreign(summary, nodes),
            *_skipped(summary, counts),
        )
    )


def _nodes(summary: Summary, nodes: Nodes) -> Iterator[str]:
    for (bus, node), node_summary in sorted(summary.nodes.items(), key=lambda item: (item[0][0], item[0][1] or -1)):
        editions = ", ".join(node_summary.labels)
        place = ", ".join(filter(None, (bus_name(bus), "no node" if node is None else f"node {node}")))
        how = _origin(nodes.identified.get((bus, node), ()), node, node_summary.commands)
        yield f"{place}, {editions}{how}: {counted(node_summary.requests, 'request')}, {_replies(node_summary)}"
        yield from _findings(node_summary)
        yield from _effects(summary.effects.get((bus, node), NodeEffects()))


def _missing_settings(summary: Summary) -> Iterator[str]:
    """The parameters without which values are missing."""
    for name in dict.fromkeys(name for node in summary.nodes.values() for name in node.without):
        having = {place: node for place, node in summary.nodes.items() if name in node.without}
        editions = [edition for node in having.values() for edition in node.editions]
        yield f"values depend on `{name}` ({_places(having)}): --set {known_values(editions, name)}"


def _unidentified(nodes: Nodes) -> Iterator[str]:
    unknown = [
        place
        for place, choices in nodes.identified.items()
        if any(choice.edition is None for choice in choices) and not nodes.is_stray(*place)
    ]
    if unknown:
        scope = next((f"{node}:" for _, node in unknown if node is not None), "")
        yield (
            f"{_places(unknown)}: no edition fits, so these frames count as foreign; `canwright identify` shows why,"
            f" --set {scope}edition=NAME selects one"
        )
    stray = [place for place in nodes.identified if nodes.is_stray(*place)]
    if stray:
        yield f"{_places(stray)}: few frames, far apart, as frames with a damaged id are; they do not affect the exit status"
    for misread in nodes.misread:
        where = f"{_places([(misread.bus, misread.node)])}: frames #{misread.start} to #{misread.end}"
        yield f"{where} were decoded as {misread.label}, but fit {misread.edition.name}; decode a file, or use --set"


def _places(listed: Iterable[tuple[str, int | None]]) -> str:
    """`can0, node 1`, `can0, nodes 1..4; can1, no node`."""
    by_bus: dict[str, list[int | None]] = {}
    for bus, node in listed:
        by_bus.setdefault(bus, []).append(node)
    return "; ".join(", ".join(filter(None, (bus_name(bus), node_names(own)))) for bus, own in by_bus.items())


def node_names(listed: Iterable[int | None]) -> str:
    """`node 1`, `nodes 1..3, 7`, `no node`."""
    own = sorted({node for node in listed if node is not None})
    return f"node{'s' if len(own) > 1 else ''} {numbers(own)}" if own else "no node"


def _origin(choices: Sequence[Choice], node: int | None, commands: Collection[str]) -> str:
    """How the edition of a node is known, and from which frame on it has another."""
    if not choices:
        return ""
    first, *later = choices
    changes = [f"{choice.label or 'no edition'} from {at_frame(choice.start)}" for choice in later]
    if changes:
        return f" ({first.label or 'no edition'}, then {', '.join(changes)})"
    if first.is_assumed:
        return " (assumed, as of other nodes of the bus, since most requests have no reply)"
    if not first.others:
        return " (identified)"
    fitting = ", ".join(edition.name for edition in first.others)
    fits = f"{fitting} fit{'' if len(first.others) > 1 else 's'} as well"
    differing = sorted(first.differing.intersection(commands))
    if not differing:
        return f" ({fits}, and all frames mean the same)"
    return f" ({fits}, with other meanings of {', '.join(differing)}; --set {node or ''}:edition=NAME decides)"


def at_frame(place: Place) -> str:
    """`#116, 12.300000 s`."""
    return f"#{place.number}" + ("" if place.time is None else f", {seconds(place.time, 6)} s")


def _replies(node: NodeSummary) -> str:
    count, of = node.replies, ""
    if node.answered_by_others:
        count, of = count + node.answered_by_others, " of the nodes that it addresses" if not count else ""
    replies = f"{count} {'reply' if count == 1 else 'replies'}{of}"
    if not node.timed:
        return replies
    return f"{replies} after {milliseconds(node.mean_latency, 3)} ms on average, at most {milliseconds(node.longest, 3)} ms"


def _findings(node: NodeSummary) -> Iterator[str]:
    if node.missing:
        yield f"  {node.missing} missing: {counted(node.missing, 'request')} without an answer"
    if node.late:
        yield f"  {node.late} late: slower than the reply time of the spec, or if the bus is slower, than most replies"
    if node.unexpected:
        yield f"  {node.unexpected} unexpected: without a request"
    for message, periods in node.periods.items():
        if periods.late or periods.timeouts:
            yield f"  {message.name}: {_periods(periods)}"
    for (message, name), gaps in node.counters.items():
        if not gaps.is_regular:
            yield f"  {message.name}: {_counter_gaps(name, gaps)}"
    for (name, limits), values in node.implausible.items():
        cell = values.example
        value = value_text(cell.value, cell.raw, cell.column.field.type)
        yield f"  {values.count} implausible: `{name}` is outside {limits}, as {value} in {sent(values.frame)}"
    for reason, rejected in node.rejected.items():
        yield f"  {rejected.count} rejected, {reason.value}: {rejected.rejection.text}, as in {sent(rejected.example)}"


def _effects(effects: NodeEffects) -> Iterator[str]:
    """The effects of requests that are warnings, and those that the state of the node prevented."""
    for (command, effect), requests in effects.warnings.items():
        yield f"  {requests.count} {command.name}, first in #{requests.first}: {formatting.english(effect.title)}"
    for (entered, command, effect), requests in effects.prevented.items():
        title = formatting.english(effect.title)
        since = (
            f"in the state {formatting.english(entered.state.title)} since {entered.command.name} in #{entered.number}"
        )
        yield f"  {requests.count} {command.name}, first in #{requests.first}, {since}, without the effect: {title}"


def _counter_gaps(name: str, gaps: CounterGaps) -> str:
    """The frames that are missing or repeated according to a counter."""
    parts = [f"counter `{name}` from {gaps.role.first} to {gaps.role.last}"]
    if gaps.gaps:
        parts.append(f"{counted(gaps.gaps, 'gap')}, {counted(gaps.missing, 'frame')} missing")
    if gaps.repeated:
        parts.append(f"{gaps.repeated} repeated")
    if gaps.invalid:
        parts.append(f"{gaps.invalid} outside")
    return "; ".join(parts)


def _periods(periods: Periods) -> str:
    """The late and missing frames of a message with its longest gap."""
    parts = [formatting.sending(periods.sending)]
    if periods.late:
        parts.append(f"{counted(periods.late, 'late frame')}, about {periods.missing} missing")
    if periods.timeouts:
        parts.append(counted(periods.timeouts, "time-out"))
    before = "the end of the log" if periods.before is None else f"#{periods.before}"
    longest = f"longest gap {milliseconds(periods.longest, 3)} ms before {before}"
    return "; ".join((*parts, longest))


def _foreign(summary: Summary, nodes: Nodes) -> Iterator[str]:
    """The foreign frames by id, and those that are of the family except for their length."""
    foreign = summary.foreign.total() + summary.other_foreign
    if foreign:
        ids = ", ".join(f"{bus_id(*id_)} ({count})" for id_, count in summary.foreign.most_common(SHOWN))
        more = ", ..." if len(summary.foreign) > SHOWN else ""
        yield f"{counted(foreign, 'frame')} with foreign ids: {ids}{more}"
    yield from (f"  {line}" for line in neighbours(nodes.family, summary.foreign))
    for id_, _ in summary.foreign.most_common(SHOWN):
        frame = summary.foreign_examples[id_]
        every = [m for edition in nodes.family for m in meanings(edition, frame, {})]
        lengths = [m.rejection.text for m in every if m.rejection and m.rejection.reason is Refusal.WRONG_LENGTH]
        if lengths:
            yield f"  {lengths[0]}, as in {sent(frame)}"


def _skipped(summary: Summary, counts: Counts) -> Iterator[str]:
    """What no row shows."""
    if counts.remote:
        yield f"{counted(counts.remote, 'remote frame')} among all frames"
    if counts.has_differences:
        yield "the times are differences, as of `candump -td`, and were added up"
    if counts.untimed:
        number, text = counts.first_untimed
        where = f"line {number}: `{visible(text)}`" if number else "the first has more than 64 bits"
        yield f"{counted(counts.untimed, 'frame')} without a time, since it cannot be read ({where})"
    for part in SkippedPart:
        if counts.skipped[part]:
            lines = [
                f"line {n}: `{visible(text)}`" if n else visible(text) for n, text in counts.examples.get(part, ())
            ]
            yield f"skipped, {part.value}: {counts.skipped[part]}" + (f" ({'; '.join(lines)})" if lines else "")
