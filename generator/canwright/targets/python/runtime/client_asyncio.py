"""The client for asyncio: the same rules, without a thread where the bus has a file descriptor."""

from __future__ import annotations

import asyncio
import math
import threading
import time
import warnings
from collections import deque
from collections.abc import AsyncIterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, cast

import can

from ._codec import Message, Request
from .client import BusLost, ClientCore, Outcome, Steps

if TYPE_CHECKING:
    from typing_extensions import Self

R = TypeVar("R", bound=Message)
T = TypeVar("T")

AT_ONCE = 64
"""The most frames that are read at a wake-up."""


class AsyncClient(ClientCore):
    """A client for asyncio. Tasks wait for each other: `cycle` sends to all nodes at once. Use it with `async with`."""

    async def __aenter__(self) -> Self:
        self._loop = asyncio.get_running_loop()
        self._turn = asyncio.Lock()
        self._waiter: asyncio.Future[None] | None = None
        self._watch()
        await self._drive(self._open_steps())
        return self

    async def __aexit__(self, *_: object) -> None:
        if self._moved and self._lost is None and self._on_exit != "nothing":
            unconfirmed = await self._drive(self._stop_steps("stop" if self._on_exit == "stop" else "switch_off"))
            if unconfirmed:
                warnings.warn(f"nodes did not confirm {self._on_exit}, and may still move: {unconfirmed}", stacklevel=2)
        self._moved.clear()
        await self._unwatch()

    async def request(self, request: Request[R], *, allow: str = "", tries: int = 1, timeout: float | None = None) -> R:
        """The reply to a request. Raises ClientError."""
        return (await self.cycle((request,), allow=allow, tries=tries, timeout=timeout))[0].get()

    async def cycle(
        self, requests: Sequence[Request[R]], *, allow: str = "", tries: int = 1, timeout: float | None = None
    ) -> list[Outcome[R]]:
        """Sends requests to all nodes at once and waits for all; the outcome of each, in the same order."""
        return await self._drive(self._cycle_steps(requests, allow, tries, timeout))

    async def gather(self, request: Request[R], *, allow: str = "", timeout: float | None = None) -> list[R]:
        """The replies of several nodes, or of several frames, to one request: those that came in time."""
        return await self._drive(self._gather_steps(request, allow, timeout))

    async def send(self, request: Request[Any], *, allow: str = "") -> None:
        """Sends a request that nodes do not answer. Raises ClientError."""
        await self._drive(self._send_steps(request, allow))

    async def dump(self, node: int | None = None) -> dict[str, Any]:
        """The settings of a node, as `Client.dump`."""
        return await self._drive(self._dump_steps(node))

    async def restore(
        self, settings: Mapping[str, Any], node: int | None = None, *, kept: str = "", allow: str = ""
    ) -> dict[str, tuple[Any, Any]]:
        """Writes those settings that differ in a node, as `Client.restore`."""
        return await self._drive(self._restore_steps(settings, node, kept, allow))

    async def receive(self, seconds: float = math.inf) -> AsyncIterator[Message]:
        """The frames that nodes send without a request, as `Client.receive`."""
        until = time.monotonic() + seconds
        while (message := await self._drive(self._listen_steps(until))) is not None:
            yield message

    async def reopen(self, bus: can.BusABC) -> None:
        """Starts again with another bus object, as `Client.reopen`."""
        async with self._turn:
            await self._unwatch()
            self._restart(bus)
            self._watch()
        await self._drive(self._open_steps())

    async def every(self, rate: float) -> AsyncIterator[int]:
        """The number of each period, as `Client.every`."""
        for number, pause in self._periods(rate):
            yield number
            await asyncio.sleep(pause())

    async def _drive(self, steps: Steps[T]) -> T:
        async with self._turn:
            try:
                until = next(steps)
                while True:
                    try:
                        message = await self._receive(until)
                    except BaseException as error:
                        until = steps.throw(error)
                    else:
                        until = steps.send(message)
            except StopIteration as stop:
                return cast("T", stop.value)

    async def _receive(self, until: float) -> can.Message | None:
        """The next frame; None if none comes until then. Raises BusLost."""
        if self._file >= 0:
            self._read()
        while not self._arrived:
            if self._error is not None:
                raise BusLost(f"the bus does not work: {self._error}") from self._error
            left = until - time.monotonic()
            if left <= 0:
                return None
            self._waiter = self._loop.create_future()
            timer = self._loop.call_later(left, self._wake)
            await self._waiter
            timer.cancel()
        return self._arrived.popleft()

    def _wake(self) -> None:
        if self._waiter is not None and not self._waiter.done():
            self._waiter.set_result(None)

    def _watch(self) -> None:
        """Reads the bus when there is something to read, in a thread if the bus has no file descriptor."""
        self._arrived: deque[can.Message] = deque()
        self._error: Exception | None = None
        self._ended = threading.Event()
        try:
            self._file = self.bus.fileno()
        except NotImplementedError:
            self._file = -1
        if self._file >= 0:
            self._loop.add_reader(self._file, self._readable)
        else:
            self._thread = threading.Thread(target=self._run, daemon=True)
            self._thread.start()

    async def _unwatch(self) -> None:
        self._ended.set()
        if self._file >= 0:
            self._loop.remove_reader(self._file)
        else:
            await self._loop.run_in_executor(None, self._thread.join)

    def _readable(self) -> None:
        self._read()
        self._wake()

    def _read(self) -> None:
        try:
            for _ in range(AT_ONCE):
                message = self.bus.recv(0)
                if message is None:
                    return
                self._arrived.append(message)
        except (can.CanError, OSError, ValueError) as error:
            self._error = error

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                message = self.bus.recv(0.05)
            except (can.CanError, OSError, ValueError) as error:
                self._loop.call_soon_threadsafe(self._fail, error)
                return
            if message is not None:
                self._loop.call_soon_threadsafe(self._take, message)

    def _take(self, message: can.Message) -> None:
        self._arrived.append(message)
        self._wake()

    def _fail(self, error: Exception) -> None:
        self._error = error
        self._wake()
