"""The generated npm package: examples, numbers, immutable messages, errors, and the types of TypeScript."""

from __future__ import annotations

import json
import random
import re
import struct
import subprocess
from fractions import Fraction
from pathlib import Path

import pytest
from canwright.conformance.adapter import write_files
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.project.loader import specification
from canwright.recordings.frame_classes import FrameClasses
from canwright.semantics.frame import CanFrame
from canwright.targets.base import EditionInput
from canwright.targets.javascript.package import RUNTIME, module_path
from canwright.targets.javascript.target import REPOSITORY, JavaScriptTarget
from canwright.targets.javascript.text import printed, quoted
from canwright.targets.options import Options

from ..conformance.adapters.javascript import JavaScriptAdapter
from ..node import run
from ..semantics.random_frames import random_frame
from ..spec_texts import MINIMAL, ROOT, SPECS, called, edition, findings
from ..tools import run as run_tool, tool

MOTOR = ROOT / "spec/mwd_motor/v2.35.yaml"


def write(folder: Path, *specs: Path) -> Path:
    """The package of some specs."""
    return write_files(JavaScriptTarget().generate([specification(spec) for spec in specs], {}), folder)


def programs(folder: Path) -> list[str]:
    """The programs of the README."""
    return re.findall(r"```js\n(.*?)```", (folder / "README.md").read_text("utf-8"), re.DOTALL)


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_the_program_of_the_readme(spec: Path, tmp_path: Path) -> None:
    """It sends what a golden frame has; the package finds itself by its name, as if it were installed."""
    folder, item = write(tmp_path, spec), specification(spec)
    assert item.frames is not None
    (program,) = programs(folder)
    (folder / "program.mjs").write_text(program, "utf-8")
    lines = run(folder / "program.mjs", cwd=folder).splitlines()
    id_ = lines[0].split()[0]
    assert int(id_, 16) in {frame.id for frame in item.frames.frames}
    assert "undefined" not in "".join(lines)


def test_several_families_are_one_package(tmp_path: Path) -> None:
    folder = write(tmp_path, *SPECS)
    package = json.loads((folder / "package.json").read_text("utf-8"))
    paths = [path for entry in package["exports"].values() for path in entry.values()]
    assert len(paths) == 4 * len(SPECS) + 2 and all((folder / path).is_file() for path in paths)
    imports = [f'await import("canwright_bindings{name[1:]}")' for name in package["exports"]]
    (folder / "all.mjs").write_text(f"for (const one of [{','.join(imports)}]) console.log(typeof one)", "utf-8")
    assert run(folder / "all.mjs", cwd=folder).split() == ["object"] * len(imports)


def test_numbers_are_exact() -> None:
    """Quotients near the limits of doubles are rounded as Python does; texts, doubles and ties are exact."""
    chance = random.Random(1)
    cases = [
        (chance.getrandbits(chance.choice((8, 54, 70, 1100))) * chance.choice((-1, 1)), chance.getrandbits(bits) or 1)
        for bits in (4, 53, 64, 200, 1080)
        for _ in range(60)
    ]
    cases += [(((1 << 53) + 1 << 100) + step, 1 << 100) for step in (-1, 0, 1)]  # near a tie
    cases += [((1 << 54) + 1, 1), ((1 << 54) + 3, 2), (1, 1 << 1075), (3, 1 << 1075), (1 << 1024, 1), (5, 1 << 1074)]
    wanted = []
    for n, d in cases:
        try:
            wanted.append(n / d)
        except OverflowError:
            wanted.append(None)  # type: ignore[arg-type]
    doubles = [chance.uniform(-1e3, 1e3) * 10.0 ** chance.randint(-320, 300) for _ in range(100)] + [0.1, 5e-324, -0.5]
    texts = ["0.3", "-12.50", "1e-7", "2E+3", "1/3", "16.5/2048", "7"]
    arguments = json.dumps([[str(n), str(d)] for n, d in cases]), json.dumps(doubles), json.dumps(texts)
    program = f"""
        import * as numbers from {json.dumps((RUNTIME / "canwright-numbers.js").as_uri())};
        const [cases, doubles, texts] = process.argv.slice(1).map(JSON.parse);
        console.log(JSON.stringify([
          cases.map(([n, d]) => numbers.quotient(BigInt(n), BigInt(d))),
          doubles.map((one) => numbers.ratio(one).map(String)),
          texts.map((one) => numbers.rational(one).map(String)),
          [0.5, 1.5, -0.5, -2.5, 0.49999999999999994, 2 ** 51 - 0.5].map(numbers.rounded),
          [[1n, 2n], [-3n, 2n], [5n, -2n], [7n, 3n]].map((one) => Number(numbers.nearest(...one))),
          [[-7n, 2n], [7n, 2n], [-4n, 2n]].map((one) => [numbers.floor(one), numbers.ceil(one)].map(Number)),
          ["", "x", "1/0", "0x10", "1,5"].map(numbers.rational),
        ]));"""
    quotients, ratios, rationals, rounded, nearest, whole, invalid = json.loads(
        run(program, *arguments), parse_int=float
    )
    assert quotients == wanted
    assert [Fraction(int(n), int(d)) for n, d in ratios] == [Fraction(double) for double in doubles]
    notations = [Fraction(text) for text in ("3/10", "-25/2", "1e-7", "2000", "1/3", "33/4096", "7")]
    assert rationals == [[str(fraction.numerator), str(fraction.denominator)] for fraction in notations]
    assert rounded == [1, 2, -1, -3, 0, 2**51]
    assert nearest == [1, -2, -3, 2]
    assert whole == [[-4, -3], [3, 4], [-2, -2]]
    assert invalid == [None] * 5


