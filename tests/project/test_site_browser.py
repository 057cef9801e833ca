"""The site in a browser: from a folder and from a server, search, switches, keyboard, phone, print, accessibility."""

from __future__ import annotations

import functools
import json
import re
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from canwright.cli import main
from canwright.conformance.adapter import write_files
from canwright.project.loader import specification
from canwright.project.site import build
from canwright.targets.javascript.page import explorer
from click.testing import CliRunner

from ..spec_texts import ROOT
from ..untrusted.everything import filled
from .browser import PACKAGES, accessibility_violations, browser, expect
from .test_site import pages_of

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.machine(*PACKAGES)

EDITIONS = ("v2.35", "v2.36-2025-03")
COMMAND = "en/v2.35/commands/set_torque.html"
PAGES = (
    *("en/index.html", "zh/index.html", COMMAND, "zh/v2.36-2025-03/commands/set_speed.html"),
    *("en/bus-load-calculator.html", "zh/v2.35/states.html", "downloads/handover/mwd_motor-v2.35-zh.html"),
    *("en/v2.36-2025-03/index.html", "en/v2.36-2025-03/types.html", "zh/v2.36-2025-03/changes.html"),
)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site of two editions with the frame explorer, in a folder whose name has a space."""
    folder = tmp_path_factory.mktemp("two editions")
    specs = [ROOT / f"spec/mwd_motor/{edition}.yaml" for edition in EDITIONS]
    specifications = [specification(spec) for spec in specs]
    arguments = ["handover", "--spec", str(specs[0]), "--out", str(folder / "handover")]
    assert CliRunner().invoke(main, arguments).exit_code == 0
    write_files(explorer(specifications), folder / "made").rename(folder / "javascript")
    build(pages_of(specifications, folder / "docs"), folder / "site", folder / "handover")
    return folder / "site"


class _Quiet(SimpleHTTPRequestHandler):
    """A server below a sub-path, which answers unknown addresses with the page of the site for them."""

    def log_message(self, format: str, *args: object) -> None:
        pass

    def translate_path(self, path: str) -> str:
        return super().translate_path(path.removeprefix("/below/this"))

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        content = Path(self.directory, "404.html").read_bytes()
        self.send_response(code)
        self.send_header("Content-Type", "text/html")
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    """The address of the site on a server, below a sub-path."""
    with ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(_Quiet, directory=str(site))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/below/this"
        server.shutdown()


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    with browser() as launched:
        yield launched


Open = Callable[..., "Page"]


@pytest.fixture
def opened(chromium: Browser) -> Iterator[Open]:
    """Opens a page in a context of its own. At the end, nothing was reported and no other host was asked."""
    problems: list[str] = []
    contexts = []

    def open_page(url: str, **options: Any) -> Page:
        context = chromium.new_context(**{"viewport": {"width": 1280, "height": 900}, **options})
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: problems.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("dialog", lambda dialog: problems.append(f"dialog: {dialog.message}"))
        allowed = ("file:", "data:", "http://127.0.0.1:")
        page.on("request", lambda request: None if request.url.startswith(allowed) else problems.append(request.url))
        page.goto(url)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert problems == []


def folder_of(site: Path) -> str:
    """The address of the site in its folder."""
    return site.as_uri()


def test_navigation_from_a_folder_and_below_a_sub_path(site: Path, address: str, opened: Open) -> None:
    for start in (folder_of(site), address):
        page = opened(f"{start}/index.html", locale="zh-CN")
        page.wait_for_url("**/zh/index.html")
        page.goto(f"{start}/en/index.html")
        page.get_by_role("navigation", name="Pages").get_by_role("link", name="v2.36-2025-03").click()
        page.get_by_role("navigation", name="Pages").get_by_role("link", name="0xA1 Torque control").click()
        expect(page).to_have_title("0xA1 Torque control, v2.36-2025-03 · canwright")
        path = page.get_by_role("navigation", name="Path").get_by_role("link")
        expect(path).to_have_text(["Home", "v2.36-2025-03", "Commands"])
        page.get_by_role("link", name="Next").click()
        page.wait_for_url("**/set_speed.html")
        path.first.click()
        page.wait_for_url("**/en/index.html")


def test_switches_keep_page_and_section(site: Path, opened: Open) -> None:
    page = opened(f"{folder_of(site)}/{COMMAND}#reply")
    page.get_by_role("link", name="中文").click()
    page.wait_for_url("**/zh/v2.35/commands/set_torque.html#reply")
    page.get_by_role("navigation", name="版本").get_by_role("link", name="v2.36-2025-03").click()
    page.wait_for_url("**/zh/v2.36-2025-03/commands/set_torque.html#reply")
    page.wait_for_function("Math.abs(document.getElementById('reply').getBoundingClientRect().top) < 300")
    page.goto(f"{folder_of(site)}/en/v2.35/commands/read_pid.html")
    missing = page.get_by_role("navigation", name="Edition").get_by_role("link", name="v2.36-2025-03")
    missing.click()
    page.wait_for_url("**/en/v2.36-2025-03/index.html")


def test_unknown_address_below_a_sub_path_links_to_the_start_page(address: str, chromium: Browser) -> None:
    page = chromium.new_page()
    for path in ("/en/v2.35/commands/none.html", "/none/none.html", "/none"):
        page.goto(address + path)
        expect(page.get_by_role("link", name="start page")).to_have_attribute("href", "/below/this/index.html")
    page.close()


SEARCH = """async ([queries, edition]) => {
    const { language, texts } = document.getElementById("site-search").dataset;
    const search = createSearch(searchIndex, language);
    return queries.map(query => search(query, edition, JSON.parse(texts)));
}"""


def hits(page: Page, queries: Sequence[str], edition: str = "") -> dict[str, list[Mapping[str, Any]]]:
    """The hits of each query, by the search of the page."""
    if not page.evaluate("typeof createSearch === 'function' && typeof searchIndex === 'object'"):
        page.keyboard.press("/")
        page.get_by_role("searchbox").fill("x")
        expect(page.get_by_role("status")).not_to_be_empty()
        page.keyboard.press("Escape")
    return dict(zip(queries, page.evaluate(SEARCH, [list(queries), edition]), strict=True))


@pytest.mark.parametrize("language", ["en", "zh"])
def test_title_and_code_of_every_item_find_its_page(site: Path, opened: Open, language: str) -> None:
    """Among the first two hits, on a page of each edition; items of one kind and name count as one."""
    index = (site / language / "_static/search-index.js").read_text("utf-8")
    data = json.loads(index.removeprefix("searchIndex = ").removesuffix(";\n"))
    page = opened(f"{folder_of(site)}/{language}/index.html")
    failed = []
    for edition in data["editions"]:
        folder = edition["folder"]
        wanted: dict[tuple[str, str], set[str]] = {}
        for record in edition["records"]:
            if record["kind"] in ("command", "entry", "field", "value", "erratum"):
                texts = {record["name"], record.get("code", ""), record.get("title", {}).get(language, "")} - {""}
                for text in texts:
                    pages = wanted.setdefault((record["kind"], text), set())
                    pages |= {f"{folder}/{name.partition('#')[0]}" for name in record["pages"]}
        results = hits(page, list(dict.fromkeys(query for _, query in wanted)), folder)
        assert len(results) > 100
        for (kind, query), pages in wanted.items():
            first = {hit["page"] for hit in results[query][:2]}
            failed += [] if first & pages else [f"{folder}: {kind} {query}: {first} instead of {pages}"]
    assert failed == []


WORDS = {
    "commands/set_torque": ("A1", "0xA1", "a1", "set_torque", "set torque", "力矩控制", "转矩闭环"),
    "bus": ("0x141", "141", "波特率", "baud rate", "bitrate", "bit rate"),
    "commands/set_speed": ("deg/s", "转速"),
    "commands/motor_on": ("does not move", "电机不转", "开启电机"),
    "states": ("节点状态",),
    "commands/motor_stop": ("急停", "e-stop", "emergency stop", "estop"),
    "commands/read_multi_turn_angle": ("multi-turn angle", "读取多圈角度", "0x92"),
    "commands/write_encoder_offset_rom": ("wears rom", "encoder zero", "encoder offset", "零点"),
    "types": ("欠压", "undervoltage"),
    "errata": ("mh_amperes",),
}


@pytest.mark.parametrize("language", ["en", "zh"])
def test_words_that_people_search_for(site: Path, opened: Open, language: str) -> None:
    """In the current edition, which comes before the others."""
    page = opened(f"{folder_of(site)}/{language}/index.html")
    results = hits(page, [query for queries in WORDS.values() for query in queries], "v2.35")
    for expected, queries in WORDS.items():
        for query in queries:
            assert f"v2.35/{expected}" in [hit["page"] for hit in results[query][:3]], query
            assert next(hit["edition"] for hit in results[query] if hit["edition"]) == "v2.35"


@pytest.mark.parametrize("language", ["en", "zh"])
def test_guides_are_found_by_their_words(site: Path, opened: Open, language: str) -> None:
    """In both languages; a space between Chinese and Latin text does not matter."""
    page = opened(f"{folder_of(site)}/{language}/index.html")
    words = {
        "downloads": ("wireshark", "下载"),
        "bus-load": ("bus load", "总线负载"),
        "quickstart": ("快速入门", "quick start"),
    }
    results = hits(
        page, [query for queries in words.values() for query in queries] + ["修改ID", "修改 ID", "overtemperature"]
    )
    for expected, queries in words.items():
        assert all(expected in [hit["page"] for hit in results[query][:2]] for query in queries), expected
    for query in ("修改ID", "修改 ID"):
        assert {hit["anchor"] for hit in results[query][:3]} >= {"questions.id", "entries.driver_id"}
    assert "types" in results["overtemperature"][0]["page"]


def test_search_with_the_keyboard_only(site: Path, opened: Open) -> None:
    page = opened(f"{folder_of(site)}/{COMMAND}")
    for keys, query, target in (
        ("/", "0xA2", "v2.35/commands/set_speed.html"),
        ("Control+k", "急停", "v2.35/commands/motor_stop.html"),
        ("/", "mh_amperes", "v2.35/errata.html#errata.mh_amperes"),
    ):
        page.keyboard.press(keys)
        page.keyboard.type(query)
        expect(page.get_by_role("status")).to_contain_text("result")
        page.keyboard.press("Enter")
        page.wait_for_url(f"**/en/{target}")
    page.keyboard.press("/")
    page.keyboard.type("torque")
    expect(page.get_by_role("status")).to_contain_text("result")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    second = page.locator("#site-search li").nth(1).get_by_role("link").first
    expect(second).to_be_focused()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_be_hidden()
    page.keyboard.press("/")
    page.keyboard.type("qqqq")
    expect(page.get_by_role("status")).to_contain_text("No results")


def test_a_field_opens_its_row(site: Path, opened: Open) -> None:
    page = opened(f"{folder_of(site)}/{COMMAND}")
    expect(page.locator(".sidebar-tree .current-page").last).to_be_in_viewport()
    page.keyboard.press("/")
    page.keyboard.type("angleIncrement")
    expect(page.get_by_role("status")).to_contain_text("result")
    page.keyboard.press("Enter")
    page.wait_for_url("**/en/v2.35/commands/move_by_angle.html#request.increment")
    row = page.locator("tr:has(:target)")
    expect(row).to_contain_text("angleIncrement")
    expect(row).to_be_in_viewport()


def test_a_pasted_frame_opens_the_explorer_in_the_language_of_the_page(site: Path, opened: Open) -> None:
    page = opened(f"{folder_of(site)}/zh/v2.35/commands/set_torque.html", locale="en-US")
    links = page.locator("#site-search li > a:first-child")
    page.keyboard.press("/")
    for text, shown in (
        ("(1716900000.123456) can0 143#9A1E00E001000008", "143#9A1E00E001000008"),
        ("0xA5,0x01,0x00,0x00,0x28,0x23,0x00,0x00", "0xA5,0x01,0x00,0x00,0x28,0x23,0x00,0x00"),
        ("can0  143   [8]  9A 1E 00 E0 01 00 00 08", "143#9A1E00E001000008"),
    ):
        page.get_by_role("searchbox").fill(text)
        expect(links.first).to_have_text(f"解析该帧 {shown}")
        expect(page.get_by_role("status")).to_have_text(f"{links.count()} 个结果")
        assert links.count() > 1
    page.keyboard.press("Enter")
    page.wait_for_url("**/explorer/index.html?lang=zh#**")
    expect(page.locator("#frame")).to_have_value("143#9A1E00E001000008")
    expect(page.get_by_role("heading", level=1)).to_have_text("帧解析器")
    page.get_by_role("link", name="文档").click()
    page.wait_for_url("**/zh/index.html")
    page.get_by_role("link", name="English").click()
    page.wait_for_url("**/en/index.html")
    page.get_by_role("navigation", name="Pages").get_by_role("link", name="Frame explorer").click()
    page.wait_for_url("**/explorer/index.html?lang=en")
    page.get_by_role("button", name="中文").click()
    expect(page.get_by_role("link", name="文档")).to_have_attribute("href", "../zh/index.html")


def test_the_number_of_results(site: Path, opened: Open) -> None:
    page = opened(f"{folder_of(site)}/{COMMAND}")
    page.keyboard.press("/")
    for query, text in (
        ("0xA1", "1 result"),
        ("A9", "No edition has a command 0xA9."),
        ("torque", re.compile(r"^\d+ results$")),
    ):
        page.get_by_role("searchbox").fill(query)
        expect(page.get_by_role("status")).to_have_text(text)


def test_every_link_and_button_can_be_reached_with_the_keyboard(site: Path, opened: Open) -> None:
    page = opened(f"{folder_of(site)}/{COMMAND}")
    reached = set()
    for _ in range(90):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate("document.activeElement.closest('[class]')?.className + ' ' + document.activeElement.tagName")
        )
    for part in ("skip-to-content", "site-search", "reference internal", "site-language", "theme-toggle"):
        assert any(part in element for element in reached), part


def test_pages_on_a_phone_and_on_paper(site: Path, opened: Open) -> None:
    """Nothing is wider than the screen; on paper, no column of a table is cut off."""
    page = opened(f"{folder_of(site)}/{COMMAND}", viewport={"width": 390, "height": 844})
    for name in PAGES:
        page.set_viewport_size({"width": 390, "height": 844})
        page.emulate_media(media="screen")
        page.goto(f"{folder_of(site)}/{name}")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390, name
        page.set_viewport_size({"width": 720, "height": 1000})
        page.emulate_media(media="print")
        wide = "[...document.querySelectorAll('table')].filter(t => t.getBoundingClientRect().right > innerWidth + 1).length"
        assert page.evaluate(wide) == 0, name
    page.emulate_media(media="screen")
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto(f"{folder_of(site)}/{COMMAND}")
    page.get_by_role("button", name="Search", exact=True).click()
    page.get_by_role("searchbox").fill("0x9A")
    page.locator("#site-search li a").first.click()
    page.wait_for_url("**/read_status_1.html")


def test_texts_of_a_spec_are_texts(tmp_path: Path, opened: Open) -> None:
    """In pages, menus and search results: no element, no script."""
    text = "<script>alert(1)</script><img src=x onerror=alert(2)> {{ 7*7 }} {math}`x`"
    build(pages_of([filled(lambda: text, tmp_path / "spec", ("en",))], tmp_path / "docs"), tmp_path / "site")
    assert len(sorted((tmp_path / "site").rglob("*.html"))) > 20
    page = opened(f"{(tmp_path / 'site').as_uri()}/en/index.html")
    for file in sorted((tmp_path / "site").rglob("*/*.html")):
        page.goto(file.as_uri())
        assert (
            page.evaluate(
                "document.querySelectorAll('img[src=x], [onerror], article script, a[href^=javascript]').length"
            )
            == 0
        )
    page.goto(f"{(tmp_path / 'site').as_uri()}/en/v1/commands/dim.html")
    assert text in page.title()
    page.keyboard.press("/")
    page.keyboard.type("alert")
    expect(page.locator("#site-search li").first).to_contain_text(
        "<script>alert(1)</script><img src=x onerror=alert(2)>"
    )
    assert page.locator("#site-search img").count() == 0


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessibility(address: str, opened: Open, scheme: str) -> None:
    """axe-core finds nothing but what is minor."""
    page = opened("about:blank", color_scheme=scheme)
    violations = set()
    for name in (*PAGES[:-1], "404.html"):
        page.goto(f"{address}/{name}")
        for violation in accessibility_violations(page):
            if violation["impact"] != "minor":
                violations |= {f"{violation['id']}: {node['html'][:150]}" for node in violation["nodes"]}
    assert violations == set()


def test_the_size_of_the_site_and_of_a_first_view(site: Path, address: str, opened: Open) -> None:
    total = sum(file.stat().st_size for file in site.rglob("*") if file.is_file())
    assert total < 15_000_000
    page = opened("about:blank")
    sizes: list[int] = []
    page.on("response", lambda response: sizes.append(len(response.body())))
    page.goto(f"{address}/{COMMAND}", wait_until="networkidle")
    assert 0 < sum(sizes) < 4 * 200_000
