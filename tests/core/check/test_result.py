import numpy as np

from railjoule.core.check.result import Check, CheckResult, find_largest

GOOD, BAD = Check("a", 1e-9, 1e-6, None, "one"), Check("b", 0.02, 1e-6, 350.0, "the limit")
WORSE = Check("c", 0.5, 1e-9, None, "the line")


def test_the_verdict_names_the_worst():
    assert CheckResult((GOOD, GOOD), ()).verdict == "The run keeps all 2 rules that were checked."
    assert CheckResult((GOOD, BAD), ()).verdict == (
        "The run breaks 1 of 2 rules, worst of all 'b': by 0.02 of the limit at 350.0 m, where 1e-06 is permitted."
    )
    assert [check.name for check in CheckResult((BAD, GOOD, WORSE), ()).broken] == ["c", "b"]


def test_the_largest_deviation_has_its_place():
    check = find_largest("a", "one", 0.1, np.array([-1.0, 0.3, 0.2]), np.array([5.0, 6.0, 7.0]))
    assert (check.largest, check.at_m, check.ok) == (0.3, 6.0, False)


def test_a_rule_that_is_kept_everywhere_has_neither():
    check = find_largest("a", "one", 0.0, np.array([-1.0, -0.3]), np.array([5.0, 6.0]))
    assert (check.largest, check.at_m, check.ok) == (0.0, None, True)
    assert find_largest("a", "one", 0.0, np.zeros(0)).ok


def test_what_is_no_number_breaks_a_rule():
    assert not find_largest("a", "one", 1e9, np.array([0.0, np.nan])).ok
