"""The view of `monitor` in a terminal, with Textual."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine, Sequence
from pathlib import Path

from rich.segment import Segment
from rich.style import Style
from rich.text import Text
from textual.app import App, ComposeResult
from textual.binding import Binding
from textual.geometry import Size
from textual.scroll_view import ScrollView
from textual.strip import Strip
from textual.widgets import Footer, Input, Static

from ..diagnostics.unicode_safety import visible
from ..recordings.latest_values import FILTER, Line, parse_filter
from ..recordings.split import FORMATS
from ..targets.base import EditionInput
from .monitor_feed import Feed, Player, Receiver
from .monitor_send import EXAMPLE, Prepared, Sender
from .monitor_view import HEADINGS, cells, column_widths, is_implausible, joined_cells

RENEWALS = 4
"""How often the view is renewed in a second."""
_STALE = 2.0
"""The seconds after which a value is dim."""


class ValueTable(ScrollView, can_focus=True):
    """The values; only the lines that are visible are made into text."""

    DEFAULT_CSS = "ValueTable { height: 1fr; scrollbar-size-vertical: 1; }"

    def __init__(self) -> None:
        super().__init__()
        self._lines: Sequence[Line] = ()
        self._now = 0
        self._has_buses = False

    def show(self, lines: Sequence[Line], now: int, *, has_buses: bool) -> None:
        """Shows other lines."""
        self._lines, self._now, self._has_buses = lines, now, has_buses
        self.virtual_size = Size(self.scrollable_content_region.width, len(lines) + 1)
        self.refresh()

    def render_line(self, y: int) -> Strip:
        """A line of the screen; the first one has the headings."""
        width = self.scrollable_content_region.width
        widths = column_widths(width)
        at = self.scroll_offset.y + y - 1
        if y == 0:
            return _strip(joined_cells(HEADINGS, widths), width, Style(bold=True, reverse=True))
        if at >= len(self._lines):
            return Strip.blank(width)
        line = self._lines[at]
        is_repeated = y > 1 and self._lines[at - 1].entry is line.entry
        shown = cells(line, self._now, has_buses=self._has_buses, is_repeated=is_repeated)
        return _strip(joined_cells(shown, widths), width, _style(line, self._now))


def _strip(text: str, width: int, style: Style) -> Strip:
    return Strip([Segment(text, style)]).adjust_cell_length(width, style)


def _style(line: Line, now: int) -> Style:
    if line.entry.is_rejected or is_implausible(line):
        return Style(color="red")
    age = line.entry.age(now)
    return Style(dim=age is not None and age > _STALE)


class MonitorApp(App[None]):
    """The values of a feed, the state of its bus, and a line for what the user writes."""

    CSS = """
    #status { height: auto; }
    #message { height: auto; }
    Input { height: 1; border: none; padding: 0; }
    """
    BINDINGS = [
        Binding("slash", "filter", "Filter"),
        Binding("space", "pause", "Pause"),
        Binding("r", "record", "Record"),
        Binding("s", "send", "Send"),
        Binding("q", "quit", "Quit"),
        Binding("escape", "cancel", "Cancel", show=False),
    ]
    ENABLE_COMMAND_PALETTE = False

    def __init__(self, feed: Feed, specifications: Sequence[EditionInput], written: str) -> None:
        super().__init__()
        self._feed = feed
        source = feed.source
        self._sender = Sender(feed, source, specifications) if isinstance(source, Receiver) else None
        self._is_sending = False
        self._written = written
        self._filter = parse_filter(written)
        self._is_paused = False
        self._answered: Callable[[str], None] = lambda _: None

    def compose(self) -> ComposeResult:
        """The widgets, from above."""
        yield Static(id="status", markup=False)
        yield ValueTable()
        yield Static(id="message", markup=False)
        yield Input(compact=True)
        yield Footer()

    def on_mount(self) -> None:
        """Starts the renewals."""
        self._close()
        self.set_interval(1 / RENEWALS, self.renew)

    def renew(self) -> None:
        """Shows the newest values, unless the view is paused."""
        feed = self._feed
        if feed.error:
            self.exit()
            return
        if not (self.query("#status") and self.query(ValueTable)):
            return  # the view closes, and its widgets are gone before the timer
        parts = [*feed.status_parts()]
        if self._is_paused:
            parts.insert(0, "PAUSED")
        elif feed.ended.is_set():
            parts.insert(0, "end of the log")
        if self._filter != parse_filter(""):
            parts.append(f"filter {self._written}")
        sign = Text.assemble((" ● ", "bold white on red"), " ") if feed.recording else Text()
        self.query_one("#status", Static).update(sign + Text(" | ".join(parts)))
        if not self._is_paused:
            entries = feed.table.entries()
            has_buses = len({entry.bus for entry in entries}) > 1
            self.query_one(ValueTable).show([*self._filter.lines(entries)], feed.source.now(), has_buses=has_buses)

    def say(self, text: str) -> None:
        """Shows a message below the values."""
        self.query_one("#message", Static).update(visible(text))

    def action_filter(self) -> None:
        """Asks what to show."""
        self._ask(f"What to show, such as {FILTER}; empty for everything", self._written, self._set_filter)

    def _set_filter(self, text: str) -> None:
        try:
            self._filter, self._written = parse_filter(text), text
        except ValueError as error:
            self.say(str(error))
        self.renew()

    def action_pause(self) -> None:
        """Stops the view, and a log that is played; a bus is read and recorded meanwhile."""
        self._is_paused = not self._is_paused
        if isinstance(self._feed.source, Player):
            self._feed.source.run(is_running=not self._is_paused and not self._feed.ended.is_set())
        self.renew()

    def action_record(self) -> None:
        """Asks for the name of a recording, or ends it."""
        source = self._feed.source
        if not isinstance(source, Receiver):
            self.say("a log is not recorded again")
        elif ended := source.end_recording():
            self.say(f"recorded {ended.frames} frames to {ended.path}")
        else:
            self._ask("Record all frames to a new file: .log, .asc or .blf", _free_name(), self._record)
        self.renew()

    def _record(self, name: str) -> None:
        source, path = self._feed.source, Path(name)
        assert isinstance(source, Receiver)
        if path.suffix not in FORMATS:
            self.say(f"`{name}` must end in {', '.join(FORMATS)}")
            return
        try:
            source.record(path)
        except FileExistsError:
            self.say(f"`{name}` exists already; choose another name or remove it")
        except (OSError, ValueError) as error:
            self.say(str(error))
        self.renew()

    def action_send(self) -> None:
        """Asks for a command, and for the consent that it needs."""
        if self._sender is None:
            self.say("a log has no nodes to send to")
        elif self._is_sending:
            self.say("the last command is still being sent")
        else:
            question = f"Send to nodes a command with values, such as {EXAMPLE}"
            self._ask(question, "", lambda text: self._run(self._prepared(text)))

    def _run(self, steps: Coroutine[None, None, None]) -> None:
        self._is_sending = True
        self.say("sending ...")
        self.run_worker(steps)

    async def _prepared(self, text: str) -> None:
        assert self._sender is not None
        try:
            prepared = await asyncio.to_thread(self._sender.prepare, text)
        except ValueError as error:
            self._is_sending = False
            self.say(str(error))
            return
        await self._sent(prepared, "")

    async def _sent(self, prepared: Prepared, allow: str) -> None:
        """Sends requests; what lacks consent is sent when its word is typed."""
        assert self._sender is not None
        text, consent = await asyncio.to_thread(self._sender.send, prepared, allow)
        self._is_sending = False
        if not consent:
            self.say(text)
            return

        def allowed(word: str) -> None:
            if word == consent:
                self._run(self._sent(prepared, f"{allow} {consent}"))
            else:
                self.say("nothing was sent")

        self._ask(f"{text} To allow this, type {consent}", "", allowed)

    def _ask(self, question: str, text: str, answered: Callable[[str], None]) -> None:
        """Asks for a text."""
        self.say(question)
        self._answered = answered
        line = self.query_one(Input)
        line.value, line.display = text, True
        line.cursor_position = len(text)
        line.focus()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Ends a question with an answer."""
        self.action_cancel()
        self._answered(event.value.strip())

    def action_cancel(self) -> None:
        """Ends a question without an answer."""
        self.say("")
        self._close()

    def _close(self) -> None:
        self.query_one(Input).display = False
        self.query_one(ValueTable).focus()


def _free_name() -> str:
    number = 1
    while Path(f"monitor-{number}.log").exists():
        number += 1
    return f"monitor-{number}.log"
