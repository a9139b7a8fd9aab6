"""What a run says on its way."""

from __future__ import annotations

import sys
import time
from typing import TextIO


class Progress:
    """One line that is written over and over: how far the run is, its iterations, its time."""

    def __init__(self, end: float, unit: str, stream: TextIO | None = None) -> None:
        self.stream = stream or sys.stderr
        self.end, self.unit = end, unit
        self.began = time.monotonic()
        self.iterations = 0
        self.last = 0.0
        self.width = 0

    def iteration(self, parameter: float, step: int, iteration: int) -> None:
        """Told of every iteration."""
        self.iterations += 1
        now = time.monotonic()
        if now - self.last < 0.1:
            return
        self.last = now
        spent = now - self.began
        self.write(f"{parameter:.4g} of {self.end:.4g}{self.unit}, {self.iterations} iterations, {spent:.0f} s")

    def write(self, line: str) -> None:
        self.stream.write("\r" + line.ljust(self.width))
        self.stream.flush()
        self.width = len(line)

    def finish(self, words: str) -> None:
        """Told at the end."""
        self.write(f"{words}: {self.iterations} iterations in {time.monotonic() - self.began:.1f} s")
        self.stream.write("\n")
        self.stream.flush()
