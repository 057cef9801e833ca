"""The module of an edition."""

from __future__ import annotations

from collections.abc import Callable

from ...model.edition import Edition
from ...model.message import Direction
from ...semantics.dispatch import dispatch_plan
from ...semantics.exchange import exchange_plans
from ...semantics.plan import only_by_request
from ...templating.environment import environment
from ..tables import id_rule
from . import functions, text
from .tables import tables_of

HELPERS = (
    "Definition, EXACT, Edition, MessageResult, checkChecksum, checkConstant, checksum, layoutsOf, required, typesOf, "
    "unknownCode, unusedBits, wrongLength, wrongMessage"
)
"""What the functions of an edition use of the runtime."""


def _functions(edition: Edition) -> str:
    """The statements that declare the constant `edition`, which has all functions."""
    tables, within = tables_of(edition), edition.bus.reply_within_ms
    filters: dict[str, Callable[..., object]] = {
        "quoted": text.quoted,
        "printed": text.printed,
        "constant": functions.constant,
        "keys": functions.keys,
        "read_in": functions.read_in,
        "route_statements": functions.route,
        "rule_table": lambda route: id_rule(route.rule, route.remote, route.mask),
    }
    requests, replies = (dispatch_plan(edition, direction).routes for direction in Direction)
    return (
        environment("javascript", filters)
        .get_template("functions.js.j2")
        .render(
            edition=edition,
            tables=tables,
            printer=functions.Functions(tables),
            explained=only_by_request(edition),
            reply_within=text.NULL if within is None else text.double(within),
            answers=[plan for plans in exchange_plans(edition).values() for plan in plans],
            directions=[("requests", Direction.REQUEST, requests), ("replies", Direction.REPLY, replies)],
        )
    )


def module(edition: Edition, header: str) -> str:
    """The module of an edition."""
    has_sequence = any(message.sequence for message in edition.all_messages())
    template = environment("javascript", {}).get_template("edition.js.j2")
    return template.render(
        header=header, helpers=HELPERS, functions=_functions(edition), joins=["join"] if has_sequence else []
    )
