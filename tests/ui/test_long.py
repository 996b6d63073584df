"""Long work: progress in the status bar, Esc ends it, and whatever happens it leaves all tidy."""

from types import SimpleNamespace

import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.progress import Progress
from spectral_skylight.addon.ui import operator


class Window:
    """What an operator sees of a window: it notes what it is told."""

    def __init__(self):
        self.told = []
        self.window_manager = self.workspace = self
        self.window = object()

    def __getattr__(self, name):
        return lambda *values, **named: self.told.append((name, *values))


class Count(operator.Long):
    """Counts, or fails at a number."""

    doing = "Counting"

    def __init__(self, error=None):
        self.error, self.closed, self.reports, self.ended = error, False, [], None

    def report(self, levels, line):
        self.reports.append((*levels, line))

    def work(self, context):
        try:
            for k in range(3):
                if self.error and k == 1:
                    raise self.error
                yield Progress(k / 3, f"number {k}")
            return "counted"
        finally:
            self.closed = True

    def finish(self, context, done):
        self.ended = done
        return [("INFO", f"done: {done}")]


def event(kind):
    return SimpleNamespace(type=kind)


def names(window):
    return [name for name, *_ in window.told]


@pytest.fixture(autouse=True)
def one_step_a_look(monkeypatch):
    monkeypatch.setattr(operator, "SLICE", 1e-9)


def test_work_goes_on_between_events():
    count, window = Count(), Window()
    assert count.invoke(window, None) == {"RUNNING_MODAL"}
    for k in range(3):
        assert count.modal(window, event("MOUSEMOVE")) == {"RUNNING_MODAL"}
        assert count.modal(window, event("TIMER")) == {"RUNNING_MODAL"}
        text = f"Counting number {k}: {100 * k / 3:.0f} %. Press Esc to stop"
        assert window.told[-1] == ("status_text_set", text)
    assert count.modal(window, event("TIMER")) == {"FINISHED"}
    assert count.reports == [("INFO", "done: counted")]
    assert names(window)[-3:] == ["event_timer_remove", "progress_end", "status_text_set"]
    assert window.told[-1][1] is None


def test_Esc_ends_it():
    count, window = Count(), Window()
    count.invoke(window, None)
    count.modal(window, event("TIMER"))
    assert count.modal(window, event("ESC")) == {"FINISHED"}  # an undo step of what was done
    assert count.closed and count.ended is None
    assert names(window).count("progress_end") == 1


def test_bad_input_is_one_line():
    count, window = Count(InputError("sky.exr", "is no sky", "give one")), Window()
    count.invoke(window, None)
    count.modal(window, event("TIMER"))
    assert count.modal(window, event("TIMER")) == {"CANCELLED"}
    assert count.reports == [("ERROR", "sky.exr: is no sky; give one")]
    assert names(window).count("event_timer_remove") == 1


def test_a_mistake_of_ours_leaves_no_timer():
    count, window = Count(ZeroDivisionError()), Window()
    count.invoke(window, None)
    count.modal(window, event("TIMER"))
    with pytest.raises(ZeroDivisionError):
        count.modal(window, event("TIMER"))
    assert names(window).count("event_timer_remove") == 1


def test_a_script_gets_it_done_at_once():
    count = Count()
    assert count.execute(Window()) == {"FINISHED"}
    assert count.ended == "counted"
