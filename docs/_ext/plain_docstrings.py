"""Docstrings of the project are plain text with `names` and indented formulas; this makes reStructuredText of them.

Outside of backticks nothing is markup: an asterisk is a product, a bar a magnitude, a trailing underscore part of a
name.  A paragraph indented by four columns or more is a formula or code and is kept as it stands.  Runs before napoleon
(which reads Args, Returns, Raises).  References to where a name is defined are led to where it is public.
"""

from __future__ import annotations

import importlib
import inspect
import re
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx

PUBLIC = ("rocking", "dem", "excitation")
COLON = "\x00"
SECTION = re.compile(r"^(Args|Arguments|Returns|Raises|Yields|Attributes|Examples?|Notes?):\s*$")
HEAD = re.compile(r"^(Source|Status|Frame|Limits|Use when|Parameters|Adds|Changes|See|Run|Paper says)  +(?=\S)")


def escaped(line: str) -> str:
    """The line with markup characters outside of backticks escaped; single backticks become literals."""
    parts = re.split(r"(``.+?``|`[^`]+`)", line)
    for i, part in enumerate(parts):
        if i % 2:
            parts[i] = part if part.startswith("``") else f"`{part}`"
        else:
            parts[i] = re.sub(r"([*|\\])", r"\\\1", re.sub(r"(\w)_(?!\w)", r"\1\\_", part))
    return "".join(parts)


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())


def _is_verbatim(block: list[str], inside: bool) -> bool:
    """Whether a paragraph is kept as it stands: indented by four columns, and no part of a section."""
    return not inside and all(_indent(line) >= 4 for line in block)


def rewritten(lines: list[str]) -> list[str]:
    """The docstring as reStructuredText (for napoleon)."""
    out: list[str] = []
    inside = False
    block: list[str] = []

    def flush() -> None:
        nonlocal inside
        if not block:
            return
        if SECTION.match(block[0]):
            inside = True
        elif _indent(block[0]) == 0:
            inside = False
        if block[0].lstrip().startswith(">>>"):
            out.extend(block)
        elif _is_verbatim(block, inside):
            out.extend(["::", "", *block])
        else:
            out.extend(_prose(block, inside))
        block.clear()

    for line in [*lines, ""]:
        if line.strip():
            block.append(line)
        else:
            flush()
            out.append("")
    return out


LABEL = re.compile(r"^([a-z][\w\[\], /^*-]{0,60}?): (?=\S)")


def _prose(block: list[str], inside: bool) -> list[str]:
    """A paragraph: heads in bold; in a section, names before a colon are left to napoleon.

    Lines that begin with a name and a colon, or go on from such a line by indentation, make a list.
    """
    if inside:
        return [_argument(line) for line in block]
    out: list[str] = []
    listed = False
    for line in block:
        head, label = HEAD.match(line), LABEL.match(line)
        if head:
            out.append(f"- **{head.group(1)}:** {escaped(line[head.end() :].strip())}")
        elif label and (listed or _opens_a_list(block)):
            out += [] if listed or not out else [""]
            out.append(f"- *{escaped(label.group(1))}*: {escaped(line[label.end() :])}")
        elif listed and _indent(line) > 0:
            out.append(f"  {escaped(line.strip())}")
        else:
            out += [""] if listed else []
            out.append(escaped(line))
        listed = bool(head or (listed and out[-1].startswith("  ")) or out[-1].startswith("- *"))
    return out


def _opens_a_list(block: list[str]) -> bool:
    """Whether a paragraph holds names with explanations: several, or one in its first line with more lines behind."""
    names = [bool(LABEL.match(line)) for line in block]
    return sum(names) > 1 or (names[0] and len(block) > 1)


def _argument(line: str) -> str:
    """A line of a section."""
    if SECTION.match(line):
        return line
    match = re.match(r"^(\s+)([\w*]+(?:, [\w*]+)*)(: )(.*)$", line)
    if match and not match.group(2).endswith("_"):
        return f"{match.group(1)}{match.group(2)}: {escaped(match.group(4))}"
    return escaped(line)


