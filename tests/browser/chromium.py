"""Where Chromium is, and how it is started."""

import os
import shutil

ARGUMENTS = [
    "--no-sandbox",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--process-per-site",
    "--use-gl=swiftshader",
    "--enable-unsafe-swiftshader",
]
NAMES = ("chromium", "chromium-browser", "google-chrome")


def browser_path() -> str | None:
    """Return where Chromium is, if it is anywhere."""
    return os.environ.get("RAILJOULE_BROWSER") or next(filter(None, map(shutil.which, NAMES)), None)
