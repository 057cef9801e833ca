"""Values of YAML scalars and names of keys; None for a scalar that YAML 1.1 and 1.2 read differently."""

from __future__ import annotations

import functools
import re
from decimal import Decimal
from typing import Any

import yaml

from . import ambiguous

Scalar = str | int | Decimal | bool

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
MERGE = "<<"
"""The key that merges another mapping into this one in YAML 1.1."""

_INTEGER = re.compile(r"-?(?:0|[1-9][0-9]{0,30})|0x[0-9A-Fa-f]{1,16}")
_DECIMAL = re.compile(rf"-?(?:0|[1-9][0-9]{{0,30}})\.[0-9]{{1,{ambiguous.MAX_DECIMALS}}}")


@functools.lru_cache(maxsize=1 << 12)
def plain(text: str) -> Scalar | None:
    """The value of a plain scalar; None for an empty or ambiguous one."""
    if _INTEGER.fullmatch(text):
        return int(text, 0)
    if _DECIMAL.fullmatch(text):
        return Decimal(text)
    if text in ("true", "false"):
        return text == "true"
    return None if text == "" or ambiguous.ambiguity(text) else text


def name_of(event: Any) -> str | None:
    """The name of a key; None for a key that is not a name."""
    if not isinstance(event, yaml.ScalarEvent) or event.anchor or event.tag:
        return None
    if event.style:
        return str(event.value)
    value = None if event.value == MERGE else plain(event.value)
    return None if value is None or isinstance(value, bool) else str(value)