WIDE = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4, selector: {at: 0, raw: u8}}, other: {id: 0x300}}
types:
  level: {raw: i56, unit: "%", scale: 0.1}
  count: {raw: u64}
commands:
  dim: {code: 0x10, request: {level: {at: 1, type: level}}, reply: none}
  count: {address: other, request: {count: {at: 0, type: count}}, reply: none}
"""


def test_integers_above_53_bits_are_bigint(tmp_path: Path) -> None:
    item = EditionInput(edition(tmp_path, WIDE), None)
    folder = write_files(JavaScriptTarget().generate([item], {}), tmp_path)
    program = f"""
        import * as lamp from {json.dumps((folder / "lamp/v1.js").as_uri())};
        const dim = lamp.encodeRequest("dim", {{ node: 1, raw: {{ level: -(2n ** 55n) + 1n }} }});
        const count = lamp.encodeRequest("count", {{ values: {{ count: 2n ** 64n - 1n }} }});
        const refusal = (make) => {{ try {{ make(); }} catch (error) {{ return error.refusal ?? error.constructor.name; }} }};
        console.log(String(dim.raw.level), dim.values.level, String(count.values.count), count.frame.data.join());
        console.log(
          refusal(() => lamp.encodeRequest("count", {{ values: {{ count: 2n ** 64n }} }})),
          refusal(() => lamp.encodeRequest("count", {{ raw: {{ count: 2 ** 60 }} }})),
          refusal(() => lamp.encodeRequest("count", {{ raw: {{ count: 1.5 }} }})),
          String(lamp.encodeRequest("count", {{ raw: {{ count: 5 }} }}).raw.count),
        );"""
    lines = run(program).splitlines()
    assert lines == [
        f"-36028797018963967 {-36028797018963967 / 10} 18446744073709551615 255,255,255,255,255,255,255,255",
        "out_of_range TypeError TypeError 5",
    ]


def test_messages_are_json(tmp_path: Path) -> None:
    """Also those with BigInt; integers that no number holds are texts."""
    text = WIDE.replace("commands:", "parameters: {size: {number: {}}}\ncommands:")
    folder = write_files(JavaScriptTarget().generate([EditionInput(edition(tmp_path, text), None)], {}), tmp_path)
    program = f"""
        import * as lamp from {json.dumps((folder / "lamp/v1.js").as_uri())};
        const make = (count) => lamp.encodeRequest("count", {{ raw: {{ count }}, parameters: {{ size: 2n ** 60n }} }});
        const wide = make(2n ** 64n - 1n);
        console.log(JSON.stringify([wide, make(5), wide.raw, wide.values, wide.fields, lamp.MESSAGES]));
        if (Object.keys(wide.raw).join() !== "count") throw new Error("toJSON is visible");"""
    first, second, raw, values, fields, messages = json.loads(run(program))
    assert (raw, values, fields) == (first["raw"], first["values"], first["fields"]) and len(messages) == 2
    exact = {"count": str(2**64 - 1)}
    assert list(first) == [
        "family",
        "edition",
        "direction",
        "command",
        "node",
        "parameters",
        "frame",
        "fields",
        "raw",
        "values",
    ]
    assert (first["raw"], first["values"], first["parameters"]) == (exact, exact, {"size": str(2**60)})
    assert first["fields"][0]["raw"] == first["fields"][0]["value"] == str(2**64 - 1)
    assert (second["raw"], second["frame"]["data"]) == ({"count": 5}, [5, 0, 0, 0, 0, 0, 0, 0])


FLAGS = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100}, other: {id: 0x300}}
types:
  errors: {raw: u8, flags: {low: {bit: 0}, hot: {bit: 3}, torn: {bit: 7}}}
  faults: {raw: u64, flags: {first: {bit: 0}, last: {bit: 63}}}
commands:
  errors: {request: none, reply: {errors: {at: 0, type: errors}}}
  faults: {address: other, request: none, reply: {faults: {at: 0, type: faults}}}
"""


