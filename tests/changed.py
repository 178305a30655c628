"""`./run test --changed` runs the test files that this script prints: those that the changes since `main` can reach.

Changes are the commits since the merge base with `main`, the working tree and new files. The rules:

- A changed module of core/ or dashboard/: all test files but those of tests/browser that import it, directly or through
  other modules. Imports only for type checking do not count; `from railjoule.core import solve` counts as an import of
  the module that defines `solve`.
- A changed helper of the tests: all test files that import it. A changed conftest.py: all test files of its folder.
- Any changed module, script or style sheet: tests/browser/test_pages.py, which opens all pages; pages are loaded by
  name, without an import statement. A script: also tests/browser/test_scripts.py.
- A changed page, in dashboard/pages/NAME: also tests/browser/test_NAME.py.
- A changed module of commands: all test files that import the command line, which imports those modules by name.
- A changed file of any other kind: the test files that name it or its folder.
"""

import ast
import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from railjoule.core.kernel_cache import executed_nodes

ROOT = Path(__file__).parents[1]
PRODUCT, TESTS, BROWSER = ("core/", "dashboard/"), "tests/", "tests/browser/"
SMOKE, PAGES = f"{BROWSER}test_pages.py", "dashboard/pages/"
COMMANDS, COMMAND_LINE = "dashboard/command/", "dashboard/command/cli.py"


def changed_files(base: str = "main") -> list[str]:
    """List the files that differ from the merge base with a branch, and new files."""
    try:
        since = _git("merge-base", "HEAD", base)[0]
    except (subprocess.CalledProcessError, FileNotFoundError):
        sys.exit(f"run: --changed compares with the branch {base}, which this copy of railjoule lacks; use ./run test.")
    return sorted({*_git("diff", "--name-only", since), *_git("ls-files", "--others", "--exclude-standard")})


def _git(*words: str) -> list[str]:
    answer = subprocess.run(("git", *words), cwd=ROOT, capture_output=True, text=True, check=True)
    return answer.stdout.splitlines()


@cache
def module_paths() -> dict[str, str]:
    """Return the path of each Python file of the product and its tests by the name of its module."""
    found = {}
    for folder in (*PRODUCT, TESTS):
        for path in (ROOT / folder).rglob("*.py"):
            place = path.relative_to(ROOT / TESTS if folder == TESTS else ROOT).with_suffix("")
            words = place.parts[:-1] if place.name == "__init__" else place.parts
            found[".".join(words if folder == TESTS else ("railjoule", *words))] = str(path.relative_to(ROOT))
    return found


@cache
def importers() -> dict[str, set[str]]:
    """Return the files that import each file.

    A package whose names come from its modules is imported by files that take such a name from it, but does not hand on
    the changes of its modules to them: those files are listed under the module of the name.
    """
    paths = module_paths()
    names = {path: list(_imported(path)) for path in paths.values()}
    sources = {
        module: {alias: f"{source}.{name}" for source, name, alias in names[path]} for module, path in paths.items()
    }
    found: defaultdict[str, set[str]] = defaultdict(set)
    for path, imported in names.items():
        if path.startswith(COMMANDS):
            found[path].add(COMMAND_LINE)
        for source, name, _ in imported:
            module = f"{source}.{name}" if name else source
            while module and module not in paths:
                package, _, last = module.rpartition(".")
                module = sources.get(package, {}).get(last, package)
                if package in paths and module != package:
                    found[f"names of {paths[package]}"].add(path)
            if module:
                found[paths[module]].add(path)
    return found


def _imported(path: str) -> Iterator[tuple[str, str, str]]:
    """Yield the module, the name and the local name of each import of a file."""
    for node in executed_nodes(ast.parse((ROOT / path).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "", alias.asname or alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from ((node.module, alias.name, alias.asname or alias.name) for alias in node.names)


def reached_tests(changed: list[str]) -> list[str]:
    """List the test files that changes can reach."""
    users = importers()
    reached: set[str] = set()
    waiting = [*changed, *(f"names of {path}" for path in changed)]
    while waiting:
        path = waiting.pop()
        if path not in reached:
            reached.add(path)
            waiting += [user for user in users[path] if path.startswith(TESTS) or not user.startswith(BROWSER)]
    tests = {path for path in module_paths().values() if Path(path).name.startswith("test_")}
    return sorted((tests & reached).union(*(_tests_by_name(path, tests) for path in changed)))


def _tests_by_name(path: str, tests: set[str]) -> set[str]:
    """Return the test files that a change reaches without an import."""
    place = Path(path)
    if place.name == "conftest.py":
        return {test for test in tests if test.startswith(f"{place.parent}/")}
    found = {SMOKE} if path.startswith(PRODUCT) or place.suffix in {".js", ".css"} else set()
    if place.suffix == ".js":
        found.add(f"{BROWSER}test_scripts.py")
    if path.startswith(PAGES):
        found |= tests & {f"{BROWSER}test_{place.parts[2]}.py"}
    if place.suffix == ".py":
        return found
    words = "|".join(re.escape(word) for word in (place.name, place.stem, place.parent.name) if word)
    named = re.compile(rf"""["'/_]({words})["'/.]""")
    return found | {test for test in tests if named.search((ROOT / test).read_text(encoding="utf-8"))}


if __name__ == "__main__":
    found = reached_tests(changed_files())
    print(f"The changes since main can reach {len(found)} test files.", file=sys.stderr)
    print(*found, sep="\n")
