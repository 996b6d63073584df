"""Long work as generators: driven to the end, as a part of other work, and ended on the way."""

import time

import pytest

from spectral_skylight.addon.commands.progress_bar import run_with_bar
from spectral_skylight.addon.progress import Progress, mapped, run, timed


class Work:
    """Three steps, and whether they were ended in order."""

    def __init__(self):
        self.ended = False

    def steps(self):
        try:
            for number in range(3):
                yield Progress(number / 3, f"number {number}")
            return "made"
        finally:
            self.ended = True


def half(progress):
    return Progress(progress.done / 2, f"half {progress.line}")


def test_work_is_done_and_returns_what_it_made():
    told = []
    assert run(Work().steps(), told.append) == "made" == run(Work().steps())
    assert [step.done for step in told] == [0.0, 1 / 3, 2 / 3]


def test_work_as_a_part_of_other_work():
    def whole():
        made = yield from mapped(Work().steps(), half)
        yield Progress(1.0, made)
        return made

    told = []
    assert run(whole(), told.append) == "made"
    assert [(step.done, step.line) for step in told] == [
        (0.0, "half number 0"),
        (1 / 6, "half number 1"),
        (1 / 3, "half number 2"),
        (1.0, "made"),
    ]


def test_whoever_closes_the_whole_closes_the_part():
    work = Work()
    part = work.steps()
    whole = mapped(part, half)
    next(whole)
    assert not work.ended
    whole.close()
    assert work.ended


def test_time_is_that_of_the_work_alone():
    def work():
        until = time.process_time() + 0.05
        while time.process_time() < until:
            pass
        yield Progress(0.5, "half")
        return "made"

    steps = timed(work())
    next(steps)
    until = time.process_time() + 0.2  # what others do meanwhile
    while time.process_time() < until:
        pass
    done, seconds = run(steps)
    assert done == "made" and 0.05 <= seconds < 0.15


def test_what_goes_wrong_in_the_part_reaches_the_whole():
    def broken():
        yield Progress(0.0, "")
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        run(mapped(broken(), half))


def test_a_bar_shows_it_and_goes(capsys):
    def slow():
        for step in Work().steps():
            time.sleep(0.15)  # a bar is drawn ten times a second at most
            yield step
        return "made"

    assert run_with_bar(slow(), "paint") == "made"
    assert "paint number 2" in capsys.readouterr().err
