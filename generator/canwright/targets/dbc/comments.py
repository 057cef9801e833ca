"""The language of comments: English in ASCII, which every reader accepts, or another language of the specs in UTF-8."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ...model.deprecation import Deprecation
from ...model.types import Text
from ...templating.data_files import template_texts
from .text import any_text, in_ascii

ENGLISH = "en"
_FILE = "dbc/comments.yaml"


class Comments:
    """Texts of the spec and fixed texts in one language, as sentences of comments."""

    def __init__(self, language: str) -> None:
        self.language = language
        self.texts: Mapping[str, str] = template_texts(_FILE)[language]
        """The fixed texts with their placeholders."""

    def of(self, texts: Text) -> str:
        """A text of the spec: in the language, else in English or the first language."""
        return in_ascii(texts) if self.language == ENGLISH else any_text(texts.get(self.language) or in_ascii(texts))

    def fixed(self, name: str, **values: object) -> str:
        """A fixed text with its values."""
        return self.texts[name].format(**values)

    def deprecation(self, deprecated: Deprecation | None, name: str = "") -> str:
        """The sentence about a deprecated item, with its name if it is not the first thing in the comment."""
        if deprecated is None:
            return ""
        key = "deprecated_until" if deprecated.until else "deprecated"
        sentence = self.fixed(key, since=deprecated.since, until=deprecated.until)
        return self.labelled(name, sentence) if name else sentence

    def in_manual(self, name: str) -> str:
        """The sentence about the name of a field in the manual; empty without one."""
        printed = self.printed(name)
        return self.fixed("manual_name", printed=printed) if printed else ""

    def printed(self, name: str) -> str:
        """A name in the manual; empty for another script than ASCII in English comments."""
        return "" if self.language == ENGLISH and not name.isascii() else any_text(name)

    def labelled(self, label: str, text: str) -> str:
        """`label: text`."""
        return f"{label}{self.texts['colon']}{text}"

    def listed(self, texts: Iterable[str]) -> str:
        """`one, two`."""
        return self.texts["comma"].join(texts)

    def sentences(self, texts: Iterable[str]) -> str:
        """The texts that are not empty, each as a sentence."""
        ended = [text.rstrip(".。") for text in texts if text]
        return self.texts["stop"].join(ended) + self.texts["end"] if ended else ""


def languages() -> Sequence[str]:
    """The languages that comments can have."""
    return list(template_texts(_FILE))
