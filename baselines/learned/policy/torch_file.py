"""Read the tensors of a file that `torch.save` wrote, without torch and without unpickling.

The file is a zip archive: `data.pkl` describes a dict of tensors, and each storage is a file of
plain numbers. The pickle is split into its opcodes, and the few opcodes that such a dict needs are
interpreted here. Nothing in it is imported or called, so a file of a stranger can do no harm.
"""

import io
import math
import pickletools
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np

from benchnav.arrays import AnyArray

MAX_BYTES = 1 << 29  # of a file, and of each member that is read

_NUMBERS = {
    "torch FloatStorage": "<f4", "torch DoubleStorage": "<f8", "torch HalfStorage": "<f2",
    "torch LongStorage": "<i8", "torch IntStorage": "<i4", "torch BoolStorage": "|b1",
}  # fmt: skip
_MARK = object()
_VALUES = frozenset(
    {"BININT", "BININT1", "BININT2", "LONG1", "BINFLOAT", "BINUNICODE", "SHORT_BINUNICODE"}
)
_EMPTY: Mapping[str, type] = {"EMPTY_DICT": dict, "EMPTY_LIST": list, "EMPTY_TUPLE": tuple}
_CONSTANTS = {"NONE": None, "NEWTRUE": True, "NEWFALSE": False}
_TUPLES = {"TUPLE1": 1, "TUPLE2": 2, "TUPLE3": 3}


def member(archive: zipfile.ZipFile, name: str) -> bytes:
    """Return a file of an archive. Raises KeyError if it is missing, ValueError if too large."""
    if archive.getinfo(name).file_size > MAX_BYTES:
        raise ValueError(f"{name} must have at most {MAX_BYTES} bytes; it is larger")
    with archive.open(name) as file:
        return file.read(MAX_BYTES + 1)


def read_torch_tensors(data: bytes) -> dict[str, AnyArray]:
    """Return name → tensor of a dict of tensors in the format of `torch.save`.

    Raises ValueError or an error of the reader of archives for anything else.
    """
    archive = zipfile.ZipFile(io.BytesIO(data))
    pickles = [name for name in archive.namelist() if name.endswith("/data.pkl")]
    if not pickles:
        raise ValueError("it holds no data.pkl")
    content = _Reader(archive, pickles[0].removesuffix("data.pkl")).read()
    if not isinstance(content, dict):
        raise ValueError(f"it must hold a dict of tensors; it holds a {type(content).__name__}")
    return {str(name): value for name, value in content.items() if isinstance(value, np.ndarray)}


class _Global(str):
    """The name of a class or function, which is never imported."""


class _Reader:
    """Interprets the opcodes of one pickle."""

    def __init__(self, archive: zipfile.ZipFile, folder: str) -> None:
        self._archive, self._folder = archive, folder
        self._stack: list[Any] = []
        self._memo: dict[int, Any] = {}
        self._storages: dict[str, AnyArray] = {}

    def read(self) -> Any:
        pickled = member(self._archive, self._folder + "data.pkl")
        for opcode, argument, _ in pickletools.genops(pickled):
            self._execute(opcode.name, argument)
        return self._stack.pop()

    def _execute(self, name: str, argument: Any) -> None:
        stack, memo = self._stack, self._memo
        if name in _VALUES:
            stack.append(argument)
        elif name in _EMPTY:
            stack.append(_EMPTY[name]())
        elif name in _CONSTANTS:
            stack.append(_CONSTANTS[name])
        elif name in _TUPLES:
            count = _TUPLES[name]
            stack[-count:] = [tuple(stack[-count:])]
        elif name == "TUPLE":
            stack.append(tuple(self._from_mark()))
        elif name == "MARK":
            stack.append(_MARK)
        elif name == "GLOBAL":
            stack.append(_Global(argument))
        elif name in ("BINPUT", "LONG_BINPUT"):
            memo[argument] = stack[-1]
        elif name in ("BINGET", "LONG_BINGET"):
            stack.append(memo[argument])
        elif name == "BINPERSID":
            stack.append(self._storage(stack.pop()))
        elif name == "REDUCE":
            arguments = stack.pop()
            stack.append(_built(stack.pop(), arguments))
        elif name in ("SETITEM", "SETITEMS"):
            items = self._from_mark() if name == "SETITEMS" else [stack.pop(-2), stack.pop()]
            stack[-1].update(zip(items[::2], items[1::2], strict=True))
        elif name == "BUILD":
            stack.pop()  # attributes of the dict, such as versions of modules
        elif name not in ("PROTO", "STOP"):
            raise ValueError(f"tensors need no opcode {name}")

    def _from_mark(self) -> list[Any]:
        stack = self._stack
        first = len(stack) - 1 - next(k for k, v in enumerate(reversed(stack)) if v is _MARK)
        items = stack[first + 1 :]
        del stack[first:]
        return items

    def _storage(self, identity: Any) -> AnyArray:
        _, kind, key, _, _ = identity
        if str(kind) not in _NUMBERS:
            raise ValueError(f"it holds numbers of the unknown kind {str(kind)!r}")
        if key not in self._storages:
            numbers = member(self._archive, f"{self._folder}data/{key}")
            self._storages[key] = np.frombuffer(numbers, _NUMBERS[str(kind)])
        return self._storages[key]


def _built(function: Any, arguments: Any) -> Any:
    """Return the value of a call that the pickle describes, without calling the function."""
    if function == "collections OrderedDict":
        return {}
    if function == "torch._utils _rebuild_parameter":
        return arguments[0]
    if function == "torch._utils _rebuild_tensor_v2":
        storage, offset, shape, stride = arguments[:4]
        return _tensor(storage, offset, tuple(shape), tuple(stride))
    raise ValueError(f"tensors need no call of {str(function).replace(' ', '.', 1)}")


def _tensor(
    storage: AnyArray, offset: int, shape: tuple[int, ...], stride: tuple[int, ...]
) -> AnyArray:
    size = math.prod(shape)
    inner = [math.prod(shape[k + 1 :]) for k in range(len(shape))]
    strange = any(n > 1 and s != i for n, s, i in zip(shape, stride, inner, strict=True))
    if strange or min((offset, *shape)) < 0 or offset + size > len(storage):
        raise ValueError(f"a tensor of shape {shape} must lie in its storage without gaps")
    return storage[offset : offset + size].reshape(shape)
