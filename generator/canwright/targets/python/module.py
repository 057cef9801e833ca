"""The module of an edition, as its template needs it."""

from __future__ import annotations

from collections.abc import Iterable

from ...model.edition import Edition
from ...model.message import Direction
from ..base import header
from . import code, docstrings, routes
from .class_bodies import ClassBodies
from .imports import PUBLIC, Imports
from .messages import MessageViews
from .parameters import choice_view, parameter_view
from .types import type_views

SHARED = ("_codec.py", "_dispatch.py", "nodes.py", "python_can.py")
"""The modules of the runtime that are copied into the package of each family."""

CONSTANTS = (
    *("EDITION", "FAMILY", "REPLY_WITHIN_MS", "SPEC_HASH", "UNKNOWN"),
    *("AnyReply", "AnyRequest", "Parameters"),
)
FUNCTIONS = (
    *("check_reply", "decode_answer", "decode_reply", "decode_request"),
    *("has_node_in_data", "ids_of", "node_of"),
)


def module_view(edition: Edition) -> dict[str, object]:
    """What the template prints. It records further imports with `use` while it is rendered."""
    imports = Imports()
    readers = routes.Readers(imports)
    types = type_views(edition, imports)
    parameters = {parameter.name: parameter for parameter in edition.parameters}
    class_bodies = ClassBodies(types=types, parameters=parameters, imports=imports)
    classes = MessageViews(edition, class_bodies)
    bodies = [*(v.body for v in classes.layouts), *(m.body for m in classes.messages if m.body)]
    encodes = [*(v.encode for v in classes.layouts if v.encode), *(m.encode for m in classes.messages if m.encode)]
    unpacked = _distinct(case.struct for body in bodies for case in body.reads)
    packed = _distinct(case.struct for encode in encodes for case in encode.cases)
    choices = [choice_view(p) for p in edition.parameters if p.is_choice and not p.is_numeric]
    enums = [view for view in types.values() if view.enum]
    names = (
        *(choice.name for choice in choices),
        *(view.enum for view in enums),
        *(layout.name for layout in classes.layouts),
        *(message.name for message in classes.messages),
    )
    return {
        "header": header(edition),
        "doc": docstrings.of_edition(edition),
        "family": edition.family,
        "edition": edition.name,
        "hash": edition.hash,
        "imports": imports,
        "use": imports.use,
        "public": _public(names),
        "choices": choices,
        "parameters": [parameter_view(parameter, imports) for parameter in edition.parameters],
        "enums": enums,
        "types": list(types.values()),
        "sets": [code.Items(f"{name} = {{", values, "}") for values, name in class_bodies.sets.items()],
        "unpacked": unpacked,
        "packed": packed,
        "unpack": lambda pattern: f"_UNPACK_{unpacked.index(pattern) + 1}",
        "pack": lambda pattern: f"_PACK_{packed.index(pattern) + 1}",
        "call": code.call,
        "layouts": classes.layouts,
        "messages": classes.messages,
        "request_routes": list(routes.route_views(edition, Direction.REQUEST, readers)),
        "reply_routes": list(routes.route_views(edition, Direction.REPLY, readers)),
        "answers": list(routes.answer_views(edition, readers)),
        "nodes_in_data": list(routes.node_readers(edition, readers)),
        "slow_replies": edition.slow_replies,
        "reply_within_ms": None if edition.bus.reply_within_ms is None else float(edition.bus.reply_within_ms),
        "request_classes": routes.decoded_classes(edition, Direction.REQUEST),
        "reply_classes": routes.decoded_classes(edition, Direction.REPLY),
        "readers": readers,
    }


def _distinct(patterns: Iterable[str]) -> list[str]:
    """The patterns of `struct`, each once."""
    return [pattern for pattern in dict.fromkeys(patterns) if pattern]


def _public(names: Iterable[str]) -> list[str]:
    """The names that the module exports."""
    return sorted({*CONSTANTS, *FUNCTIONS, *PUBLIC, *names})
