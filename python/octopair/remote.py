"""Servers: engines, detached jobs and scenes of ``octopair serve``. The part of octopair that needs gRPC."""

from __future__ import annotations

import dataclasses
from typing import Any, Dict, List, Optional

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from . import _arrays, _core
from ._errors import Error, UsageError, make
from ._options import Order, PathLike, call_options
from ._progress import Progress, reporter
from ._results import JobResult, Summary, html_table
from ._scene import SceneCalls

try:
    from . import _remote
except ImportError as error:
    raise UsageError(f"this octopair has no connections to servers: {error}") from error

__all__ = ["JobClient", "JobStatus", "RemoteScene", "client_options"]


def client_options(*, token: str = "", server_user: str = "", token_in_clear: bool = False, owner: str = "",
                   authority: PathLike = "", certificate: PathLike = "", key: PathLike = "", tls: bool = False,
                   connect_timeout: float = 5, patience: float = 30) -> Dict[str, Any]:
    """Returns the options of a connection. All functions that take an address take these options.

    Parameters
    ----------
    token : str
        One of the server's tokens. Sent only over encrypted connections, and over Unix sockets where no other user can listen.
    server_user : str
        User that runs the server at a Unix socket, if it is neither this user nor root.
    token_in_clear : bool
        True: the token is also sent to loopback addresses without encryption.
    owner : str
        For operators: owner of the jobs that calls name.
    authority : path
        PEM file of a certificate authority; then the connection is encrypted.
    certificate, key : path
        PEM files of this client's certificate and private key.
    tls : bool
        True: the connection is encrypted, and the system's trusted authorities count.
    connect_timeout : float
        Longest wait for the first connection, in seconds.
    patience : float
        Longest later outage of the server, in seconds.
    """
    for name, value in {"token": token, "server_user": server_user, "owner": owner}.items():
        _arrays.text(value, name)
    return {"token": token, "server_user": server_user, "token_in_clear": bool(token_in_clear), "owner": owner, "authority": str(authority),
            "certificate": str(certificate), "key": str(key), "tls": bool(tls), "connect_timeout": _arrays.real(connect_timeout, "connect_timeout"),
            "patience": _arrays.real(patience, "patience")}


def _connect(address: str, client: Dict[str, Any]) -> _core.Engine:
    return _remote.connect(address, client)


@dataclasses.dataclass(frozen=True)
class JobStatus:
    """State of a job on a server.

    Attributes
    ----------
    id : str
        UUID.
    state : str
        ``"queued"``, ``"running"``, ``"done"``, ``"failed"`` or ``"cancelled"``.
    detached : bool
        False: a job of a direct call.
    count_only : bool
        True: pairs are only counted.
    progress : float
        Fraction of the work that is done.
    queued_before : int
        Number of jobs that run before this one.
    objects : int
        Number of objects.
    summary : Summary
        Valid if the job is done.
    error : Error or None
        Set if the job failed.
    owner : str
        Name of the client that submitted the job; empty: this client.
    waits_for_room : bool
        The job is queued until the server's disk has room for its result.
    """

    id: str
    state: str
    detached: bool
    count_only: bool
    progress: float
    queued_before: int
    objects: int
    summary: Summary
    error: Optional[Error]
    owner: str
    waits_for_room: bool

    @property
    def ended(self) -> bool:
        """True if the job is done, failed or cancelled."""
        return self.state not in ("queued", "running")

    @classmethod
    def _of(cls, row: Dict[str, Any]) -> "JobStatus":
        error = None if row["error"] is None else make(*row["error"])
        values: Dict[str, Any] = {**row, "summary": Summary._of(row["summary"]), "error": error}
        return cls(**values)

    def _repr_html_(self) -> str:
        return html_table("job", [("id", self.id), ("state", self.state), ("progress", f"{self.progress:.0%}"),
                                  ("objects", f"{self.objects:,}")])


