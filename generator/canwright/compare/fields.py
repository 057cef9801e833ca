"""Changes of layouts: which bits carry which field."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..diagnostics.diagnostic import DocumentPath
from ..language.notation import At, frame_bits
from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Field, Layout, NodeRole, ReservedRole, Space
from ..model.message import KeyRole, Message
from ..model.types import Encoding, Type
from . import match, quantities
from .change import Category, Change, Item, Keyword, SentenceArgument
from .collector import AffectedUsers, Attribute, Collector, Places, at, paths


@dataclass(frozen=True)
class Editions:
    """Both editions, and which types, layouts and commands of the old one have another name in the new one."""

    old: Edition
    new: Edition
    types: dict[str, str]
    layouts: dict[str, str]
    commands: dict[str, str]


def compare(
    collector: Collector, both: Editions, command: str, message: Message, another: Message, use: AffectedUsers
) -> None:
    """All changes of the layout of a message of `command`."""
    old, new = message.layout, another.layout
    if _is_shared(both, old, new):
        item, places = Item("layout", old.name), paths(old, new)
        collector.renamed("layout-renamed", item, places, use, old=old.name, new=new.name)
        collector.texts(item, places, old, new)
        collector.section(item, places, old.manual, new.manual, AffectedUsers((), use.commands))
    else:
        item = Item("command", command)
    matched = match.fields(old, new)
    exchanged = match.exchanged_fields(old, new)
    exchanged_names = {before.name for before, _ in exchanged}
    for before, after in matched.pairs:
        if before.name in exchanged_names:
            continue
        owner = _owner(before, item)
        _field(collector, both, owner, before, after, use)
        if (before.manual, after.manual) != (old.manual, new.manual):
            collector.section(owner, paths(before, after), before.manual, after.manual, AffectedUsers((), use.commands))
    replaced = matched.also(match.overlap)
    for before, after in (*exchanged, *replaced.pairs[len(matched.pairs) :]):
        facts = {"place": place_of(before), "old": before.name, "new": after.name}
        collector.add("field-replaced", _owner(before, item), paths(before, after), use, **facts)
    for gone in replaced.removed:
        if gone.name not in constant_keys(another):
            facts = {"name": gone.name, "place": place_of(gone)}
            place = _parent(gone, new)
            collector.removed("field-removed", _owner(gone, item), (gone.path, place), use, gone.deprecated, **facts)
    for fresh in replaced.added:
        if fresh.name not in constant_keys(message):
            facts = {"name": fresh.name, "place": place_of(fresh)}
            collector.add("field-added", _owner(fresh, item), (_parent(fresh, old), fresh.path), use, **facts)


def _is_shared(both: Editions, old: Layout, new: Layout) -> bool:
    """Whether both are one layout with a name; the same name, or another one in the new edition."""
    named = old.path[0] == new.path[0] == "layouts"
    return named and both.layouts.get(old.name, old.name) == new.name


def constant_keys(message: Message) -> set[str]:
    """The names of constants that are keys of a message, and so no fields of its layout."""
    return {key.name for key in message.keys if key.role is KeyRole.CONSTANT}


def _owner(field: Field, item: Item) -> Item:
    """The entry of a table whose layout has the field, or the command or layout."""
    return Item("entry", f"{field.path[1]}.{field.path[3]}") if field.path[0] == "tables" else item


def _parent(field: Field, layout: Layout) -> DocumentPath:
    """Where a field would be in the other edition; a layout of a table may have fields of a command, and vice versa."""
    if layout.path[0] == field.path[0]:
        return layout.path
    return field.path[:4] if field.path[0] == "tables" else field.path[:-1]


def _array(field: Field) -> str:
    return formatting.numbers(e.index for e in field.elements if e.index is not None) or Keyword("one alone")


def place_of(field: Field) -> str:
    """The bits of a field, as `DATA[4..5]`."""
    return formatting.place(field.space, tuple(s for e in field.elements for s in e.segments))


_OF_FIELD = (
    Attribute[Field]("array-changed", "array", _array),
    Attribute[Field]("field-condition-changed", "only", lambda f: ", ".join(f.only) or Keyword("all")),
    Attribute[Field](
        "holds-changed", "holds", lambda f: Keyword("the node" if isinstance(f.role, NodeRole) else "a value")
    ),
)


def _field(collector: Collector, both: Editions, item: Item, old: Field, new: Field, use: AffectedUsers) -> None:
    places = paths(old, new)
    collector.renamed("field-renamed", item, places, use, old=old.name, new=new.name)
    if _moved(old, new):
        facts = {"name": new.name, "old": place_of(old), "new": place_of(new)}
        collector.add("field-moved", item, at(places, "at"), use, **facts)
    collector.attributes(_OF_FIELD, item, places, old, new, use, name=new.name)
    if (old.role.sent_raw, old.role.required_raw) != (new.role.sent_raw, new.role.required_raw):
        before, after = ((*f.path, "reserved" if isinstance(f.role, ReservedRole) else "constant") for f in (old, new))
        shown = {"old": _constant(old), "new": _constant(new)}
        collector.add("constant-changed", item, (before, after), use, name=new.name, **shown)
    collector.deprecation(item, places, new.name, old.deprecated, new.deprecated)
    if (old.title, new.title) != (old.type.title, new.type.title):
        collector.title(item, at(places, "title"), new.name, old.title, new.title)
    collector.text("text-changed", item, at(places, "about"), new.name, old.about, new.about)
    if isinstance(old.role, ReservedRole) is isinstance(new.role, ReservedRole):  # reserved bits have no meaning
        _type(collector, both, item, old, new, use)


def _constant(field: Field) -> SentenceArgument:
    if field.role.is_value:
        return Keyword("any value")
    if isinstance(field.role, ReservedRole):
        return (Keyword("any value"), ", ", Keyword("sent as"), f" {field.role.sent_raw}")
    return str(field.role.sent_raw)


def _moved(old: Field, new: Field) -> bool:
    """Whether a field starts elsewhere; one that only grew, or turned its bytes, has not moved."""
    if old.space is not new.space:
        return True
    before, after = ((f.type.width, f.type.order, len(f.elements)) for f in (old, new))
    if before == after:
        return [e.segments for e in old.elements] != [e.segments for e in new.elements]
    return _starts(old).isdisjoint(_starts(new))


def _starts(field: Field) -> set[At]:
    """What the spec can say of the position of a field."""
    bits = sorted(bit for element in field.elements for bit in element.bits)
    bytes_ = (0,) if field.space is Space.ID else (bits[0] // 8, bits[-1] // 8)
    in_byte = (bits[0],) if field.space is Space.ID else (None, *(bit % 8 for bit in bits))
    starts = {At(field.space, byte, bit) for byte in bytes_ for bit in in_byte}
    return {start for start in starts if sorted(frame_bits(start, len(bits), field.type.order)) == bits}


_WIDTH = Attribute[Type]("width-changed", "raw", lambda t: str(t.width))
_SIGN = Attribute[Type]("sign-changed", "raw", lambda t: Keyword(t.encoding.value))
_ENCODING = Attribute[Type]("encoding-changed", "raw", lambda t: Keyword(t.encoding.value))
_ORDER = Attribute[Type]("byte-order-changed", "byte_order", lambda t: Keyword(t.order.value))


def _type(collector: Collector, both: Editions, item: Item, old: Field, new: Field, use: AffectedUsers) -> None:
    old_type, new_type = old.type, new.type
    named = [t.path[0] == "types" for t in (old_type, new_type)]
    same = all(named) and both.types.get(old_type.name, old_type.name) == new_type.name
    owner, name = (Item("type", old_type.name), old_type.name) if same else (item, new.name)
    places = paths(old_type, new_type) if same else (_path(old), _path(new))
    if min(old_type.width, new_type.width) > 8 and _follows_edition(both, old_type, new_type):
        edition: tuple[Item, Places] = Item("edition", ""), ((), ())
        collector.attributes([_ORDER], *edition, old_type, new_type, use, name="byte_order")
    if not same and any(named) and old_type.name != new_type.name:
        _other_type(collector, both, item, old, new, use)
        return
    if same:
        collector.renamed("type-renamed", owner, places, use, old=old_type.name, new=new_type.name)
        collector.texts(owner, places, old_type, new_type)
        collector.text("text-changed", owner, at(places, "differs"), name, old_type.differs, new_type.differs)
    _meaning(collector, both, owner, name, places, old_type, new_type, use)


def _other_type(collector: Collector, both: Editions, item: Item, old: Field, new: Field, use: AffectedUsers) -> None:
    """Adds one change for a field that has another type, with all that differs."""
    places = _path(old), _path(new)
    inner = collector.empty_copy()
    _meaning(inner, both, item, new.name, places, old.type, new.type, use)
    changes = list(inner)
    facts: dict[str, SentenceArgument] = {"name": new.name, "old": old.type.name, "new": new.type.name}
    for change in changes:
        if change.rule.category is Category.DOC:
            collector.add(change.rule.id, item, places, use, **change.facts)
    strong = [c for c in changes if c.rule.category in (Category.WIRE, Category.VALUE)]
    if strong:
        wire = any(c.rule.category is Category.WIRE for c in strong)
        rule = "field-format-changed" if wire else "field-meaning-changed"
        facts["changes"] = tuple(
            part for i, c in enumerate(strong) for part in ((", ", _difference(c)) if i else (_difference(c),))
        )
        collector.add(rule, item, places, use, **facts)
    elif old.type.path[0] == "types":  # a number without a type had no names
        collector.renamed("type-of-field-changed", item, places, use, **facts)


def _follows_edition(both: Editions, old: Type, new: Type) -> bool:
    """Whether two types have the byte orders of their editions."""
    return (old.order, new.order) == (both.old.order, both.new.order)


_WHAT = {"range-changed": "raw range", "scale-changed": "resolution"}
"""What a change is about, where its rule has another word."""


def _difference(change: Change) -> SentenceArgument:
    """What differs, such as `scale 0.1 V (was 1 V)`."""
    what = Keyword(_WHAT.get(change.rule.id) or change.rule.id.rpartition("-")[0].replace("-", " "))
    if not {"old", "new"} <= change.facts.keys() or change.rule.id.startswith("member"):
        return Keyword("members")
    when = change.facts.get("when", "")
    return (what, when, " ", change.facts["new"], " (", Keyword("was"), " ", change.facts["old"], ")")


def _meaning(
    collector: Collector,
    both: Editions,
    owner: Item,
    name: str,
    places: Places,
    old: Type,
    new: Type,
    use: AffectedUsers,
) -> None:
    """Changes of the raw format of a type, and of what its values mean."""
    encoding = _ENCODING if Encoding.FLOAT in (old.encoding, new.encoding) else _SIGN
    collector.attributes((_WIDTH, encoding), owner, places, old, new, use, name=name)
    if min(old.width, new.width) > 8 and not _follows_edition(both, old, new):
        collector.attributes([_ORDER], owner, places, old, new, use, name=name)
    quantities.compare(collector, quantities.Pair(old, new, owner, name, places, use))


def _path(field: Field) -> DocumentPath:
    return (*field.path, "type") if field.type.path[0] == "types" else (*field.path, "raw")


def type_pairs(layouts: Sequence[tuple[Layout, Layout]]) -> list[tuple[Type, Type]]:
    """Types that stand in for one another in matched layouts."""
    return [
        (old_field.type, new_field.type)
        for old, new in layouts
        for old_field, new_field in match.fields(old, new).pairs
    ]
