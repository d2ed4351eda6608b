"""The page as those see it who write to it: trouble is a warning, and signals wait until it is written."""

import logging
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mlflow import MlflowClient

from flexsurr.tracking.store import Store, shown, warn

log = logging.getLogger(__name__)


class Page:
    """A client whose trouble is a warning: after it, the page is left alone until `insist`."""

    def __init__(self, store: Store | None) -> None:
        self._store = store
        self._client: MlflowClient | None = None
        self._connect()

    @property
    def is_reachable(self) -> bool:
        """Whether there is a store, and no trouble with it so far."""
        return self._client is not None

    def attempt(self, action: Callable[[MlflowClient, Store], Any]) -> Any:
        """The result of `action`; None where there is no store, or trouble now, or has been.

        Signals wait: one that breaks into a write leaves the database locked until the process has ended.
        """
        if self._client is None or self._store is None:
            return None
        try:
            with signals_wait():
                return action(self._client, self._store)
        # The database may be deleted, locked or full, the server away: nothing of it is worth a result.
        except Exception as error:
            warn(f"trouble with {self._store.uri}", error)
            self._client = None
            return None

    def insist(self, action: Callable[[MlflowClient, Store], Any]) -> Any:
        """`attempt`, once more after trouble with a file, even this one; a server is not waited for twice."""
        result = self.attempt(action)
        if self._client is None and self._store is not None and self._store.uri.startswith("sqlite:"):
            self._connect()
            result = self.attempt(action)
        return result

    def _connect(self) -> None:
        if self._store is None:
            return
        uri = self._store.uri
        path = Path(uri.removeprefix("sqlite:///"))
        if uri.startswith("sqlite:///") and not path.is_file():
            # Creating it here could meet another process that does the same, and ruin it.
            log.warning("tracking: %s is gone; results are made without it", path)
            return
        if not self._store.experiments:
            log.warning("tracking: %s was out of reach at the start; results are made without it", shown(uri))
            return
        try:
            self._client = MlflowClient(uri)
        except Exception as error:  # as above
            warn(f"{uri} is out of reach", error)


@contextmanager
def signals_wait() -> Iterator[None]:
    """Heed SIGTERM and Ctrl-C after the block: either in the middle would leave a run RUNNING for ever.

    Blocks may stand in one another; the outermost raises what came.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # signals are the main thread's, and only it may say what they do
        return
    came: list[int] = []
    before = {
        waiting: signal.signal(waiting, lambda number, frame: came.append(number))
        for waiting in (signal.SIGTERM, signal.SIGINT)
    }
    try:
        yield
    finally:
        for waiting, handler in before.items():
            signal.signal(waiting, handler)
        for number in came:
            signal.raise_signal(number)
