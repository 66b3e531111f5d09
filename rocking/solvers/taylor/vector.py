"""Vectors of doubles for compiled code: one number for each of several runs that are carried side by side.

A `Lanes` value in a numba function is one LLVM vector, so an operation on it is an instruction or two for all runs at
once; a `Mask` holds a truth value for each.  `emitted` turns a Python function of such numbers into compiled code by
running it once, at compile time, on symbols: loops over the order of a series are thereby written out.

Status   the fused multiply-add and every other operation is asked for by name, and none mixes lanes: what a run gives
         does not depend on its neighbours, nor on the width of the processor's registers.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

LANES = 16
"""Runs side by side: two registers of eight where the processor has those, so that one's latency hides the other's."""

DOUBLE, BIT, INT, INT32 = ir.DoubleType(), ir.IntType(1), ir.IntType(64), ir.IntType(32)
DOUBLES, BITS, INTS = (ir.VectorType(kind, LANES) for kind in (DOUBLE, BIT, INT))


class LanesType(types.Type):
    """A double for each lane."""

    def __init__(self) -> None:
        super().__init__(name=f"Lanes({LANES})")


class MaskType(types.Type):
    """A truth value for each lane."""

    def __init__(self) -> None:
        super().__init__(name=f"Mask({LANES})")


lanes_type, mask_type = LanesType(), MaskType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, DOUBLES)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, BITS)


class Term:
    """A symbol for a value of the code being built; arithmetic and comparison emit instructions."""

    def __init__(self, builder: Any, value: Any) -> None:
        self.builder, self.value = builder, value

    def _with(self, name: str, other: Any) -> Any:
        return Term(self.builder, getattr(self.builder, name)(self.value, self.like(other).value))

    def _compared(self, sign: str, other: Any) -> Any:
        return Term(self.builder, self.builder.fcmp_ordered(sign, self.value, self.like(other).value))

    def like(self, other: Any) -> Term:
        """`other`, a Term or a number, in every lane."""
        return other if isinstance(other, Term) else Term(self.builder, ir.Constant(DOUBLES, [float(other)] * LANES))

    def __add__(self, other: Any) -> Any:
        return self._with("fadd", other)

    def __sub__(self, other: Any) -> Any:
        return self._with("fsub", other)

    def __mul__(self, other: Any) -> Any:
        return self._with("fmul", other)

    def __truediv__(self, other: Any) -> Any:
        return self._with("fdiv", other)

    def __radd__(self, other: Any) -> Any:
        return self.like(other) + self

    def __rsub__(self, other: Any) -> Any:
        return self.like(other) - self

    def __rmul__(self, other: Any) -> Any:
        return self.like(other) * self

    def __rtruediv__(self, other: Any) -> Any:
        return self.like(other) / self

    def __neg__(self) -> Any:
        return Term(self.builder, self.builder.fneg(self.value))

    def __lt__(self, other: Any) -> Any:
        return self._compared("<", other)

    def __le__(self, other: Any) -> Any:
        return self._compared("<=", other)

    def __gt__(self, other: Any) -> Any:
        return self._compared(">", other)

    def __ge__(self, other: Any) -> Any:
        return self._compared(">=", other)

    def __and__(self, other: Any) -> Any:
        return self._with("and_", other)

    def __or__(self, other: Any) -> Any:
        return self._with("or_", other)

    def __invert__(self) -> Any:
        return Term(self.builder, self.builder.not_(self.value))


def _called(name: str, *terms: Term) -> Term:
    """The LLVM intrinsic of that name on vectors of doubles."""
    builder = terms[0].builder
    kind = ir.FunctionType(DOUBLES, [DOUBLES] * len(terms))
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{LANES}f64")
    return Term(builder, builder.call(function, [term.value for term in terms]))


def fma_of(a: Any, b: Any, c: Any) -> Any:
    """a b + c, rounded once."""
    term = next(x for x in (a, b, c) if isinstance(x, Term))
    return _called("fma", term.like(a), term.like(b), term.like(c))


def where_of(mask: Any, a: Any, b: Any) -> Any:
    """a where the mask holds, else b."""
    term = next(x for x in (a, b) if isinstance(x, Term))
    return Term(mask.builder, mask.builder.select(mask.value, term.like(a).value, term.like(b).value))


def least_of(a: Any, b: Any) -> Any:
    """The lesser of the two."""
    return where_of(a < b, a, b)


def most_of(a: Any, b: Any) -> Any:
    """The greater of the two."""
    return where_of(a > b, a, b)


def size_of(a: Term) -> Term:
    """|a|."""
    return _called("fabs", a)


def root_of(a: Term) -> Term:
    """Square root."""
    return _called("sqrt", a)


def _symbol(builder: Any, value: Any, kind: Any) -> Any:
    """Term, or tuple of Terms, for an argument; a plain number is put into every lane."""
    if isinstance(kind, types.BaseTuple):
        kinds: Any = kind
        parts = cgutils.unpack_tuple(builder, value, len(kinds))
        return tuple(_symbol(builder, part, own) for part, own in zip(parts, kinds, strict=True))
    if kind in (lanes_type, mask_type):
        return Term(builder, value)
    if isinstance(kind, types.NoneType):
        return None
    if isinstance(kind, types.Integer):
        value = builder.sitofp(value, DOUBLE)
    empty = ir.Constant(DOUBLES, ir.Undefined)
    first = builder.insert_element(empty, value, ir.Constant(INT32, 0))
    return Term(builder, builder.shuffle_vector(first, empty, ir.Constant(ir.VectorType(INT32, LANES), [0] * LANES)))


def _lowered(rule: Any) -> Callable[..., Any]:
    """Code generation by running `rule` on symbols."""

    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        out = rule(*(_symbol(builder, value, kind) for value, kind in zip(args, sig.args, strict=True)))
        if isinstance(out, tuple):
            return context.make_tuple(builder, sig.return_type, [term.value for term in out])
        return out.value

    return lowered


def _register(name: Any, result: Callable[..., Any]) -> None:
    """Tell numba that `name` may be called, and the type of what it gives; None for arguments that are not ours."""

    def generic(self: Any, args: Any, kws: Any) -> Any:
        kind = result(*args)
        return None if kind is None else signature(kind, *args)

    template = type("Template", (AbstractTemplate,), {"generic": generic, "key": name})
    infer_global(name, types.Function(template))


def emitted(result: Any) -> Callable[[Any], Any]:
    """Compiled code may call the function below, which runs on symbols at compile time.

    result: the type of what it returns, or a function that gives it from the types of the arguments.
    """

    def register(rule: Any) -> Any:
        _register(rule, result if not isinstance(result, types.Type) else lambda *args: result)
        lower_builtin(rule, types.VarArg(types.Any))(_lowered(rule))
        return rule

    return register


def _operator(name: Any, result: Any) -> None:
    """Let an operator act on lanes, and on lanes and plain numbers."""

    def kind(*args: Any) -> Any:
        return result if any(a in (lanes_type, mask_type) for a in args) else None

    _register(name, kind)
    one, other, number = LanesType, MaskType, types.Number
    for pattern in ((one,), (other,), (one, one), (other, other), (one, number), (number, one)):
        lower_builtin(name, *pattern)(_lowered(name))


for _name in ("add", "sub", "mul", "truediv", "neg"):
    _operator(getattr(operator, _name), lanes_type)
for _name in ("lt", "le", "gt", "ge", "and_", "or_", "invert"):
    _operator(getattr(operator, _name), mask_type)

fma = emitted(lanes_type)(fma_of)
where = emitted(lanes_type)(where_of)
least = emitted(lanes_type)(least_of)
most = emitted(lanes_type)(most_of)
size = emitted(lanes_type)(size_of)


def _place(context: Any, builder: Any, kind: Any, table: Any, row: Any) -> Any:
    """Pointer to a row of LANES doubles of a table of shape (row, LANES)."""
    data = context.make_array(kind)(context, builder, table).data
    return builder.bitcast(builder.gep(data, [builder.mul(row, row.type(LANES))]), DOUBLES.as_pointer())


def _load(typing_context, table, row):
    """The lanes in a row of a table of shape (row, LANES)."""

    def codegen(context, builder, sig, args):
        return builder.load(_place(context, builder, sig.args[0], *args), align=8)

    return lanes_type(table, types.int64), codegen


def _store(typing_context, table, row, value):
    """Put lanes into a row of a table of shape (row, LANES)."""

    def codegen(context, builder, sig, args):
        builder.store(args[2], _place(context, builder, sig.args[0], *args[:2]), align=8)
        return context.get_dummy_value()

    return types.void(table, types.int64, value), codegen


def _gather(typing_context, values, index):
    """values[index] in each lane; the indices are whole and in range."""

    def codegen(context, builder, sig, args):
        first = context.make_array(sig.args[0])(context, builder, args[0]).data
        empty = ir.Constant(INTS, ir.Undefined)
        base = builder.insert_element(empty, builder.ptrtoint(first, INT), INT32(0))
        base = builder.shuffle_vector(base, empty, ir.Constant(ir.VectorType(INT32, LANES), [0] * LANES))
        offset = builder.shl(builder.fptosi(args[1], INTS), ir.Constant(INTS, [3] * LANES))
        places = ir.VectorType(DOUBLE.as_pointer(), LANES)
        kind = ir.FunctionType(DOUBLES, [places, INT32, BITS, DOUBLES])
        name = f"llvm.masked.gather.v{LANES}f64.v{LANES}p0"
        function = cgutils.get_or_insert_function(builder.module, kind, name)
        every = ir.Constant(BITS, [1] * LANES)
        spots = builder.inttoptr(builder.add(base, offset), places)
        return builder.call(function, [spots, INT32(8), every, ir.Constant(DOUBLES, ir.Undefined)])

    return lanes_type(values, index), codegen


def _bits(typing_context, mask):
    """The mask as an integer, lane 0 the lowest bit; 0 where it holds nowhere."""

    def codegen(context, builder, sig, args):
        return builder.zext(builder.bitcast(args[0], ir.IntType(LANES)), INT)

    return types.int64(mask), codegen


def _count(typing_context, mask):
    """In how many lanes the mask holds."""

    def codegen(context, builder, sig, args):
        return builder.zext(builder.ctpop(builder.bitcast(args[0], ir.IntType(LANES))), INT)

    return types.int64(mask), codegen


load: Any = intrinsic(_load)
store: Any = intrinsic(_store)
gather: Any = intrinsic(_gather)
bits: Any = intrinsic(_bits)
count: Any = intrinsic(_count)
