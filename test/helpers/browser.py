"""Pages under test: a server as a process, a real chromium, and axe for accessibility."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import pytest

CHROMIUM = shutil.which('chromium')
_FLAGS = [
    '--headless',
    '--no-sandbox',
    '--disable-gpu',
    '--disable-quic',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    # A renderer for the browser's own address bar, and one for each frame's site: half of the
    # processor's time.
    '--disable-features=PaintHolding,WebUIOmniboxPopup,WebUIOmniboxAimPopup',
    '--disable-site-isolation-trials',
]
_WCAG_AA = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa']
PATIENCE = 150_000  # ms, far more than anything takes
# Width and height in CSS pixels. At 200 % zoom a screen has half as many.
SCREENS = {
    'desktop': (1280, 800),
    'zoomed': (640, 400),
    'tablet': (768, 1024),
    'phone': (390, 664),
    'small': (320, 568),
}


@dataclass(frozen=True)
class Server:
    """A running server: its process, and the address it printed."""

    process: subprocess.Popen[str]
    url: str

    @property
    def port(self) -> str:
        """The port that it listens at."""
        return self.url.split(':')[2].split('/')[0]

    def kill(self) -> None:
        """End it as a power cut would."""
        self.process.kill()
        self.process.wait()


@contextmanager
def served(arguments: Sequence[str], stderr: TextIO | None = None) -> Iterator[Server]:
    """Run `python ARGUMENTS`, wait until it prints where it serves, and end it afterwards.

    What it says besides goes to `stderr`, or to that of the tests.
    """
    path = os.pathsep.join([str(Path(__file__).parent), os.environ.get('PYTHONPATH', '')])
    with subprocess.Popen(
        [sys.executable, *arguments],
        stdout=subprocess.PIPE,
        stderr=stderr,
        text=True,
        env={**os.environ, 'PYTHONPATH': path},
    ) as process:
        try:
            line = next((said for said in process.stdout if said.startswith('Open ')), None)
            assert line, f'{arguments} ended with {process.wait()}'
            yield Server(process, line.split()[1])
        finally:
            process.terminate()


@pytest.fixture(scope='module')
def chromium():
    """A real browser, or the tests that need one are skipped."""
    playwright = pytest.importorskip(
        'playwright.sync_api', reason='playwright is not installed (the extra [test])'
    )
    playwright.expect.set_options(timeout=PATIENCE)
    if CHROMIUM is None:
        pytest.skip('there is no /usr/bin/chromium: apt install chromium')
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=_FLAGS)
        yield browser
        browser.close()


@contextmanager
def person(chromium, screen: str = 'desktop', scripts: bool = True):
    """Yield a page of a browser of one's own, which must not report any error in the end."""
    width, height = SCREENS[screen]
    context = chromium.new_context(
        viewport={'width': width, 'height': height}, java_script_enabled=scripts
    )
    context.set_default_timeout(PATIENCE)
    page = context.new_page()
    page.errors = []
    page.on('console', lambda said: said.type == 'error' and page.errors.append(said.text))
    page.on('pageerror', lambda error: page.errors.append(str(error)))
    try:
        yield page
        assert not page.errors, page.errors
    finally:
        context.close()


def violations(page) -> list[str]:
    """Return what axe finds on the page against WCAG 2.2, levels A and AA."""
    from axe_playwright_python.sync_playwright import Axe

    found = Axe().run(page, options={'runOnly': {'type': 'tag', 'values': _WCAG_AA}}).response
    return [
        f'{problem["id"]}: {problem["help"]}: {node["html"]}'
        for problem in found['violations']
        for node in problem['nodes']
    ]


def resized(page) -> Iterator[tuple[str, int]]:
    """Yield each screen's name and height in turn, as the size that the page has meanwhile."""
    for screen, (width, height) in SCREENS.items():
        page.set_viewport_size({'width': width, 'height': height})
        yield screen, height


def overflow(page) -> int:
    """Return by how many CSS pixels the page is wider than the screen."""
    return page.evaluate('document.documentElement.scrollWidth - window.innerWidth')
