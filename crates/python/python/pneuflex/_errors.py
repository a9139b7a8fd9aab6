"""What can go wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._result import Result


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with what was given.

    Attributes
    ----------
    message
        What is wrong, with the allowed range.
    key
        The key that it is about, e.g. ``"actuator.gap"``.
    help
        What to do about it, e.g. the nearest name there is.
    file, line
        Where it stands.
    of_machine
        Whether it is about this machine (its memory, its cores, a folder) and not about what is to be solved.
    """

    message: str
    key: str | None = None
    help: str | None = None
    file: str | None = None
    line: int | None = None
    of_machine: bool = False


class InputError(ValueError):
    """What was given cannot be used. Says everything that is wrong at once; nothing was solved or written.

    Attributes
    ----------
    problems
        The same one by one.
    """

    problems: tuple[Problem, ...]

    def __init__(self, message: str, problems: tuple[Problem, ...] = ()) -> None:
        super().__init__(message)
        self.problems = problems or (Problem(message),)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.problems)

    @classmethod
    def _of(
        cls, problems: list[tuple[str, str, str | None, str | None, str | None, int | None, bool]]
    ) -> InputError:
        text = "\n".join(problem[0] for problem in problems)
        return cls(text, tuple(Problem(*problem[1:]) for problem in problems))


class NotConverged(RuntimeError):
    """The path of equilibria ended before the last pressure or time that was asked for.

    Attributes
    ----------
    result : Result
        What was reached, with the reason as :attr:`Result.reason`.
    advice : str
        What to try; empty if nothing is known that helps.
    """

    def __init__(self, message: str, result: Result) -> None:
        super().__init__(message)
        self.result = result
        reason = result.reason
        self.advice: str = reason["advice"] if reason else ""
        if self.advice:
            self.add_note(f"what to try: {self.advice}")

    def __reduce__(self) -> tuple[Any, ...]:
        # Results hold what cannot be sent to another process.
        return RuntimeError, (str(self),)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C: the run ended at its next iteration.

    Attributes
    ----------
    result : Result
        What was reached; :meth:`Result.resume` goes on.
    """

    def __init__(self, message: str, result: Result) -> None:
        super().__init__(message)
        self.result = result


def missing(package: str, what: str) -> ImportError:
    """The error of an optional package that is not installed."""
    return ImportError(f"{what} needs {package}: pip install {package}", name=package)
