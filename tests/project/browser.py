"""A browser for the tests of pages: the Chromium of the machine, otherwise the one that Playwright installed."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Browser, Error, sync_playwright

_NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
_ARGUMENTS = ("--no-sandbox", "--disable-dev-shm-usage")
"""Tests often run in a container, which has no user namespaces and little shared memory."""


class BrowserError(Exception):
    """No browser is installed; says what to install."""


@contextmanager
def browser() -> Iterator[Browser]:
    """A headless browser. Raises BrowserError."""
    installed = next(filter(None, map(shutil.which, _NAMES)), None)
    with sync_playwright() as playwright:
        try:
            launched = playwright.chromium.launch(executable_path=installed, args=_ARGUMENTS)
        except Error as error:
            raise BrowserError(
                "tests of pages need Chromium; on Debian: apt-get install chromium; elsewhere: "
                f"python -m playwright install chromium\n{error}"
            ) from None
        yield launched
        launched.close()
