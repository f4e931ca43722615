"""What runs where the work is done: a chunk's points, with a model that is kept between chunks."""

from __future__ import annotations

import collections
import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import wait
from typing import Any

from ..errors import SweepError
from ..simulation import CompiledModel
from ..simulation.solvers import EXPLICIT, choose
from .block import Block
from .evaluate import Columns, evaluate
from .job import Job

# Models that a process keeps: of the sweeps that its workers take part in, the last few.
KEPT = 4


@dataclass(frozen=True, eq=False)
class Parcel:
    """A job as it travels: with each chunk, and opened once in a process.

    Attributes
    ----------
    token : str
        Tells jobs apart.
    data : bytes or None
        The pickled job; None where it stays in its process.
    job : Job or None
    watched : bool
        Whether a worker process ends with its parent.
    """

    token: str
    data: bytes | None = None
    job: Job | None = None
    watched: bool = False

    def opened(self) -> Job:
        """Return the job."""
        if self.job is not None:
            return self.job
        assert self.data is not None
        job: Job = pickle.loads(self.data)
        return job


def packed(job: Job, token: str, *, by_value: bool = False, watched: bool = False) -> Parcel:
    """Pickle a job.

    Parameters
    ----------
    job : Job
    token : str
    by_value : bool
        Send the code of functions too, where cloudpickle is there to do it; for
        workers that may not be able to import it.
    watched : bool

    Raises
    ------
    SweepError
        For a quantity or input that does not pickle.
    """
    try:
        if by_value:
            try:
                import cloudpickle

                return Parcel(token, cloudpickle.dumps(job), watched=watched)
            except ImportError:
                pass
        return Parcel(token, pickle.dumps(job), watched=watched)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise SweepError(
            f"this sweep cannot be sent to other processes: {error}; define functions at the top of "
            f"a module, or use executor='threads'"
        ) from None


def run_parcel(parcel: Parcel, columns: Columns) -> Block:
    """Run a chunk's points; what executors are given to do.

    Parameters
    ----------
    parcel : Parcel
    columns : mapping of str to (n,) array
        SI.

    Returns
    -------
    Block
    """
    if parcel.watched:
        end_with_parent()
    job, model = _kept(parcel)
    return evaluate(model, job, columns, _stopped)


def compiled(model: CompiledModel, job: Job) -> bool:
    """Whether runs are expected to be compiled C, which needs no Python."""
    if model.switched or job.options["backend"] == "vm":
        return False
    choice = choose(model, job.options["solver"], job.options["backend"])
    return choice.solver == EXPLICIT and model.modes.compiled()


def shareable(model: CompiledModel, job: Job) -> bool:
    """Whether threads may share a model: where no point can turn to an integrator of CasADi."""
    never_stiff = bool(model.contact_names) or job.options["solver"] == EXPLICIT
    return never_stiff and compiled(model, job)


_MODELS: collections.OrderedDict[tuple[str, int], tuple[Job, CompiledModel]] = (
    collections.OrderedDict()
)
_LOCK = threading.Lock()


def _kept(parcel: Parcel) -> tuple[Job, CompiledModel]:
    """Return a parcel's model, made on first use; a thread has its own where none can be shared."""
    thread = threading.get_ident()
    with _LOCK:
        for key in ((parcel.token, 0), (parcel.token, thread)):
            if key in _MODELS:
                _MODELS.move_to_end(key)
                return _MODELS[key]
        job = parcel.opened()
        model = CompiledModel(job.graph)
        key = (parcel.token, 0 if shareable(model, job) else thread)
        _MODELS[key] = job, model
        tokens = list(dict.fromkeys(token for token, _ in _MODELS))
        for old in [key for key in _MODELS if key[0] in tokens[:-KEPT]]:
            del _MODELS[old]
        return job, model


# ---------------------------------------------------------------------- worker processes

_STOP: list[Any] = []  # the event by which the parent calls off


def begin(stop: Any) -> None:
    """Set a worker process up: it leaves Ctrl-C to its parent and ends with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _STOP[:] = [stop]
    end_with_parent()


def ready() -> int:
    """Tell that a worker has begun."""
    return os.getpid()


def _stopped() -> bool:
    return bool(_STOP) and _STOP[0].is_set()


_WATCHED = threading.Event()


def end_with_parent() -> None:
    """End this process when its parent does, however that ends; asked again, do nothing."""
    parent = multiprocessing.parent_process()
    if parent is None or _WATCHED.is_set():
        return
    _WATCHED.set()

    def watch() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, name="parent", daemon=True).start()


def local_stop() -> tuple[Callable[[], None], Callable[[], bool]]:
    """Return how to call work in this process off, and how the work asks."""
    event = threading.Event()
    return event.set, event.is_set
