"""Labels as text: `SIT[job]<1>`, `Find[bolt] aborts`, `p!3`, `2 s pass`."""

from __future__ import annotations

from planner_reactor.rs.configurations import Label
from planner_reactor.rs.terms import Value


def show_label(label: Label) -> str:
    """One step as text."""
    name, arguments, status, values = label
    if name == "TIME":
        return f"{_value(arguments[0])} s pass"
    if name == "COM":
        return f"{arguments[0]}!{_value(arguments[1])}"
    called = name + (f"[{', '.join(map(_value, arguments))}]" if arguments else "")
    if status == "ab":
        return f"{called} aborts"
    if status == "wait":
        return f"{called} waits"
    return called + (f"<{', '.join(map(_value, values))}>" if values else "")


def _value(value: Value) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
