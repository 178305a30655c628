"""Section 7: the lowest release of each package that is allowed, and of those the lowest without a known advisory.

Advisories as the packages' own release notes and GitHub's advisory database name them; whoever adds a package or hears
of an advisory adds a line here. `python -m tests.try_floors` installs what pyproject.toml allows at least and tries it.
"""

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.trust.rows import Found, Row

ROOT = Path(__file__).resolve().parents[2]
REQUIREMENT = re.compile(r"(?P<name>[A-Za-z0-9._-]+)(?:\[[^\]]*\])?\s*(?:>=\s*(?P<least>[0-9.]+))?")


@dataclass(frozen=True)
class Floor:
    """The lowest release of a package without an advisory that is known here, and the last of those advisories."""

    package: str
    lowest: str
    advisory: str


FLOORS = (
    Floor("tornado", "6.6.1", "CVE-2026-82397 and before it CVE-2026-49853/4/5, CVE-2026-31958, CVE-2025-67724/5/6"),
    Floor("bokeh", "3.8.2", "CVE-2026-21883: websockets of other origins"),
    Floor("jinja2", "3.1.6", "CVE-2025-27516: sandbox"),
    Floor("requests", "2.32.4", "CVE-2024-47081: netrc"),
    Floor("urllib3", "2.6.3", "CVE-2026-21441: decompression of redirects"),
    Floor("pillow", "11.3.0", "CVE-2025-48379: DDS"),
    Floor("certifi", "2024.7.4", "CVE-2024-39689"),
    Floor("idna", "3.7", "CVE-2024-3651"),
    Floor("setuptools", "78.1.1", "CVE-2025-47273"),
    Floor("tqdm", "4.66.3", "CVE-2024-34062"),
    Floor("pyarrow", "14.0.1", "CVE-2023-47248: reads of strangers' files"),
)
"""Of what is served or reads what strangers wrote; a package that is not installed needs no floor."""


def canonical(name: str) -> str:
    """Return the name of a package as indexes write it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def parts(version: str) -> tuple[int, ...]:
    """Return a release as numbers, which can be compared."""
    return tuple(int(part) for part in re.findall(r"\d+", version))


def allowed() -> dict[str, str]:
    """Return the lowest release that pyproject.toml allows of each package that it names with one."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    build = project["build-system"]["requires"]
    groups = [build, project["project"]["dependencies"], *project["project"]["optional-dependencies"].values()]
    found = (REQUIREMENT.match(line) for group in groups for line in group)
    return {canonical(one["name"]): one["least"] for one in found if one and one["least"]}


def tried() -> dict[str, str]:
    """Return the releases that the gate is tried with."""
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pairs = (line.split("==") for line in lines if "==" in line)
    return {canonical(name): version.strip() for name, version in pairs}


def below() -> Iterator[str]:
    """Yield each release that is allowed or tried although an advisory is known."""
    for place, releases in (("pyproject.toml", allowed()), ("constraints.txt", tried())):
        for floor in FLOORS:
            release = releases.get(floor.package)
            if release is not None and parts(release) < parts(floor.lowest):
                yield f"{place}: {floor.package} {release} is below {floor.lowest} ({floor.advisory})"


def no_advisory() -> Found:
    """Compare what is allowed and tried with the table."""
    found = list(below())
    return Found("; ".join(found) or f"none of {len(FLOORS)} packages below its floor", not found)


ROWS = (Row("7", "releases with a known advisory", "tornado >= 6.4.1 allows ten", no_advisory),)