def test_flags_without_a_name_are_kept(tmp_path: Path) -> None:
    """They follow the names as one integer; a message with them is not sent, as in all languages, and never without them."""
    folder = write_files(JavaScriptTarget().generate([EditionInput(edition(tmp_path, FLAGS), None)], {}), tmp_path)
    program = f"""
        import * as lamp from {json.dumps((folder / "lamp/v1.js").as_uri())};
        const values = (id, data) => lamp.decodeReply({{ id, data: [...data, ...Array(8 - data.length).fill(0)] }}).values;
        const given = (errors) => {{
          try {{ return lamp.encodeReply("errors", {{ values: {{ errors }} }}).frame.data[0]; }} catch (error) {{ return error.refusal; }}
        }};
        console.log(JSON.stringify([
          values(0x100, [0xF9]), values(0x100, [0x89]), values(0x100, [0]),
          values(0x300, [3, 0, 0, 0, 0, 0, 0, 0xC0]).faults.map(String),
          [["low", "hot", "torn", 0x70], ["low", 0x80], ["low", 1.5], ["low", "other"], 0x89, 0xF9].map(given),
        ]));"""
    assert json.loads(run(program)) == [
        {"errors": ["low", "hot", "torn", 0x70]},
        {"errors": ["low", "hot", "torn"]},
        {"errors": []},
        ["first", "last", str((1 << 62) + 2)],
        ["out_of_range", 0x81, "out_of_range", "out_of_range", 0x89, "out_of_range"],
    ]


NAMES = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100}}
types:
  power: {raw: u16, unit: "%", scale: 0.1, range: 0..100, names: {stopped: 0, maximum: 1000}, no_value: {lost: 0xFFFF}}
  steps: {raw: u8, names: {few: 3}}
  serial: {raw: u56, byte_order: big, names: {blank: 72057594037927935}}
commands:
  dim: {request: {power: {at: 0, type: power}, steps: {at: 2, type: steps, array: 1..3}}, reply: none}
  mark: {request: none, reply: {serial: {at: 0, type: serial}}}
