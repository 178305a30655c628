from railjoule.dashboard.server.places import Places


def test_places_are_those_of_all_processes() -> None:
    shared = [0] * 4
    here = Places(5, lambda: (2, 1), shared, 0)
    there = Places(5, lambda: (1, 0), shared, 1)
    assert (here.taken, there.taken) == (3, 4)
    assert here.taken == 4
    assert here.has_one
    assert there.has_one


def test_a_page_answered_in_one_process_and_opened_in_another_takes_one_place() -> None:
    shared = [0] * 4
    answered = Places(2, lambda: (0, 1), shared, 0)
    opened = Places(2, lambda: (1, -1), shared, 1)
    answered.tell()
    opened.tell()
    assert answered.taken == opened.taken == 1


def test_a_connection_finds_the_place_that_was_kept_for_its_page_and_no_other() -> None:
    numbers = [2, 1]
    places = Places(2, lambda: (numbers[0], numbers[1]))
    assert places.has_one
    numbers[1] = 0
    assert not places.has_one
    numbers[0] = 1
    assert places.has_one


def test_without_a_limit_there_is_always_a_place() -> None:
    assert Places(None, lambda: (1000, 0)).has_one
