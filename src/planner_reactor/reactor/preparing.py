"""What can be found out about an adaptation before it is received: is its text sound, and which reactions does it add?

It costs most of what a small adaptation costs, and looks at nothing that changes while the reactor runs: whoever hands
an adaptation in may do it beforehand (`Reactor.prepare`), in a thread of its own, so that the loop is held up less.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import msgspec

from planner_reactor.errors import RefusedError, RSError
from planner_reactor.link.messages import Adaptation
from planner_reactor.rs.loading import load
from planner_reactor.rs.printer import show
from planner_reactor.rs.reactions import Reaction, reaction_of
from planner_reactor.rs.terms import Program, Schema, Value
from planner_reactor.rs.vocabulary import Signature
from planner_reactor.runtime import Clause


class Vocabulary(msgspec.Struct, frozen=True):
    """What a text may name: the host's processes and functions, and equation (3), beside which clauses are checked."""

    signatures: Mapping[str, Signature]
    functions: Mapping[str, Callable[..., Value]]
    equation: Program


class Prepared(msgspec.Struct, frozen=True):
    """An adaptation whose text was read and checked. With a `refusal` it adds nothing."""

    adaptation: Adaptation
    reactions: Mapping[int, Reaction] = {}  # by label
    clauses: Mapping[int, str] = {}  # the same in canonical print
    compiled: tuple[Clause, ...] = ()  # and ready to be loaded
    refusal: RefusedError | None = None


def prepare(
    adaptation: Adaptation, vocabulary: Vocabulary, compiled: Callable[[Iterable[Schema]], tuple[Clause, ...]]
) -> Prepared:
    """Read and check the text of an adaptation. Raises nothing: what is wrong is the `refusal`."""
    try:
        program = load(
            adaptation.definitions,
            file=f"<adaptation {adaptation.id}>",
            signatures=vocabulary.signatures,
            functions=vocabulary.functions,
            given=vocabulary.equation,
        )
    except RSError as problem:
        return Prepared(adaptation, refusal=RefusedError("text", str(problem)))
    reactions = {}
    for schema in program.schemas:
        if (reaction := reaction_of(schema)) is None:
            refusal = RefusedError("labels", f"{schema.name} is no reaction, expected clauses P[n] = …")
            return Prepared(adaptation, refusal=refusal)
        reactions[reaction.label] = reaction
    printed = {label: show(reaction.schema) for label, reaction in reactions.items()}
    return Prepared(adaptation, reactions, printed, compiled([r.schema for r in reactions.values()]))