"""
"""10 % are raw 100 = 0x64, 100 % are raw 1000 = 0x03E8."""


def test_numbers_have_names_beside_their_values(tmp_path: Path) -> None:
    text = NAMES.replace("  dim: {", "  dim: {address: lamp, ").replace("  mark: {", "  mark: {address: other, ")
    text = text.replace("{lamp: {id: 0x100}}", "{lamp: {id: 0x100}, other: {id: 0x200}}")
    folder = write_files(JavaScriptTarget().generate([EditionInput(edition(tmp_path, text), None)], {}), tmp_path)
    program = f"""
        import * as lamp from {json.dumps((folder / "lamp/v1.js").as_uri())};
        const dim = (power, steps) => lamp.encodeRequest("dim", {{ values: {{ power, steps }} }});
        const refused = (...given) => {{ try {{ dim(...given); }} catch (error) {{ return [error.refusal, error.field, error.message]; }} }};
        const short = ({{ fields }}) => fields.map(({{ value, noValue, valueName }}) => [value, noValue, valueName]);
        const blank = lamp.encodeReply("mark", {{ values: {{ serial: "blank" }} }});
        console.log(JSON.stringify([
          [...dim("maximum", ["few", 4, 3]).frame.data], short(dim("maximum", ["few", 4, 3])), short(dim(10, [1, 2, 4])),
          short(dim("lost", [0, 0, 3])), refused("off", [1, 2, 3]), refused(1, ["on", 2, 3]),
          [...blank.frame.data], blank.fields[0].valueName,
          lamp.MESSAGES[0].fields.map(({{ type }}) => type.names),
        ]));"""
    assert json.loads(run(program)) == [
        [0xE8, 3, 3, 4, 3, 0, 0, 0],
        [[100, None, "maximum"], [[3, 4, 3], None, ["few", None, "few"]]],
        [[10, None, None], [[1, 2, 4], None, None]],
        [[None, "lost", None], [[0, 0, 3], None, [None, None, "few"]]],
        ["out_of_range", "power", 'power="off" is no number and none of the names lost, stopped, maximum'],
        ["out_of_range", "steps", 'steps="on" is no number and none of the names few'],
        [*[0xFF] * 7, 0],
        "blank",
        [[[0, "stopped"], [1000, "maximum"]], [[3, "few"]]],
    ]
    declared = (folder / "lamp/v1.d.ts").read_text("utf-8")
    assert 'FieldOf<number, number | null, number | bigint | "lost" | "stopped" | "maximum" | null>' in declared
    assert 'FieldOf<bigint, bigint, number | bigint | "blank">' in declared
    assert "raw 1000 is named maximum" in declared


FLOAT = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100}}
types: {level: {raw: f32, scale: 3}}
commands: {dim: {request: {level: {at: 0, type: level}}, reply: none}}
"""


def test_bigints_are_rounded_to_floats_once(tmp_path: Path) -> None:
    """Next to a tie of 32-bit floats, which the nearest double is."""
    item = EditionInput(edition(tmp_path, FLOAT), None)
    folder = write_files(JavaScriptTarget().generate([item], {}), tmp_path)
    tie = ((1 << 24) + 1) << 40
    values = [3 * tie + 3 * step for step in (-1, 0, 1)] + [-3 * tie - 3]
    program = f"""
        import * as lamp from {json.dumps((folder / "lamp/v1.js").as_uri())};
        const bits = (level) => lamp.encodeRequest("dim", {{ values: {{ level }} }}).raw.level;
        console.log([{", ".join(f"{value}n" for value in values)}].map(bits).join());"""
    exact = (struct.unpack("<I", struct.pack("<f", float(n << 40)))[0] for n in (1 << 24, 1 << 24, (1 << 24) + 2))
    assert [int(text) for text in run(program).split(",")] == [*exact, 0xDF800001]


def test_wrong_arguments_are_errors_and_messages_are_immutable(tmp_path: Path) -> None:
    folder = write(tmp_path, MOTOR)
    program = f"""
        import * as motor from {json.dumps((folder / "mwd_motor/v2_35.js").as_uri())};
        const say = (make) => {{ try {{ make(); return "nothing"; }} catch (error) {{ return `${{error.name}}: ${{error.message}}`; }} }};
        const speed = {{ node: 1, values: {{ speed: 1 }} }};
        const request = motor.encodeRequest("set_speed", speed);
        const parameters = {{ series: "MG" }};
        console.log([
          () => motor.encodeRequest("set_sped", speed),
          () => motor.encodeRequest("set_speed", {{ node: 1, values: {{ sped: 1 }} }}),
          () => motor.encodeRequest("set_speed", {{ node: 1 }}),
          () => motor.encodeRequest("set_speed", {{ ...speed, parameters: {{ serie: "MG" }} }}),
          () => motor.encodeRequest("set_speed", {{ ...speed, parameters: {{ series: "XX" }} }}),
          () => motor.encodeRequest("set_speed", {{ ...speed, parameters: {{ gear_ratio: 0.5 }} }}),
          () => motor.encodeRequest("set_speed", {{ ...speed, parameters: {{ gear_ratio: NaN }} }}),
          () => motor.encodeRequest("set_speed", {{ node: 33, values: {{ speed: 1 }} }}),
          () => motor.encodeRequest("set_speed", {{ values: {{ speed: 1 }} }}),
          () => motor.encodeRequest("set_speed", {{ node: "1", values: {{ speed: 1 }} }}),
          () => motor.encodeRequest("set_speed", {{ node: 1, values: {{ speed: "1" }} }}),
          () => motor.decodeRequest({{ id: 2 ** 29 }}),
          () => motor.decodeRequest({{ id: 0x141, data: [256] }}),
          () => motor.decodeReply({{ id: 0x141, data: [0x00, 0, 0, 0, 0, 0, 0, 0] }}),
          () => motor.decodeReply({{ id: 0x141, data: [0xA2] }}),
          () => motor.decodeReply({{ id: 0x141, extended: true }}),
          () => {{ request.values.speed = 2; }},
          () => {{ request.frame.data[0] = 2; }},
          () => {{ motor.MESSAGES[0].fields.push(1); }},
          () => motor.decodeAnswer(request, {{ ...request.frame, id: 0x142 }}, parameters),
        ].map(say).join("\\n"));
        console.log(JSON.stringify(motor.decodeAnswer(request, {{ id: 0x141, data: Uint8Array.of(0xA2, 32, 0, 4, 1, 0, 0, 0) }}, parameters).values));
        """
    lines = run(program).splitlines()
    assert lines == EXPECTED.splitlines(), "\n".join(lines)


