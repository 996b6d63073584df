"""The one exception for input that a user can mend."""


class InputError(ValueError):
    """Bad input: one line that names the file, the place in it and the cure."""

    def __init__(self, place: object, problem: str, cure: str) -> None:
        self.problem = problem
        super().__init__(f"{place}: {problem}; {cure}".replace("\n", " "))
