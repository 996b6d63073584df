"""One line for each cause, with who is concerned and their number."""

from spectral_skylight.addon.grouping import grouped, some


def test_names_are_counted_and_some_are_named():
    assert some(["Wall"], "object") == "Wall"
    assert some(["Wall", "Wall"], "object") == "Wall"
    assert some(["Wall", "Roof"], "object") == "2 objects (Wall, Roof)"
    assert some(list("ABCDE"), "lamp") == "5 lamps (A, B, C …)"


def test_a_line_for_each_cause_in_their_order():
    found = [("A", "is glass"), ("B", "is hair"), *((f"C{k}", "is glass") for k in range(16))]
    assert grouped(found) == ["17 materials (A, C0, C1 …): is glass", "B: is hair"]
    assert grouped([]) == []
