"""Lets the memory of NumPy's arrays run out, through NumPy's interface for data managers (NEP 49)."""
import contextlib
import ctypes

import numpy as np

_libc = ctypes.CDLL(None)
for _name, _result, _arguments in (("malloc", ctypes.c_void_p, [ctypes.c_size_t]), ("calloc", ctypes.c_void_p, [ctypes.c_size_t] * 2),
                                   ("realloc", ctypes.c_void_p, [ctypes.c_void_p, ctypes.c_size_t]), ("free", None, [ctypes.c_void_p])):
    getattr(_libc, _name).restype, getattr(_libc, _name).argtypes = _result, _arguments

_remaining = None  # number of arrays that get memory; None: all


def _has_room():
    global _remaining
    if _remaining is None:
        return True
    _remaining -= 1
    return _remaining >= 0


_Malloc = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
_Calloc = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t)
_Realloc = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
_Free = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)


class _Handler(ctypes.Structure):
    """PyDataMem_Handler."""
    _fields_ = [("name", ctypes.c_char * 127), ("version", ctypes.c_uint8), ("context", ctypes.c_void_p), ("malloc", _Malloc),
                ("calloc", _Calloc), ("realloc", _Realloc), ("free", _Free)]


_handler = _Handler(b"failing", 1, None, _Malloc(lambda _, size: _libc.malloc(size) if _has_room() else None),
                    _Calloc(lambda _, count, size: _libc.calloc(count, size) if _has_room() else None),
                    _Realloc(lambda _, memory, size: _libc.realloc(memory, size) if _has_room() else None),
                    _Free(lambda _, memory, size: _libc.free(memory)))
_handler_name = ctypes.create_string_buffer(b"mem_handler")  # a capsule keeps the address


def _capsule_function(name, result, *arguments):
    return ctypes.PYFUNCTYPE(result, *arguments)((name, ctypes.pythonapi))


_new_capsule = _capsule_function("PyCapsule_New", ctypes.py_object, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
_pointer_of = _capsule_function("PyCapsule_GetPointer", ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)
_numpy = np._core if hasattr(np, "_core") else np.core  # NumPy 2 has renamed it
_functions = ctypes.cast(_pointer_of(_numpy._multiarray_umath._ARRAY_API, None), ctypes.POINTER(ctypes.c_void_p))
_set_handler = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.py_object)(_functions[304])  # PyDataMem_SetHandler
_capsule = _new_capsule(ctypes.addressof(_handler), ctypes.addressof(_handler_name), None)


@contextlib.contextmanager
def room_for(arrays):
    """Within this context, the first `arrays` arrays get memory, and no others. Those must not outlive this module."""
    global _remaining
    former = _set_handler(_capsule)
    _remaining = arrays
    try:
        yield
    finally:
        _remaining = None
        _set_handler(former)
