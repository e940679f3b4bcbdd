"""libpolyrecon by ctypes: the functions of include/polyrecon/polyrecon.h, and errors as exceptions."""

from __future__ import annotations

import ctypes
import json
import os
import threading
from typing import Any, Callable, Optional

import numpy as np

Progress = Callable[[str, float], Optional[bool]]

FILE = "libpolyrecon.so.1"
USAGE = 2
OUT_OF_MEMORY = 33
INTERRUPTED = 130


class Error(Exception):
    """A failure, in one line that names the image, file or parameter.

    exit_code: that of the program `polyrecon` (docs/reference/exit_codes.md): 2 wrong use, 3 a damaged input or one
    that does not fit, 4 something is missing, 5 a file cannot be written, 6 the result failed a check, 33 too little
    memory.
    """

    def __init__(self, message: str, exit_code: int) -> None:
        super().__init__(message)
        self.exit_code = exit_code


class StoppedError(Error):
    """The progress function returned False."""


class _Image(ctypes.Structure):
    _fields_ = (
        ("data", ctypes.c_void_p),
        ("format", ctypes.c_int),
        ("width", ctypes.c_int),
        ("height", ctypes.c_int),
        ("channels", ctypes.c_int),
        ("channel_stride", ctypes.c_ssize_t),
        ("pixel_stride", ctypes.c_ssize_t),
        ("row_stride", ctypes.c_ssize_t),
    )


_PROGRESS = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_double)
_FORMATS = {np.dtype(np.float32): 1, np.dtype(np.float16): 2}


def library_path() -> str:
    """The file that is loaded: $POLYRECON_LIBRARY, else that of this package, else the system's."""
    packaged = os.path.join(os.path.dirname(os.path.abspath(__file__)), "lib", FILE)
    return os.environ.get("POLYRECON_LIBRARY") or (packaged if os.path.exists(packaged) else FILE)


def _load() -> ctypes.CDLL:
    try:
        library = ctypes.CDLL(library_path())
    except OSError as error:
        raise ImportError(
            f"libpolyrecon cannot be loaded ({error}); install the Debian package libpolyrecon1, or name "
            "the library in $POLYRECON_LIBRARY"
        ) from error
    handle, text, image = ctypes.c_void_p, ctypes.c_char_p, ctypes.POINTER(_Image)
    for name, result, arguments in (
        ("version", text, ()),
        ("new_filter", handle, (text,)),
        ("release_filter", None, (handle,)),
        ("get_error", ctypes.c_int, (handle, ctypes.POINTER(text))),
        ("set_image", ctypes.c_int, (handle, text, image)),
        ("set_text", ctypes.c_int, (handle, text, text)),
        ("set_number", ctypes.c_int, (handle, text, ctypes.c_double)),
        ("set_progress", ctypes.c_int, (handle, _PROGRESS, ctypes.c_void_p)),
        ("execute", ctypes.c_int, (handle,)),
        ("image_count", ctypes.c_int, (handle,)),
        ("image_name", text, (handle, ctypes.c_int)),
        ("describe_image", ctypes.c_int, (handle, text, image)),
        ("get_image", ctypes.c_int, (handle, text, image)),
        ("get_report", text, (handle,)),
    ):
        function = getattr(library, f"polyrecon_{name}")
        function.restype, function.argtypes = result, arguments
    return library


_LIBRARY = _load()


def version() -> str:
    return str(_LIBRARY.polyrecon_version().decode())


def _encoded(text: str | bytes) -> bytes:
    encoded = os.fsencode(text)
    if b"\0" in encoded:  # the library would take the text for one that ends there
        raise Error(f"{os.fsdecode(encoded)!r} contains a null character", USAGE)
    return encoded


def _described(array: np.ndarray) -> _Image:
    """An array of 3 dimensions as the library takes it."""
    height, width, channels = array.shape
    return _Image(
        array.ctypes.data, _FORMATS[array.dtype], width, height, channels, array.strides[2], array.strides[1],
        array.strides[0],
    )  # fmt: skip


def _start(function: Callable[[], None]) -> None:
    try:
        threading.Thread(target=function).start()
    except RuntimeError as error:
        raise Error(f"{error}: allow more threads (ulimit -u)", OUT_OF_MEMORY) from None


