"""The client for asyncio: the same rules, without a thread where the bus has a file descriptor."""

from __future__ import annotations

import asyncio
import functools
import math
import time
from collections.abc import AsyncIterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, cast

import can

from ._codec import Message, Request
from .client import LISTEN, BusLost, ClientCore, Outcome, Steps

if TYPE_CHECKING:
    from typing_extensions import Self

R = TypeVar("R", bound=Message)
T = TypeVar("T")


class AsyncClient(ClientCore):
    """A client for asyncio. Tasks wait for each other: `cycle` sends to all nodes at once. Use it with `async with`."""

    async def __aenter__(self) -> Self:
        self._turn = asyncio.Lock()
        await self._open()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self._drive(self._close_steps())
        await self._wait_for_reading()

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
            await self._wait_for_reading()
            self._use(bus)
        await self._open()

    async def every(self, rate: float) -> AsyncIterator[int]:
        """The number of each period, as `Client.every`."""
        periods = self._periods(rate, time.monotonic(), self._bits)
        yield 0
        for number, pause in periods:
            await asyncio.sleep(pause)
            yield number

    async def _open(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._reading: asyncio.Future[can.Message | None] | None = None
        try:
            self._file = -1 if self._reader else self.bus.fileno()
        except NotImplementedError:
            self._file = -1
        await self._drive(self._settle(self._lines.values()))

    async def _drive(self, steps: Steps[T]) -> T:
        """Waits for the bus between steps; tasks wait for each other."""
        async with self._turn:
            try:
                until = next(steps)
                while True:
                    try:
                        message = await self._receive(until)
                    except (can.CanError, OSError, ValueError) as error:
                        until = steps.throw(BusLost(f"the bus does not work: {error}"))
                    except BaseException as error:
                        until = steps.throw(error)
                    else:
                        until = steps.send(message)
            except StopIteration as stop:
                return cast("T", stop.value)

    async def _receive(self, until: float) -> can.Message | None:
        """The next frame; None if there is none until then, or if the wait ended before."""
        if self._reading is None:
            message = self._receiver()(0)
            left = until - time.monotonic()
            if message is not None or left <= 0:
                return message
            if self._file >= 0:
                await self._readable(left)
                return self._receiver()(0)
            self._reading = self._loop.run_in_executor(None, self._receiver(), min(left, LISTEN))
        try:
            return await asyncio.shield(self._reading)  # a frame that comes after a cancellation is the next one
        finally:
            if self._reading.done():
                self._reading = None

    async def _readable(self, seconds: float) -> None:
        """Waits until the bus has a frame, at most that long."""
        wake = self._loop.create_future()
        end = functools.partial(_end, wake)
        timer = self._loop.call_later(seconds, end)
        self._loop.add_reader(self._file, end)
        try:
            await wake
        finally:
            self._loop.remove_reader(self._file)
            timer.cancel()

    async def _wait_for_reading(self) -> None:
        """Waits for the thread that reads the bus, if there is one."""
        if self._reading is not None:
            await asyncio.wait((self._reading,))


def _end(wake: asyncio.Future[None]) -> None:
    if not wake.done():
        wake.set_result(None)
