from importlib.metadata import version

from tests.bill_of_materials import bill
from tests.trust.floors import tried
from tests.try_floors import runtime_floors


def test_the_bill_names_what_is_installed_and_each_reference_once() -> None:
    told = bill()
    parts = {part["name"]: part for part in told["components"]}
    # needed directly, by the page, and only by another package
    for name in ("numpy", "tornado", "llvmlite", "markupsafe"):
        assert parts[name]["version"] == version(name) == tried()[name]
    references = [part["bom-ref"] for part in told["components"]] + [told["metadata"]["component"]["bom-ref"]]
    assert len(set(references)) == len(references)
    assert {one["ref"] for one in told["dependencies"]} == set(references)
    assert all(need in references for one in told["dependencies"] for need in one["dependsOn"])
    numba = next(one for one in told["dependencies"] if one["ref"].startswith("pkg:pypi/numba@"))
    assert any(need.startswith("pkg:pypi/llvmlite@") for need in numba["dependsOn"])
    # what only the tests need is no part of what is served
    assert not {"pytest", "hypothesis", "mypy"} & set(parts)


def test_the_floors_are_those_of_the_core_and_the_page() -> None:
    floors = runtime_floors()
    assert "tornado==6.6.1" in floors
    assert any(one.startswith("numba==") for one in floors)
    assert not any(one.startswith("pytest") for one in floors)
