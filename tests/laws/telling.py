"""The tables of laws and non-laws in the documentation, made from the code that checks them."""

from __future__ import annotations

from planner_reactor.rs.configurations import Label
from planner_reactor.rs.printer import show
from tests.laws.checking import smallest
from tests.laws.table import BINDINGS, BRANCHING, LAWS, NON_LAWS, Law


def laws() -> str:
    """Each law, with its condition and where it does not hold."""
    lines = ["| law | if |", "|---|---|"]
    lines += [f"| {_equation(law)} | {_proviso(law)} |" for law in LAWS]
    return "\n".join([*lines, ""])


def _proviso(law: Law) -> str:
    if law.equivalences == (BRANCHING,):
        return "port h is local: branching bisimilar, and not below `#`"
    if BINDINGS in law.not_in:
        return "results of P are not looked at" + ("" if law.context == "driven" else "; P begins with a step")
    return law.condition


def non_laws() -> str:
    """Each non-law with its smallest counterexample, searched for anew."""
    lines = ["| no law | terms | run | left | right |", "|---|---|---|---|---|"]
    for law in NON_LAWS:
        found = smallest(law)
        assert found is not None
        terms = ", ".join(f"{name} = `{_cell(show(term))}`" for name, term in found.terms.items())
        run = " ".join(map(_label, found.run)) or "–"
        lines.append(f"| {_equation(law)} | {terms} | {run} | {found.left} | {found.right} |")
    return "\n".join([*lines, ""])


def _equation(law: Law) -> str:
    return f"`{_cell(law.name)}`"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _label(label: Label) -> str:
    name, _, status, _ = label
    return f"{name}{'✓' if status == 'ok' else '✗'}"
