"""An edition as the devices of one bus have it: with known parameters in ids and constants in place of their names.

For what describes or reads one bus: its ids are then fixed. Parameters that only fields depend on are not replaced.
"""

from __future__ import annotations

import dataclasses
import functools
from fractions import Fraction

from ..model.edition import Edition
from ..model.layout import ConstantRole, Field, Layout, ParameterRole, Variant
from ..model.message import Command, IdRule, Message
from ..model.types import Assignment, number_of
from .frame import parameter_raw


def configured(edition: Edition, assignment: Assignment) -> Edition:
    """The edition under the known parameters of ids and constants; the edition itself if there are none."""
    numbers = ((p.name, number_of(assignment, p.name)) for p in edition.parameters if p.whole)
    known = tuple((name, number) for name, number in numbers if number is not None)
    return _configured(edition, known) if known else edition


@functools.lru_cache(maxsize=64)
def _configured(edition: Edition, known: tuple[tuple[str, Fraction], ...]) -> Edition:
    assignment = dict(known)

    def rule(of: IdRule) -> IdRule:
        return of.at(assignment) or of

    @functools.cache
    def field(of: Field) -> Field:
        raw = parameter_raw(of.role.parameter, assignment) if isinstance(of.role, ParameterRole) else None
        return of if raw is None else dataclasses.replace(of, role=ConstantRole(raw))

    @functools.cache
    def layout(of: Layout) -> Layout:
        fields = tuple(map(field, of.fields))
        variants = tuple(Variant(values=v.values, fields=tuple(map(field, v.fields))) for v in of.variants)
        return of if fields == of.fields else dataclasses.replace(of, fields=fields, variants=variants)

    @functools.cache
    def message(of: Message) -> Message:
        id_, fields = rule(of.id), layout(of.layout)
        return of if (id_, fields) == (of.id, of.layout) else dataclasses.replace(of, id=id_, layout=fields)

    def command(of: Command) -> Command:
        replies = tuple(dataclasses.replace(reply, message=message(reply.message)) for reply in of.replies)
        return dataclasses.replace(of, request=of.request and message(of.request), replies=replies)

    return dataclasses.replace(
        edition,
        addresses=tuple(
            dataclasses.replace(a, request=rule(a.request), reply=rule(a.reply)) for a in edition.addresses
        ),
        layouts=tuple(map(layout, edition.layouts)),
        commands=tuple(map(command, edition.commands)),
    )
