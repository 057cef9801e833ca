"""The language of comments: English in ASCII, which every reader accepts, or another language of the specs in UTF-8."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping

from ...model.deprecation import Deprecation
from ...model.types import Text
from ...templating import resources
from ...templating.data_files import read_data
from .text import any_text, in_ascii

ENGLISH = "en"


class Comments:
    """Texts of the spec and fixed texts in one language, as sentences of comments."""

    def __init__(self, language: str) -> None:
        self.language = language
        self._texts = _texts()[language]

    def of(self, texts: Text) -> str:
        """A text of the spec: in the language, else in English or the first language."""
        return in_ascii(texts) if self.language == ENGLISH else any_text(texts.get(self.language) or in_ascii(texts))

    def fixed(self, name: str, **values: object) -> str:
        """A fixed text with its values."""
        return self._texts[name].format(**values)

    def deprecation(self, deprecated: Deprecation | None, name: str = "") -> str:
        """The sentence about a deprecated item, with its name if it is not the first thing in the comment."""
        if deprecated is None:
            return ""
        key = "deprecated_until" if deprecated.until else "deprecated"
        sentence = self.fixed(key, since=deprecated.since, until=deprecated.until)
        return self.labelled(name, sentence) if name else sentence

    def labelled(self, label: str, text: str) -> str:
        """`label: text`."""
        return f"{label}{self._texts['colon']}{text}"

    def listed(self, texts: Iterable[str]) -> str:
        """`one, two`."""
        return self._texts["comma"].join(texts)

    def sentences(self, texts: Iterable[str]) -> str:
        """The texts that are not empty, each as a sentence."""
        ended = [text.rstrip(".。") for text in texts if text]
        return self._texts["stop"].join(ended) + self._texts["end"] if ended else ""


def languages() -> Iterable[str]:
    """The languages that comments can have."""
    return _texts()


@functools.cache
def _texts() -> Mapping[str, Mapping[str, str]]:
    return read_data(resources.TEMPLATES / "dbc/comments.yaml")  # type: ignore[no-any-return]
