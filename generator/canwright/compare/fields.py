"""Changes of layouts: which bits hold which field."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Field, Layout, NodeRole, ReservedRole
from ..model.types import Encoding, Type
from . import match, quantities
from .change import Fact, Impact, Item, Said, Side
from .collector import Found, Use, listed


@dataclass(frozen=True)
class Editions:
    """Both editions, and which types and layouts of the old one have another name in the new one."""

    old: Edition
    new: Edition
    types: dict[str, str]
    layouts: dict[str, str]


def compare(found: Found, both: Editions, command: str, old: Layout, new: Layout, use: Use) -> None:
    """All changes of one layout, as it is used by a message of `command`."""
    item = _item(command, old, new)
    if item.kind == "layout" and both.layouts.get(old.name) == new.name:
        found.renamed("layout-renamed", item, old.path, new.path, use, old=old.name, new=new.name)
    if item.kind == "layout":
        found.texts(item, (old.path, new.path), old, new)
        found.section(item, (old.path, new.path), old.manual, new.manual, Use((), use.commands))
    matched = match.fields(old, new)
    for one, other in matched.pairs:
        _field(found, both, item, one, other, use)
        if (one.manual, other.manual) != (old.manual, new.manual):
            found.section(item, (one.path, other.path), one.manual, other.manual, Use((), use.commands))
    removed, added = list(matched.removed), list(matched.added)
    for gone in matched.removed:
        fresh = next((f for f in added if match.overlap(gone, f)), None)
        if fresh is not None:
            removed.remove(gone)
            added.remove(fresh)
            facts = {"place": places([gone]), "old": gone.name, "new": fresh.name}
            found.add("field-replaced", item, gone.path, fresh.path, Impact.SILENT, use, **facts)
    for gone in removed:
        facts = {"name": gone.name, "place": places([gone])}
        found.add("field-removed", item, gone.path, new.path, Impact.SILENT, use, **facts)
    for fresh in added:
        taken = any(match.overlap(fresh, f) for f in old.fields)
        impact = Impact.SILENT if taken or Side.SENDING in use.sides else Impact.SAFE
        impact = Impact.LOUD if fresh.demanded else impact
        facts = {"name": fresh.name, "place": places([fresh])}
        found.add("field-added", item, old.path, fresh.path, impact, use, **facts)


def _item(command: str, old: Layout, new: Layout) -> Item:
    if old.path[0] == "tables":
        return Item("entry", f"{old.path[1]}.{old.path[3]}")
    return Item("layout", old.name) if old.shared and new.shared else Item("command", command)


def _field(found: Found, both: Editions, item: Item, old: Field, new: Field, use: Use) -> None:
    where = old.path, new.path
    if old.name != new.name:
        found.renamed("field-renamed", item, *where, use, old=old.name, new=new.name)

    def add(rule: str, impact: Impact, key: str, one: str, other: str) -> None:
        paths = (*old.path, key), (*new.path, key)
        found.add(rule, item, *paths, impact, use, name=new.name, old=one, new=other)

    if _moved(old, new):
        add("field-moved", Impact.SILENT, "at", places([old]), places([new]))
    before, after = ([e.index for e in f.elements] for f in (old, new))
    if (old.is_array, before) != (new.is_array, after):
        add("array-changed", Impact.SILENT, "array", *(_array(f) for f in (old, new)))
    if old.only != new.only:
        add("field-condition-changed", Impact.SILENT, "only", old_only(old), old_only(new))
    if (old.fixed, old.demanded) != (new.fixed, new.demanded):
        _constant(found, item, old, new, use)
    if isinstance(old.role, NodeRole) != isinstance(new.role, NodeRole):
        add(
            "holds-changed",
            Impact.LOUD,
            "holds",
            *(Said("the node" if isinstance(f.role, NodeRole) else "a value") for f in (old, new)),
        )
    if (old.title, new.title) != (old.type.title, new.type.title):
        found.title(item, _at(old, new, "title"), (old.name, new.name), old.title, new.title)
    found.text("text-changed", item, _at(old, new, "about"), new.name, old.about, new.about)
    _type(found, both, item, old, new, use)


def _constant(found: Found, item: Item, old: Field, new: Field, use: Use) -> None:
    ignored = old.demanded is None and new.demanded is None and Side.SENDING not in use.sides
    before, after = ((*f.path, "reserved" if isinstance(f.role, ReservedRole) else "constant") for f in (old, new))
    impact = Impact.SAFE if ignored else Impact.LOUD
    found.add("constant-changed", item, before, after, impact, use, name=new.name, old=_held(old), new=_held(new))


def _held(field: Field) -> Fact:
    if field.fixed is None:
        return Said("any value")
    if isinstance(field.role, ReservedRole):
        return (Said("any value"), ", ", Said("sent as"), f" {field.fixed}")
    return str(field.fixed)


def old_only(field: Field) -> str:
    return ", ".join(field.only) or Said("all")


def _array(field: Field) -> str:
    return listed(e.index for e in field.elements) if field.is_array else Said("one alone")


def places(fields: Sequence[Field]) -> str:
    """Where fields stand, as `DATA[4..5]`."""
    return ", ".join(formatting.place(f.space, tuple(s for e in f.elements for s in e.segments)) for f in fields)


def _moved(old: Field, new: Field) -> bool:
    """Whether a field starts elsewhere; one that only grew, or turned its bytes, has not moved."""
    if old.space is not new.space:
        return True
    same_shape = (old.type.width, old.type.order, len(old.elements)) == (
        *(new.type.width, new.type.order),
        len(new.elements),
    )
    if same_shape:
        return [e.segments for e in old.elements] != [e.segments for e in new.elements]
    return min(old.elements[0].bits) != min(new.elements[0].bits)


def _type(found: Found, both: Editions, item: Item, old: Field, new: Field, use: Use) -> None:
    one, other = old.type, new.type
    named = one.path[0] == other.path[0] == "types"
    same = named and both.types.get(one.name, one.name) == other.name
    owner, name = (Item("type", one.name), one.name) if same else (item, new.name)
    paths = (one.path, other.path) if same else (_path(old), _path(new))
    pair = quantities.Pair(one, other, owner, name, *paths, use)
    if same and one.name != other.name:
        found.renamed("type-renamed", owner, *paths, use, old=one.name, new=other.name)
    elif not same and one.name != other.name:
        found.renamed("type-of-field-changed", item, *paths, use, name=new.name, old=one.name, new=other.name)
    if one.width != other.width:
        pair.add(found, "width-changed", Impact.SILENT, "raw", old=str(one.width), new=str(other.width))
    floats = [t.encoding is Encoding.FLOAT for t in (one, other)]
    if one.encoding is not other.encoding:
        rule = "encoding-changed" if any(floats) else "sign-changed"
        pair.add(found, rule, Impact.SILENT, "raw", old=Said(one.encoding.value), new=Said(other.encoding.value))
    _order(found, both, pair)
    if same:
        found.texts(owner, paths, one, other)
        found.text("text-changed", owner, _at(one, other, "differs"), name, one.differs, other.differs)
    quantities.compare(found, pair)


def _order(found: Found, both: Editions, pair: quantities.Pair) -> None:
    old, new = pair.old, pair.new
    if old.order is new.order or min(old.width, new.width) <= 8:
        return
    facts = {"old": Said(old.order.value), "new": Said(new.order.value)}
    everywhere = (old.order, new.order) == (both.old.order, both.new.order)
    if everywhere:
        place = ("byte_order",)
        item = Item("edition", "")
        found.add("byte-order-changed", item, place, place, Impact.SILENT, pair.use, name="byte_order", **facts)
    else:
        pair.add(found, "byte-order-changed", Impact.SILENT, "byte_order", **facts)


def _at(old: Layout | Field | Type, new: Layout | Field | Type, key: str) -> tuple[DocumentPath, DocumentPath]:
    return (*old.path, key), (*new.path, key)


def _path(field: Field) -> DocumentPath:
    return (*field.path, "type") if field.type.path[0] == "types" else (*field.path, "raw")


def type_pairs(layouts: Sequence[tuple[Layout, Layout]]) -> list[tuple[Type, Type]]:
    """Types that stand in for one another in matched layouts."""
    return [(one.type, other.type) for old, new in layouts for one, other in match.fields(old, new).pairs]
