"""Places where a source can be broken: a sign, a factor, an index, a comparison, min for max, sin for cos.

Only what computes is broken: docstrings, texts, annotations, messages, checks that refuse an argument, drawings and
command lines are left alone.  An edit replaces a few bytes, so that everything else of the file stays as it is.
"""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass

SIGNS = {ast.Add: ("+", "-"), ast.Sub: ("-", "+")}
FACTORS = {ast.Mult: ("*", "/"), ast.Div: ("/", "*")}
COMPARISONS = {
    ast.Lt: ("<", ("<=", ">")), ast.LtE: ("<=", ("<", ">=")), ast.Gt: (">", (">=", "<")), ast.GtE: (">=", (">", "<=")),
    ast.Eq: ("==", ("!=",)), ast.NotEq: ("!=", ("==",)),
}  # fmt: skip
TWINS = (("min", "max"), ("minimum", "maximum"), ("argmin", "argmax"), ("sin", "cos"), ("sinh", "cosh"))
TWIN = {a: b for pair in TWINS for a, b in (pair, pair[::-1])}

# A function with one of these arguments draws or reads a command line; one with such a name too.
DRAWING_ARGUMENTS = {"ax", "axes", "axis", "fig", "parser", "options"}
DRAWING_NAMES = re.compile(
    r"_?(figure|draw|plot|caption|main|check|in_words|repr|films|.*_figure|.*_in_words|__repr__)"
)


@dataclass(frozen=True)
class Break:
    """One edit of a file.

    Attributes:
        file: path from the root of the project.
        line: number of the line, from 1.
        function: the function or class around it, with dots.
        kind: "sign", "factor", "index", "comparison", "min/max" or "sin/cos".
        start, end: bytes of the file that are replaced.
        new: what is put there.
        before, after: the line without and with the break.
    """

    file: str
    line: int
    function: str
    kind: str
    start: int
    end: int
    new: str
    before: str
    after: str

    def apply(self, source: bytes) -> bytes:
        """The source with the break in it."""
        return source[: self.start] + self.new.encode() + source[self.end :]


class _Source:
    """A source with its tokens, by byte."""

    def __init__(self, source: bytes) -> None:
        self.source = source
        lines = source.splitlines(keepends=True)
        self.begins = [0]
        for line in lines:
            self.begins.append(self.begins[-1] + len(line))
        texts = [line.decode() for line in lines]
        self.operators = [
            (self.begins[row - 1] + len(texts[row - 1][:column].encode()), token.string)
            for token in tokenize.tokenize(io.BytesIO(source).readline)
            if token.type == tokenize.OP
            for row, column in (token.start,)
        ]

    def span(self, node: ast.expr) -> tuple[int, int]:
        """First byte of a node and the one after its last."""
        assert node.end_lineno is not None and node.end_col_offset is not None
        return self.begins[node.lineno - 1] + node.col_offset, self.begins[node.end_lineno - 1] + node.end_col_offset

    def operator(self, start: int, end: int, text: str) -> tuple[int, int]:
        """Where the operator stands between two bytes."""
        at = next(at for at, found in self.operators if start <= at < end and found == text)
        return at, at + len(text)


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr | ast.List | ast.Tuple) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def _refuses(node: ast.If) -> bool:
    """Whether a statement only raises, or only speaks, when its condition holds."""
    return all(isinstance(s, ast.Raise) for s in node.body) and not node.orelse


def _draws(node: ast.FunctionDef) -> bool:
    given = {a.arg for a in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)}
    return bool(DRAWING_NAMES.fullmatch(node.name)) or bool(given & DRAWING_ARGUMENTS)


def _parts(node: ast.AST) -> Iterator[ast.AST]:
    """Children of a node that compute."""
    left_out: set[int] = set()
    if isinstance(node, ast.FunctionDef):
        defaults = [d for d in node.args.kw_defaults if d is not None]
        yield from (*node.body, *node.args.defaults, *defaults)
        return
    if isinstance(node, ast.If) and _refuses(node):
        return
    if isinstance(node, ast.Raise | ast.Assert | ast.JoinedStr | ast.Import | ast.ImportFrom):
        return
    if isinstance(node, ast.AnnAssign):
        left_out.add(id(node.annotation))
    if isinstance(node, ast.ClassDef):
        left_out |= {id(part) for part in (*node.bases, *node.keywords, *node.decorator_list)}
    yield from (child for child in ast.iter_child_nodes(node) if id(child) not in left_out)


