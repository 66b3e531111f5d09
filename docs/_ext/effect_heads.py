"""The page of effects, made from the heads of the files in rocking/effects: a table of all, and a section for each."""

from __future__ import annotations

import dataclasses
import importlib
import math
import re
import textwrap

from rocking.effects import available, load

ENTRY = re.compile(
    r"^(Adds|Changes|Parameters|Use when|Limits|Source|Status"  # of effects
    r"|Accuracy|Cases?|Scenes|Maps|Sweeps?|Runs?|Peers|Floor|Measure|Load) +(?=\S)"  # of benchmarks
)


def head_of(doc: str) -> tuple[str, list[tuple[str, str]]]:
    """The first sentence of a head, and its entries (name, text)."""
    title, _, rest = doc.partition("\n\n")
    entries: list[tuple[str, str]] = []
    for line in textwrap.dedent(rest).splitlines():
        match = ENTRY.match(line)
        if match:
            entries.append((match.group(1), line[match.end() :].strip()))
        elif line.strip() and entries:
            name, text = entries[-1]
            entries[-1] = (name, f"{text} {line.strip()}")
        elif not line.strip() and entries:
            break
    return " ".join(title.split()), entries


def literal(text: str) -> str:
    """Text of a head as Markdown: what is no word of English stays as it is."""
    # Two primes are a second derivative, not the end of a quotation.
    parts = re.split(r"(`[^`]+`)", text.replace("''", "\N{DOUBLE PRIME}"))
    return "".join(p if i % 2 else re.sub(r"([*_<>|\[\]\\$])", r"\\\1", p) for i, p in enumerate(parts))


def _number(value: float | None) -> str:
    return "the block's own" if value is None else {math.inf: "∞", -math.inf: "−∞"}.get(value, f"{value:g}")


def _parameters(name: str) -> str:
    effect = load(name)
    rows = ["| parameter | unit | absent at | from | to |", "|---|---|---|---|---|"]
    for field in dataclasses.fields(effect):
        low, high = effect.ranges.get(field.name, (-math.inf, math.inf))
        unit = effect.units.get(field.name, "1")
        rows.append(
            f"| `{field.name}` | {literal(unit)} | {_number(field.default)} | {_number(low)} | {_number(high)} |"
        )
    return "\n".join(rows)


def _short(title: str) -> str:
    """The first sentence of a head without the name before its colon."""
    return literal(title.partition(": ")[2] or title).rstrip(".")


def effects_text() -> str:
    """A table of all, and one section for each effect of the package."""
    heads = {name: head_of(importlib.import_module(load(name).__module__).__doc__ or "") for name in available()}
    rows = [f"| [`{name}`](#{name.replace('_', '-')}-effect) | {_short(title)} |" for name, (title, _) in heads.items()]
    table = ["| effect | what the ideal block lacks |", "|---|---|", *rows]
    parts = ["\n".join(["::::{container} commands", *table, "::::", ""])]
    for name, (title, entries) in heads.items():
        lines = [f"({name.replace('_', '-')}-effect)=", f"## `{name}`", "", literal(title), ""]
        # A list of definitions.
        for entry, text in entries:
            if entry != "Parameters":
                lines += [entry, f": {literal(text)}", ""]
            else:
                lines += ["Parameters", f": {literal(text)}", ""]
        parts.append("\n".join([*lines, _parameters(name), ""]))
    return "\n".join(parts)
