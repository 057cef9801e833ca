"""What a name becomes in the bindings."""

from __future__ import annotations

from ..targets.c import names as c
from ..targets.python import text as python


def command(old: str, new: str) -> str:
    """The class of the request, for both names."""
    return _told(
        f"{old}_request_t", f"{new}_request_t", python.class_name(f"{old}_request"), python.class_name(f"{new}_request")
    )


def layout(old: str, new: str) -> str:
    """The struct and the class, for both names."""
    return _told(f"{old}_t", f"{new}_t", python.class_name(old), python.class_name(new))


def type_(old: str, new: str) -> str:
    """The conversion functions, for both names."""
    return f"C `…_{old}_to_milli` → `…_{new}_to_milli`"


def parameter(old: str, new: str) -> str:
    """Members and attributes, for both names."""
    return f"C `.{old}` → `.{new}`, Python `{python.attribute(old)}` → `{python.attribute(new)}`"


def listed_name(old: str, new: str) -> str:
    """Strings that messages carry, for both names."""
    return f'Python `"{old}"` → `"{new}"`'


def host(old: str, new: str) -> str:
    """The node of the host, for both names."""
    return f"DBC `{old}` → `{new}`"


def field(old: str, new: str) -> str:
    """Members, attributes and signals, for both names."""
    return f"{_told(c.member(old), c.member(new), python.attribute(old), python.attribute(new))}, DBC `…_{old}` → `…_{new}`"


def member(owner: str, old: str, new: str) -> str:
    """Constants, for both names of a member of `owner`."""
    macro, other = f"…_{owner}_{old}".upper(), f"…_{owner}_{new}".upper()
    return _told(macro, other, python.member_name(old), python.member_name(new))


def _told(c_old: str, c_new: str, python_old: str, python_new: str) -> str:
    return f"C `{c_old}` → `{c_new}`, Python `{python_old}` → `{python_new}`"
