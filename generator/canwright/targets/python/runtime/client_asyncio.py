"""The client for asyncio: the same rules, without a thread where the bus has a file descriptor."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import AsyncIterator, Coroutine, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import can

from ._codec import Message, Request
from .client import LISTEN, ClientCore, Outcome, R, T

if TYPE_CHECKING:
    from typing_extensions import Self


class AsyncClient(ClientCore):
    """A client for asyncio. Tasks wait for each other: `cycle` sends to all nodes at once. Use it with `async with`."""

    async def __aenter__(self) -> Self:
        self._turn = asyncio.Lock()
        self._timer: asyncio.TimerHandle | None = None
        await self._run(self._settle(self.nodes.values()))
        return self

    async def __aexit__(self, *_: object) -> None:
        await self._run(self._close())

    async def request(self, request: Request[R], *, allow: str = "", tries: int = 1, timeout: float | None = None) -> R:
        """The reply to a request. Raises ClientError."""
        return (await self.cycle((request,), allow=allow, tries=tries, timeout=timeout))[0].get()

    async def cycle(
        self, requests: Sequence[Request[R]], *, allow: str = "", tries: int = 1, timeout: float | None = None
    ) -> list[Outcome[R]]:
        """Sends requests to all nodes at once and waits for all; the outcome of each, in the same order."""
        return await self._run(self._cycle(requests, allow, tries, timeout))

    async def gather(self, request: Request[R], *, allow: str = "", timeout: float | None = None) -> list[R]:
        """The replies of several nodes, or of several frames, to one request: those that came in time."""
        return await self._run(self._gather(request, allow, timeout))

    async def send(self, request: Request[Any], *, allow: str = "") -> None:
        """Sends a request that nodes do not answer. Raises ClientError."""
        await self._run(self._send(request, allow))

    async def dump(self, node: int | None = None) -> dict[str, Any]:
        """The settings of a node, as `Client.dump`."""
        return await self._run(self._dump(node))

    async def restore(
        self, settings: Mapping[str, Any], node: int | None = None, *, kept: str = "", allow: str = ""
    ) -> dict[str, tuple[Any, Any]]:
        """Writes those settings that differ in a node, as `Client.restore`."""
        return await self._run(self._restore(settings, node, kept, allow))

    async def receive(self, seconds: float = math.inf) -> AsyncIterator[Message]:
        """The frames that nodes send without a request, as `Client.receive`."""
        until = time.monotonic() + seconds
        while (message := await self._run(self._listen(until))) is not None:
            yield message

    async def reopen(self, bus: can.BusABC) -> None:
        """Starts again with another bus object, as `Client.reopen`."""
        async with self._turn:
            self._use(bus)
            await self._settle(self.nodes.values())

    async def every(self, rate: float) -> AsyncIterator[int]:
        """The number of each period, as `Client.every`."""
        for number, pause in self._periods(rate):
            await asyncio.sleep(pause)
            yield number

    def _use(self, bus: can.BusABC) -> None:
        super()._use(bus)
        self._file = -1
        with contextlib.suppress(NotImplementedError):
            self._file = -1 if self._notifier else bus.fileno()

    async def _run(self, steps: Coroutine[Any, Any, T]) -> T:
        """What the steps of a method return; tasks wait for each other."""
        try:
            async with self._turn:
                return await steps
        finally:
            steps.close()

    async def _next_frame(self, until: float) -> can.Message | None:
        message = self._receive(0.0)
        left = until - time.monotonic()
        if message is not None or left <= 0:
            return message
        if self._file >= 0:
            await self._readable(left)
            return self._receive(0.0)
        reading = asyncio.get_running_loop().run_in_executor(None, self._receive, min(left, LISTEN))
        try:
            return await asyncio.shield(reading)
        except asyncio.CancelledError:
            await asyncio.wait((reading,))  # only one thread may read the bus
            raise

    async def _readable(self, seconds: float) -> None:
        """Waits until the bus has a frame, or until a timer fires; at most for a time in seconds.

        A timer stays for later waits: most end before it fires, and a timer of their own would cost more than they do.
        """
        loop = asyncio.get_running_loop()
        at = loop.time() + seconds
        if self._timer is None or at < self._timer.when():
            if self._timer is not None:
                self._timer.cancel()
            self._timer = loop.call_at(at, self._end_wait)
        self._wait = loop.create_future()
        loop.add_reader(self._file, self._wake)
        try:
            await self._wait
        finally:
            loop.remove_reader(self._file)

    def _end_wait(self) -> None:
        self._timer = None
        self._wake()

    def _wake(self) -> None:
        if not self._wait.done():
            self._wait.set_result(None)
