import param
import pytest

from railjoule.dashboard.keep.link import read_link, write_link
from railjoule.dashboard.keep.snapshot import changed, lay, originals_of, snapshot_of
from railjoule.dashboard.state.kept import Kept, is_kept
from railjoule.dashboard.state.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    return Workbench()


def kept_models() -> list[Kept]:
    """Return the page's state, all its models, and one of each kind that their lists hold."""
    state = Workbench()
    models = [state, *state.models.values()]
    kinds = [getattr(model.param[field], "item_type", None) for model in models for field in model.kept]
    return [*models, *(kind() for kind in kinds if is_kept(kind))]


def settable(model: Kept) -> list[str]:
    """Return the parameters that are set by hand; the others hold results and signals."""
    return sorted(
        name
        for name, parameter in model.param.objects("existing").items()
        if name not in {"name", "originals"}
        and not isinstance(parameter, param.Event)
        and type(parameter) is not param.ClassSelector
    )


@pytest.mark.parametrize("model", kept_models(), ids=lambda model: type(model).__name__)
def test_every_field_is_named_kept_or_passing(model: Kept) -> None:
    assert settable(model) == sorted({*model.kept, *model.passing})
    assert set(model.kept).isdisjoint(model.passing)


def test_a_new_page_differs_in_nothing_from_what_it_begins_with(state: Workbench) -> None:
    snapshot = snapshot_of(state)
    originals = originals_of(snapshot)
    # the pages take over the scenario when they are composed; these alone have lists of models
    assert set(changed(snapshot, originals)) <= {key for key in snapshot if key.startswith(("line.", "set_speeds."))}


def test_a_page_comes_back_from_its_link(state: Workbench) -> None:
    lay(state, {"preset": "liashenko-ii"})
    state.scenario.edit(
        {"vehicle.auxiliary_power_kw": 40.0, "line.speed_limits": [{"from_m": 100.0, "to_m": 200.0, "limit_kmh": 50.0}]}
    )
    state.scenario.param.update(travel_time_s=150.0, load_percent=30.0)
    state.day.param.update(seed=7, target_braking=False)
    state.pages["What if"].known = "both"
    state.day.drop("limit", 700.0)
    state.pages["Set speeds"].cut(3)
    state.pages["Set speeds"].param.update(section_count=3, found=False, storage_size_kwh=1.5)
    state.param.update(ticked=["optimal"], chosen="eoc", over_time=True, page="What if", colours="dark")
    snapshot = snapshot_of(state)
    read = read_link(write_link(snapshot, originals_of(snapshot)))
    assert read.refusal == ""
    other = Workbench()
    assert lay(other, read.snapshot) == ()
    assert snapshot_of(other) == snapshot
    assert other.scenario.scenario() == state.scenario.scenario()


def test_what_cannot_be_is_told_and_the_rest_is_laid(state: Workbench) -> None:
    refusals = lay(state, {"edits": {"vehicle.wings": 2}, "load_percent": 30.0, "day.seed": 5, "page": "Nowhere"})
    assert len(refusals) == 2
    assert "unknown key vehicle.wings" in refusals[0]
    assert refusals[1].startswith("page is not one of the 13 known")
    assert state.scenario.load_percent == 30.0
    assert state.day.seed == 5
    assert state.page == Workbench().page


def test_too_few_sections_change_nothing(state: Workbench) -> None:
    lay(state, {})
    # the preset's line has two sections of its own at least
    state.pages["Set speeds"].take(state.scenario.base)
    before = snapshot_of(state)
    (refusal,) = lay(state, {"set_speeds.sections": [{}]})
    assert refusal == "set_speeds: sections must be 2 to 12, not 1"
    assert snapshot_of(state) == before


def test_a_broken_scenario_leaves_the_shipped_one(state: Workbench) -> None:
    (refusal,) = lay(state, {"toml": "railjoule = 99", "load_percent": 30.0, "chosen": "fastest"})
    assert refusal.startswith("the scenario of the link: ")
    assert state.scenario.scenario() == Workbench().scenario.scenario()
    assert state.chosen == "fastest"


def test_a_snapshot_without_a_scenario_has_that_of_a_new_page(state: Workbench) -> None:
    state.scenario.choose("liashenko-i")
    lay(state, {"load_percent": 30.0})
    assert state.scenario.preset == Workbench().scenario.preset
    assert state.scenario.load_percent == 30.0