def test_a_change_of_the_callers_objects_counts_from_the_next_call_on(tmp_path: Path) -> None:
    """Also of parameters, whose scales are kept as long as they are equal."""
    folder = write(tmp_path, MOTOR)
    program = f"""
        import * as motor from {json.dumps((folder / "mwd_motor/v2_35.js").as_uri())};
        const frame = {{ id: 0x141, data: Uint8Array.of(0xA2, 32, 0, 4, 1, 0, 0, 0) }};
        const parameters = {{ series: "MG" }};
        const first = motor.decodeReply(frame, parameters);
        parameters.series = "MF";
        frame.data[2] = 1;
        const second = motor.decodeReply(frame, parameters);
        console.log(first.values.iq, first.frame.data[2], first.parameters.series, second.values.iq, second.parameters.series);"""
    assert run(program).splitlines() == ["16.5 0 MG 8.258056640625 MF"]


def test_the_error_of_a_received_frame_has_no_stack_and_that_of_a_wrong_value_has_one(tmp_path: Path) -> None:
    folder = write(tmp_path, MOTOR)
    program = f"""
        import {{ CodecError }} from {json.dumps((folder / "canwright-codec.js").as_uri())};
        import * as motor from {json.dumps((folder / "mwd_motor/v2_35.js").as_uri())};
        const thrown = (make) => {{ try {{ make(); }} catch (error) {{ return error; }} }};
        const errors = [
          thrown(() => motor.decodeReply({{ id: 0x7FF }})),
          thrown(() => motor.encodeRequest("set_speed", {{ node: 1, values: {{ speed: 1e9 }} }})),
        ];
        for (const error of errors) {{
          console.log(error instanceof CodecError, error instanceof Error, typeof error.stack, String(error));
          console.log(JSON.stringify(error));
        }}"""
    assert run(program).splitlines() == [
        "true true undefined CodecError: no reply has the id 0x7FF",
        '{"name":"CodecError","message":"no reply has the id 0x7FF","refusal":"unknown_id","values":["0x7FF"]}',
        "true true string CodecError: speed=1000000000 °/s is out of range -21474836.48..21474836.47 °/s (raw -2147483648..2147483647)",
        '{"name":"CodecError","refusal":"out_of_range","field":"speed","values":["-21474836.48..21474836.47 °/s","-2147483648..2147483647"]}',
    ]


RANGES = """\
iq=100 A is out of range -33..33 A (raw -2048..2048)
iq depends on series, which is not given; pass parameters: { series: ... }
iq has no scale here; use its raw integer
iq=raw 3000 is out of range -33..33 A (raw -2048..2048)
iq=raw 3000 is out of range raw -2048..2048
power=851 is out of range -850..850 (raw -850..850)
speed=NaN is not a finite number
spin_direction="left" is none of clockwise, counterclockwise
spin_direction=5 is none of clockwise, counterclockwise
"""


