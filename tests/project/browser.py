"""A browser for the tests of pages: the Chromium of the machine, otherwise the one that Playwright installed."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator, Page

PACKAGES = ("playwright", "axe_playwright_python")
"""What tests with a browser import; they are not installed for other tests."""

_NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
_ARGUMENTS = ("--no-sandbox", "--disable-dev-shm-usage")
"""Tests often run in a container, which has no user namespaces and little shared memory."""


class BrowserError(Exception):
    """No browser is installed; says what to install."""


@contextmanager
def browser() -> Iterator[Browser]:
    """A headless browser. Raises BrowserError."""
    from playwright.sync_api import Error, sync_playwright

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


def expect(part: Locator | Page) -> Any:
    """Assertions about a page or a part of it, which wait until they hold."""
    from playwright.sync_api import expect as assertions

    return assertions(part)


def accessibility_violations(page: Page, options: Mapping[str, object] | None = None) -> Sequence[Any]:
    """What axe finds on a page."""
    from axe_playwright_python.sync_playwright import Axe

    violations: Sequence[Any] = Axe().run(page, options=options).response["violations"]
    return violations
