"""Machine code only of what Python calls; whatever that calls in turn becomes part of it.

numba completes every function: optimised, translated, with wrappers for Python and for C. Equations and the
steps of an integrator are linked into what calls them and optimised there once more, with all around them;
completing them took almost half of the time of compilation. Here a function that is compiled for another
stays in LLVM's intermediate form, without wrappers, until somebody asks for an address in it. If Python
calls it after all, it is compiled anew, as numba would have.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from llvmlite import binding
from numba.core.caching import FunctionCache
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.dispatcher import Dispatcher, _FunctionCompiler  # type: ignore[attr-defined]
from numba.core.environment import lookup_environment
from numba.core.sigutils import normalize_signature

# Types are ignored where numba's own leave out what is private to it, or refuse that it is replaced.
_UNTRANSLATED = "untranslated"
_ENVIRONMENT = "_ZN08NumbaEnv"

_depth: ContextVar[int] = ContextVar("_depth", default=0)

_add_overload = Dispatcher.add_overload
_compile_for_args = Dispatcher._compile_for_args  # type: ignore[attr-defined]
_set_env = JITCPUCodegen.set_env
_index_key = FunctionCache._index_key


def translate_on_demand() -> None:
    """Have numba do so with whatever it compiles from now on."""
    JITCPUCodegen._library_class = OnDemand
    JITCPUCodegen.set_env = _set_env_if_there
    _FunctionCompiler._customize_flags = _without_wrappers
    FunctionCache._index_key = _key
    Dispatcher.add_overload = _add  # type: ignore[assignment, method-assign]
    Dispatcher._compile_for_args = _called_from_python  # type: ignore[attr-defined]


@contextmanager
def compiling(dispatcher: Any, sig: Any) -> Iterator[None]:
    """Within it other functions are compiled for this one."""
    argument_types = tuple(normalize_signature(sig)[0])
    before = _depth.set(_depth.get() + 1)
    found = dispatcher.overloads.get(argument_types)
    if found is not None and not _for_another() and not _callable(found.library):
        del dispatcher.overloads[argument_types]
    try:
        yield
    finally:
        _depth.reset(before)


class OnDemand(JITCodeLibrary):  # type: ignore[misc]
    """What a function and those linked into it are compiled to.

    `inlined`: always, by what calls it, so that it is optimised there alone. Others are optimised before: the
    size that they come to says whether they are inlined. `translated`: it has machine code.
    """

    inlined = translated = False

    def finalize(self) -> None:
        """Link what it calls. Nothing may be added any more."""
        self._raise_if_finalized()
        self.inlined = any(
            b"alwaysinline" in attributes
            for function in self.get_defined_functions()
            for attributes in function.attributes
        )
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        if not self.inlined:
            self._optimize_final_module()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """The address of a function; 0 if there is none of that name."""
        self._ensure_finalized()
        if not self.translated:
            defined = any(function.name == name for function in self.get_defined_functions())
            if not defined:
                return 0
            self._translate()
        address: int = super().get_pointer_to_function(name)
        return address

    def _translate(self) -> None:
        self.translated = True
        if self.inlined:
            self._optimize_final_module()
        self._final_module.verify()
        self._finalize_final_module()
        for variable in self._final_module.global_variables:
            if variable.name.startswith(_ENVIRONMENT):
                environment = lookup_environment(variable.name)
                if environment is not None:
                    self._codegen.set_env(variable.name, environment)

    def serialize_using_object_code(self) -> tuple[str, str, Any]:
        """What numba keeps on disk: machine code only where there is a use for it."""
        self._ensure_finalized()
        if not self.translated:
            if _for_another():
                return self.name, _UNTRANSLATED, self._get_module_for_linking().as_bitcode()
            self._translate()
        kept: tuple[str, str, Any] = super().serialize_using_object_code()
        return kept

    @classmethod
    def _unserialize(cls, codegen: Any, state: tuple[str, str, Any]) -> Any:
        name, kind, data = state
        if kind != _UNTRANSLATED:
            library = super()._unserialize(codegen, state)
            library.translated = True
            return library
        library = codegen.create_library(name)
        library._final_module = library._shared_module = binding.parse_bitcode(data)
        library._finalized = True
        return library


def _for_another() -> bool:
    """Whether what is compiled now is called by another function that is being compiled."""
    return _depth.get() > 1


def _callable(library: Any) -> bool:
    """Whether Python can call what is in it."""
    return getattr(library, "translated", True)


def _without_wrappers(compiler: Any, flags: Any) -> Any:
    flags.no_cpython_wrapper = flags.no_cfunc_wrapper = _for_another()
    return flags


def _add(dispatcher: Any, result: Any) -> None:
    """As numba, but Python does not find what it cannot call."""
    if _callable(result.library):
        _add_overload(dispatcher, result)
    else:
        dispatcher.overloads[tuple(result.signature.args)] = result


def _called_from_python(dispatcher: Any, *arguments: Any, **named: Any) -> Any:
    """As numba, even while something else is being compiled."""
    before = _depth.set(0)
    try:
        return _compile_for_args(dispatcher, *arguments, **named)
    finally:
        _depth.reset(before)


def _key(cache: Any, sig: Any, codegen: Any) -> Any:
    """What numba finds an overload by on disk, and whether it is machine code."""
    return *_index_key(cache, sig, codegen), _for_another()


def _set_env_if_there(codegen: Any, name: str, environment: Any) -> None:
    if codegen._engine.get_global_value_address(name):
        _set_env(codegen, name, environment)
