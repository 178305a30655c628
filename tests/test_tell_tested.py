from collections import Counter

from tests.tell_tested import PART, text
from tests.trust.soak import Sample


def test_the_page_tells_what_was_found() -> None:
    trust = "| section | row | before | now | verdict |\n| 5 | a | b | c | good |\n| 6 | d | e | f | FAULT |\n"
    rows = [{"seed": 0, "strategy": "optimal", "status": "solved", "broken": [], "told": False, "energy_kwh": 1.0,
             "time_s": 2.0}]  # fmt: skip
    samples = [Sample(60.0 * k, 7 * k, 6, 100, 60.0, 80.0 + k, 300.0, 0, 900.0 + k, 52, 13, 0.1) for k in (1, 2)]
    told = text(trust, rows, range(20_000), samples, Counter({"core": 1200, "browser": 30}))
    assert "runs 1,230 tests" in told
    assert "| tests/core | 1,200 |" in told
    assert "1 of 2 rows are faulty" in told
    assert "120 minutes, 14 pages opened, 200 moves, 0 lost" in told
    assert "verdict: 1 of 20,000 scenarios, 1 calls: 0 not finite" in told


def test_the_count_of_tests_is_read_by_folder() -> None:
    told = "tests/core/scenario/test_line.py: 12\ntests/test_run.py: 3\n\nno tests ran in 0.1 s"
    assert [(one["part"], one["count"]) for one in PART.finditer(told)] == [("core", "12"), ("test", "3")]
