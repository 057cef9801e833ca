"""The exchanges in golden frames are accepted or rejected as listed."""

from __future__ import annotations

from collections.abc import Iterator

from ..diagnostics.diagnostic import DocumentPath
from ..model.golden_frames import Exchange
from ..model.refusal import Refusal
from ..semantics.decoder import Decoder, Rejection
from ..semantics.exchange import check_reply
from ..semantics.frame import can_frame
from .golden_entries import EntryProblem, entry_findings, named
from .rule import CheckInput, Findings


def check(subject: CheckInput) -> Findings:
    if subject.frames is not None and subject.frames.exchanges:
        decoder = Decoder(subject.edition)
        yield from entry_findings(
            subject.edition, "exchanges", subject.frames.exchanges, lambda entry: _exchange(decoder, entry)
        )


def _exchange(decoder: Decoder, entry: Exchange) -> Iterator[EntryProblem]:
    answer = check_reply(decoder, can_frame(entry.request), can_frame(entry.reply), entry.parameters)
    says = answer.reason if isinstance(answer, Rejection) else None
    if says is entry.says:
        return
    at: DocumentPath = ("says",) if entry.says else ("reply",)
    if isinstance(answer, Rejection):
        what = "this is not the reply" if answer.reason is Refusal.NOT_ANSWER else "the request is rejected"
        hint = f"write `says: {answer.reason.value}`, or check the spec"
        yield at, f"according to the spec, {what}: {answer.text}", hint
    else:
        text = f"according to the spec, this is the reply: {named(answer.message, answer.node)}"
        yield at, text, "remove `says`, or check the spec"
