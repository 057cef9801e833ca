"""`test`."""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from ..conformance.replay import TARGETS, MissingToolError, reasons, replay
from ..conformance.runner import Failure, Report
from ..diagnostics.diagnostic import Diagnostic, Severity
from ..model.formatting import counted
from ..project.loader import Loaded
from .common import FINDINGS, OfSpecs, format_option, load, show_findings, spec_option, stop
from .terminal import print_text


@click.command(cls=OfSpecs)
@spec_option
@click.option(
    "--target",
    "targets",
    multiple=True,
    type=click.Choice(TARGETS),
    help="A target to ask; may be given several times.  [default: those whose tools are installed]",
)
@format_option
def test(specs: Sequence[Path], targets: Sequence[str], printer: str) -> None:
    """Replay the golden frames of the specs through generated code.

    Each one is decoded and encoded by the reference decoder and encoder, by the generated Python package, by cantools
    with the DBC files, and by the C headers. What must be rejected is asked for, too. Golden frames without a source
    are counted, but not asked. The code is generated in a temporary folder.

    C needs a compiler: that in CC, or cc, gcc, clang, tcc or zig.

    \b
      canwright test
      canwright test --spec my.yaml --target python --target c

    Exit status: 0, or 1 if a target fails or an edition has no golden frame to ask, 2 if it could not run. A target
    whose tool is missing is listed; if --target names it, the exit status is 2.
    """
    loaded = load(specs, printer)
    with tempfile.TemporaryDirectory() as folder:
        replays = [_replayed(item, target, Path(folder)) for item in loaded for target in targets or TARGETS]
    missing = [f"{each.target}: {each.missing_tool}" for each in replays if each.missing_tool]
    if targets and missing:
        stop(missing[0])
    findings = [finding for item in loaded for finding in (*item.warnings, *_findings(item, replays))]
    if findings or printer != "text":
        show_findings(findings, printer)
    print_text("".join(f"{line}\n" for line in (*_table(replays), *_left_out(replays))), error=printer != "text")
    if any(finding.severity is Severity.ERROR for finding in findings):
        sys.exit(FINDINGS)


@dataclass(frozen=True)
class _Replay:
    item: Loaded
    target: str
    report: Report
    missing_tool: str = ""

    @property
    def not_asked(self) -> int:
        """The number of entries that the target is not asked."""
        return (len(self.item.golden.golden.entries) if self.item.golden else 0) - self.report.asked


def _replayed(item: Loaded, target: str, folder: Path) -> _Replay:
    edition, frames = item.specification
    report = Report(target, f"{edition.family} {edition.name}")
    try:
        if frames is not None and frames.entries:
            report = replay(target, item.specification, frames, folder)
    except MissingToolError as error:
        return _Replay(item, target, report, str(error))
    return _Replay(item, target, report)


def _findings(item: Loaded, replays: Sequence[_Replay]) -> Iterator[Diagnostic]:
    """The first failure of each golden frame in each target, or that none was asked."""
    reports = [each.report for each in replays if each.item is item]
    if not any(report.asked for report in reports):
        text, hint = "no golden frame was asked, so nothing is tested", "write one, and name its source"
        yield item.document.finding((), "not-tested", text, hint)
    for report in reports:
        first: dict[int, Failure] = {}
        for failure in report.failures:
            first.setdefault(id(failure.entry), failure)
        yield from (_finding(item, failure) for failure in first.values())


def _finding(item: Loaded, failure: Failure) -> Diagnostic:
    text = f"{failure.target}, {failure.kind}: {failure.wrong}"
    hint = "the spec agrees with the golden frame, so this is an error of canwright: report it with both files"
    entries = item.golden.golden.entries if item.golden else {}
    path = next((path for path, entry in entries.items() if entry is failure.entry), ())
    document = item.golden.document if item.golden else item.document
    return document.finding(path, "target-contradiction", text, hint)


def _table(replays: Sequence[_Replay]) -> Iterator[str]:
    width = max(len(each.report.edition) for each in replays)
    yield f"{'edition':<{width}}  target     asked  passed  failed  not asked"
    for each in replays:
        asked, failed = each.report.asked, each.report.failed
        numbers = f"{asked:>5}  {asked - failed:>6}  {failed:>6}  {each.not_asked:>9}  {each.missing_tool}"
        yield f"{each.report.edition:<{width}}  {each.target:<9}  {numbers}".rstrip()


def _left_out(replays: Sequence[_Replay]) -> Iterator[str]:
    """What targets are not asked, and why."""
    unreviewed = {id(each.item): len(each.item.golden.golden.unreviewed) for each in replays if each.item.golden}
    if count := sum(unreviewed.values()):
        yield f"not asked: {counted(count, 'golden frame')} without a source"
    left_out: Counter[tuple[str, str]] = Counter()
    for each in replays:
        left_out.update({(each.target, name): count for name, count in each.report.exceptions.items()})
    for (target, name), count in left_out.items():
        yield f"not asked: {counted(count, 'question')} of {target}: {reasons(target)[name]}"