def _factor(value: float) -> str:
    """Another number in place of a factor or an exponent."""
    if isinstance(value, int):
        return str(value + 1)
    return repr(0.5 * value if abs(value) < 1.0 else 1.5 * value)


def _edits(node: ast.AST, src: _Source) -> Iterator[tuple[str, int, int, str]]:
    """(kind, start, end, new) of each edit of one node itself."""
    if isinstance(node, ast.BinOp) and not (_is_text(node.left) or _is_text(node.right)):
        between = src.span(node.left)[1], src.span(node.right)[0]
        for kind, table in (("sign", SIGNS), ("factor", FACTORS)):
            if type(node.op) in table:
                old, new = table[type(node.op)]
                yield kind, *src.operator(*between, old), new
        if isinstance(node.op, ast.Mult | ast.Div | ast.Pow):
            for side in (node.left, node.right):
                number = isinstance(side, ast.Constant) and type(side.value) in (int, float)
                if number and side.value != 0:
                    yield "factor", *src.span(side), _factor(side.value)
    if isinstance(node, ast.AugAssign):
        between = src.span(node.target)[1], src.span(node.value)[0]
        for kind, table in (("sign", SIGNS), ("factor", FACTORS)):
            if type(node.op) in table:
                old, new = table[type(node.op)]
                yield kind, *src.operator(*between, old + "="), new + "="
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        start, _ = src.span(node)
        yield "sign", start, start + 1, "+"
    if isinstance(node, ast.Compare):
        sides = [node.left, *node.comparators]
        for left, op, right in zip(sides, node.ops, sides[1:], strict=False):
            if type(op) in COMPARISONS and not (_is_text(left) or _is_text(right)):
                old, others = COMPARISONS[type(op)]
                place = src.operator(src.span(left)[1], src.span(right)[0], old)
                for new in others:
                    yield "comparison", *place, new
    yield from _index_edits(node, src)
    if isinstance(node, ast.Call):
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if name in TWIN:
            end = src.span(node.func)[1]
            kind = "sin/cos" if name in ("sin", "cos", "sinh", "cosh") else "min/max"
            yield kind, end - len(name), end, TWIN[name]


def _index_edits(node: ast.AST, src: _Source) -> Iterator[tuple[str, int, int, str]]:
    """Numbers in square brackets and in range(), shifted by one."""
    if isinstance(node, ast.Subscript):
        places = list(node.slice.elts) if isinstance(node.slice, ast.Tuple) else [node.slice]
        bounds = [b for p in places if isinstance(p, ast.Slice) for b in (p.lower, p.upper) if b is not None]
        places += bounds
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("range", "prange"):
        places = list(node.args)
    else:
        return
    for place in places:
        if isinstance(place, ast.Constant) and type(place.value) is int:
            yield "index", *src.span(place), str(place.value - 1 if place.value > 0 else 1)
        if isinstance(place, ast.UnaryOp) and isinstance(place.operand, ast.Constant):
            yield "index", *src.span(place.operand), str(int(place.operand.value) + 1)


def breaks_of(file: str, source: bytes) -> list[Break]:
    """All breaks of one file, in the order of its bytes."""
    src, found = _Source(source), []

    def walk(node: ast.AST, around: tuple[str, ...]) -> None:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            if isinstance(node, ast.FunctionDef) and _draws(node):
                return
            around = (*around, node.name)
        for kind, start, end, new in _edits(node, src):
            line = source.count(b"\n", 0, start) + 1
            first, last = src.begins[line - 1], src.begins[line]
            before = source[first:last].decode().strip()
            after = (source[first:start] + new.encode() + source[end:last]).decode().strip()
            found.append(Break(file, line, ".".join(around), kind, start, end, new, before, after))
        for child in _parts(node):
            walk(child, around)

    walk(ast.parse(source), ())
    return sorted(found, key=lambda b: (b.start, b.new))
