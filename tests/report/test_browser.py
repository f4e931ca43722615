"""Reports as a reader has them: opened from a file, on a desktop, a phone and paper."""

from __future__ import annotations

import pytest

from bondgraph.cli.library import library_reports
from tests.browser import DESKTOP, PAPER, PHONE, chromium, opened

SCREENS = {"desktop": DESKTOP, "phone": PHONE}
PLOTS = ".panel > svg"


@pytest.fixture(scope="module")
def browser():
    with chromium() as found:
        yield found


@pytest.fixture(scope="module", params=["bicycle_brake", "quarter_car"])
def report(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("reports")
    (entry,) = library_reports(folder, [request.param])
    return folder / entry.page


@pytest.mark.parametrize("screen", SCREENS)
def test_the_page_asks_for_nothing_and_complains_of_nothing(report, browser, screen):
    with opened(browser, report, SCREENS[screen]) as found:
        assert found.requests == [report.as_uri()]
        assert found.complaints == []


@pytest.mark.parametrize("screen", SCREENS)
def test_every_plot_is_seen_whole(report, browser, screen, tmp_path):
    width = SCREENS[screen][0]
    with opened(browser, report, SCREENS[screen]) as found:
        found.page.screenshot(path=tmp_path / f"{screen}.png", full_page=True)
        plots = found.boxes(PLOTS)
        assert len(plots) == len(list((report.parent / "plots").glob("*.svg"))) >= 2
        for left, right, wide, high in plots:
            assert wide > 300 and high > 60
            assert left >= 0 and right <= width


@pytest.mark.parametrize("screen", SCREENS)
def test_the_page_does_not_scroll_sideways(report, browser, screen):
    with opened(browser, report, SCREENS[screen]) as found:
        assert found.width <= SCREENS[screen][0]
        for _, right, _, _ in found.boxes("p, li, h1, h2, h3, .wide, .drawing, .formulas, pre"):
            assert right <= SCREENS[screen][0]


@pytest.mark.parametrize("screen", SCREENS)
def test_letters_in_plots_can_be_read(report, browser, screen):
    with opened(browser, report, SCREENS[screen]) as found:
        letters = found.letters(f"{PLOTS} text")
        assert len(letters) > 20
        # parts of exponents stand smaller than the rest
        small = [text for text, size in letters if size < 8.5 and len(text) > 3]
        assert not small


def test_paper_cuts_nothing_off(report, browser, tmp_path):
    with opened(browser, report, PAPER) as found:
        found.print_on(PAPER)
        assert found.width <= PAPER[0]
        for left, right, _, high in found.boxes(f"{PLOTS}, .drawing svg, figure"):
            assert left >= -0.5 and right <= PAPER[0] + 0.5
            assert high <= PAPER[1]
        assert found.boxes("nav") and all(box[2] == 0 for box in found.boxes("nav, .files"))
        tables = found.boxes("table, pre, .formulas math")
        assert all(right <= PAPER[0] + 0.5 for _, right, _, _ in tables)
        printed = found.page.pdf(path=tmp_path / "page.pdf", format="A4")
        assert printed.startswith(b"%PDF")


def test_the_index_leads_to_its_report(report, browser):
    index = report.parent.parent / "index.html"
    for size in SCREENS.values():
        with opened(browser, index, size) as found:
            assert found.requests == [index.as_uri()] and not found.complaints
            assert found.width <= size[0]
            found.page.locator("h3 a").click()
            assert found.page.url == report.as_uri()


def test_contents_lead_to_their_chapters(report, browser):
    with opened(browser, report, DESKTOP) as found:
        links = found.page.locator("nav a")
        links.nth(links.count() - 1).click()
        target = links.nth(links.count() - 1).get_attribute("href")
        found.page.wait_for_timeout(1000)
        assert found.page.locator(f"section{target}").is_visible()
        assert found.page.evaluate("window.scrollY") > 500
