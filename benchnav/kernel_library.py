"""LLVM code of kernels: machine code is made only for those that Python calls.

A kernel within a kernel is linked into its callers as LLVM code. Numba makes machine code of it
too, which nothing runs, and which takes an eighth of a first compile.
"""

from importlib import import_module
from typing import Any

from llvmlite.binding import parse_bitcode

# Numba's annotations are incomplete, so its classes are imported as Any
JITCodeLibrary: Any = import_module("numba.core.codegen").JITCodeLibrary
Compiler: Any = import_module("numba.core.compiler").Compiler
lookup_environment: Any = import_module("numba.core.environment").lookup_environment
_ENVIRONMENT = "_ZN08NumbaEnv"  # the names of global variables of the constants of kernels


class InnerLibrary(JITCodeLibrary):  # type: ignore[misc]
    """The code of a kernel that only other kernels call."""

    @classmethod
    def from_bitcode(cls, codegen: Any, name: str, bitcode: bytes) -> "InnerLibrary":
        """Return the library that `serialize_using_object_code` stored."""
        library = cls(codegen, name)
        library._final_module = library._shared_module = parse_bitcode(bitcode)
        library._finalized = True
        return library

    @property
    def codegen(self) -> "InnerLibrary":
        """Itself, so that Numba calls its `set_env`."""
        return self

    def set_env(self, name: str, environment: object) -> None:
        """Do nothing: `OuterLibrary` sets the environments of all kernels that it contains."""

    def get_pointer_to_function(self, name: str) -> int:
        """Return that there is no machine code."""
        return 0

    def serialize_using_object_code(self) -> tuple[str, str, bytes]:
        """Return its name, its kind and its LLVM code."""
        return self.name, "inner", self._get_module_for_linking().as_bitcode()

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class OuterLibrary(JITCodeLibrary):  # type: ignore[misc]
    """The code of a kernel that Python calls, with that of all kernels that it calls."""

    def _finalize_specific(self) -> None:
        super()._finalize_specific()
        for variable in self._final_module.global_variables:
            if variable.name.startswith(_ENVIRONMENT):
                environment = lookup_environment(variable.name)
                if environment is not None:
                    self._codegen.set_env(variable.name, environment)


class InnerCompiler(Compiler):  # type: ignore[misc]
    """Compiles kernels for other kernels."""

    library_class: type = InnerLibrary

    def define_pipelines(self) -> Any:
        """Return Numba's pipelines, and let them fill a library of this kind."""
        state = self.state
        state.library = self.library_class(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return super().define_pipelines()


class OuterCompiler(InnerCompiler):
    """Compiles kernels for Python."""

    library_class = OuterLibrary