class JobClient:
    """Submits detached jobs to a server (``octopair serve --state DIR``) and collects their results later, from any machine.

    A submitted job is on the server's disk: it completes even if this process ends or the server restarts. Thread safety: several threads
    may use a client at once.

    Parameters
    ----------
    address : str
        ``"unix:PATH"`` or ``"HOST:PORT"``.
    token, server_user, token_in_clear, owner, authority, certificate, key, tls, connect_timeout, patience
        Options of the connection: :func:`client_options`.
    """

    def __init__(self, address: str, *, token: str = "", server_user: str = "", token_in_clear: bool = False,
                 owner: str = "", authority: PathLike = "", certificate: PathLike = "", key: PathLike = "", tls: bool = False,
                 connect_timeout: float = 5, patience: float = 30) -> None:
        client = client_options(token=token, server_user=server_user, token_in_clear=token_in_clear, owner=owner, authority=authority,
                                certificate=certificate, key=key, tls=tls, connect_timeout=connect_timeout, patience=patience)
        self._address = _arrays.text(address, "address")
        self._client = _remote.JobClient(address, client)

    def submit(self, boxes: ArrayLike, against: Optional[ArrayLike] = None, *, margin: float = 0, order: Order = "ascending",
               padding: Optional[ArrayLike] = None, against_padding: Optional[ArrayLike] = None, limit: Optional[int] = None,
               count_only: bool = False, id: str = "", progress: Progress = None, copy: bool = False) -> str:
        """Stores a job on the server and returns its id. If a job with this id exists, no second job is made.

        Parameters are those of :func:`octopair.find_pairs`, and:

        Parameters
        ----------
        count_only : bool
            True: counts the pairs and stores none.
        id : str
            Lower-case UUID. Default: a random one.
        progress : callable or bool
            Progress of the upload.
        """
        data = _core.Input(*_arrays.join_input(boxes, against, (padding, against_padding), copy))
        with reporter(progress) as report:
            return self._client.submit(data, call_options(margin, order, limit), (id, bool(count_only), report))

    def status(self, id: str) -> JobStatus:
        """Returns the state of a job."""
        return JobStatus._of(self._client.status(id))

    def wait(self, id: str, timeout: float = 1e9) -> JobStatus:
        """Waits until the job has ended, at most `timeout` seconds, and returns its state."""
        return JobStatus._of(self._client.wait(id, min(float(timeout), 1e9)))

    def cancel(self, id: str) -> JobStatus:
        """Cancels a job, waits at most 10 s until it has ended, and returns its state."""
        return JobStatus._of(self._client.cancel(id))

    def release(self, id: str) -> None:
        """Deletes a job that has ended, and its result."""
        self._client.release(id)

    def list(self) -> List[JobStatus]:
        """Returns the states of all jobs that this client sees."""
        return [JobStatus._of(row) for row in self._client.list()]

    def drain(self) -> None:
        """Starts the shutdown of the server. Requires the role operator."""
        self._client.drain()

    def result(self, id: str, *, progress: Progress = None) -> JobResult:
        """Waits for the job and returns its pairs and summary. The result stays on the server. Raises the job's error if it failed."""
        with reporter(progress) as report:
            pairs, summary = self._client.result(id, report)
        return JobResult(pairs, Summary._of(summary))

    def __repr__(self) -> str:
        return f"JobClient({self._address!r})"


class RemoteScene(SceneCalls):
    """A scene on a server. Calls and results are those of :class:`octopair.Scene`, without queries.

    Only :meth:`step` uses the network.

    Parameters
    ----------
    address : str
        ``"unix:PATH"`` or ``"HOST:PORT"``.
    margin : float
        Largest gap, per axis, at which a pair counts.
    dtype : {"float32", "float64"}
        dtype of the boxes.
    token, server_user, token_in_clear, owner, authority, certificate, key, tls, connect_timeout, patience
        Options of the connection: :func:`client_options`.
    """

    def __init__(self, address: str, *, margin: float = 0, dtype: DTypeLike = "float32", token: str = "", server_user: str = "",
                 token_in_clear: bool = False, owner: str = "", authority: PathLike = "", certificate: PathLike = "",
                 key: PathLike = "", tls: bool = False, connect_timeout: float = 5, patience: float = 30) -> None:
        client = client_options(token=token, server_user=server_user, token_in_clear=token_in_clear, owner=owner, authority=authority,
                                certificate=certificate, key=key, tls=tls, connect_timeout=connect_timeout, patience=patience)
        self._start(margin, dtype)
        self._scene = _remote.Scene(_arrays.text(address, "address"), (self._dtype == np.float64, self._margin), client)
