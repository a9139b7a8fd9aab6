"""Worker processes of this machine."""

from __future__ import annotations

import os
import queue
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from ._worker import receive, send

ATTEMPTS = 3
"""How often a task is tried whose worker dies."""


class WorkerDied(RuntimeError):
    """The worker died each time the design was tried: it was killed, or there was not enough memory."""


class Processes(Executor):
    """Processes that solve designs, one at a time each. A worker that dies is replaced, and its task tried again; nobody else notices.

    They are no `multiprocessing` processes: these would run the caller's script once more, and break all together when one is killed.
    """

    def __init__(self, workers: int) -> None:
        self._tasks: queue.SimpleQueue[tuple[Future[Any], tuple[Any, ...]] | None] = queue.SimpleQueue()
        self._workers: list[subprocess.Popen[bytes] | None] = [None] * workers
        self._is_closed = False
        self._threads = [threading.Thread(target=self._serve, args=(i,), daemon=True) for i in range(workers)]
        for thread in self._threads:
            thread.start()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Takes a task; `fn` is :func:`pneuflex._worker.solve_design`, which is what workers do."""
        future: Future[Any] = Future()
        self._tasks.put((future, args))
        return future

    @property
    def pids(self) -> list[int]:
        """Of the workers that are there."""
        return [worker.pid for worker in self._workers if worker is not None and worker.poll() is None]

    def _worker(self, index: int) -> subprocess.Popen[bytes]:
        worker = self._workers[index]
        if worker is None or worker.poll() is not None:
            package = str(Path(__file__).parents[1])
            code = f"import sys; sys.path.insert(0, {package!r}); from pneuflex._worker import main; main()"
            worker = subprocess.Popen(
                [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
            )
            self._workers[index] = worker
        return worker

    def _serve(self, index: int) -> None:
        while (taken := self._tasks.get()) is not None:
            future, args = taken
            if self._is_closed or not future.set_running_or_notify_cancel():
                continue
            for attempt in range(ATTEMPTS):
                try:
                    worker = self._worker(index)
                    assert worker.stdin is not None and worker.stdout is not None
                    send(worker.stdin, args[0])
                    future.set_result(receive(worker.stdout))
                    break
                except (EOFError, OSError):
                    self._end(index)
                    if self._is_closed or attempt + 1 == ATTEMPTS:
                        words = f"its worker process died {attempt + 1} times: it was killed, or there was not enough memory"
                        future.set_exception(WorkerDied(words))
                        break
                except Exception as error:  # noqa: BLE001 — whoever waits must hear of it
                    self._end(index)
                    future.set_exception(error)
                    break
        self._end(index)

    def _end(self, index: int) -> None:
        worker, self._workers[index] = self._workers[index], None
        if worker is None:
            return
        for stream in (worker.stdin, worker.stdout):
            try:
                if stream is not None:
                    stream.close()
            except OSError:
                pass
        worker.kill()
        worker.wait()

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Ends the workers; with `cancel_futures` in the middle of what they do."""
        if cancel_futures:
            self._is_closed = True
            for worker in list(self._workers):
                if worker is not None:
                    worker.kill()
        for _ in self._threads:
            self._tasks.put(None)
        if wait:
            for thread in self._threads:
                thread.join()


def cores() -> int:
    """Cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1
