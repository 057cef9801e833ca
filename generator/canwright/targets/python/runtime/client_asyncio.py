"""The client for asyncio: the same rules, without a thread where the bus has a file descriptor."""

from __future__ import annotations

import asyncio
import contextlib
import math
import os
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
        self._watched = -1
        """A descriptor of its own for the bus, while the loop watches it: the program may close the bus at any time."""
        await self._run(self._settle(self.nodes.values()))
        return self

    async def __aexit__(self, *_: object) -> None:
        try:
            await self._run(self._close())
        finally:
            self._unwatch()

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
            self._unwatch()
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
            self._file = -1 if self._notifier or os.name == "nt" else bus.fileno()

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
            return await self._watch(left)
        reading = asyncio.get_running_loop().run_in_executor(None, self._receive, min(left, LISTEN))
        try:
            return await asyncio.shield(reading)
        except asyncio.CancelledError:
            await asyncio.wait((reading,))  # only one thread may read the bus
            raise

    async def _watch(self, seconds: float) -> can.Message | None:
        """The next frame; None if there is none for a time in seconds. Afterwards, the loop still watches the bus."""
        loop = asyncio.get_running_loop()
        self._wait: asyncio.Future[can.Message | None] = loop.create_future()
        if self._watched < 0:
            self._watched = os.dup(self._file)
            loop.add_reader(self._watched, self._on_readable)
        timer = loop.call_later(seconds, self._end_wait)
        try:
            return await self._wait
        finally:
            timer.cancel()

    def _on_readable(self) -> None:
        """Reads for the task that waits. Without one, a frame ends the watch, so that the loop does not turn for nothing."""
        if self._wait.done():
            self._unwatch()
            return
        try:
            message = self._receive(0.0)
        except Exception as error:
            self._wait.set_exception(error)
        else:
            if message is not None:
                self._wait.set_result(message)

    def _end_wait(self) -> None:
        if not self._wait.done():
            self._wait.set_result(None)

    def _unwatch(self) -> None:
        if self._watched >= 0:
            asyncio.get_running_loop().remove_reader(self._watched)
            os.close(self._watched)
            self._watched = -1