def _wait(finished: threading.Event, stop: threading.Event) -> None:
    """Waits for the end of the work. What interrupts it, however often, stops the work and is raised at its end.

    Thread.join would not do: before Python 3.13, a call that a KeyboardInterrupt has left makes the next one return at
    once.
    """
    try:
        finished.wait()
    except BaseException:
        stop.set()
        _wait(finished, stop)
        raise


class Filter:
    """A piece of work. The arrays of its images stay referenced until it is gone."""

    def __init__(self, kind: str) -> None:
        self._handle = ctypes.c_void_p(_LIBRARY.polyrecon_new_filter(kind.encode()))
        if not self._handle:
            raise Error(f"libpolyrecon {version()} has no filter '{kind}'", USAGE)
        self._arrays: dict[str, np.ndarray] = {}
        self._progress: Any = None

    def __del__(self) -> None:
        if handle := getattr(self, "_handle", None):
            _LIBRARY.polyrecon_release_filter(handle)

    def _check(self, code: int) -> None:
        if code == 0:
            return
        message = ctypes.c_char_p()
        _LIBRARY.polyrecon_get_error(self._handle, ctypes.byref(message))
        kind = StoppedError if code == INTERRUPTED else Error
        raise kind((message.value or b"").decode(errors="replace"), code)

    def set_image(self, name: str, array: np.ndarray) -> None:
        """array: (height, width, channels), float16 or float32."""
        self._arrays[name] = array
        self._check(_LIBRARY.polyrecon_set_image(self._handle, _encoded(name), ctypes.byref(_described(array))))

    def set(self, name: str, value: Any) -> None:
        """A text, a number, or a list of texts; None leaves the default."""
        if value is None:
            return
        if isinstance(value, (list, tuple)):
            for one in value:
                self.set(name, one)
        elif isinstance(value, (str, bytes, os.PathLike)):
            self._check(_LIBRARY.polyrecon_set_text(self._handle, _encoded(name), _encoded(os.fspath(value))))
        else:
            try:
                number = float(value)
            except (TypeError, ValueError, OverflowError) as error:
                raise Error(f"parameter '{name}': {error}", USAGE) from None
            self._check(_LIBRARY.polyrecon_set_number(self._handle, _encoded(name), number))

    def execute(self, progress: Progress | None = None) -> None:
        """Does the work in a thread of its own, so that this one can be interrupted from the keyboard."""
        stop, finished = threading.Event(), threading.Event()
        raised: list[BaseException] = []

        def report(_user: Any, phase: bytes, done: float) -> int:
            if progress is not None and not stop.is_set():
                try:
                    if progress(phase.decode(errors="replace"), done) is False:
                        stop.set()
                except BaseException as error:
                    raised.append(error)
                    stop.set()
            return 0 if stop.is_set() else 1

        self._progress = _PROGRESS(report)
        self._check(_LIBRARY.polyrecon_set_progress(self._handle, self._progress, None))
        codes: list[int] = []

        def work() -> None:
            # The thread refers to self, so filter, arrays and progress function exist until the library has returned.
            try:
                codes.append(_LIBRARY.polyrecon_execute(self._handle))
            finally:
                finished.set()

        _start(work)
        _wait(finished, stop)
        if raised:
            raise raised[0]
        self._check(codes[0])

    def image(self, name: str) -> np.ndarray:
        """A copy of an image that was made: (height, width, channels), float32."""
        size = _Image()
        self._check(_LIBRARY.polyrecon_describe_image(self._handle, _encoded(name), ctypes.byref(size)))
        array = np.empty((size.height, size.width, size.channels), np.float32)
        self._check(_LIBRARY.polyrecon_get_image(self._handle, _encoded(name), ctypes.byref(_described(array))))
        return array

    def images(self) -> dict[str, np.ndarray]:
        count = _LIBRARY.polyrecon_image_count(self._handle)
        names = [os.fsdecode(_LIBRARY.polyrecon_image_name(self._handle, index)) for index in range(count)]
        return {name: self.image(name) for name in names}

    def report(self) -> dict[str, Any]:
        report: dict[str, Any] = json.loads(_LIBRARY.polyrecon_get_report(self._handle))
        return report
