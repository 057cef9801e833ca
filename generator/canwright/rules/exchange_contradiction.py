"""What golden frames say of requests and answers, the spec says as well."""

from __future__ import annotations

from collections.abc import Iterator

from ..diagnostics.diagnostic import DocumentPath
from ..language.golden_frames import CheckedFrame, Exchange
from ..model.refusal import Refusal
from ..semantics.decoder import Decoder, Rejection
from ..semantics.exchange import check_reply
from ..semantics.frame import CanFrame
from .golden_entries import Problem, judged, named
from .rule import Found, Subject


def check(subject: Subject) -> Found:
    if subject.frames is not None and subject.frames.exchanges:
        decoder = Decoder(subject.edition)
        yield from judged(
            subject.edition, "exchanges", subject.frames.exchanges, lambda entry: _exchange(decoder, entry)
        )


def _exchange(decoder: Decoder, entry: Exchange) -> Iterator[Problem]:
    found = check_reply(decoder, _frame(entry.request), _frame(entry.reply))
    says = found.reason if isinstance(found, Rejection) else None
    if says is entry.says:
        return
    at: DocumentPath = ("says",) if entry.says else ("reply",)
    if isinstance(found, Rejection):
        no = "this is no answer" if found.reason is Refusal.NOT_ANSWER else "the request cannot be read"
        hint = f"says: {found.reason.value}" + ("" if entry.says else ", if that is right; otherwise check the spec")
        yield at, f"by the spec {no}: {found.text}", hint
    else:
        text = f"by the spec this is the answer, {named(found.message, found.node)}"
        yield at, text, "leave `says` out, if that is right; otherwise check the spec"


def _frame(frame: CheckedFrame) -> CanFrame:
    return CanFrame(frame.id, frame.data, frame.extended, frame.remote)
