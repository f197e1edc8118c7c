"""Which rule of the semantics a piece of the code belongs to.

A rule's id stands in the comment above its case, or in the documentation of its function; what the store and the
terms do for several rules is listed here by function. Nothing may be left over: a function that belongs to no rule
is an error of the table.
"""

from __future__ import annotations

import ast
import re

MODULES = ("evolves", "leaves", "serving", "store", "states", "configurations")
"""The modules of `planner_reactor.rs` that are the semantics."""

IDS = re.compile(r"\b(N\d+'?|SEQ|PAR|COM|TIME)(?![\w'])")

FUNCTIONS = {
    "evolves": {
        "started": "roots", "begin": "begin", "_begin_left": "SIT", "_begin_call": "N7", "_needed": "scopes",
        "terminate": "termination", "_chain": "SIT", "_served": "SIT", "_joined": "N6", "_granted": "ASSERT",
        "settle": "settling", "_quiet": "settling", "_undecided": "N5",
    },
    "leaves": {
        "": "leaves", "steps": "PAR", "window": "TIME", "_seconds": "TIME", "_ended": "TIME", "_endings": "outcomes",
        "slack": "TIME", "_older": "TIME", "_posted": "POST", "_named": "COM", "_killed": "KILL", "resting": "KILL",
        "Step": "TIME",
    },
    "serving": {
        "assert_": "ASSERT", "sit": "SIT", "succeed": "SUCCEED", "fail": "FAIL", "_ended_instance": "SUCCEED",
        "update": "UPDATE", "wait": "WAIT", "drain": "DRAIN", "renew": "RENEW", "wait_old": "WAITOLD",
        "migrate": "MIGRATE", "inhibit": "INHIBIT", "uninhibit": "UNINHIBIT", "disable": "DISABLE", "enable": "ENABLE",
        "disabled": "DISABLE", "enabled": "ENABLE", "stub": "STUB", "report": "REPORT", "monitor": "ASSUMONITOR",
    },
    "store": {
        "Instance": "ASSERT", "Inhibition": "INHIBIT", "QueuedAssert": "ASSERT", "Store": "ASSERT",
        "Store.get": "ASSERT", "Store.in_service": "ASSERT", "Store.holds_back": "DRAIN",
        "Store.inhibited": "INHIBIT", "Store.disabled": "DISABLE", "Store.gone": "ASSERT",
        "Store.complete": "ASSERT", "Store.quiescent": "WAIT", "Store.available": "SIT", "Store.above": "ASSERT",
        "Store.changed": "UPDATE", "Store.asserted": "ASSERT", "Store.queued": "DRAIN",
        "Store.left_queue": "DRAIN", "Store.abandoned_in_queue": "MIGRATE", "Store.migrated": "MIGRATE",
        "Store.ended": "SUCCEED", "Store.abandoned": "N9", "Store.entered": "SIT",
        "Store.left": "SIT", "Store.stamped": "SIT", "Store.without": "ASSERT", "Store.inhibit": "INHIBIT",
        "Store.uninhibit": "UNINHIBIT", "Store.drain": "DRAIN", "Store.drain_ended": "DRAIN",
        "Store.released": "UNINHIBIT", "Store.root_ended": "owners", "Store._fated": "DRAIN",
        "Store.settled": "settling", "Store._once_settled": "settling",
    },
    "states": {
        "parts_of": "SEQ", "with_parts": "SEQ", "put": "SEQ", "guard_of": "KILL", "spots": "SEQ", "bind": "N4",
        "only": "scopes", "variables": "scopes", "leaf_of": "begin", "results_of": "outcomes",
    },
    "configurations": {"": "roots", "World": "N7", "Config": "roots", "spawned_situations": "ASSERT"},
}  # fmt: skip

BRANCHES = {
    "Testing": "N8", "Round": "N8", "Spawning": "N8", "WAIT": "WAIT", "WAITINHIBIT": "WAITINHIBIT", "DRAIN": "DRAIN",
    "REASSERT": "REASSERT", "Delay": "TIME", "SUSPEND": "TIME", "Term": "TIME", "OUT": "COM", "KILL": "KILL",
    "POST": "POST", "Chain": "N1", "Seq": "N1", "Cond": "N2", "Par": "N4", "All": "N4'", "Disable": "N5", "Not": "N3",
    "Loop": "N8", "Spawn": "N8", "If": "N10", "Call": "N7", "Inverted": "N3", "Deciding": "N10", "Serve": "SIT",
    "Keep": "N6", "Export": "N6", "Await": "ASSERT", "Queued": "DRAIN", "Waiting": "WAIT",
}  # fmt: skip
"""In a function that tells terms or leaves apart: to which rule a case for this one belongs."""


class Rules:
    """The rules of one module's code."""

    def __init__(self, module: str, source: str) -> None:
        self._module = module
        self._lines = source.splitlines()
        self._starts: dict[str, tuple[int, str]] = {}
        self._note(ast.parse(source), "")

    def _note(self, node: ast.AST, outside: str) -> None:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.FunctionDef | ast.ClassDef):
                name = f"{outside}.{child.name}".strip(".")
                self._starts[name] = (child.lineno, ast.get_docstring(child) or "")
                self._note(child, name)
            else:
                self._note(child, outside)

    def of(self, function: str, line: int, text: str = "") -> str:
        """The rule of a place: of its entry, its comment, its case, its function, in this order."""
        if entry := re.match(r"drop (?:entry|item) '(\w+)'$", text):
            return entry[1]
        if above := self._commented(function, line):
            return above
        if case := re.match(r"drop case .*?(\w+)", text):
            return BRANCHES.get(case[1], self._by_function(function))
        return self._by_function(function)

    def _commented(self, function: str, line: int) -> str | None:
        """The id in the nearest comment above a line, inside its function."""
        first, documented = self._starts.get(function, (0, ""))
        for number in range(line, first, -1):
            text = self._lines[number - 1].strip()
            if text.startswith("#") and (found := IDS.findall(text)):
                return found[-1] if len(found) == 1 or found[0] == "N8" else found[0]
            if text.startswith(("# SIT", "# an await")):
                return "SIT" if "SIT" in text else "ASSERT"
        found = IDS.findall(documented)
        return str(found[0]) if found else None

    def _by_function(self, function: str) -> str:
        known = FUNCTIONS[self._module]
        while function and function not in known:
            function = function.rpartition(".")[0]
        return known.get(function, f"{self._module}.{function}" if function else "terms")