def process(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Replace a docstring by its reStructuredText."""
    if what == "class" and inspect.isclass(obj) and not obj.__dict__.get("__doc__"):
        return
    if not _is_ours(obj, name):
        return
    if lines and lines[0].startswith("Alias for field number"):
        owner = importlib.import_module(name.split(".")[0])
        for part in name.split(".")[1:-1]:
            owner = getattr(owner, part)
        lines[:] = [fields_of(owner).get(name.rsplit(".", 1)[1], "")]
    has_list = hasattr(obj, "_fields") or any(line.startswith("Args:") for line in lines)
    if what == "class" and not has_list:
        lines += ["", *(f"{field}: {text}" for field, text in fields_of(obj).items()), ""]
    lines[:] = rewritten(lines)
    if what in ("property", "attribute", "data"):
        # There napoleon would take what stands before a colon for a type.
        lines[:] = [line.replace(": ", COLON) for line in lines]


def restore(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Colons back, after napoleon."""
    lines[:] = [line.replace(COLON, ": ") for line in lines]


def _is_ours(obj: Any, name: str) -> bool:
    return name.split(".")[0] in (*PUBLIC, "studies")


ARRAY = re.compile(
    r"~?(?:numpy\.)?ndarray\[tuple\[~?(?:typing\.)?Any, \.\.\.\], ~?(?:numpy\.)?dtype\[~?(?:numpy\.)?(\w+)\]\]"
)


ARRAY_LIKE = re.compile(r"[\w.~]*Buffer \| .*?_NestedSequence\[[\w.~]*complex \| bytes \| str\]")
FIELD = re.compile(r"^    (\w+): [^#\n]*?  # (.+)$", re.MULTILINE)


def fields_of(obj: Any) -> dict[str, str]:
    """What comments say of the fields of a class, by name."""
    try:
        return {name: text.strip() for name, text in FIELD.findall(inspect.getsource(obj))}
    except (OSError, TypeError):
        return {}


def shorter(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, arguments: str | None, returns: str | None
) -> tuple[str | None, str | None]:
    """Signatures with `NDArray[float64]` and `ArrayLike` in place of what these are short for.

    A default that is made anew each time has no value to show; without it the rest can be read as Python.
    """
    return arguments and named(arguments).replace("<factory>", "..."), returns and named(returns)


def named(text: str) -> str:
    """A type with the names of arrays put back."""
    return ARRAY_LIKE.sub("ArrayLike", ARRAY.sub(r"NDArray[\1]", text))


def shorten_properties(app: Sphinx, doctree: nodes.document) -> None:
    """The same for the types of properties, which are no signatures."""
    for node in doctree.findall(addnodes.desc_annotation):
        text = node.astext()
        if ARRAY.search(text):
            node.clear()
            node += nodes.Text(named(text))


def public_names() -> dict[str, str]:
    """Where each public object is defined -> where it is public."""
    names: dict[str, str] = {}
    for package in PUBLIC:
        module = importlib.import_module(package)
        for name in module.__all__:
            obj = getattr(module, name)
            home = getattr(obj, "__module__", None)
            if home and getattr(obj, "__qualname__", None):
                names[f"{home}.{obj.__qualname__}"] = f"{package}.{name}"
    return names


def resolve(app: Sphinx, env: Any, node: pending_xref, contnode: nodes.Element) -> nodes.Element | None:
    """A reference to where an object is defined leads to where it is documented; other types stay plain text."""
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"]
    domain = env.get_domain("py")
    found = _PUBLIC_NAMES.get(target)
    if found is None:
        endings = [public for home, public in _PUBLIC_NAMES.items() if home.rsplit(".", 1)[-1] == target]
        found = endings[0] if len(endings) == 1 else None
    if found is None:
        # A type in a signature that has no page of its own: a name of the project or of another one.
        return contnode if node.get("reftype") in ("class", "obj") and not node.get("refexplicit") else None
    reference = domain.resolve_xref(env, node.get("refdoc"), app.builder, "obj", found, node, contnode)
    return reference if reference is not None else contnode


_PUBLIC_NAMES: dict[str, str] = {}


def setup(app: Sphinx) -> dict[str, Any]:
    _PUBLIC_NAMES.update(public_names())
    app.connect("autodoc-process-docstring", process, priority=100)
    app.connect("autodoc-process-docstring", restore, priority=900)
    app.connect("autodoc-process-signature", shorter)
    app.connect("doctree-read", shorten_properties)
    app.connect("missing-reference", resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
