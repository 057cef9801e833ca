"""Small specs that ask for much work, and the time and memory that they take: `python -m tests.untrusted.attacks`.

Every spec within the limits of canwright takes at most `LOOPS` times the processor time of a fixed loop, and
`MEGABYTES` of memory, and so does the rejection of any other. The loop runs before each attack, so that a busy machine
does not change the verdict. The command runs every spec of `ATTACKS` through `generate`, `check`, `show` and `diff`; of a
spec that is too large also the largest of some shares that is accepted. It exits with 1 if one of them takes more. Names
given as arguments select attacks.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from pathlib import Path
from typing import NamedTuple

LOOPS = 40.0
"""The maximum processor time of a run, relative to that of `LOOP`, which takes about a quarter of a second."""
LOOP = "sum(i * i % 7 for i in range(3_000_000))"
MEGABYTES = 500
TIME_OUT = 60
"""Seconds of processor time after which a run is killed."""
ADDRESS_SPACE = 3 << 30
"""Bytes of address space of a run: what it reserves is more than what it uses."""

HEAD = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u16}
"""
FRAMES_HEAD = """\
canwright: 1
family: lamp
edition: v1
sources: {manual: Examples of the manual}
"""


class Attack(NamedTuple):
    """The texts of a spec and of its golden frames."""

    spec: str
    frames: str = ""

    def write(self, folder: Path, name: str = "lamp") -> Path:
        """Writes both files, and returns the spec."""
        spec = folder / f"{name}.yaml"
        spec.write_text(self.spec, "utf-8")
        if self.frames:
            (folder / f"{name}.frames.yaml").write_text(self.frames, "utf-8")
        return spec


SHARES = [1.0, *(share / 2**halvings for halvings in range(1, 9) for share in (1.75, 1.5, 1.25, 1))]
SHARE = ContextVar("SHARE", default=1.0)
"""The share of the usual number of items that a spec gets."""


def many(count: int, text: str) -> str:
    """A text many times, with its number in place of each `#`."""
    return "".join(text.replace("#", str(i)) for i in range(max(1, int(count * SHARE.get()))))


def fields(count: int, form: str = "{at: 2, raw: u8}") -> str:
    """A mapping of fields that may overlap."""
    return "{" + many(count, f"f#: {form}, ") + "}"


def bits(count: int) -> str:
    """A mapping of fields of one bit each."""
    return "{" + "".join(f"f{i}: {{at: {2 + i // 8}.{i % 8}, raw: u1}}, " for i in range(count)) + "}"


def commands(count: int, body: str) -> str:
    return "commands:\n" + many(count, f"  c#: {{code: #, {body}}}\n")


def choices(count: int, values: int) -> str:
    names = ", ".join(f"v{i}" for i in range(values))
    return "parameters: {" + many(count, f"p#: {{values: [{names}]}}, ") + "}\n"


def table(entries: int, entry: str) -> str:
    return "tables: {t: {index: {at: 2, raw: u16}, entries: {" + many(entries, f"e#: {entry}, ") + "}}}\n"


def head(nodes: str, languages: str = "") -> str:
    """The start of a spec with other nodes, and 29-bit ids for them."""
    address = f"{{id: 0x1000 + node, extended: true, nodes: {nodes}}}"
    text = HEAD.replace("{id: 0x100 + node, nodes: 1..4}", address)
    return text + (f"languages: [{languages}]\n" if languages else "")


def head_of_addresses() -> str:
    """The start of a spec with 256 addresses of 65536 nodes each."""
    address = "{{id: {} + node * 256, extended: true, nodes: 0..65535}}"
    addresses = "".join(f"a{i}: {address.format(i)}, " for i in range(256))
    return HEAD.replace("{lamp: {id: 0x100 + node, nodes: 1..4}}", "{" + addresses + "}")


def texts(count: int) -> str:
    return "x" * count


READ = "reply: {a: {at: 4, raw: u8}}"
ONE = commands(1, READ)
SERIES = "s: {values: [" + ", ".join(f"v{i}" for i in range(64)) + "]}"
SHORT_ENTRY = "{index: #, layout: {a: {at: 4, raw: u8}}}"


