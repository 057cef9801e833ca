"""Logs of known editions, and what `canwright identify` makes of them. The frames are worked out by hand."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.model.edition import Edition
from canwright.project.loader import spec_files, specification
from canwright.recordings import candump
from canwright.recordings.directions import DecidedBy, Directions
from canwright.recordings.frame_classes import FrameClasses
from canwright.recordings.identify import identify
from canwright.recordings.kept_frames import BLOCK, MAX_KEPT
from canwright.recordings.log_frame import Counts, LogFrame
from canwright.recordings.nodes import Identifiers
from canwright.recordings.readings import EditionReader
from canwright.recordings.results import Identification, NodeResult
from canwright.semantics.frame import CanFrame
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL, ROOT, WITHOUT_SETTINGS_IN_IDS, called, edition
from .traffic import in_cycles

EDITIONS = [specification(file).edition for file in spec_files(ROOT / "spec")]

# 48.7 V as 0.1 V in DATA[3..4]: 487 = 0x01E7
V2_35 = ["142#9A00000000000000", "142#9A3200E701000000", "142#A10000009B000000", "142#A1329B00F4010080"]
# 48.72 V as 0.01 V in DATA[2..3]: 4872 = 0x1308; 1 A in DATA[4..5]
V2_35_2024_02 = ["141#9A00000000000000", "141#9A32081364000000"]
V2_36 = ["143#9A00000000000000", "183#9A32081364000000"]
# 0x18 calibrates, and only the edition of 2025-03 has it
V2_36_2025_03 = ["143#1800000000000000", "183#1800000100020011", "143#9A00000000000000", "183#9A32081364000000"]
# What real drives were seen to answer, published by those who use them: 23.88 V; 48.72 V; gains of the loops
MEASURED = [
    (["141#9A00000000000000", "141#9A1F540900000000"], 1, ["v2.35-2024-02"]),
    (["141#9A00000000000000", "141#9A24081300000000"], 1, ["v2.35-2024-02"]),
    (["142#9A00000000000000", "142#9A250A1300000000"], 2, ["v2.35-2024-02"]),
    (["143#9A00000000000000", "143#9A22111300000000"], 3, ["v2.35-2024-02"]),
    (["141#3000000000000000", "141#30001E001E051E05"], 1, ["v2.35"]),
]


CHANGING = ["v2.35"] * 300 + ["v2.35-2024-02"] * 300


def write(folder: Path, lines: list[str]) -> Path:
    file = folder / "bus.log"
    file.write_text("".join(f"(1.{i:03}000) can0 {line}\n" for i, line in enumerate(lines)), "utf-8")
    return file


def identified(lines: Sequence[str], editions: Sequence[Edition] = EDITIONS) -> Identification:
    return identify(candump.read([f"(1.000000) can0 {line}\n" for line in lines], Counts()), editions)


def cycles(*texts: str) -> Identification:
    return identify(in_cycles(*texts), EDITIONS)


def names(result: NodeResult) -> list[str]:
    return sorted(edition.name for edition in result.editions)


def run(folder: Path, lines: list[str], *options: str) -> Result:
    copies = [shutil.copy(file, folder) for file in spec_files(ROOT / "spec")]  # without their golden frames
    specs = [option for file in copies for option in ("--spec", str(file))]
    return CliRunner().invoke(main, ["identify", str(write(folder, lines)), *specs, *options])


@pytest.mark.parametrize(
    ("lines", "node", "fits"),
    [
        (V2_35, 2, ["v2.35"]),
        (V2_35_2024_02, 1, ["v2.35-2024-02"]),
        (V2_36, 3, ["v2.36-2024-11", "v2.36-2025-03"]),
        (V2_36_2025_03, 3, ["v2.36-2025-03"]),
        (["141#8100000000000000"] * 2, 1, ["v2.35", "v2.35-2024-02"]),
        (["141#8100000000000000"], 1, []),
        (["141#EE00000000000000"], 1, []),
        *MEASURED,
    ],
)
def test_editions_that_fit_the_frames_of_a_node(lines: list[str], node: int, fits: list[str]) -> None:
    identification = identified(lines)
    assert [(f.node, names(f)) for f in identification.nodes] == [(node, fits)]
    assert not identification.foreign


def test_each_node_of_a_bus_has_its_own_edition(tmp_path: Path) -> None:
    result = run(tmp_path, V2_35 + V2_35_2024_02 + V2_36_2025_03)
    assert result.exit_code == 0
    assert "node 1, 2 frames: fits v2.35-2024-02\n" in result.output
    assert "node 2, 4 frames: fits v2.35\n" in result.output
    assert "node 3, 4 frames: fits v2.36-2025-03\n" in result.output
    assert "is outside the plausible range 6..100 V" in result.output
    assert "0x180 + node is not an id of this edition (2 of 2, as in 183#1800000100020011)" in result.output


def test_an_undecided_result_suggests_what_to_record(tmp_path: Path) -> None:
    result = run(tmp_path, ["141#9C00000000000000", "141#9C32010002000A00", "7FF#00"])
    assert result.exit_code == 1
    assert "undecided, v2.35 and v2.35-2024-02 fit equally well" in result.output
    assert "record the reply to read_status_1" in result.output
    assert "1 of 3 frames are ignored, since their ids do not belong to mwd_motor: 0x7FF" in result.output
    assert run(tmp_path, ["7FF#00"]).exit_code == 1


def test_a_low_voltage_weakens_a_fit_but_does_not_exclude_it() -> None:
    # 5.00 V as 0.01 V in DATA[2..3], and the flag of a low voltage
    low = ["141#9A00000000000000", "141#9A1EF40100000001"]
    assert names(identified(low).nodes[0]) == ["v2.35", "v2.35-2024-02"]  # which reads 0.1 V
    assert names(identified(low * 3).nodes[0]) == ["v2.35-2024-02"]
    assert names(identified([f"{line[:1]}8{line[2:]}" if i % 2 else line for i, line in enumerate(low)]).nodes[0]) == [
        "v2.36-2024-11",
        "v2.36-2025-03",
    ]


@pytest.mark.parametrize("mark", ["", " R"])
@pytest.mark.parametrize("lines", [V2_35, V2_35_2024_02], ids=["v2.35", "v2.35-2024-02"])
def test_replies_without_requests(lines: list[str], mark: str) -> None:
    """A recorder that does not see its own requests; an echo that has none is no unanswered request."""
    echo = f"{lines[0][:3]}#8800000000000000"
    identification = identified([f"{line}{mark}" for line in [echo, *lines[1::2] * 5]])
    assert names(identification.nodes[0]) == names(identified(lines).nodes[0])
    assert identification.nodes[0].scores[0].requests == 0


def test_requests_without_replies() -> None:
    """A request of one edition that another one reserves bits of is no reply, from which that edition follows."""
    lines = ["144#A200FDFFA8670000", *["144#9200000000000000", "144#A400D20400E80300"] * 2]
    assert names(identified(lines * 5).nodes[0]) == []


def test_marks_decide_between_a_request_and_a_reply() -> None:
    """All-zero frames are requests; as replies they would be implausible, or a motor at an angle of 0."""
    zero = "141#9200000000000000"
    sent, received = f"{zero} T", f"{zero} R"
    assert names(identified([sent, received] * 3).nodes[0]) == ["v2.35", "v2.35-2024-02"]
    assert names(identified([sent] * 6).nodes[0]) == []


STATUS_WITH_COPY = "0 141#9A00000000000000, 80 141#9A00000000000000, 300 181#9A257B0900000000"
# 0xC0 with index 0x24 is the ramp of the current, which only the edition of 2024-11 has
RAMP_WITH_COPY = "0 141#C024000000000000, 80 141#C024000000000000"


def test_copies_of_requests_are_not_requests_without_a_reply() -> None:
    """A recorder that has its own requests twice, as its adapter returns them."""
    ramp = [f"{RAMP_WITH_COPY}, 300 181#C024000041000000", RAMP_WITH_COPY]
    (result,) = cycles(*[STATUS_WITH_COPY] * 20, *ramp).nodes
    assert names(result) == ["v2.36-2024-11"]
    assert result.scores[0].unanswered == {"read_control_parameter_current_ramp": 1}
    lost = STATUS_WITH_COPY.rpartition(",")[0]
    assert names(cycles(*[STATUS_WITH_COPY] * 20, lost).nodes[0]) == ["v2.36-2024-11", "v2.36-2025-03"]


@pytest.mark.parametrize("marks", ["TRR", "   "])
def test_copies_of_broadcasts(marks: str) -> None:
    """Nothing that nodes send is equal to them."""
    to_all, reply = "280#6400640000000000", "141#A12A640010000040"
    log = in_cycles(*[f"0 {to_all} {marks[0]}, 80 {to_all} {marks[1]}, 300 {reply} {marks[2]}"] * 10)
    assert {result.node: names(result) for result in identify(log, EDITIONS).nodes} == {
        None: ["v2.35"],
        1: ["v2.35", "v2.35-2024-02"],
    }
    edition = next(edition for edition in EDITIONS if edition.name == "v2.35")
    judged = [*Directions({}, edition).classify(log)]
    assert {frame.decided_by for frame in judged[1::3]} == {DecidedBy.COPY}
    assert [frame.request for frame in judged[2::3]] == list(range(0, 30, 3))


def test_an_edition_that_does_not_explain_what_another_one_explains_does_not_fit() -> None:
    """Even if 22 of 43 requests of the other one have no reply, and 20 of 40 of its own."""
    status, ramp = "0 141#9A00000000000000", "0 141#C024000000000000"
    answered = [*[f"{status}, 300 181#9A257B0900000000"] * 20, f"{ramp}, 300 181#C024000041000000"]
    (result,) = cycles(*answered, *[status] * 20, *[ramp] * 2).nodes
    assert names(result) == []


def test_requests_of_another_edition_that_no_node_answers_are_no_evidence() -> None:
    """The host of a mixed bus sends the same commands to all nodes."""
    read, lacked = "0 141#9C00000000000000, 300 141#9C32000000000000", "0 141#3000000000000000"
    (result,) = cycles(*["0 141#9A00000000000000, 300 141#9A32081364000000", read, lacked] * 20).nodes
    assert names(result) == ["v2.35-2024-02"]
    assert {score.edition.name: (score.explained, score.tried) for score in result.scores} == {
        "v2.35-2024-02": (80, 20),
        "v2.35": (100, 0),
        "v2.36-2024-11": (40, 20),
        "v2.36-2025-03": (40, 20),
    }
    unanswered = ["0 141#A755555500000000", "0 141#8155555555555555", "0 141#8C01555555555555"] * 7
    assert names(cycles(*unanswered).nodes[0]) != ["v2.35"]  # nothing shows that the log has replies
    answered = lacked + ", 300 141#3000010203040506"
    assert names(cycles(*[read, answered] * 20).nodes[0]) == ["v2.35"]


def test_no_part_of_a_log_is_empty() -> None:
    """Not even if the reply with which another edition begins answers the first frame, as it can in a log without times."""
    requests, off, on = "141#9555555500000000 181#9500000000000000", "181#8800000000000000", "141#8855555555555555"
    lines = [*requests.split(), on, off, "181#8100000000000000", requests.split()[0], *[on] * 3]
    results = identify(candump.read([f"can0 {line}\n" for line in lines], Counts()), EDITIONS).nodes
    assert sum(result.frames for result in results) == len(lines) and all(result.frames for result in results)


def exchanges(data: str, answers: str, marks: str = "  ", id_: int = 0x141) -> list[str]:
    """Cycles of a request and its reply 0.3 ms later, with the marks of both."""
    pairs = zip(data.split(), answers.split(), strict=True)
    return [f"0 {id_:X}#{asked} {marks[0]}, 300 {id_:X}#{answered} {marks[1]}" for asked, answered in pairs]


POLL = "9A00000000000000"
READS = exchanges("9A00000000000000 9200000000000000", "9A20081300000000 9218FCFFFFFFFFFF", "TR")
WRITE, BRAKE = "B10E000022000000", "8C01000000000000"
STATUS = "9A32081364000000"
EXCHANGES = {
    "another host drives node 2": [*READS, *(cycle.replace("141", "142").replace(" T", " R") for cycle in READS)],
    "motors on the computer of the recorder": [cycle.replace(" R", " T") for cycle in READS],
    **{
        f"copies of requests with {mark}": [f"0 141#{POLL} T, 80 141#{POLL} {mark}, 300 141#{STATUS} R"] * 20
        for mark in "TR"
    },
    **{
        f"replies with the bytes of {data}, marks {marks}": exchanges(
            f"{data} " * 9 + POLL, f"{data} " * 9 + STATUS, marks
        )
        * 3
        for data in (WRITE, BRAKE)
        for marks in ("  ", "TR")
    },
    **{
        f"reserved bytes of {byte}": exchanges(
            f"9A{byte * 7} 8C01{byte * 6} B10E{byte * 2}22000000", f"{STATUS} {BRAKE} {WRITE}"
        )
        * 20
        for byte in ("55", "FF")
    },
}
"""Logs of v2.35-2024-02 in cycles of a request, copies of it, and its reply."""


@pytest.mark.parametrize("name", EXCHANGES)
def test_exchanges_are_paired_and_identified(name: str) -> None:
    """Each reply answers the first frame of its cycle, and nothing speaks against the edition."""
    frames, size = in_cycles(*EXCHANGES[name]), EXCHANGES[name][0].count(",") + 1
    for result in identify(frames, EDITIONS).nodes:
        assert (names(result), result.unexplained, result.scores[0].unanswered) == (["v2.35-2024-02"], (), {})
        assert not result.scores[0].against
    (known,) = (edition for edition in EDITIONS if edition.name == "v2.35-2024-02")
    judged = [*Directions({}, known).classify(frames)]
    assert [frame.request for frame in judged[size - 1 :: size]] == [frame.number for frame in judged[::size]]
    assert all(frame.decided_by is DecidedBy.COPY for at, frame in enumerate(judged) if at % size not in (0, size - 1))


def test_a_poll_is_not_answered_by_itself() -> None:
    """A host that asks a silent node each millisecond: the edition cannot be seen from requests."""
    poll = ", ".join(f"{offset} 141#9A00000000000000" for offset in range(0, 10_000, 1_000))
    assert names(cycles(*[poll] * 9).nodes[0]) == []


@pytest.mark.parametrize("data", [WRITE, BRAKE])
def test_a_repeated_write_is_not_its_own_reply(data: str) -> None:
    (silent,) = cycles(*[f"0 141#{data}, 5000 141#{data}"] * 9, *exchanges(POLL, STATUS)).nodes
    assert names(silent) == []


def test_a_node_with_a_damaged_id_is_listed_apart(tmp_path: Path) -> None:
    lines = V2_35 * 40
    lines[81] = lines[81].replace("142#", "152#")  # one reply
    result = run(tmp_path, lines)
    assert result.exit_code == 0
    last = result.output.split("\n\n")[-2]
    assert last.startswith(
        "mwd_motor, node 18, 1 frame: few frames, far apart, as frames with a damaged id are; fits v2.35"
    )
    assert "mwd_motor, node 2, 159 frames: fits v2.35\n" in result.output


def test_a_node_in_the_data() -> None:
    """The last frame has the low bits of its node only."""
    valves = specification(ROOT / "tests/specs/valve/v1.yaml").edition
    lines = ["7E5#1000006F00000000", "46F#100000000DF0AD8B", "7E6#1125000000000000", "7E4#1150000002010000"]
    assert [(result.node, result.frames) for result in identified(lines, [valves]).nodes] == [
        (None, 1),
        (37, 1),
        (111, 2),
    ]


def test_an_unknown_parameter_in_an_id_is_named(tmp_path: Path) -> None:
    text = MINIMAL.replace("{id: 0x100 + node", "{request: 0x100 + node, reply: host_id")
    (tmp_path / "lamp.yaml").write_text(
        f"{text}parameters: {{host_id: {{number: {{}}, title: Id of the host}}}}\n", "utf-8"
    )
    lines = ["101#1000640000000000", "7A1#1000640000000000"]
    remark = "ids or constants contain `host_id`, which is unknown: --set host_id=NUMBER\n"
    assert remark in run(tmp_path, lines, "--spec", str(tmp_path / "lamp.yaml")).output
    known = run(tmp_path, lines, "--spec", str(tmp_path / "lamp.yaml"), "--set", "host_id=0x7A1")
    assert known.exit_code == 0
    assert "host_id" not in known.output


def test_json(tmp_path: Path) -> None:
    printed = json.loads(run(tmp_path, V2_35, "--format", "json").output)
    (node,) = printed["nodes"]
    assert (printed["family"], node["node"], node["fits"]) == ("mwd_motor", 2, ["v2.35"])
    first = {"edition": "v2.35", "explained": 4, "tried": 0, "score": 0, "requests": 2, "unanswered": {}, "against": []}
    assert node["editions"][0] == first
    assert all(edition["score"] >= 3 for edition in node["editions"][1:])


# 23.8 V as 0.1 V in DATA[3..4]; another reading of the reply would be a request with two odd bytes
POLLED = ["141#9A00000000000000", "141#9A2800EE00000000"]


def test_what_follows_a_request_is_its_reply(tmp_path: Path) -> None:
    for lines in (POLLED * 9, POLLED[1:] * 9, [POLLED[0], *POLLED] * 9, [*POLLED, *V2_36[2:]] * 9):
        assert names(identified(lines).nodes[0]) == ["v2.35"], lines
    text = run(tmp_path, POLLED).output
    assert "0x140 + node has a reply of read_status_1; expected replies on 0x180 + node (1 of 2, as in" in text
    assert "expected replies on 0x180 + node (1 of 1, as in" in run(tmp_path, POLLED[1:]).output


@pytest.mark.parametrize(
    ("lines", "fits"),
    [
        # flags that no manual names, a motor state that none does, codes that a host tries
        (["141#9A00000000000000", "141#9A1F540905001024"], "v2.35-2024-02"),
        (["141#9A00000000000000", "141#9A1F540905000100"], "v2.35-2024-02"),
        (["141#9A00000000000000", "141#9A1F00F000000024"], "v2.35"),
        (["141#B500000000000000", "141#3700000000000000", *V2_35_2024_02, *V2_35_2024_02], "v2.35-2024-02"),
    ],
)
def test_frames_unknown_to_all_editions_are_no_evidence(lines: list[str], fits: str) -> None:
    assert names(identified(lines).nodes[0]) == [fits]


def test_frames_of_no_edition_are_listed(tmp_path: Path) -> None:
    lines = ["141#B500000000000000"] * 2 + ["141#9A"] + V2_35_2024_02 * 2
    text = run(tmp_path, lines).output
    assert "node 1, 7 frames: fits v2.35-2024-02\n" in text
    assert "  3 frames of no edition, ignored: 141#B500000000000000 (2), 141#9A (1)\n" in text
    assert "explains every frame" in text and "explain 2 of 4 frames" in text
    (node,) = json.loads(run(tmp_path, lines, "--format", "json").output)["nodes"]
    assert (node["bus"], node["frames"], node["of_no_edition"]) == ("can0", 7, 3)
    assert "no frame of 8 bytes that starts with 30 on 0x140 + node" in run(tmp_path, MEASURED[4][0]).output


def test_suggested_commands_only_read_and_are_not_in_the_log(tmp_path: Path) -> None:
    # 23.88 V at 0.01 A reads as 26.5 V in the other edition
    text = run(tmp_path, ["141#9A00000000000000", "141#9A1F540901000000"]).output
    assert "undecided, v2.35-2024-02 and v2.35 fit equally well" in text
    assert text.rstrip().endswith("read_status_1") and "set_power" not in text
    assert "record the reply to read_control_parameter" in run(tmp_path, V2_36).output
    text = MINIMAL + "".join(
        f"  {name}:\n    code: 0x1{i}\n    effects: [{effects}]\n    reply: {{level: {{at: 2, type: level}}}}\n"
        for i, (name, effects) in enumerate((("burn", "burns"), ("read", "")), start=1)
    )
    editions = [edition(tmp_path, f"{text}effects: {{burns: {{}}}}\n".replace("0.1", scale)) for scale in ("0.1", "1")]
    (result,) = identified(["101#1000000000000000"] * 2, editions).nodes
    assert result.distinguishing == ("read",)


def test_a_rare_slip_does_not_decide() -> None:
    (result,) = identified(V2_35 * 30 + ["142#9A3200E701000400"]).nodes
    assert names(result) == ["v2.35"]
    assert [evidence.counts for evidence in result.scores[0].against] == [False]


@pytest.mark.parametrize("form", ["text", "json"])
def test_a_log_of_two_recorders_is_a_finding(form: str, tmp_path: Path) -> None:
    """With a log of one recorder, the exit status is 0."""
    polls = [(at, "9A00000000000000") for at in range(0, 600_000, 10_000)]
    replies = [(at + 300, f"9A320813{at // 10_000:02X}000000") for at, _ in polls]
    again = [(at + 12_000, data) for at, data in polls + replies]
    spec = shutil.copy(ROOT / "spec/mwd_motor/v2.35-2024-02.yaml", tmp_path)
    for frames, status in ((polls + replies, 0), (polls + replies + again, 1)):
        log = "".join(f"(1.{at:06}) can0 141#{data}\n" for at, data in sorted(frames))
        options = ["--spec", str(spec), "--format", form]
        result = CliRunner().invoke(main, ["identify", "-", *options], input=log)
        assert result.exit_code == status, result.output
        sentence = "can0: each frame is recorded twice, again after 12 ms, as by two recorders"
        assert (sentence in (result.stdout if form == "text" else result.stderr)) == bool(status)


def test_a_file_that_is_no_log(tmp_path: Path) -> None:
    file = tmp_path / "x.log"
    file.write_text("hello\n", "utf-8")
    result = CliRunner().invoke(main, ["identify", str(file), "--spec", str(spec_files(ROOT / "spec")[0])])
    assert (result.exit_code, "has no frames (line 1: `hello`)" in result.output) == (2, True)


def test_buses_share_what_is_known_of_ids(monkeypatch: pytest.MonkeyPatch) -> None:
    """A log of hundreds of buses takes no longer than one bus with as many frames."""
    lines = [f"(1.000000) can{bus} {line}\n" for bus in range(50) for line in (*V2_35, *V2_35_2024_02)]
    frames = [*candump.read(lines, Counts())]
    identify(frames[:6], EDITIONS)
    monkeypatch.setattr(FrameClasses, "_class", None)  # no class of frames is found again
    result = identify(frames, EDITIONS)
    assert [names(node) for node in result.nodes] == 50 * [["v2.35-2024-02"], ["v2.35"]]


@pytest.mark.parametrize("spec", WITHOUT_SETTINGS_IN_IDS, ids=called)
def test_golden_frames_speak_for_their_own_edition(spec: Path) -> None:
    """What an encoder of an edition writes has nothing against it there, but for values that no node would report."""
    item = specification(spec)
    assert item.frames is not None
    far_out = {m.command for m in item.edition.all_messages() for f in m.layout.fields if f.type.plausible}
    checked = [g for g in item.frames.frames if not g.decode_only and g.command not in far_out]
    assert checked
    reader = EditionReader(item.edition, [item.edition], None, None)
    for golden in checked:
        frame = CanFrame(golden.id, golden.data, golden.extended, golden.remote)
        (reading,) = reader.read([[LogFrame(0, "", frame, None)]]).frames
        assert not reading.is_rejected and (reading.is_request or not reading.reasons), golden


@pytest.mark.parametrize(("options", "fits"), [([], []), (["--window", "1500"], ["v2.36-2024-11", "v2.36-2025-03"])])
def test_a_log_of_slow_replies_fits_an_edition_with_a_longer_window(
    tmp_path: Path, options: list[str], fits: list[str]
) -> None:
    """Replies that come after 1 s, so that no request is answered within the window that suits the spec."""
    lines = [f"({time}.000000) can0 {frame}\n" for time, frame in enumerate(V2_36)]
    log = tmp_path / "slow.log"
    log.write_text("".join(lines), "utf-8")
    arguments = ["identify", str(log), "--spec", str(ROOT / "spec"), "--format", "json", *options]
    assert sorted(json.loads(CliRunner().invoke(main, arguments).stdout)["nodes"][0]["fits"]) == fits


def torque(node: int, start: int, count: int) -> Iterator[LogFrame]:
    """A fast loop in which all editions without ids for replies have the same frames; times in µs."""
    for time in range(start, start + 1000 * count, 1000):
        for offset, data in ((0, "A10000003E000000"), (300, "A1323E00F4010080")):
            frame = CanFrame(0x140 + node, bytes.fromhex(data))
            yield LogFrame(1000 * (time + offset), "can0", frame, None)


def status(node: int, start: int, edition: str) -> Iterator[LogFrame]:
    replies = {"v2.35": "9A3200E701000000", "v2.35-2024-02": "9A32081364000000"}
    for offset, data in ((0, "9A00000000000000"), (300, replies[edition])):
        yield LogFrame(1000 * (start + offset), "can0", CanFrame(0x140 + node, bytes.fromhex(data)), None)


def test_a_long_log_is_identified_from_a_part_of_each_of_its_parts() -> None:
    """A few exchanges in a long log, and a node that speaks late, are compared; what repeats is not kept."""
    frames = [
        *torque(1, 0, MAX_KEPT // 2),
        *(frame for at in range(12) for frame in status(1, 10**9 + 1000 * at, "v2.35")),
        *torque(1, 2 * 10**9, MAX_KEPT // 2),
        *status(2, 3 * 10**9, "v2.35-2024-02"),
        *torque(1, 4 * 10**9, MAX_KEPT // 2),
    ]
    first, second = identify(frames, EDITIONS).nodes
    assert (names(first), names(second)) == (["v2.35"], ["v2.35-2024-02"])
    assert first.total == len(frames) - 2 and MAX_KEPT // 4 < first.frames <= MAX_KEPT


def test_a_change_in_a_long_log() -> None:
    """The edition of a node that is reset, in a log of which a part is compared."""
    cycle = [[*torque(1, at * 10**6, 60), *status(1, at * 10**6 + 90_000, name)] for at, name in enumerate(CHANGING)]
    frames = [frame for part in cycle for frame in part]
    before, after = identify(frames, EDITIONS).nodes
    assert (names(before), names(after)) == (["v2.35"], ["v2.35-2024-02"])
    assert after.start is not None
    changed = sum(map(len, cycle[: CHANGING.count("v2.35")]))
    assert changed - len(cycle[0]) < after.start.number < changed + 8 * BLOCK


WIDE = """\
canwright: 1
family: {family}
edition: v1
addresses: {{axis: {{id: node << 5, nodes: 0..62}}}}
selector: {{at: id.0, raw: u5}}
commands:
  move: {{code: 0x01, request: {{speed: {{at: 0, raw: u16}}}}, reply: {reply}}}
"""


@pytest.mark.parametrize(
    ("lines", "family"),
    [
        (["102#1000640000000000", "102#1000640000000000", "7E1#01"], "lamp"),
        (["041#6400000000000000", "041#6500000000000000"], "sender"),
        (["041#6400000000000000", "042#0000000000000000"], "asker"),
    ],
    ids=["most frames are messages", "a request without its reply", "no family fits"],
)
def test_the_family_of_a_log_has_messages_for_most_frames(lines: list[str], family: str, tmp_path: Path) -> None:
    """`asker` and `sender` have nearly all ids, and the same requests; those of `asker` have replies."""
    texts = [
        WIDE.format(family="asker", reply="{layout: {speed: {at: 0, raw: u16}}, dlc: 2}"),
        WIDE.format(family="sender", reply="none"),
    ]
    identifiers = Identifiers([edition(tmp_path, text) for text in (*texts, MINIMAL)], None)
    for frame in candump.read([f"(1.{i:03}000) can0 {line}\n" for i, line in enumerate(lines)], Counts()):
        identifiers.add(frame)
    assert identifiers.best.editions[0].family == family
