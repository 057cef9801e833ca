"""Changes of layouts: which bits carry which field."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..diagnostics.diagnostic import DocumentPath
from ..language.notation import At, frame_bits
from ..model import formatting
from ..model.edition import Edition
from ..model.exhaustive import assert_never
from ..model.layout import (
    ChecksumRole,
    ConstantRole,
    CounterRole,
    Field,
    GivenRole,
    Layout,
    ParameterRole,
    ReservedRole,
    Role,
    Space,
)
from ..model.message import Message
from ..model.types import Encoding, Type
from . import match, quantities
from .change import Category, Change, Impact, Item, Keyword, SentenceArgument
from .collector import Attribute, Subject
from .forms import constants


class Editions(NamedTuple):
    """Both editions, and which types, layouts and commands of the old one have another name in the new one."""

    old: Edition
    new: Edition
    types: dict[str, str]
    layouts: dict[str, str]
    commands: dict[str, str]


def compare(command: Subject, both: Editions, message: Message, another: Message) -> None:
    """All changes of the layout of a message of a command."""
    old, new = message.layout, another.layout
    layout = command
    if _is_shared(both, old, new):
        layout = command.of(Item("layout", old.name), old, new)
        layout.renamed("layout-renamed", old.name, new.name)
        layout.texts(old, new)
        layout.section(old.manual, new.manual)
    matched = match.fields(old, new)
    exchanged = match.exchanged_fields(old, new)
    exchanged_names = {before.name for before, _ in exchanged}
    for before, after in matched.pairs:
        if before.name not in exchanged_names:
            field = layout.of(_owner(before, layout.item), before, after)
            _field(field, both, before, after)
            if (before.manual, after.manual) != (old.manual, new.manual):
                field.section(before.manual, after.manual)
            field.manual_name(before.manual_name, after.manual_name)
    replaced = matched.also(match.overlap)
    for before, after in (*exchanged, *replaced.pairs[len(matched.pairs) :]):
        field = layout.of(_owner(before, layout.item), before, after)
        field.add("field-replaced", place=place_of(before), old=before.name, new=after.name)
    for gone in replaced.removed:
        if gone.name not in constants(another):
            field = layout.of(_owner(gone, layout.item), gone, gone).within(gone.path, _parent(gone, new))
            field.removed("field-removed", gone.deprecated, name=gone.name, place=place_of(gone))
    for fresh in replaced.added:
        if fresh.name not in constants(message):
            field = layout.of(_owner(fresh, layout.item), fresh, fresh).within(_parent(fresh, old), fresh.path)
            field.add("field-added", name=fresh.name, place=place_of(fresh))


def _is_shared(both: Editions, old: Layout, new: Layout) -> bool:
    """Whether both are one layout with a name; the same name, or another one in the new edition."""
    named = old.path[0] == new.path[0] == "layouts"
    return named and both.layouts.get(old.name, old.name) == new.name


def _owner(field: Field, item: Item) -> Item:
    """The entry of a table whose layout has the field, or the command or layout."""
    return Item("entry", f"{field.path[1]}.{field.path[3]}") if field.path[0] == "tables" else item


def _parent(field: Field, layout: Layout) -> DocumentPath:
    """Where a field would be in the other edition; a layout of a table may have fields of a command, and vice versa."""
    if layout.path[0] == field.path[0]:
        return layout.path
    return field.path[:4] if field.path[0] == "tables" else field.path[:-1]


def _array(field: Field) -> str:
    if field.type.joined is not None:
        return Keyword("one alone")
    return formatting.numbers(e.index for e in field.elements if e.index is not None) or Keyword("one alone")


def place_of(field: Field) -> str:
    """The bits of a field, as `DATA[4..5]`."""
    if not field.is_array:
        return formatting.place(field.space, field.elements[0].segments, order=field.type.order)
    return formatting.place(field.space, tuple(s for e in field.elements for s in e.segments))


_OF_FIELD = (
    Attribute[Field]("array-changed", "array", _array),
    Attribute[Field]("field-condition-changed", "only", lambda f: ", ".join(f.only) or Keyword("all")),
    Attribute[Field]("holds-changed", "holds", lambda f: Keyword("the node" if f.is_node else "a value")),
    Attribute[Field]("variable-changed", "variable", lambda f: f.variable or Keyword("none"), impact=Impact.SILENT),
)


def _field(field: Subject, both: Editions, old: Field, new: Field) -> None:
    field.renamed("field-renamed", old.name, new.name)
    if _moved(old, new):
        field.at("at").add("field-moved", name=new.name, old=place_of(old), new=place_of(new))
    field.attributes(_OF_FIELD, old, new, name=new.name)
    if match.fixed(old) != match.fixed(new):
        change = "checksum-changed" if old.checksum or new.checksum else "constant-changed"
        sent = field.within(*((*f.path, f.role.key) for f in (old, new)))
        sent.add(change, name=new.name, old=what_is_sent(old.role), new=what_is_sent(new.role))
    if old.counter != new.counter:
        counter = field.within(*((*f.path, CounterRole.key) for f in (old, new)))
        counter.add("counter-changed", name=new.name, old=_counter(old.counter), new=_counter(new.counter))
    field.deprecation(new.name, old.deprecated, new.deprecated)
    if (old.title, new.title) != (old.type.title, new.type.title):
        field.title(new.name, old.title, new.title)
    field.text("text-changed", "about", new.name, old.about, new.about)
    if match.has_meaning(old) is match.has_meaning(new):
        _type(field, both, old, new)


def _counter(role: CounterRole | None) -> SentenceArgument:
    return (Keyword("a counter"), f" {role.first}..{role.last}") if role else Keyword("a value")


def what_is_sent(role: Role) -> SentenceArgument:
    """What a field contains because of its role."""
    match role:
        case GivenRole():
            return Keyword("any value")
        case ChecksumRole():
            return formatting.checksum(role)
        case ReservedRole():
            return (Keyword("any value"), ", ", Keyword("sent as"), f" {role.raw}")
        case ConstantRole():
            return str(role.raw)
        case ParameterRole():
            return role.parameter
        case _:
            assert_never(role)


def _moved(old: Field, new: Field) -> bool:
    """Whether a field starts elsewhere; one that only grew, or turned its bytes, has not moved."""
    if old.space is not new.space:
        return True
    if [e.segments for e in old.elements] == [e.segments for e in new.elements]:
        return False
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
_JOINED = Attribute[Type]("joined-changed", "raw", lambda t: _joined(t), lambda t: t.joined and t.joined.format)
_PADDING = Attribute[Type]("joined-changed", "padding", lambda t: _joined(t))
_ORDER = Attribute[Type]("byte-order-changed", "byte_order", lambda t: Keyword(t.order.value))


def _joined(type_: Type) -> SentenceArgument:
    return type_.joined.facts if type_.joined else Keyword("separate numbers")


def _type(field: Subject, both: Editions, old: Field, new: Field) -> None:
    old_type, new_type = old.type, new.type
    named = [t.path[0] == "types" for t in (old_type, new_type)]
    same = all(named) and both.types.get(old_type.name, old_type.name) == new_type.name
    if min(old_type.width, new_type.width) > 8 and _follows_edition(both, old_type, new_type):
        edition = field._replace(item=Item("edition", ""), places=((), ()))
        edition.attributes([_ORDER], old_type, new_type, name="byte_order")
    if same:
        type_ = field.of(Item("type", old_type.name), old_type, new_type)
        type_.renamed("type-renamed", old_type.name, new_type.name)
        type_.texts(old_type, new_type)
        type_.text("text-changed", "differs", old_type.name, old_type.differs, new_type.differs)
        _meaning(type_, both, old_type.name, old_type, new_type)
    elif any(named) and old_type.name != new_type.name:
        _other_type(field.within(_path(old), _path(new)), both, old, new)
    else:
        _meaning(field.within(_path(old), _path(new)), both, new.name, old_type, new_type)


def _other_type(field: Subject, both: Editions, old: Field, new: Field) -> None:
    """Adds one change for a field that has another type, with all that differs."""
    inner = field.collector.empty_copy()
    _meaning(field._replace(collector=inner), both, new.name, old.type, new.type)
    changes = list(inner)
    for change in changes:
        if change.rule.category is Category.DOC:
            field.add(change.rule.id, **change.facts)
    strong = [c for c in changes if c.rule.category in (Category.WIRE, Category.VALUE)]
    if strong:
        wire = any(c.rule.category is Category.WIRE for c in strong)
        rule = "field-format-changed" if wire else "field-meaning-changed"
        differences = tuple(
            part for i, c in enumerate(strong) for part in ((", ", _difference(c)) if i else (_difference(c),))
        )
        field.add(rule, name=new.name, old=old.type.name, new=new.type.name, changes=differences)
    elif old.type.path[0] == "types":  # a number without a type had no names
        field.renamed("type-of-field-changed", old.type.name, new.type.name, name=new.name)


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


def _meaning(type_: Subject, both: Editions, name: str, old: Type, new: Type) -> None:
    """Changes of the raw format of a type, and of what its values mean."""
    encoding = _ENCODING if Encoding.FLOAT in (old.encoding, new.encoding) else _SIGN
    type_.attributes((_WIDTH, encoding, _JOINED), old, new, name=name)
    if old.joined and new.joined and old.joined.format == new.joined.format:
        type_.attributes([_PADDING], old, new, name=name)
    if min(old.width, new.width) > 8 and not _follows_edition(both, old, new):
        type_.attributes([_ORDER], old, new, name=name)
    quantities.compare(type_, name, old, new)


def _path(field: Field) -> DocumentPath:
    return (*field.path, "type") if field.type.path[0] == "types" else (*field.path, "raw")


def type_pairs(layouts: Sequence[tuple[Layout, Layout]]) -> list[tuple[Type, Type]]:
    """Types that stand in for one another in matched layouts."""
    return [
        (old_field.type, new_field.type)
        for old, new in layouts
        for old_field, new_field in match.fields(old, new).pairs
    ]