def enum(count: int, member: str = "m#: #") -> str:
    return "types: {t: {raw: u32, enum: {" + many(count, f"{member}, ") + "}}}\n"


USE_OF_T = commands(1, "reply: {a: {at: 2, type: t}}")


def _golden_frames(count: int) -> str:
    frame = '  - {reply: c0, node: 1, id: 0x101, data: "00 00 00 00 00 00 00 00", raw: {a: 0}, values: {a: 0}, source: manual}\n'
    return f"{FRAMES_HEAD}frames:\n{many(count, frame)}"


ATTACKS: dict[str, Callable[[], Attack]] = {
    "bits x nodes x series": lambda: Attack(
        head("0..255") + "parameters: {" + SERIES + "}\n" + commands(2000, f"request: {bits(4)}, reply: echo")
    ),
    "layout x commands": lambda: Attack(
        HEAD + f"layouts: {{l: {{fields: {bits(48)}}}}}\n" + commands(1900, "request: l, reply: l")
    ),
    "layout x commands x series": lambda: Attack(
        HEAD
        + "parameters: {"
        + SERIES
        + "}\n"
        + f"layouts: {{l: {{fields: {bits(48)}}}}}\n"
        + commands(1000, "request: l, reply: l")
    ),
    "entries x commands": lambda: Attack(
        HEAD + table(1000, f"{{index: #, layout: {bits(30)}}}") + commands(4, "table: t, request: entry, reply: entry")
    ),
    "array x commands": lambda: Attack(
        HEAD + "layouts: {l: {fields: {a: {at: 2, raw: u1, array: 0..47}}}}\n" + commands(1900, "request: l, reply: l")
    ),
    "enum": lambda: Attack(HEAD + enum(45_000) + USE_OF_T),
    "enum x fields": lambda: Attack(
        HEAD + enum(9_000) + "layouts: {l: {fields: {a: {at: 4, type: t}}}}\n" + commands(1000, "request: l, reply: l")
    ),
    "enum x nodes": lambda: Attack(head("0..65535") + enum(9_000) + USE_OF_T),
    "enum x series": lambda: Attack(HEAD + "parameters: {" + SERIES + "}\n" + enum(20_000) + USE_OF_T),
    "many enums": lambda: Attack(
        HEAD
        + "types:\n"
        + many(300, "  t#: {raw: u16, enum: {" + many(200, "m@: @, ").replace("@", "@") + "}}\n").replace(
            "m@: @", "x: 1"
        )
        + ONE
    ),
    "flags": lambda: Attack(
        HEAD
        + "types: {"
        + many(3000, "t#: {raw: u32, flags: {" + "".join(f"b{i}: {i}, " for i in range(32)) + "}}, ")
        + "}\n"
        + commands(1, "reply: {a: {at: 2, type: t0}}")
    ),
    "types with scales by series": lambda: Attack(
        HEAD
        + "parameters: {"
        + SERIES
        + "}\n"
        + "types: {"
        + many(1500, "t#: {raw: u16, scale: {by: s, " + "".join(f"v{i}: 0.{i + 1}, " for i in range(64)) + "}}, ")
        + "}\n"
        + "commands:\n"
        + many(1500, "  c#: {code: #, reply: {a: {at: 2, type: t#}}}\n")
    ),
    "unknown types": lambda: Attack(HEAD + commands(1, "reply: " + fields(990, "{at: 2, type: none_such_#}"))),
    "unknown effects": lambda: Attack(
        HEAD
        + "effects: {"
        + many(900, "effect_#: {}, ")
        + "}\n"
        + commands(1, "reply: none, effects: [" + many(200_000, "efect_#, ") + "]")
    ),
    "unknown parameters": lambda: Attack(
        HEAD + commands(1, "reply: none, only: {" + many(200_000, "efect_#: [a], ") + "}")
    ),
    "unknown layouts": lambda: Attack(
        HEAD
        + f"layouts: {{{many(1000, 'layout_#: {fields: {}}, ')}}}\n"
        + commands(1900, "request: layuot_#, reply: lyout_#")
    ),
    "unknown errata": lambda: Attack(
        HEAD
        + ONE
        + "errata:\n  - {id: e, manual: a, printed: a, used: a, why: a, where: ["
        + many(200_000, "commands.d#, ")
        + "]}\n"
    ),
    "unknown entry commands": lambda: Attack(
        HEAD
        + table(900, "{index: #, commands: [" + "x, " * 200 + "], layout: {}}")
        + commands(5, "table: t, reply: none")
    ),
    "unknown keys": lambda: Attack(HEAD + ONE + many(500_000, "k#: 1\n")),
    "unknown keys of one command": lambda: Attack(HEAD + ONE + "  d:\n" + many(300_000, "    k#: 1\n")),
    "duplicate keys": lambda: Attack(HEAD + ONE + "a: 1\n" * 700_000),
    "keys of a mapping": lambda: Attack(HEAD + ONE + "settings: {" + many(500_000, "a#: {}, ") + "}\n"),
    "keys without a value": lambda: Attack(HEAD + ONE + "settings:\n" + many(500_000, "  a#:\n")),
    "keys as names": lambda: Attack("{" + many(700_000, "k#: 1, ") + "}"),
    "keys of nothing": lambda: Attack(many(350_000, "#a: 1\n")),
    "long list": lambda: Attack(HEAD + commands(1, "reply: none, effects: [" + "a, " * 1_300_000 + "]")),
    "long list of mappings": lambda: Attack(HEAD + ONE + "errata: [" + "{}, " * 1_000_000 + "]\n"),
    "list of empty lists": lambda: Attack("[" + "[]," * 1_300_000 + "]"),
    "nested": lambda: Attack(("[" * 20 + "]" * 20 + ",\n").join(["[", *([""] * 100_000), "]"])),
    "sequence in every key": lambda: Attack(many(300_000, "? [a, b]\n: 1\n")),
    "one long line": lambda: Attack(HEAD + ONE.strip()[:-1] + f', title: "{texts(4_000_000)}"}}\n'),
    "findings on one long line": lambda: Attack(
        "{" + HEAD.strip().replace("\n", ", ") + ", commands: {" + many(250_000, "c#: {code: x}, ") + "}}"
    ),
    "many lines": lambda: Attack(HEAD + ONE + "#\n" * 1_900_000),
    "many types": lambda: Attack(HEAD + "types:\n" + many(35_000, "  t#: {raw: u8, unit: A, scale: 0.#1}\n") + ONE),
    "many types of a quantity": lambda: Attack(
        HEAD
        + "types:\n"
        + many(1900, "  t#: {raw: u8, unit: A, title: Current, scale: 0.#1}\n")
        + "commands:\n"
        + many(1900, "  c#: {code: #, reply: {current: {at: 2, type: t#}}}\n")
    ),
    "many layouts": lambda: Attack(HEAD + "layouts:\n" + many(35_000, "  l#: {fields: {a: {at: 2, raw: u8}}}\n") + ONE),
    "overlapping fields": lambda: Attack(HEAD + commands(300, f"reply: {fields(700)}")),
    "overlapping wide fields": lambda: Attack(HEAD + commands(150, f"reply: {fields(990, '{at: 0, raw: u64}')}")),
    "overlapping big-endian fields": lambda: Attack(
        HEAD + "byte_order: big\n" + commands(20, f"reply: {fields(990, '{at: 3, raw: u32}')}")
    ),
    "overlapping arrays": lambda: Attack(
        HEAD + commands(150, f"reply: {fields(990, '{at: 0, raw: u1, array: 1..64}')}")
    ),
    "arrays in 512 bits": lambda: Attack(
        HEAD + commands(150, f"reply: {fields(990, '{at: 0, raw: u64, array: 1..512}')}")
    ),
    "alternating only": lambda: Attack(
        HEAD
        + "parameters: {p: {values: ["
        + many(256, "v#, ")
        + "]}}\n"
        + commands(
            100, "reply: {" + "".join(f"f{i}: {{at: 2, raw: u8, only: {{p: [v{i}]}}}}, " for i in range(256)) + "}"
        )
    ),
    "equal commands": lambda: Attack(
        HEAD + "commands:\n" + many(1900, "  c#: {code: 1, reply: {f#: {at: 2, raw: u8}}}\n")
    ),
    "equal codes, other constants": lambda: Attack(
        HEAD + "commands:\n" + many(1900, "  c#: {code: 1, reply: {f#: {at: 2, raw: u16, constant: #}}}\n")
    ),
    "equal codes, constants elsewhere": lambda: Attack(
        HEAD.replace("u16", "u8")
        + "commands:\n"
        + "".join(
            f"  c{i}: {{code: 1, reply: {{f: {{at: {1 + i % 7}.{i % 8}, raw: u{1 + i % 8}, constant: {i % 2}}}}}}}\n"
            for i in range(1900)
        )
    ),
    "codes accepted twice": lambda: Attack(
        HEAD
        + "commands:\n"
        + many(2000, "  c#: {code: #, reply: {layout: {}, accept: [" + many(200, "3@, ").replace("@", "000") + "]}}\n")
    ),
    "accepted codes": lambda: Attack(
        HEAD
        + "commands:\n"
        + "".join(
            f"  c{i}: {{code: {i}, reply: {{layout: {{a: {{at: 2, raw: u8}}}}, accept: [{', '.join(str(1000 + i * 200 + j) for j in range(200))}]}}}}\n"
            for i in range(300)
        )
    ),
    "addresses": lambda: Attack(
        head_of_addresses()
        + "commands:\n"
        + "".join(f"  c{i}: {{code: {i}, address: a{i}, {READ}}}\n" for i in range(256))
    ),
    "addresses with fields in the id": lambda: Attack(
        head_of_addresses()
        + "commands:\n"
        + "".join(f"  c{i}: {{code: {i}, address: a{i}, reply: {{a: {{at: id.24, raw: u5}}}}}}\n" for i in range(256))
    ),
    "fixed ids": lambda: Attack(
        HEAD.replace("{lamp: {id: 0x100 + node, nodes: 1..4}}", "{" + many(256, "a#: {id: #}, ") + "}")
        + "commands:\n"
        + "".join(f"  c{i}: {{code: {i // 256}, address: a{i % 256}, {READ}}}\n" for i in range(1900))
    ),
    "all nodes reply": lambda: Attack(
        head("0..65535") + commands(200, "reply: {layout: {a: {at: 2, raw: u8}}, from_each: 0..65535}")
    ),
    "from_each of other nodes": lambda: Attack(
        head("0..9") + commands(2000, "reply: {layout: {a: {at: 2, raw: u8}}, from_each: 0..65535}")
    ),
    "all nodes x commands": lambda: Attack(head("0..65535") + commands(20, READ)),
    "all ids": lambda: Attack(head("0..536870911") + ONE),
    "256 nodes x commands": lambda: Attack(head("0..255") + commands(4000, READ)),
    "256 nodes x commands with the code in the id": lambda: Attack(
        head("0..255").replace("{at: 0, raw: u16}", "{at: id.13, raw: u16}") + commands(4000, READ)
    ),
    "combinations": lambda: Attack(HEAD + choices(6, 2) + commands(2000, READ)),
    "numeric choices": lambda: Attack(
        HEAD + "parameters: {" + many(200, "p#: {values: [" + ", ".join(map(str, range(256))) + "]}, ") + "}\n" + ONE
    ),
    "combinations for conversions": lambda: Attack(
        HEAD
        + "parameters: {p: {values: ["
        + ", ".join(map(str, range(256)))
        + "]}}\n"
        + "types: {"
        + many(300, "t#: {raw: u16, scale: {by: p, " + "".join(f"{i}: 0.{i + 1}, " for i in range(256)) + "}}, ")
        + "}\n"
        + "commands:\n"
        + many(300, "  c#: {code: #, reply: {a: {at: 2, type: t#}}}\n")
    ),
    "long title": lambda: Attack(HEAD + commands(1, f'title: "{texts(2_000_000)}", {READ}')),
    "long title of an address": lambda: Attack(
        head("0..255").replace("extended: true", f'extended: true, title: "{texts(2_000)}"') + commands(100, READ)
    ),
    "long text of a type": lambda: Attack(
        HEAD
        + f'types: {{t: {{raw: u8, title: "{texts(2_000)}", about: "{texts(2_000)}"}}}}\n'
        + commands(1000, "reply: {a: {at: 2, type: t}}")
    ),
    "long text of an enum": lambda: Attack(
        HEAD
        + f'types: {{t: {{raw: u8, enum: {{m: {{value: 1, title: "{texts(2_000)}"}}}}}}}}\n'
        + commands(1000, "reply: {a: {at: 2, type: t}}")
    ),
    "long text of a layout": lambda: Attack(
        HEAD
        + f'layouts: {{l: {{about: "{texts(2_000)}", fields: {{a: {{at: 2, raw: u8, about: "{texts(2_000)}"}}}}}}}}\n'
        + commands(1000, "reply: l")
    ),
    "long text of an effect": lambda: Attack(
        HEAD
        + f'effects: {{e: {{title: "{texts(2_000)}", about: "{texts(2_000)}"}}}}\n'
        + commands(1000, "reply: none, effects: [e]")
    ),
    "long text of a setting": lambda: Attack(
        HEAD
        + f'settings: {{e: {{title: "{texts(2_000)}", about: "{texts(2_000)}"}}}}\n'
        + commands(1000, "reply: none, limited_by: [e]")
    ),
    "long text of a table": lambda: Attack(
        HEAD
        + table(2000, SHORT_ENTRY).replace("{t: {", f'{{t: {{title: "{texts(2_000)}", about: "{texts(2_000)}", ')
        + commands(2, "table: t, request: none, reply: entry")
    ),
    "long text of a command with a table": lambda: Attack(
        HEAD
        + table(2000, SHORT_ENTRY)
        + commands(
            1, f'title: "{texts(2_000)}", about: "{texts(2_000)}", notes: ["{texts(2_000)}"], table: t, reply: entry'
        )
    ),
    "long text of the edition": lambda: Attack(
        HEAD + f'title: "{texts(2_000)}"\nabout: "{texts(2_000)}"\nmanual: "{texts(2_000)}"\n' + commands(1000, READ)
    ),
    "long sections of the manual": lambda: Attack(HEAD + commands(1, f'manual: "{texts(1_000_000)}", {READ}')),
    "long effects of a command with a table": lambda: Attack(
        HEAD
        + "effects: {"
        + many(500, "e#: {}, ")
        + "}\n"
        + table(2000, SHORT_ENTRY)
        + commands(1, "table: t, reply: entry, effects: [" + many(500, "e#, ") + "]")
    ),
    "wide characters": lambda: Attack(HEAD + commands(1000, f'title: "{"中" * 2_000}", {READ}')),
    "text of short lines": lambda: Attack(HEAD + commands(1000, f'about: "{"a " * 1_000}", {READ}')),
    "text of brackets": lambda: Attack(HEAD + commands(1000, f'about: "{"[(*_`<&|" * 250}", {READ}')),
    "golden frames": lambda: Attack(HEAD + commands(1, "reply: {a: {at: 2, raw: u8}}"), _golden_frames(9_000)),
    "golden frames of an enum": lambda: Attack(HEAD + enum(9000) + USE_OF_T, _golden_frames(9_000)),
    "rejected frames": lambda: Attack(
        HEAD + commands(1000, READ),
        f"{FRAMES_HEAD}frames: []\nrefused:\n"
        + '  - {decode: reply, id: 0x101, data: "FF FF 00", says: unknown_code, source: manual}\n' * 25_000,
    ),
    "long notes of frames": lambda: Attack(
        HEAD + commands(1, "reply: {a: {at: 2, raw: u8}}"),
        _golden_frames(1).replace("source: manual}", f'source: manual, note: "{texts(7_000_000)}"}}'),
    ),
    "errata": lambda: Attack(
        HEAD
        + ONE
        + "errata:\n"
        + many(35_000, "  - {id: e#, manual: a, where: [commands.c0], printed: a, used: a, why: a}\n")
    ),
    "places of an erratum": lambda: Attack(
        HEAD
        + ONE
        + "errata:\n"
        + many(2000, "  - {id: e#, manual: a, where: [" + "commands.c0, " * 200 + "], printed: a, used: a, why: a}\n")
    ),
    "errata x commands": lambda: Attack(
        HEAD
        + commands(2000, READ)
        + "errata:\n"
        + many(100, "  - {id: e#, manual: a, where: [commands], printed: a, used: a, why: a}\n")
    ),
    "equal errata": lambda: Attack(
        HEAD
        + ONE
        + "errata:\n"
        + "  - {id: e, manual: a, where: [commands.c0], printed: a, used: a, why: a}\n" * 40_000
    ),
    "languages": lambda: Attack(HEAD + "languages: [" + "en, zh, " * 500_000 + "]\n" + ONE),
    "texts without a language": lambda: Attack(
        HEAD + "languages: [en, zh]\n" + commands(1900, READ + ", title: a, about: b, notes: [" + "a, " * 100 + "]")
    ),
    "settings": lambda: Attack(
        HEAD
        + "settings: {"
        + many(40_000, "s#: {}, ")
        + "}\n"
        + commands(1, "reply: none, limited_by: [" + many(40_000, "s#, ") + "]")
    ),
    "settings x commands": lambda: Attack(
        HEAD
        + "settings: {"
        + many(300, "s#: {}, ")
        + "}\n"
        + commands(3000, "reply: none, limited_by: [" + many(300, "s#, ") + "]")
    ),
    "modes": lambda: Attack(HEAD + "bus: {modes: {" + many(35_000, "m#: {bit_rates_kbps: [500]}, ") + "}}\n" + ONE),
    "bit rates": lambda: Attack(HEAD + "bus: {modes: {m: {bit_rates_kbps: [" + "500, " * 1_000_000 + "]}}}\n" + ONE),
    "notes": lambda: Attack(HEAD + commands(1, "reply: none, notes: [" + "a, " * 1_000_000 + "]")),
    "sources": lambda: Attack(
        HEAD + ONE,
        FRAMES_HEAD.replace("{manual: Examples", "{" + many(400_000, "s#: a, ") + "manual: Examples") + "frames: []\n",
    ),
    "unknown sources": lambda: Attack(
        HEAD + ONE,
        FRAMES_HEAD.replace("{manual: Examples", "{" + many(900, "source_#: a, ") + "manual: Examples")
        + "frames:\n"
        + many(50_000, '  - {reply: c0, node: 1, id: 0x101, data: "00", source: suorce_#}\n'),
    ),
    "chain of replies": lambda: Attack(
        HEAD + "commands:\n" + "".join(f"  c{i}: {{code: {i}, reply: {{of: c{i + 1}}}}}\n" for i in range(1900))
    ),
    "one reply of many": lambda: Attack(
        HEAD
        + f"commands:\n  c0: {{code: 0, reply: {bits(48)}}}\n"
        + "".join(f"  c{i}: {{code: {i}, reply: {{of: c0}}}}\n" for i in range(1, 1900))
    ),
    "large protocol": lambda: Attack(
        HEAD.replace("{id: 0x100 + node, nodes: 1..4}", "{id: 0x100}")
        + "commands:\n"
        + many(
            2000,
            "  message_#: {code: #, request: none, reply: {"
            + "".join(
                f"signal_{i}: {{at: {2 + i * 0}.{0}, raw: u4}}, ".replace("at: 2.0", f"at: {2 + i // 2}.{i % 2 * 4}")
                for i in range(10)
            )
            + "}}\n",
        )
    ),
}


