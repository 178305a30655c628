"""Someone who opens a report on a machine without a network."""

from datetime import UTC, datetime
from pathlib import Path

from playwright.sync_api import Page

from railjoule.core import Scenario
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.document import report_html
from railjoule.dashboard.report.findings import ReportRequest, compute_findings


def written(folder: Path, scenario: Scenario, contents: Contents) -> Path:
    """Return the file of a report."""
    *_, findings = compute_findings(ReportRequest(scenario, contents=contents))
    path = folder / "report.html"
    path.write_text(report_html(findings, datetime(2026, 3, 9, 14, 5, tzinfo=UTC)), encoding="utf-8")
    return path


class Reader:
    """Someone who opens a report on a machine without a network; what goes wrong is kept for the end."""

    def __init__(self, page: Page, file: Path) -> None:
        self.page = page
        self.troubles: list[str] = []
        page.on("console", lambda message: message.type == "error" and self.troubles.append(message.text))
        page.on("pageerror", lambda error: self.troubles.append(str(error)))
        page.on("request", lambda request: self._note(request.url, file))
        page.goto(file.as_uri())
        page.locator("html.ready").wait_for()

    def _note(self, address: str, file: Path) -> None:
        if address != file.as_uri() and not address.startswith(("data:", "blob:")):
            self.troubles.append(address)

    def energy(self) -> str:
        return self.page.locator("#numbers .figure.main .value").inner_text()

    def picture(self, name: str) -> bytes:
        return self.page.locator(f"[data-plot={name}]").screenshot()

    def drawn(self) -> None:
        """Wait until the browser has drawn two more frames, as a surface is drawn with the next frame."""
        self.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
