from benchnav.text.plural import counted


def test_one_of_a_thing_is_singular():
    assert [counted(n, "world") for n in (0, 1, 2)] == ["0 worlds", "1 world", "2 worlds"]