class Usage(NamedTuple):
    """The resources of one run; `megabytes` is the most memory at one time."""

    seconds: float
    megabytes: float
    status: int
    output: str

    def is_within_limits(self, seconds: float) -> bool:
        return (
            self.status in (0, 1, 2)
            and self.seconds <= seconds
            and self.megabytes <= MEGABYTES
            and "Traceback" not in self.output
        )


def run(*arguments: str, log: Path, address_space: int = ADDRESS_SPACE, time_out: int = TIME_OUT) -> Usage:
    """Runs Python with limits that the kernel enforces, in bytes and seconds; the output is in the file `log`."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))
        resource.setrlimit(resource.RLIMIT_CPU, (time_out, time_out))

    with log.open("wb") as stream:
        process = subprocess.Popen(
            [sys.executable, *arguments],
            stdout=stream,
            stderr=subprocess.STDOUT,
            cwd=log.parent,
            preexec_fn=limit,
        )
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    with log.open("rb") as written:
        shown = written.read(1 << 16).decode("utf-8", "replace")
    return Usage(used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, process.returncode, shown)


def uses(attack: Attack, folder: Path) -> Iterator[tuple[str, Usage]]:
    """The resources of every command for one attack."""
    spec = str(attack.write(folder))
    for name, arguments in {
        "generate": ("generate", "--spec", spec, "--out", str(folder / "out"), "--no-cache"),
        "check": ("check", "--spec", spec, "--no-cache"),
        "show": ("show", "c0", "--spec", spec),
        "diff": ("diff", spec, str(_edited(attack, folder))),
    }.items():
        yield name, run("-m", "canwright", *arguments, log=folder / "log")


def _edited(attack: Attack, folder: Path) -> Path:
    """The spec of an attack with other codes and bits: nearly everything differs."""
    changed = attack.spec.replace("edition: v1", "edition: v2").replace("u8", "u7").replace("at: 2", "at: 3")
    return Attack(changed.replace("m1:", "n1:").replace("xxx", "yyy")).write(folder, "other")


def reduced(make: Callable[[], Attack], folder: Path) -> Iterator[Attack]:
    """The spec of an attack, and the largest share of it that is not too large."""
    for share in SHARES:
        token = SHARE.set(share)
        attack = make()
        SHARE.reset(token)
        checked = run("-m", "canwright", "check", "--spec", str(attack.write(folder)), "--no-cache", log=folder / "log")
        is_accepted = not any(f"[{rule}]" in checked.output for rule in ("too-large", "file-size"))
        if is_accepted or share == 1:
            yield attack
        if is_accepted:
            return


def main(names: list[str]) -> int:
    exceeding = []
    selected = [name for name in ATTACKS if not names or any(word in name for word in names)]
    with tempfile.TemporaryDirectory() as made_in:
        attacks = ((name, attack) for name in selected for attack in reduced(ATTACKS[name], Path(made_in)))
        for name, attack in attacks:
            exceeding += _exceeding(name, attack)
    return int(bool(exceeding))


def _exceeding(name: str, attack: Attack) -> list[str]:
    """Runs and prints every command for one attack; the name for each that takes too much."""
    exceeding = []
    with tempfile.TemporaryDirectory() as folder:
        seconds = LOOPS * run("-c", LOOP, log=Path(folder, "log")).seconds
        for command, used in uses(attack, Path(folder)):
            is_within = used.is_within_limits(seconds)
            verdict = "OK" if is_within else "EXCEEDS"
            size = (
                sum(f.stat().st_size for f in Path(folder, "out").rglob("*") if f.is_file())
                if command == "generate"
                else 0
            )
            first = used.output.strip().splitlines()[:1]
            print(
                f"{verdict:8}{name:45}{command:9}{used.seconds:7.1f} s of {seconds:4.1f} {used.megabytes:6.0f} MB {used.status:4}"
                f" {size / 1e6:8.1f} {''.join(first)[-110:]}",
                flush=True,
            )
            if not is_within:
                exceeding.append(name)
    return exceeding


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
