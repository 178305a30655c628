"""`python -m tests.bill_of_materials` writes what railjoule is installed with, as CycloneDX 1.5 in JSON.

It lists railjoule and all that it needs, with extras, as they are installed here: name, release, licence, and who needs
whom. It reads nothing but the metadata of the installed packages.
"""

import json
import sys
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from typing import Any

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT_PACKAGE, EXTRAS = "railjoule", ("page", "excel", "yaml")


def needs(package: Distribution, extras: tuple[str, ...]) -> list[tuple[str, tuple[str, ...]]]:
    """Return the packages that one needs with some of its extras, each with the extras that it is needed with."""
    return [
        (canonicalize_name(one.name), tuple(sorted(one.extras)))
        for one in map(Requirement, package.requires or ())
        if one.marker is None or any(one.marker.evaluate({"extra": extra}) for extra in ("", *extras))
    ]


def component(package: Distribution, kind: str) -> dict[str, Any]:
    """Return one package as CycloneDX names it."""
    name, version = canonicalize_name(package.metadata["Name"]), package.version
    told: dict[str, Any] = {"type": kind, "bom-ref": f"pkg:pypi/{name}@{version}", "name": name, "version": version}
    told["purl"] = told["bom-ref"]
    licence = package.metadata.get("License-Expression") or package.metadata.get("License") or ""
    if licence and "\n" not in licence:
        told["licenses"] = [{"license": {"name": licence}}]
    return told


def bill() -> dict[str, Any]:
    """Return the bill; what is needed on other systems alone, and so not installed, is left out."""
    root = distribution(ROOT_PACKAGE)
    packages: dict[str, Distribution] = {ROOT_PACKAGE: root}
    edges: dict[str, set[str]] = {}
    waiting: list[tuple[str, tuple[str, ...]]] = [(ROOT_PACKAGE, EXTRAS)]
    seen = set(waiting)
    while waiting:
        name, extras = waiting.pop()
        for other, with_extras in needs(packages[name], extras):
            if other not in packages:
                try:
                    packages[other] = distribution(other)
                except PackageNotFoundError:
                    continue
            edges.setdefault(name, set()).add(other)
            if (other, with_extras) not in seen:
                seen.add((other, with_extras))
                waiting.append((other, with_extras))
    parts = {name: component(package, "library") for name, package in packages.items()}
    own = component(root, "application")
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": own},
        "components": [parts[name] for name in sorted(parts) if name != ROOT_PACKAGE],
        "dependencies": [
            {"ref": parts[name]["bom-ref"], "dependsOn": sorted(parts[one]["bom-ref"] for one in edges.get(name, ()))}
            for name in sorted(parts)
        ],
    }


if __name__ == "__main__":
    json.dump(bill(), sys.stdout, indent=2)
    print()
