"""The system's Chromium, without a window, for tests that look at pages as a reader does."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.engines.presence import BROWSERS, need

DESKTOP, PHONE = (1280, 900), (390, 844)
# A4 between margins of 16 mm, at the 96 dots an inch that a browser prints with.
PAPER = (672, 1001)
ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--no-first-run",
]

# Boxes of all elements that a selector finds, and how large the letters of drawings come out.
_BOXES = """selector => [...document.querySelectorAll(selector)].map(found => {
    const box = found.getBoundingClientRect();
    return [box.left, box.right, box.width, box.height];
})"""
_LETTERS = """selector => [...document.querySelectorAll(selector)]
    .filter(found => found.textContent.trim())
    .map(found => [
        found.textContent,
        parseFloat(getComputedStyle(found).fontSize)
            * Math.hypot(found.getScreenCTM().a, found.getScreenCTM().b),
    ])"""
_WIDTH = "document.scrollingElement.scrollWidth"


@dataclass
class Opened:
    """A page in the browser, with whatever it asked for and complained about."""

    page: Any
    requests: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    def boxes(self, selector: str) -> list[tuple[float, float, float, float]]:
        """Return left, right, width and height of each element, in pixels."""
        return [tuple(box) for box in self.page.evaluate(_BOXES, selector)]

    def letters(self, selector: str) -> list[tuple[str, float]]:
        """Return each text with the size it is drawn at, in pixels."""
        return [tuple(pair) for pair in self.page.evaluate(_LETTERS, selector)]

    @property
    def width(self) -> float:
        """The width that the page would like to have."""
        return float(self.page.evaluate(_WIDTH))

    def print_on(self, size: tuple[int, int]) -> None:
        """Lay the page out as for paper of a size."""
        self.page.emulate_media(media="print")
        self.page.set_viewport_size({"width": size[0], "height": size[1]})


@contextmanager
def chromium() -> Iterator[Any]:
    """Start the system's browser with an empty profile."""
    need("playwright")
    need("chromium")
    from playwright.sync_api import sync_playwright

    path = next(filter(None, map(shutil.which, BROWSERS)))
    with sync_playwright() as engine:
        browser = engine.chromium.launch(executable_path=path, args=ARGUMENTS)
        yield browser
        browser.close()


@contextmanager
def opened(browser: Any, path: Path, size: tuple[int, int]) -> Iterator[Opened]:
    """Open a file in a window of a size; nothing is remembered from one page to the next."""
    context = browser.new_context(viewport={"width": size[0], "height": size[1]}, offline=True)
    found = Opened(context.new_page())
    found.page.on("request", lambda request: found.requests.append(request.url))
    found.page.on("console", lambda message: found.complaints.append(message.text))
    found.page.on("pageerror", lambda error: found.complaints.append(str(error)))
    found.page.goto(path.resolve().as_uri())
    yield found
    context.close()
