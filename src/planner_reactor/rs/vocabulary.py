"""What the language offers beyond schemas: the built-in processes, and the form in which any process is
declared.

A `Signature` says what a basic or built-in process takes and returns, how long it may last and how it may
end. `BUILT_IN` holds the processes of R §4.2 and X §4.1 (ports, time, tests), of R Tables 1 and 2
(situations, guards) and R §8.3 (stubs, monitors), with ours: DRAIN, POST, HOLDMONITOR, REPORT, DISABLE,
ENABLE, DISABLED, ENABLED, FREEZE. Their meaning is not here: see `evolves` and `leaves`. A host declares its own
processes in the same form.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import KW_ONLY, dataclass
from types import MappingProxyType
from typing import Literal, TypeAlias

Kind: TypeAlias = Literal["number", "symbol", "any", "port", "situation", "instance", "label", "assumption"]
"""What an argument stands for: a number (instances and labels are numbers given out at run time), a name (of a
port, a situation, an assumption, or any symbol), or anything."""

BOTH = frozenset({"stop", "abort"})
STOPS = frozenset({"stop"})
ABORTS = frozenset({"abort"})
NEVER_ENDS: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Signature:
    """How a basic or built-in process is called.

    The last `optional` of `inputs` may be left out; with `open_inputs` any number of further arguments may
    follow. A call names none of the results, or all of them, with `open_results` any number of further ones.
    `window` is the least and greatest age in seconds at which the process ends (None: it depends on its
    arguments or on others), `outcomes` how it may end, beside an abort for arguments that have no value. `means` is a
    test in RS on `parameters`, such as `LST[p, a]`: the process stops where it would (its stop condition, X §6.1).
    """

    name: str
    inputs: tuple[Kind, ...] = ()
    results: tuple[str, ...] = ()
    _: KW_ONLY
    optional: int = 0
    open_inputs: bool = False
    open_results: bool = False
    window: tuple[float, float] | None = None
    outcomes: frozenset[str] = BOTH
    parameters: tuple[str, ...] = ()
    means: str = ""

    def takes(self, count: int) -> bool:
        """May it be called with this many arguments?"""
        most = len(self.inputs)
        return count >= most - self.optional and (count <= most or self.open_inputs)

    def returns(self, count: int) -> bool:
        """May a call name this many results?"""
        return count in (0, len(self.results)) or (self.open_results and count > len(self.results))

    def kind(self, position: int) -> Kind:
        """What the argument at this position (from 0) stands for."""
        return self.inputs[position] if position < len(self.inputs) else "any"

    def usage(self) -> str:
        """How a call is written, for messages: `SIT[situation]<k, …>`."""
        first_optional = len(self.inputs) - self.optional
        inputs = [kind if i < first_optional else f"{kind}?" for i, kind in enumerate(self.inputs)]
        inputs += ["…"] * self.open_inputs
        results = [*self.results, *["…"] * self.open_results]
        text = self.name + (f"[{', '.join(inputs)}]" if inputs else "")
        return text + (f"<{', '.join(results)}>" if results else "")


AT_ONCE = (0.0, 0.0)
_FIRST: tuple[Kind, ...] = ("situation",)
_SERVED: tuple[Kind, ...] = ("situation", "instance")


def _ports_time_tests() -> Iterable[Signature]:
    yield Signature("STOP", window=AT_ONCE, outcomes=STOPS)
    yield Signature("ABORT", window=AT_ONCE, outcomes=ABORTS)
    yield Signature("NIL", outcomes=NEVER_ENDS)
    yield Signature("IN", ("port",), ("x",), outcomes=STOPS)
    yield Signature("OUT", ("port", "any"), outcomes=STOPS)
    yield Signature("STREAM", ("port", "any"), outcomes=NEVER_ENDS)
    yield Signature("Delay", ("number",), outcomes=STOPS)
    yield Signature("Term", ("number",), outcomes=STOPS)
    yield Signature("SUSPEND", ("number",), outcomes=STOPS)
    yield Signature("Ran", ("number", "number"), ("x",), window=AT_ONCE, outcomes=STOPS)
    yield Signature("GTR", ("number", "number"), window=AT_ONCE)
    yield Signature("LST", ("number", "number"), window=AT_ONCE)
    yield Signature("Equal", ("any", "any", "number"), optional=1, window=AT_ONCE)


def _situations() -> Iterable[Signature]:
    """R Table 1, with UPDATE, REASSERT and STUB (R §5.5, §8.3)."""
    yield Signature("ASSERT", _FIRST, open_inputs=True, open_results=True)
    yield Signature("REASSERT", _FIRST, open_inputs=True, open_results=True)
    yield Signature("SIT", _FIRST, ("k",), open_results=True, outcomes=STOPS)
    yield Signature("SUCCEED", _SERVED, window=AT_ONCE, outcomes=STOPS)
    yield Signature("FAIL", _SERVED, window=AT_ONCE, outcomes=STOPS)
    yield Signature("UPDATE", _SERVED, open_inputs=True, window=AT_ONCE, outcomes=STOPS)
    yield Signature("STUB", _FIRST, window=AT_ONCE, outcomes=STOPS)


def _adaptation() -> Iterable[Signature]:
    """R Table 2, the guards of equation (3), drains, and what failed assumptions do to situations."""
    yield Signature("WAIT", _FIRST, outcomes=STOPS)
    yield Signature("INHIBIT", _FIRST, window=AT_ONCE, outcomes=STOPS)
    yield Signature("UNINHIBIT", _FIRST, window=AT_ONCE, outcomes=STOPS)
    yield Signature("WAITINHIBIT", _FIRST, outcomes=STOPS)
    yield Signature("DRAIN", _FIRST, outcomes=STOPS)
    yield Signature("RENEW", _FIRST, window=AT_ONCE, outcomes=STOPS)
    yield Signature("WAITOLD", _FIRST, outcomes=STOPS)
    yield Signature("MIGRATE", _FIRST, open_inputs=True, window=AT_ONCE, outcomes=STOPS)
    yield Signature("KILL", ("label",))
    yield Signature("RETIRE", ("label",), window=AT_ONCE)
    yield Signature("E", ("label",), outcomes=STOPS)
    yield Signature("ADD", (), ("m",), outcomes=STOPS)
    yield Signature("POST", ("label",))
    yield Signature("COMMIT", ("number",), window=AT_ONCE)
    yield Signature("DISABLE", ("situation", "assumption"), window=AT_ONCE, outcomes=STOPS)
    yield Signature("ENABLE", ("situation", "assumption"), window=AT_ONCE, outcomes=STOPS)
    yield Signature("DISABLED", _FIRST, ("assumption",), outcomes=STOPS)
    yield Signature("ENABLED", _FIRST, outcomes=STOPS)
    yield Signature("FREEZE", _FIRST, window=AT_ONCE)


def _monitors() -> Iterable[Signature]:
    """R §8.3; periods are milliseconds."""
    yield Signature("ASSUMONITOR", ("assumption", "number"), outcomes=NEVER_ENDS)
    yield Signature("HOLDMONITOR", ("assumption", "number"), outcomes=NEVER_ENDS)
    yield Signature("REPORT", ("symbol",), open_inputs=True, window=AT_ONCE, outcomes=STOPS)


BUILT_IN: Mapping[str, Signature] = MappingProxyType(
    {
        signature.name: signature
        for group in (_ports_time_tests(), _situations(), _adaptation(), _monitors())
        for signature in group
    }
)
"""Every process that a text may use without a host."""
