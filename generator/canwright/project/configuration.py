"""`canwright.toml`: how severe findings and changes are, which are ignored, and what makes `diff` fail."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated

from ..compare import CHANGES, Category, Change, Impact
from ..diagnostics.diagnostic import Diagnostic, Severity, nearest
from ..language.concept import Concept, Doc, Limits, Notation
from ..language.decoder import decode
from ..rules import ALL_RULES

NAME = "canwright.toml"

BREAKING, NEVER = "breaking", "none"

KINDS = (BREAKING, *(c.value for c in Category), Impact.SILENT.value, Impact.LOUD.value, NEVER)
"""What makes `diff` fail: `breaking` changes are the silent and loud ones of wire and value, except removals that were announced."""

WARNINGS = {rule.id: rule for rule in ALL_RULES.values() if rule.severity is Severity.WARNING}


class RuleSeverity(str, Enum):
    """How severe the findings of a rule are."""

    ERROR = "error"
    WARNING = "warning"
    IGNORE = "ignore"


def _change_rule(text: str) -> str:
    if text not in CHANGES:
        raise ValueError(_unknown(text, CHANGES, "canwright diff"))
    return text


def _warning_rule(text: str) -> str:
    if text not in WARNINGS:
        fixed = text in ALL_RULES
        raise ValueError(f"`{text}` is always an error" if fixed else _unknown(text, WARNINGS, "canwright check"))
    return text


def kind_of_change(text: str) -> str:
    """A kind of change that makes `diff` fail. Raises ValueError for another text."""
    if text not in KINDS:
        raise ValueError(f"`{text}` is not a kind of change; use one of: {', '.join(KINDS)}")
    return text


def _unknown(text: str, known: Mapping[str, object], command: str) -> str:
    return f"`{command}` has no such rule as `{text}`; {nearest(text, known) or '`canwright explain` lists the rules'}"


_RULE = {"type": "string"}
ChangeRuleId = Annotated[str, Notation(_change_rule, "a rule of `canwright diff`", _RULE)]
WarningRuleId = Annotated[str, Notation(_warning_rule, "a rule of `canwright check`", _RULE)]
Kind = Annotated[str, Notation(kind_of_change, "a kind of change", _RULE)]
Pattern = Annotated[str, Limits(min_length=1)]


@dataclass(frozen=True, eq=False, kw_only=True)
class CheckConfiguration(Concept):
    """The warnings of `check` and `generate`."""

    severity: Annotated[
        dict[WarningRuleId, RuleSeverity], Doc("`error`, `warning` or `ignore`, for each rule with warnings.")
    ] = field(default_factory=dict)
    ignore: Annotated[
        dict[WarningRuleId, list[Pattern]], Doc("Files without the warnings of a rule, such as `spec/old/*`.")
    ] = field(default_factory=dict)

    def applied(self, findings: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
        """The findings with the severity that the project gives them, without those that it ignores."""
        return tuple(self._applied(findings))

    def _applied(self, findings: Sequence[Diagnostic]) -> Iterator[Diagnostic]:
        for finding in findings:
            severity = self.severity.get(finding.rule)
            ignored = any(fnmatchcase(finding.position.file, pattern) for pattern in self.ignore.get(finding.rule, ()))
            if severity is RuleSeverity.ERROR and not ignored:
                yield dataclasses.replace(finding, severity=Severity.ERROR)
            elif severity is not RuleSeverity.IGNORE and not ignored:
                yield finding


@dataclass(frozen=True, eq=False, kw_only=True)
class DiffConfiguration(Concept):
    """The changes that `diff` shows, and those that make it fail."""

    fail_on: Annotated[list[Kind], Doc("The default of `--fail-on`.", examples=(["wire", "silent"],))] = field(
        default_factory=lambda: [BREAKING]
    )
    baseline: Annotated[str | None, Limits(min_length=1), Doc("The default of `--baseline`, from this folder.")] = None
    severity: Annotated[
        dict[ChangeRuleId, RuleSeverity],
        Doc("`error` for a change that always fails, `warning` for one that never does, `ignore` to omit it."),
    ] = field(default_factory=dict)
    ignore: Annotated[
        dict[ChangeRuleId, list[Pattern]],
        Doc("Items without the changes of a rule, such as `type level` or `command read_*`."),
    ] = field(default_factory=dict)

    def ignores(self, change: Change) -> bool:
        """Whether a change is not shown."""
        rule = change.rule.id
        return self.severity.get(rule) is RuleSeverity.IGNORE or any(
            fnmatchcase(str(change.item), pattern) for pattern in self.ignore.get(rule, ())
        )

    def fails(self, change: Change, kinds: Collection[str]) -> bool:
        """Whether a change makes `diff` fail on these kinds."""
        severity = self.severity.get(change.rule.id)
        if severity is not None or NEVER in kinds:
            return severity is RuleSeverity.ERROR and NEVER not in kinds
        category, impact = change.rule.category, change.impact
        breaks = category in (Category.WIRE, Category.VALUE) and impact in (Impact.SILENT, Impact.LOUD)
        breaking = (BREAKING,) if breaks and not change.announced else ()
        return bool({category.value, impact.value, *breaking} & set(kinds))


@dataclass(frozen=True, eq=False, kw_only=True)
class Configuration(Concept):
    """The configuration of a project."""

    check: Annotated[CheckConfiguration, Doc("Warnings of `check` and `generate`.")] = field(
        default_factory=CheckConfiguration
    )
    diff: Annotated[DiffConfiguration, Doc("Changes in `diff`.")] = field(default_factory=DiffConfiguration)


def candidates() -> list[Path]:
    """Where the configuration can be: in the current folder, and above it up to the top of its git repository."""
    folders = [Path.cwd(), *Path.cwd().parents]
    top = next((i for i, folder in enumerate(folders) if (folder / ".git").exists()), 0)
    return [Path(*[".."] * level) / NAME for level in range(top + 1)]


def configuration_file() -> Path | None:
    """The nearest configuration; None without one."""
    return next((file for file in candidates() if file.is_file()), None)


def read_configuration(file: Path) -> Configuration:
    """The configuration in a file. Raises SpecError with all findings, and OSError."""
    from ..document.toml import read_toml  # most folders have no configuration

    return decode(read_toml(file), Configuration).value
