import pytest

from railjoule import core
from railjoule.core import RailjouleError


@pytest.mark.parametrize("name", [name for name in core.__all__ if name.endswith("Error")])
def test_every_error_can_be_caught_as_one_kind(name):
    assert issubclass(getattr(core, name), RailjouleError)
