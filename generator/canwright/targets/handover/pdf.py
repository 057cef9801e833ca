"""The reference of an edition as a PDF, typeset by Typst with a font that contains Chinese glyphs."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Mapping
from typing import Any

from ...templating import resources

FONTS = "pylopdf_fonts_zh_cn"


def pdf(reference: Mapping[str, Any]) -> bytes:
    """The PDF; equal references make equal bytes. Fonts of the machine are not used. Raises ImportError."""
    import typst

    package = importlib.util.find_spec(FONTS)
    arguments: Mapping[str, Any] = {
        "font_paths": list(package.submodule_search_locations or ()) if package else [],
        "ignore_system_fonts": True,
        "sys_inputs": {"reference": json.dumps(reference)},
        "format": "pdf",
    }
    content: bytes = typst.compile((resources.TEMPLATES / "handover/reference.typ").read_bytes(), **arguments)
    return content
