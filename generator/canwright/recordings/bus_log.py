"""The frames of a bus of python-can as a log without an end, for a recorder that sends nothing."""

from __future__ import annotations

import io
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..diagnostics.unicode_safety import visible
from .by_python_can import recorded_frame
from .log_frame import LogError, LogFrame, SkippedPart
from .readers import PAUSE, Log

if TYPE_CHECKING:
    import can


def errors_of_use() -> tuple[type[Exception], ...]:
    """What a bus raises that is lost."""
    import can

    return can.CanError, OSError, ValueError


def sentence(error: BaseException) -> str:
    """The text of an error of python-can or an interface in one line."""
    return visible(" ".join(str(error).split()).rstrip(".")) or type(error).__name__


def lost(error: BaseException) -> str:
    """What became of a bus that raised an error."""
    return f"the bus does not work any more: {sentence(error)}"


class BusLog(Log):
    """What a bus receives until the user ends it."""

    def __init__(self, bus: can.BusABC) -> None:
        super().__init__(io.BytesIO(), "the bus")
        self._bus = bus

    @property
    def is_file(self) -> bool:
        return False

    def recorded(self) -> Iterator[LogFrame | None]:
        """The frames, without a mark of their direction. Raises LogError."""
        while not self.is_ended:
            message = self._received(0)
            if message is None:
                start, waited = time.monotonic(), self.waited
                self.on_wait(0)
                while message is None and not self.is_ended:
                    message = self._received(PAUSE)
                    self.waited = waited + time.monotonic() - start
                    if message is None:
                        self.on_wait(self.waited - waited)
                        yield None
            if message is not None:
                recorded = recorded_frame("", message)
                if isinstance(recorded, SkippedPart):
                    self.counts.skip(recorded)
                else:
                    yield recorded._replace(mark=None)

    def _received(self, seconds: float) -> can.Message | None:
        try:
            return self._bus.recv(seconds)
        except errors_of_use() as error:
            raise LogError(lost(error)) from None