def test_errors_have_value_unit_and_range(tmp_path: Path) -> None:
    """The texts are those of Python where both languages have the same values."""
    folder = write(tmp_path, MOTOR)
    program = f"""
        import * as motor from {json.dumps((folder / "mwd_motor/v2_35.js").as_uri())};
        const say = ([command, content]) => {{
          try {{ motor.encodeRequest(command, {{ node: 1, ...content }}); return "nothing"; }} catch (error) {{ return error.message; }}
        }};
        const turn = (spin_direction) => ["turn_to_angle", {{ values: {{ spin_direction, angle: 1 }} }}];
        console.log([
          ["set_torque", {{ values: {{ iq: 100 }}, parameters: {{ series: "MG" }} }}],
          ["set_torque", {{ values: {{ iq: 1 }} }}],
          ["set_torque", {{ values: {{ iq: 1 }}, parameters: {{ series: "MH" }} }}],
          ["set_torque", {{ raw: {{ iq: 3000 }}, parameters: {{ series: "MG" }} }}],
          ["set_torque", {{ raw: {{ iq: 3000 }} }}],
          ["set_power", {{ values: {{ power: 851 }} }}],
          ["set_speed", {{ values: {{ speed: NaN }} }}],
          turn("left"),
          turn(5),
        ].map(say).join("\\n"));"""
    assert run(program) == RANGES


def test_buffers_and_views_are_data(tmp_path: Path) -> None:
    """A view is the bytes that it shows; what has no bytes is an error, not a frame without data."""
    folder = write(tmp_path, MOTOR)
    program = f"""
        import * as motor from {json.dumps((folder / "mwd_motor/v2_35.js").as_uri())};
        const bytes = Uint8Array.of(0xFF, 0xA2, 32, 0, 4, 1, 0, 0, 0, 0xFF);
        const read = (data) => {{
          try {{ return motor.decodeReply({{ id: 0x141, data }}, {{ series: "MG" }}).values.temperature; }} catch (error) {{ return error.name; }}
        }};
        console.log([
          bytes.slice(1, 9).buffer, new DataView(bytes.buffer, 1, 8), bytes.subarray(1, 9), Buffer.from(bytes.slice(1, 9)),
          new DataView(bytes.buffer), {{}}, 5, null, "A2",
        ].map(read).join());"""
    errors = ["CodecError", "TypeError", "TypeError", "TypeError", "TypeError"]
    assert run(program).strip().split(",") == ["32"] * 4 + errors


def test_the_package_has_a_licence_a_repository_and_one_entry(tmp_path: Path) -> None:
    items = [specification(spec) for spec in SPECS[:2]]
    options = Options({REPOSITORY: "github:someone/motor"})
    folder = write_files(JavaScriptTarget().generate(items, {}, options), tmp_path)
    package = json.loads((folder / "package.json").read_text("utf-8"))
    assert (package["license"], package["repository"]) == ("MIT", "github:someone/motor")
    assert (folder / "LICENSE").read_text("utf-8") == (ROOT / "LICENSE").read_text("utf-8")
    program = 'import * as motor from "mwd_motor"; console.log(Object.keys(motor).join(), motor.v2_35.EDITION)'
    (folder / "all.mjs").write_text(program, "utf-8")
    assert run(folder / "all.mjs", cwd=folder).split() == ["v2_35,v2_35_2024_02", "v2.35"]
    with pytest.raises(ValueError, match="must be an address"):
        REPOSITORY.parse("motor", [])
    assert "repository" not in json.loads((write(tmp_path / "plain", MOTOR) / "package.json").read_text("utf-8"))


@pytest.mark.tools
def test_a_bundler_drops_what_is_not_used(tmp_path: Path) -> None:
    """Nothing remains of an edition that a program does not use, also without `sideEffects` of package.json."""
    folder = write(tmp_path, *SPECS[:2])
    package = json.loads((folder / "package.json").read_text("utf-8"))
    uses = {
        "nothing": "1",
        "part": "motor.v2_35.decodeReply",
        "all": "motor.v2_35.decodeReply, motor.v2_35_2024_02.decodeReply",
    }
    for has_effects in (False, True):
        (folder / "package.json").write_text(json.dumps({**package, "sideEffects": has_effects}), "utf-8")
        sizes = {}
        for name, used in uses.items():
            (folder / "use.mjs").write_text(f'import * as motor from "mwd_motor"; globalThis.used = [{used}];', "utf-8")
            esbuild = [tool("npm"), "exec", "--yes", "--package=esbuild@0.25", "--", "esbuild", "--bundle", "--minify"]
            sizes[name] = len(run_tool(*esbuild, "--format=esm", "use.mjs", cwd=folder))
        assert sizes["nothing"] < 100 and sizes["part"] < sizes["all"] - 10_000, (has_effects, sizes)


