"""View: a running scene in a browser."""

from __future__ import annotations

import webbrowser
from types import TracebackType
from typing import Optional, Sequence, Type

from . import _arrays
from ._errors import InputTypeError, UsageError
from ._results import StepResult
from ._scene import Scene


class View:
    """Shows a running scene in a browser, step by step. The scene never waits for a page.

    The page shows boxes, pairs, events, octants and times of steps. It is served by threads of this process, on this machine only,
    and only to this user and root. Pages that read slowly get fewer frames. Boxes are copied so seldom that this takes at most a
    hundredth of the time. Of more than 200,000 objects, those with the first indices are drawn.

    Parameters
    ----------
    scene : Scene
        Stays in use until the view is closed.
    title : str
        Title of the page.
    names : sequence of str, optional
        Names of the objects by index.
    up : {"z", "y"}
        Axis that points up.
    unit : str
        Unit of length, for example "m".
    host : str
        Numeric address to listen on.
    port : int
        0: any free port.
    token : str
        Required for a `host` that other machines reach; at least 16 letters and digits.
    frames_per_second : float
        Most frames that are copied in a second.
    open_browser : bool
        True: opens the page in the browser.

    Examples
    --------
    >>> import numpy as np, octopair as op
    >>> scene = op.Scene()
    >>> ids = scene.add(op.generate("uniform", 100, seed=1))
    >>> with op.View(scene, title="dust") as view:
    ...     view.show(scene.step())
    ...     view.address.startswith("http://127.0.0.1:")
    True
    """

    def __init__(self, scene: Scene, *, title: str = "scene", names: Optional[Sequence[str]] = None, up: str = "z", unit: str = "",
                 host: str = "127.0.0.1", port: int = 0, token: str = "", frames_per_second: float = 30,
                 open_browser: bool = False) -> None:
        try:
            from . import _view
        except ImportError as error:
            raise UsageError(f"this octopair was built without the viewer: {error}") from error
        if not isinstance(scene, Scene):
            raise InputTypeError(f"scene: it must be an octopair.Scene, not {type(scene).__name__}")
        settings = {"title": _arrays.text(title, "title"), "names": [] if names is None else _arrays.texts(names, "names"),
                    "up": _arrays.text(up, "up"), "unit": _arrays.text(unit, "unit"), "margin": scene.margin,
                    "host": _arrays.text(host, "host"), "port": _arrays.whole(port, "port", 65535), "token": _arrays.text(token, "token"),
                    "frames_per_second": _arrays.real(frames_per_second, "frames_per_second")}
        self._view = _view.View(scene._scene, settings)
        scene._views.add(self)
        if open_browser:
            webbrowser.open(self.address)

    @property
    def address(self) -> str:
        """Address of the page."""
        return self._view.address()

    @property
    def pages(self) -> int:
        """Number of pages that are connected."""
        return self._view.pages()

    def show(self, step: StepResult, *, at_once: bool = False) -> None:
        """Shows the scene after a step: ``view.show(scene.step())``. Call it after each step, because it counts the events.

        Parameters
        ----------
        step : StepResult
            Result of the step.
        at_once : bool
            True: shows this step for certain, for example the last one before a pause. Otherwise steps are left out if they come faster
            than the view copies them.
        """
        self._view.show((step.began, step.ended), step.persisting, step.seconds, bool(at_once))

    def close(self) -> None:
        """Ends the server. Pages keep their last frame."""
        self._view.close()

    def __enter__(self) -> "View":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()
