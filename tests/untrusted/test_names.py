"""Valid names that mean something else in a generated language."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import cantools
from canwright.project.loader import load
from canwright.project.pipeline import generate
from canwright.targets.registry import default_targets

from .. import node
from ..compilers import ZIG

SPEC = """\
canwright: 1
family: lamp
edition: v1
bus: {modes: {class: {bit_rates_kbps: [500], default_kbps: 500}, import: {bit_rates_kbps: [1000]}}}
addresses: {namespace: {id: 0x100 + node, nodes: 1..4}, lambda: {id: 0x200 + node, nodes: 1..4}, bu_: {id: 0x300}}
selector: {at: 0, raw: u8}
parameters:
  std: {values: [3, 4]}
  set: {values: {int: {}, none_: {}, BO_: {}, default: {}}}
  value: {values: {with: {}, None_: {}, x: {}}}
  get: {number: {min: 1, max: 9}}
  register: {number: {min: 1, max: 9}}
settings: {global: {}, delete: {}}
effects: {yield: {}, operator: {}}
types:
  dict: {raw: u16, scale: {by: std, 3: 0.5, 4: 0.25}}
  lamp: {raw: u8, enum: {and: 1, self: 2, nan: 3, errno: 4}}
  type: {raw: u8, flags: {class: 0, print: 1, values: 2, len: 3}}
  double: {raw: i16, scale: 1/512*get, range: -get..get}
  goto: {raw: i16, scale: 1/256*register}
layouts: {template: {fields: {this: {at: 1, type: lamp}, uint16_t: {at: 2, type: type}}}}
tables:
  union: {index: {at: 1, raw: u8}, entries: {try: {index: 1, layout: {self: {at: 2, raw: u8}}}}}
commands:
  typename:
    code: 1
    address: namespace
    request: {uint8_t: {at: 1, type: lamp}, cls: {at: 2, type: dict}, double: {at: 4, type: double}, std: {at: 6, type: goto}}
    reply: {layout: template}
    effects: [yield, operator]
    limited_by: [global]
  volatile: {code: 2, address: lambda, table: union, request: entry, reply: echo, mode: class}
  super: {code: 3, address: bu_, request: none, reply: {int: {at: 1, raw: u8, array: 0..2}, sg_: {at: 4, type: dict}}}
  property: {code: 4, only: {set: [int]}, reply: {next: {at: 1, raw: u8}}, not_limited_by: [delete]}
"""


def test_names_that_are_words_of_other_languages(tmp_path: Path) -> None:
    spec = tmp_path / "lamp.yaml"
    spec.write_text(SPEC, "utf-8")
    for path, content in generate([load(spec).specification], default_targets(), {}).files.items():
        file = tmp_path / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    module = next(tmp_path.glob("python/**/v1.py"))
    program = "from lamp.v1 import *\nimport lamp.v1\nlamp.v1.TypenameRequest"
    subprocess.run([sys.executable, "-W", "error", "-c", program], cwd=module.parents[1], check=True)
    edition = json.dumps((tmp_path / "javascript/lamp/v1.js").as_uri())
    node.run(f"""
        const lamp = await import({edition});
        const parameters = {{ value: "with", set: "int", get: 3 }};
        const message = lamp.encodeRequest("typename", {{
          node: 1, values: {{ uint8_t: "self", cls: 0.5, double: 0, std: 0 }}, parameters: {{ ...parameters, std: 3, register: 2 }} }});
        if (message.values.uint8_t !== "self") throw new Error(message.values.uint8_t);
    """)
    for database in tmp_path.glob("dbc/*.dbc"):
        assert cantools.database.load_file(database)
    include = tmp_path / "c" / "include"
    headers = sorted(file.relative_to(include) for file in (include / "lamp").glob("v1*.h*"))
    assert len(headers) > 3
    unit = tmp_path / "unit.c"
    unit.write_text("".join(f'#include "{header}"\n' for header in headers if header.suffix == ".h"), "utf-8")
    ZIG.check("c99", f"-I{include}", "-c", "-o", tmp_path / "unit.o", unit)
    unit.write_text('#include "lamp/v1.hpp"\n', "utf-8")
    ZIG.check("c++17", f"-I{include}", "-x", "c++", "-c", "-o", tmp_path / "unit.o", unit)