EXPECTED = """\
TypeError: there is no request of "set_sped"
TypeError: the request of set_speed needs values, or raw integers, of: speed
TypeError: the request of set_speed needs values, or raw integers, of: speed
TypeError: there is no parameter "serie"
RangeError: series is none of MS, MF, MH, MG; leave it out if it is unknown
RangeError: gear_ratio must be from 1 to ∞; leave it out if it is unknown
RangeError: gear_ratio is no number; leave it out if it is unknown
CodecError: there is no node 33; nodes are 1..32
TypeError: set_speed needs a node from 1..32
TypeError: set_speed needs a node from 1..32
TypeError: speed is no number
TypeError: a frame has an id of at most 29 bits, and bytes as data
TypeError: a frame has an id of at most 29 bits, and bytes as data
CodecError: no reply on 0x141 has the code 0x0
CodecError: 0x141 has 1 data bytes, not 8
CodecError: no reply has the 29-bit id 0x141
TypeError: Cannot assign to read only property 'speed' of object '#<Object>'
TypeError: Cannot assign to read only property '0' of object '[object Array]'
TypeError: Cannot add property 0, object is not extensible
CodecError: it comes from node 2, not 1
{"temperature":32,"iq":16.5,"speed":1,"encoder":null}
"""


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_requests_that_a_node_does_not_have_are_rejected(spec: Path, tmp_path: Path) -> None:
    """Before anything else, and only if the parameters that decide it are given; replies and frames of the bus are not."""
    item, asked = specification(spec), 0
    adapter = JavaScriptAdapter.create(item, tmp_path)
    for message in item.edition.all_messages():
        command = item.edition.command(message.command)
        for parameter in item.edition.parameters:
            for value in parameter.values:
                content = {"node": -1, "raw": {"nonsense": 1}, "parameters": {parameter.name: value.name}}
                question = {"direction": message.direction.value, "command": message.command, "content": content}
                refusal = adapter.refusal("encode", **question)
                is_available = message.direction is Direction.REPLY or command.available({parameter.name: value.name})
                assert (refusal != "not_available") == is_available, question
                asked += not is_available
    limited = [c for c in item.edition.commands if c.request and any(c.only.values())]
    assert bool(asked) == any(
        len(item.edition.parameter(n).values) > len(v) for c in limited for n, v in c.only.items()
    )


@pytest.mark.parametrize("name", ["mwd_motor/v2.35", "press/v1"])
def test_candidates_are_those_of_the_reference(name: str, tmp_path: Path) -> None:
    spec = next(spec for spec in SPECS if called(spec) == name)
    item, chance = specification(spec), random.Random(1)
    adapter, wanted = JavaScriptAdapter.create(item, tmp_path), FrameClasses(item.edition)
    messages, ambiguous = item.edition.all_messages(), 0
    assert item.frames is not None
    frames = [CanFrame(golden.id, golden.data, golden.extended, golden.remote) for golden in item.frames.frames]
    random_frames = [random_frame(chance.choice(messages), chance.choice(messages), chance) for _ in range(50)]
    for frame in (*chance.sample(frames, min(len(frames), 100)), *random_frames):
        answer = adapter.ask("candidates", frame=_frame(frame))
        assert [(candidate["direction"], candidate["command"]) for candidate in answer] == [
            (form.message.direction.value, form.message.command) for form in wanted.of(frame).forms
        ]
        ambiguous += len(answer) > 1
    assert ambiguous


def _frame(frame: CanFrame) -> dict[str, object]:
    return {"id": frame.id, "data": list(frame.data), "extended": frame.extended, "remote": frame.remote}


