"""The module of an edition, as its template needs it."""

from __future__ import annotations

from collections.abc import Iterable

from ...model.edition import Edition
from ...model.message import Direction
from ..base import header
from . import client_facts, code, docstrings, routes, text
from .checksums import Checksums
from .class_bodies import ClassBodies
from .imports import PUBLIC, Imports
from .messages import MessageViews
from .runtime._codec import Message
from .types import ParameterView, type_views

SHARED = (
    "_codec.py",
    "_dispatch.py",
    "client.py",
    "client_asyncio.py",
    "exchange.py",
    "nodes.py",
    "python_can.py",
    "simulation.py",
)
"""The modules of the runtime that are copied into the package of each family."""

CONSTANTS = (
    *("EDITION", "FAMILY", "REPLY_WITHIN_MS", "SPEC_HASH", "UNKNOWN"),
    *("AnyReply", "AnyRequest", "Parameters"),
)
FUNCTIONS = (
    *("check_reply", "client_facts", "decode_answer", "decode_reply", "decode_request"),
    *("has_node_in_data", "ids_of", "node_bits_of", "node_of", "replies_to", "share_a_reply"),
)


def module_view(edition: Edition) -> dict[str, object]:
    """What the template prints. It records further imports with `use` while it is rendered."""
    imports = Imports()
    readers = routes.Readers(imports)
    types = type_views(edition, imports)
    parameters = {parameter.name: parameter for parameter in edition.parameters}
    checksums = Checksums(imports)
    class_bodies = ClassBodies(types=types, parameters=parameters, imports=imports, checksums=checksums)
    classes = MessageViews(edition, class_bodies)
    choices = [parameter for parameter in edition.parameters if parameter.is_choice and not parameter.is_numeric]
    enums = [type_ for type_ in edition.types if not type_.is_number]
    names = (
        *(text.class_name(name) for name in (*(c.name for c in choices), *(e.name for e in enums))),
        *(layout.name for layout in classes.layouts),
        *(message.name for message in classes.messages),
    )
    helpers = [imports.use("join")] if any(m.sequence for m in edition.all_messages()) else []
    return {
        "header": header(edition),
        "doc": docstrings.of_edition(edition),
        "family": edition.family,
        "edition": edition.name,
        "hash": edition.hash,
        "imports": imports,
        "use": imports.use,
        "public": _public((*names, *helpers)),
        "choices": choices,
        "parameters": [ParameterView(parameter, imports) for parameter in edition.parameters],
        "enums": enums,
        "types": list(types.values()),
        "sets": [code.Items(f"{name} = {{", values, "}") for values, name in class_bodies.sets.items()],
        "unpacked": class_bodies.unpacked,
        "packed": class_bodies.packed,
        "checksums": checksums.functions,
        "layouts": classes.layouts,
        "messages": classes.messages,
        "default_length": Message.DLC,
        "frame_format": edition.bus.frame_format,
        "request_routes": list(routes.route_views(edition, Direction.REQUEST, readers)),
        "reply_routes": list(routes.route_views(edition, Direction.REPLY, readers)),
        "answers": list(routes.answer_views(edition, readers)),
        "nodes_in_data": list(routes.node_readers(edition, readers)),
        "client_facts": client_facts.ClientFactsView(edition),
        "slow_replies": edition.slow_replies,
        "reply_within_ms": None if edition.bus.reply_within_ms is None else float(edition.bus.reply_within_ms),
        "request_classes": routes.decoded_classes(edition, Direction.REQUEST),
        "reply_classes": routes.decoded_classes(edition, Direction.REPLY),
        "readers": readers,
    }


def _public(names: Iterable[str]) -> list[str]:
    """The names that the module exports."""
    return sorted({*CONSTANTS, *FUNCTIONS, *PUBLIC, *names})
