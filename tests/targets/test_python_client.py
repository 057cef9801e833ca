"""The client of the generated package: which frame it takes for a reply, what it sends, and what it refuses."""

from __future__ import annotations

import asyncio
import errno
import itertools
import queue
import random
import selectors
import socket
import sys
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from types import ModuleType
from typing import Any

import can
import pytest

from ..spec_texts import ROOT
from .live_bus import Clock, VirtualTimeBus

NAMES = ("v2_35", "v2_36_2025_03", "nodes", "client", "exchange")


@pytest.fixture(scope="module")
def package() -> Iterator[dict[str, ModuleType]]:
    """The committed package, whatever other tests have imported under its name."""
    imported = {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] == "mwd_motor"}
    sys.path.insert(0, str(ROOT / "generated/python"))
    yield {name: import_module(f"mwd_motor.{name}") for name in NAMES}
    sys.path.remove(str(ROOT / "generated/python"))
    for name in [name for name in sys.modules if name.split(".")[0] == "mwd_motor"]:
        del sys.modules[name]
    sys.modules.update(imported)


@pytest.fixture
def clock(package: dict[str, ModuleType], monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(package["client"], "time", made)
    return made


class Bench:
    """A client and the nodes of one edition on a bus in virtual time, which answer as the manual prints."""

    def __init__(self, package: dict[str, ModuleType], clock: Clock, edition: str, **options: Any) -> None:
        self.edition = package[edition]
        self.client_module = package["client"]
        self.known = self.edition.Parameters(series=self.edition.Series.MG, encoder_bits=14)
        self.silent: set[int] = set()
        self.bus = VirtualTimeBus(clock, self._answer, **options)
        self.nodes = [package["nodes"].Node(self.edition, number, self.known) for number in (1, 2, 3, 4)]
        self.reply_offset = 0 if edition == "v2_35" else 0x40

    def client(self, **options: Any) -> Any:
        return self.client_module.Client(self.bus, self.nodes, **options)

    def torque(self, node: int = 1, raw: int = 100) -> Any:
        return self.edition.SetTorqueRequest.from_raw(node=node, iq=raw, parameters=self.known)

    def sent(self) -> list[str]:
        """Id and code of each frame sent since the last call."""
        sent = [f"{m.arbitration_id:03X} {m.data[0]:02X}" for m in self.bus.sent]
        self.bus.sent.clear()
        return sent

    def _answer(self, asked: can.Message) -> Iterable[can.Message]:
        """Voltage 48.0 V; a motion is answered with the low byte of its argument as the speed."""
        if asked.arbitration_id == 0x280:
            for number in (1, 2, 3, 4):
                yield from self._motion(number, 0xA1, asked.data[2 * number - 2])
            return
        node, code = asked.arbitration_id - 0x140, asked.data[0]
        if code in (0x9A, 0x9B):
            voltage = (480).to_bytes(2, "little") if self.reply_offset == 0 else (4800).to_bytes(2, "little")
            body = bytes(2) + voltage if self.reply_offset == 0 else b"\x14" + voltage + bytes(1)
            data = bytes([0x9A if self.reply_offset == 0 else code]) + body
            yield from self._reply(node, data.ljust(8, b"\0"))
        elif code in (0x80, 0x81, 0x88, 0x31, 0x32, 0x34):
            yield from self._reply(node, bytes(asked.data))
        elif 0xA0 <= code <= 0xA8 or code == 0x9C:
            yield from self._motion(node, code, asked.data[4])
        else:
            yield from self._reply(node, bytes([code, *asked.data[1:3], 1, 2, 3, 0, 0]))

    def _motion(self, node: int, code: int, speed: int) -> Iterable[can.Message]:
        return self._reply(node, bytes([code, 0x32, 0x10, 0x00, speed, 0x00, 0x00, 0x20]))

    def _reply(self, node: int, data: bytes) -> Iterable[can.Message]:
        if node not in self.silent:
            yield can.Message(arbitration_id=0x140 + node + self.reply_offset, data=data, is_extended_id=False)


Make = Callable[..., Bench]


@pytest.fixture
def bench(package: dict[str, ModuleType], clock: Clock) -> Make:
    return lambda edition="v2_35", **options: Bench(package, clock, edition, **options)


@pytest.mark.parametrize("returned", [False, True])
@pytest.mark.parametrize("edition", ["v2_35", "v2_36_2025_03"])
def test_a_request_has_its_reply(bench: Make, edition: str, returned: bool) -> None:
    bus = bench(edition, returned=returned)
    with bus.client(allow="motion") as client:
        assert client.request(bus.torque(raw=7)).speed == 7
        assert client.request(bus.edition.ReadStatus1Request(node=2)).voltage == 48
        assert client.request(bus.edition.MotorOnRequest(node=3)) == bus.edition.MotorOnReply(node=3)
        outcomes = client.cycle([bus.torque(node, 10 * node) for node in (4, 2, 2)])
        assert [outcome.reply.speed for outcome in outcomes] == [40, 20, 20]
        assert {outcome.error for outcome in outcomes} == {None}
        assert client.counters.missing == client.counters.foreign == client.counters.unproven == 0


def test_opening_reads_each_node_once(bench: Make) -> None:
    bus = bench()
    with bus.client():
        assert bus.sent() == ["141 9A", "142 9A", "143 9A", "144 9A"]
    assert bus.sent() == []


@pytest.mark.parametrize("returned", [False, True])
def test_own_frames_are_never_a_success(bench: Make, returned: bool) -> None:
    bus = bench(returned=returned)
    bus.silent = {1, 2, 3, 4}
    with bus.client(allow="motion", on_exit="nothing") as client:
        for request in (bus.torque(), bus.edition.MotorOnRequest(node=1), bus.edition.ReadStatus1Request(node=2)):
            with pytest.raises(bus.client_module.ClientError):
                client.request(request)


def test_an_edition_without_a_proving_read_is_unproven(bench: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    bus = bench()
    facts = bus.edition.client_facts
    monkeypatch.setattr(bus.edition, "client_facts", facts._replace(reads=()))
    with (
        bus.client(on_exit="nothing") as client,
        pytest.raises(bus.client_module.Unproven, match="the same frame came back"),
    ):
        client.request(bus.edition.MotorOnRequest(node=1))


def _wrong(bus: Bench, client: Any, exchanges: int) -> tuple[int, int]:
    """Replies that belong to another request, and requests with a reply."""
    choose, wrong, answered = random.Random(3).random, 0, 0
    for number in range(exchanges):
        raw = number % 251
        if choose() < 0.1:
            outcome = client.cycle([bus.edition.ReadStatus1Request(node=1)], tries=3)[0]
            wrong += outcome.reply is not None and outcome.reply.voltage != 48
        else:
            outcome = client.cycle([bus.torque(raw=raw)], tries=3)[0]
            wrong += outcome.reply is not None and outcome.reply.speed_raw != raw
        assert (outcome.reply is None) != (outcome.error is None)
        client.bus.clock.sleep(0.001)
        answered += outcome.reply is not None
    return wrong, answered


@pytest.mark.parametrize("edition", ["v2_35", "v2_36_2025_03"])
def test_no_late_reply_is_taken_for_another(bench: Make, edition: str) -> None:
    bus = bench(edition, loss=0.005, late=0.01, twice=0.001)
    with bus.client(allow="motion", bit_rate=1_000_000, timeout=0.01) as client:
        wrong, answered = _wrong(bus, client, 20_000)
    assert wrong == 0
    assert answered > 19_000
    assert client.counters.late > 50


def test_after_a_missing_reply_only_reads_go_out(bench: Make) -> None:
    bus = bench()
    with bus.client(allow="motion", on_exit="nothing") as client:
        bus.silent = {1}
        bus.sent()
        for _ in range(20):
            client.cycle([bus.torque(1), bus.torque(2)])
        sent = bus.sent()
        assert sent.count("141 A1") == 1
        assert sent.count("142 A1") == 20
        assert 3 < len([frame for frame in sent if frame.startswith("141")]) < 12
        bus.silent = set()
        client.bus.clock.sleep(2)
        assert client.request(bus.torque(1, 5)).speed == 5
        first, last = bus.sent()
        assert (first != "141 A1", last) == (True, "141 A1")


def test_motion_wear_and_contact_need_consent(bench: Make) -> None:
    bus = bench("v2_36_2025_03")
    edition, refused = bus.edition, bus.client_module.ConsentError
    contact = edition.StageStoredSettingDriverIdRequest(node=1, driver_id=7)
    wear = edition.WritePositionAsZeroRomRequest(node=1)
    brake = edition.BrakeAction
    with bus.client(allow={2: "motion"}) as client:
        bus.sent()
        with pytest.raises(
            refused, match=r"The motor moves. To allow this, give the client or the call allow=\"motion\"$"
        ):
            client.request(bus.torque(1))
        for request, consent in ((contact, "contact"), (wear, "wear")):
            with pytest.raises(refused, match=f'give the call allow="{consent}"$'):
                client.request(request, allow="motion")
        with pytest.raises(refused, match="brake is locked or released"):
            client.request(edition.BrakeRequest(node=1, action=brake.RELEASE))
        outcomes = client.cycle([bus.torque(1), bus.torque(2)])
        assert isinstance(outcomes[0].error, refused)
        assert outcomes[1].reply is not None
        assert bus.sent() == ["142 A1"]
        client.request(edition.BrakeRequest(node=1, action=brake.READ))
        client.request(edition.MotorStopRequest(node=1))
        client.request(wear, allow="wear")
        assert bus.sent() == ["141 8C", "141 81", "141 19"]


def test_an_effect_is_exempt_if_each_element_is(bench: Make) -> None:
    """Of a field with several elements, one value without the effect is not enough."""

    class Request:
        EFFECTS = ("moves", "writes")
        EXEMPT = {"action": {16: ("moves",)}}

        def __init__(self, *actions: int) -> None:
            self.actions = actions

        def raw(self) -> dict[str, tuple[int, ...]]:
            return {"action": self.actions}

    effects_of = bench().client_module.effects_of
    assert effects_of(Request(16, 16)) == ("writes",)
    assert effects_of(Request(16, 1)) == ("moves", "writes")


def test_a_request_whose_reply_could_not_be_decoded_is_not_sent(bench: Make) -> None:
    """Without the series: else the motor would move, and its reply would be lost. It can be stopped."""
    bus = bench()
    unknown = [type(node)(node.edition, node.node) for node in bus.nodes]
    with bus.client_module.Client(bus.bus, unknown, allow="motion") as client:
        bus.sent()
        with pytest.raises(bus.client_module.NotSent, match="depends on series, which is not given"):
            client.request(bus.edition.MoveByAngleRequest(node=1, increment=90))
        assert client.request(bus.edition.MotorStopRequest(node=1))
        assert bus.sent() == ["141 81"]


def test_only_what_is_safe_is_repeated(bench: Make) -> None:
    bus = bench()
    edition = bus.edition
    with bus.client(allow="motion", on_exit="nothing") as client:
        turn = edition.TurnToAngleRequest(node=1, spin_direction=edition.SpinDirection.CLOCKWISE, angle=10)
        for request in (edition.MoveByAngleRequest(node=1, increment=10), turn):
            with pytest.raises(ValueError, match="cannot be repeated safely; leave out tries=2"):
                client.request(request, tries=2)
        assert client.request(bus.torque(), tries=2).speed == 100


@pytest.mark.parametrize(("on_exit", "last"), [("stop", ["142 81"]), ("off", ["142 80"]), ("nothing", [])])
def test_leaving_stops_the_nodes_that_were_moved(bench: Make, on_exit: str, last: list[str]) -> None:
    bus = bench()
    with pytest.raises(ZeroDivisionError), bus.client(allow="motion", on_exit=on_exit) as client:
        client.request(bus.torque(2))
        client.request(bus.torque(1))
        client.request(bus.edition.MotorStopRequest(node=1))
        bus.sent()
        raise ZeroDivisionError
    assert bus.sent() == last


def test_a_stop_without_a_reply_is_sent_again_at_the_end(bench: Make) -> None:
    bus = bench()
    with pytest.raises(bus.client_module.NoReply), bus.client(allow="motion") as client:
        client.request(bus.torque(2))
        bus.silent = {2}
        try:
            client.request(bus.edition.MotorStopRequest(node=2))
        finally:
            bus.silent = set()
            bus.sent()
    assert bus.sent() == ["142 81"]


def test_each_of_many_requests_to_a_silent_node_has_an_outcome(bench: Make) -> None:
    bus = bench()
    with bus.client(allow="motion", on_exit="nothing") as client:
        bus.silent = {1}
        outcomes = client.cycle([bus.torque(1)] * 1000)
    assert isinstance(outcomes[0].error, bus.client_module.NoReply)
    assert {type(outcome.error) for outcome in outcomes[1:]} == {bus.client_module.NotSent}


def test_a_node_that_does_not_confirm_its_stop_is_named(bench: Make) -> None:
    bus = bench()
    with pytest.warns(UserWarning, match=r"nodes did not confirm stop, and may still move: \[2\]"):  # noqa: SIM117
        with bus.client(allow="motion") as client:
            client.request(bus.torque(2))
            bus.silent = {2}
            bus.sent()
    assert bus.sent()[0] == "142 81"


@pytest.mark.parametrize("is_full", [False, True])
def test_a_stop_without_a_reply_needs_no_confirmation(
    bench: Make, monkeypatch: pytest.MonkeyPatch, is_full: bool
) -> None:
    """Where it was sent."""
    bus = bench()
    monkeypatch.setattr(bus.edition.client_facts.ends_motion["stop"], "REPLIES", 0)
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        with bus.client(allow="motion") as client:
            client.request(bus.torque(2))
            bus.silent = {2}
            bus.sent()
            if is_full:
                bus.bus.send_error = can.CanOperationError("Transmit buffer full", error_code=errno.ENOBUFS)
    assert [str(each.message)[:27] for each in warned] == ["nodes did not confirm stop,"] * is_full
    assert bus.sent()[:1] == ["142 81"] * (not is_full)


def test_a_node_without_a_request_that_stops_it_is_named(bench: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    bus = bench()
    monkeypatch.delitem(bus.edition.client_facts.ends_motion, "stop")
    says = r"no request ends the motion of nodes with on_exit='stop', so they may still move: \[2\]"
    with pytest.warns(UserWarning, match=says) as warned, bus.client(allow="motion") as client:
        client.request(bus.torque(2))
    assert len(warned) == 1


def test_a_full_queue_and_a_lost_bus_are_outcomes(bench: Make) -> None:
    bus, full = bench(), can.CanOperationError("Transmit buffer full", error_code=errno.ENOBUFS)
    module = bus.client_module
    with bus.client(allow="motion", on_exit="nothing") as client:
        bus.bus.send_error = full
        assert isinstance(client.cycle([bus.torque(1)])[0].error, module.NotSent)
        bus.bus.send_error = None
        assert client.request(bus.torque(1, 9)).speed == 9
        bus.bus.recv_error = can.CanOperationError("bus off")
        errors = [outcome.error for outcome in client.cycle([bus.torque(1), bus.torque(2)])]
        assert [type(error) for error in errors] == [module.BusLost, module.BusLost]
        bus.bus.recv_error = None
        with pytest.raises(module.BusLost, match="call reopen"):
            client.request(bus.torque(1))
        bus.sent()
        client.reopen(bus.bus)
        assert bus.sent() == ["141 9A", "142 9A", "143 9A", "144 9A"]
        assert client.request(bus.torque(1, 8)).speed == 8


def test_a_program_that_is_held_up_finds_the_replies_that_came(
    bench: Make, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The reply lies behind other frames in the bus, but no stream of frames holds up a time-out for long."""
    bus = bench(edition="v2_36_2025_03", returned=True, round_trip=0)
    answer = bus.bus.answer

    def hold_up(asked: can.Message) -> Iterable[can.Message]:
        clock.sleep(0.1)
        return answer(asked)

    def next_of_stream(timeout: float) -> can.Message | None:
        clock.sleep(0.001)
        assert clock.now < start + 0.3
        return can.Message(arbitration_id=0x700, is_extended_id=False) if bus.bus.sent else None

    with bus.client(allow="motion", on_exit="nothing") as client:
        bus.bus.answer = hold_up
        assert client.request(bus.torque(1, 7)).speed == 7
        bus.bus.answer = answer
        bus.silent = {1}
        bus.sent()
        start = clock.now
        monkeypatch.setattr(bus.bus, "recv", next_of_stream)
        assert client.cycle([bus.torque()])[0].reply is None


def test_an_interrupted_request_is_not_answered_later(bench: Make) -> None:
    bus = bench()
    with bus.client(allow="motion", on_exit="nothing") as client:
        receive = bus.bus.recv

        def interrupted(timeout: float) -> can.Message | None:
            if timeout and bus.bus.sent:
                raise KeyboardInterrupt
            return receive(timeout)

        bus.sent()
        bus.bus.recv = interrupted  # type: ignore[method-assign]
        with pytest.raises(KeyboardInterrupt):
            client.request(bus.torque(1, 1))
        bus.bus.recv = receive  # type: ignore[method-assign]
        assert client.request(bus.torque(1, 2)).speed == 2
        assert bus.sent() == ["141 A1", "141 30", "141 A1"]


def test_a_broadcast_has_a_reply_of_each_node(bench: Make) -> None:
    bus = bench()
    request = bus.edition.BroadcastTorqueRequest.from_raw(iq=(1, 2, 3, 4))
    with bus.client(allow="motion") as client:
        with pytest.raises(TypeError, match="use send or gather"):
            client.request(request)
        assert [(reply.node, reply.speed) for reply in client.gather(request)] == [(1, 1), (2, 2), (3, 3), (4, 4)]
        bus.silent = {3}
        assert [reply.node for reply in client.gather(request)] == [1, 2, 4]
        bus.sent()
        with pytest.raises(bus.client_module.NotSent, match="because a node does not answer"):
            client.gather(request)
        assert "280 01" not in bus.sent()
        bus.silent = set()
    assert sorted(bus.sent()) == ["141 81", "142 81", "143 81", "144 81"]


def test_frames_of_another_host_are_counted(bench: Make) -> None:
    bus = bench()
    with bus.client() as client:
        bus.bus.put(can.Message(arbitration_id=0x142, data=bytes(8), is_extended_id=False))
        bus.bus.put(can.Message(arbitration_id=0x7FF, data=bytes(8), is_extended_id=False))
        bus.bus.put(can.Message(is_error_frame=True))
        client.request(bus.edition.ReadEncoderRequest(node=1))
        assert (client.counters.foreign, client.counters.errors) == (1, 1)


def test_a_period_is_kept_and_overruns_are_counted(bench: Make, clock: Clock) -> None:
    bus = bench()
    with bus.client(allow="motion", bit_rate=1_000_000) as client:
        starts = []
        for period in client.every(100):
            starts.append(round(clock.now, 6))
            client.cycle([bus.torque(1)])
            if period == 2:
                clock.sleep(0.025)
            if period > 5:
                break
    assert [round(b - a, 3) for a, b in itertools.pairwise(starts)] == [0.01, 0.01, 0.03, 0.01]
    assert client.counters.overruns == 2


def test_a_rate_beyond_the_wire_is_a_warning(bench: Make) -> None:
    bus = bench(round_trip=0.003)
    with (
        bus.client(allow="motion", bit_rate=125_000) as client,
        pytest.warns(UserWarning, match="at 125000 bit/s, more"),
    ):
        for period in client.every(200):
            if period:
                break
            client.cycle([bus.torque(node) for node in (1, 2, 3, 4)])


def test_requests_of_two_threads_have_their_replies(package: dict[str, ModuleType]) -> None:
    """On a virtual bus of python-can, and through a notifier that something else reads, too."""
    bench = Bench(package, Clock(), "v2_35")
    edition, module = bench.edition, bench.client_module
    host, node = (can.Bus("threads", interface="virtual") for _ in range(2))
    ended = threading.Event()

    def run() -> None:
        while not ended.is_set():
            asked = node.recv(0.02)
            for reply in bench._answer(asked) if asked else ():
                node.send(reply)

    wrong: list[tuple[int, int]] = []

    def ask(number: int) -> None:
        for raw in range(100):
            if client.request(bench.torque(number, raw), timeout=5).speed != raw:
                wrong.append((number, raw))

    threads = [threading.Thread(target=ask, args=(number,), daemon=True) for number in (1, 2)]
    answering = threading.Thread(target=run, daemon=True)
    answering.start()
    heard = can.BufferedReader()
    with (
        can.Notifier(host, [heard]) as notifier,
        module.Client(host, bench.nodes, allow="motion", timeout=5, notifier=notifier) as client,
    ):
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert client.request(edition.ReadStatus1Request(node=1)).voltage == 48
    ended.set()
    answering.join()
    host.shutdown()
    node.shutdown()
    assert wrong == []
    assert client.counters.sent == client.counters.answered
    assert heard.get_message(0) is not None


def test_mistakes_of_a_program_are_errors(bench: Make, package: dict[str, ModuleType]) -> None:
    bus = bench()
    with bus.client() as client:
        with pytest.raises(ValueError, match=r"node=9 is none of this client; give one of"):
            client.request(bus.edition.ReadStatus1Request(node=9))
        with pytest.raises(TypeError, match="is of another edition"):
            client.request(package["v2_36_2025_03"].ReadStatus1Request(node=1))
    with pytest.raises(ValueError, match="allow='wear' is not motion; give other consents with each request"):
        bus.client(allow="wear")
    with pytest.raises(ValueError, match="on_exit='park' is none of stop, off, nothing"):
        bus.client(on_exit="park")
    with pytest.raises(ValueError, match="have the same number"):
        bus.client_module.Client(bus.bus, [bus.nodes[0], bus.nodes[0]])


def test_a_notifier_with_asyncio(package: dict[str, ModuleType]) -> None:
    bench = Bench(package, Clock(), "v2_35")
    module = import_module("mwd_motor.client_asyncio")

    async def ask() -> list[int]:
        async with module.AsyncClient(host, bench.nodes, allow="motion", timeout=5, notifier=notifier) as client:
            return [(await client.request(bench.torque(1, raw))).speed for raw in range(20)]

    def answer(asked: can.Message) -> None:
        for reply in bench._answer(asked):
            node.send(reply)

    with can.Bus("tasks", interface="virtual") as host, can.Bus("tasks", interface="virtual") as node:
        heard = can.BufferedReader()
        with can.Notifier(node, [answer], timeout=0.05), can.Notifier(host, [heard], timeout=0.05) as notifier:
            assert asyncio.run(ask()) == [*range(20)]
            assert notifier.listeners == [heard]
        assert heard.get_message(0) is not None


@pytest.mark.parametrize("has_file", [False, True])
def test_asyncio_has_the_same_rules(package: dict[str, ModuleType], has_file: bool) -> None:
    """With a thread that reads, and with a file descriptor: a socket that is readable when a frame has come."""
    bench = Bench(package, Clock(), "v2_35")
    module = import_module("mwd_motor.client_asyncio")
    bus = _AnsweringBus(bench, has_file=has_file)

    async def control() -> list[Any]:
        async with module.AsyncClient(bus, bench.nodes, allow="motion", timeout=5) as client:
            seen = [(await client.request(bench.torque(1, 7))).speed]
            results = await asyncio.gather(*(client.request(bench.torque(2, raw)) for raw in range(20)))
            seen += [[reply.speed for reply in results] == [*range(20)]]
            seen += [
                outcome.reply.speed for outcome in await client.cycle([bench.torque(node, node) for node in (1, 2)])
            ]
            async for period in client.every(1000):
                if period >= 2:
                    break
            bench.silent = {1}
            with pytest.raises(bench.client_module.NoReply):
                await client.request(bench.edition.ReadEncoderRequest(node=1), timeout=0.01)
            bench.silent = set()
            bus.sent.clear()
            seen += [len(await client.gather(bench.edition.BroadcastTorqueRequest.from_raw(iq=(1, 2, 3, 4))))]
            bus.error = can.CanOperationError("bus off")
            with pytest.raises(bench.client_module.BusLost):
                await client.request(bench.torque(1))
            bus.error = None
        return seen

    assert asyncio.run(control()) == [7, True, 1, 2, 4]
    assert bus.sent[0] != 0x280, "the node that did not answer has to answer a read first"
    bus.shutdown()


def test_a_time_out_of_asyncio_ends_in_time_in_each_loop(package: dict[str, ModuleType]) -> None:
    """Also after longer ones, and in a second loop."""
    bench = Bench(package, Clock(), "v2_35")
    bus = _AnsweringBus(bench, has_file=True, delay=0.002)
    options: dict[str, Any] = {"allow": "motion", "on_exit": "nothing", "timeout": 60}
    client = import_module("mwd_motor.client_asyncio").AsyncClient(bus, bench.nodes[:1], **options)

    async def ask(timeout: float) -> None:
        async with client:
            assert (await client.request(bench.torque(1, 7))).speed == 7
            bench.silent = {1}
            with pytest.raises(bench.client_module.NoReply):
                await asyncio.wait_for(client.request(bench.torque(), timeout=timeout), 20)
            bench.silent = set()
            assert [(await client.request(bench.torque(1, raw))).speed for raw in range(20)] == [*range(20)]

    asyncio.run(ask(0.02))
    asyncio.run(ask(0.1))
    bus.shutdown()


def test_a_program_can_close_the_bus_that_the_loop_watches(package: dict[str, ModuleType]) -> None:
    """The number of its file is free for others then, and the loop of asyncio serves them."""
    bench = Bench(package, Clock(), "v2_35")
    module = import_module("mwd_motor.client_asyncio")

    async def close_and_open(reopen: bool) -> None:
        bus = _AnsweringBus(bench, has_file=True, delay=0.001)
        async with module.AsyncClient(bus, bench.nodes[:1], timeout=10) as client:
            status = bench.edition.ReadStatus1Request(node=1)
            assert (await client.request(status)).voltage == 48
            number = bus.fileno()
            bus.error = can.CanOperationError("closed")
            bus.shutdown()
            ours, theirs = socket.socketpair()
            assert ours.fileno() == number
            reader, writer = await asyncio.open_connection(sock=ours)
            theirs.send(b"line\n")
            assert await asyncio.wait_for(reader.readline(), 10) == b"line\n"
            with pytest.raises(bench.client_module.BusLost):
                await client.request(status)
            if reopen:
                bus = _AnsweringBus(bench, has_file=True, delay=0.001)
                await client.reopen(bus)
                assert (await client.request(status)).voltage == 48
        theirs.send(b"more\n")
        assert await asyncio.wait_for(reader.readline(), 10) == b"more\n"
        writer.close()
        theirs.close()
        bus.shutdown()

    for reopen in (False, True):
        asyncio.run(close_and_open(reopen))


@pytest.mark.parametrize("has_file", [False, True])
def test_a_bus_that_is_lost_ends_the_wait_of_asyncio(package: dict[str, ModuleType], has_file: bool) -> None:
    bench = Bench(package, Clock(), "v2_35")
    bus = _AnsweringBus(bench, has_file=has_file)

    async def lose() -> None:
        async with import_module("mwd_motor.client_asyncio").AsyncClient(bus, bench.nodes[:1], timeout=20) as client:
            asked = asyncio.ensure_future(client.request(bench.edition.ReadEncoderRequest(node=1)))
            bench.silent = {1}
            await asyncio.sleep(0.02)
            bus.error = can.CanOperationError("bus off")
            bus.wake()
            with pytest.raises(bench.client_module.BusLost, match="bus off"):
                await asyncio.wait_for(asked, 5)

    asyncio.run(lose())
    bus.shutdown()


def test_frames_that_no_task_waits_for_do_not_turn_the_loop(package: dict[str, ModuleType]) -> None:
    bench = Bench(package, Clock(), "v2_35")
    bus = _AnsweringBus(bench, has_file=True, delay=0.001)

    class Counted(selectors.DefaultSelector):
        turns = 0

        def select(self, timeout: float | None = None) -> Any:
            self.turns += 1
            return super().select(timeout)

    async def idle() -> int:
        """How often the loop turns while frames lie in the bus."""
        async with import_module("mwd_motor.client_asyncio").AsyncClient(bus, bench.nodes[:1], timeout=10) as client:
            status = bench.edition.ReadStatus1Request(node=1)
            await client.request(status)
            bus._reply(can.Message(arbitration_id=0x142, data=bytes.fromhex("9C00000000000000")))
            start = selector.turns
            await asyncio.sleep(0.2)
            turns = selector.turns - start
            assert (await client.request(status)).voltage == 48
        return turns

    selector = Counted()
    loop = asyncio.SelectorEventLoop(selector)
    assert loop.run_until_complete(idle()) < 10
    loop.close()
    bus.shutdown()


class _AnsweringBus:
    """A bus without a wire: the nodes answer within `send`, or after a delay in seconds."""

    def __init__(self, bench: Bench, *, has_file: bool, delay: float = 0.0) -> None:
        self._bench = bench
        self._delay = delay
        self._frames: queue.SimpleQueue[can.Message] = queue.SimpleQueue()
        self._sockets = socket.socketpair() if has_file else None
        self.sent: list[int] = []
        self.error: Exception | None = None

    def fileno(self) -> int:
        if self._sockets is None:
            raise NotImplementedError
        return self._sockets[0].fileno()

    def send(self, message: can.Message) -> None:
        if self.error is not None:
            raise self.error
        self.sent.append(message.arbitration_id)
        if self._delay:
            asyncio.get_running_loop().call_later(self._delay, self._reply, message)
        else:
            self._reply(message)

    def _reply(self, message: can.Message) -> None:
        for reply in self._bench._answer(message):
            self._frames.put(reply)
            self.wake()

    def wake(self) -> None:
        if self._sockets is not None:
            self._sockets[1].send(b"x")

    def recv(self, timeout: float) -> can.Message | None:
        if self.error is not None:
            raise self.error
        try:
            message = self._frames.get(timeout=timeout) if timeout else self._frames.get_nowait()
        except queue.Empty:
            return None
        if self._sockets is not None:
            self._sockets[0].recv(1)
        return message

    def shutdown(self) -> None:
        for end in self._sockets or ():
            end.close()