def test_texts_are_literals() -> None:
    texts = ["</script><!--", "\u2028\u2029", "\\", '"', "${x}`'", "\n\r\0", "急停", "\U0001f600"]
    assert not re.search(r"[^ -~]|[<>]", "".join(map(quoted, texts)))
    value = {text: [text, None] for text in texts}
    assert json.loads(run(f"console.log(JSON.stringify(Object.entries({printed(value)})))")) == [
        [text, [text, None]] for text in texts
    ]


def test_reserved_names_of_packages(tmp_path: Path) -> None:
    diagnostics = findings(tmp_path, MINIMAL.replace("family: lamp\n", "family: stream\n"))
    assert [finding.message for finding in diagnostics] == [
        "the npm package cannot have the name `stream`, which Node uses itself"
    ]


def test_refusals_are_those_of_the_model() -> None:
    declared = (RUNTIME / "canwright-codec.d.ts").read_text("utf-8")
    names = re.search(r"type Refusal =([^;]*);", declared)
    refusals = [refusal.value for refusal in Refusal]
    assert names and re.findall(r'"(\w+)"', names.group(1)) == refusals


USE = """\
import * as motor from "mwd_motor/v2_35";
import { TEXTS } from "mwd_motor/v2_35.texts";

const request = motor.encodeRequest("set_torque", { node: 1, values: { iq: 1.5 }, parameters: { series: "MG" } });
const iq: number | null = request.values.iq;
const reply = motor.decodeAnswer(request, { id: 0x141, data: new Uint8Array(8) }, { series: "MG", encoder_bits: 14 });
const command: "set_torque" = reply.command;
const multi = motor.decodeAs("reply", "read_multi_turn_angle", { id: 0x141 });
const wide: bigint = multi.raw.angle;
const any: motor.Reply = motor.decodeReply({ id: 0x141, data: [1, 2] });
if (any.command === "read_status_1") {
  const voltage: number = any.values.voltage;
  console.log(voltage);
}
const title: string | undefined = TEXTS.commands["set_torque"]?.title?.en;
motor.encodeRequest("motor_off", { node: 1 });
motor.decodeReply({ id: 0x141, data: new DataView(new ArrayBuffer(8)) });
motor.encodeRequest("set_speed", { node: 1, raw: { speed: 5n } });
console.log(iq, command, wide, title, motor.MESSAGES[0]?.fields[0]?.type.unit);
"""

WRONG = """\
motor.encodeRequest("set_sped", { node: 1 });
motor.encodeRequest("set_speed", { node: 1, values: { sped: 1 } });
motor.encodeRequest("set_speed", { node: 1 });
motor.encodeRequest("set_speed", { values: { speed: 1 } });
motor.encodeRequest("motor_off");
motor.encodeRequest("set_speed", { node: 1, values: { speed: "1" } });
motor.encodeRequest("set_speed", { node: 1, values: { speed: 1 }, parameters: { series: "XX" } });
const number: number = multi.raw.angle;
const sure: number = request.values.iq;
request.values.iq = 1;
"""


@pytest.mark.tools
def test_declarations_are_strict_typescript(tmp_path: Path) -> None:
    """Every line of WRONG is an error, and nothing else; the declarations of all specs are correct."""
    folder = write(tmp_path, MOTOR)
    every = write(tmp_path, *SPECS)
    options = ["--strict", "--noEmit", "--module", "nodenext", "--target", "es2023", "--noUncheckedIndexedAccess"]
    npm = tool("npm")
    compiler = [npm, "exec", "--yes", "--package=typescript@5.9", "--", "tsc", *options]
    run_tool(*compiler, *(every / f"{module_path(specification(spec).edition)}.d.ts" for spec in SPECS), cwd=every)
    (folder / "use.mts").write_text(USE, "utf-8")
    run_tool(*compiler, "use.mts", cwd=folder)
    (folder / "use.mts").write_text(USE + WRONG, "utf-8")
    done = subprocess.run(
        [*compiler, "--pretty", "false", "use.mts"], cwd=folder, capture_output=True, text=True, check=False
    )
    lines = [int(line) for line in re.findall(r"^use\.mts\((\d+),", done.stdout, re.MULTILINE)]
    first = USE.count("\n") + 1
    assert sorted(set(lines)) == list(range(first, first + WRONG.count("\n"))), done.stdout
