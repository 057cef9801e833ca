"""Options that a target declares: the command line lists, checks and passes them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from ..model.edition import Edition

Value = TypeVar("Value")


class OptionError(ValueError):
    """An option that no selected target has, or a value that it cannot have; the message starts with the option."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TargetOption(Generic[Value]):
    """An option of a target: `--name` on the command line."""

    name: str
    metavar: str
    """What stands for the value in `--help`, such as `NODES`."""
    help: str
    default: Value
    parse: Callable[[str, Sequence[Edition]], Value]
    """The value that a text means for the editions of a run. Raises ValueError with the rest of a message `--name TEXT: `."""


class Options:
    """The values of the options of a target; an option that is not given has its default."""

    def __init__(self, values: Mapping[TargetOption[Any], Any] = MappingProxyType({})) -> None:
        self._values = values

    def __getitem__(self, option: TargetOption[Value]) -> Value:
        value: Value = self._values.get(option, option.default)
        return value


NO_OPTIONS = Options()
"""Every option has its default."""
