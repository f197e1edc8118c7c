"""What can be found out about an adaptation before it is received: is its text sound, and which reactions does it add?

It costs most of what a small adaptation costs, and looks at nothing that changes while the reactor runs: whoever hands
an adaptation in may do it beforehand (`Reactor.prepare`), in a thread of its own, so that the loop is held up less.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import msgspec

from planner_reactor.errors import RefusedError, RSError
from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.forms import Durations, Filling, Form, Forms, filling, key_of
from planner_reactor.rs.loading import load
from planner_reactor.rs.printer import show
from planner_reactor.rs.reactions import Reaction, reaction_of
from planner_reactor.rs.terms import Process, Program, Schema, Value, operands
from planner_reactor.rs.vocabulary import BUILT_IN, Signature
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
    needed: int = 0  # processes that they may at once be made of as they come to life
    durations: Mapping[int, Durations] = {}  # of those of a form met before
    refusal: RefusedError | None = None


def size(process: Process) -> int:
    """How many processes it may at once be made of, as it comes to life: no more than it has parts."""
    return 2 + sum(map(size, operands(process)))


class Preparing:
    """Prepares adaptations for one reactor, in any thread. What was met before is read by its form (`forms`)."""

    def __init__(
        self, vocabulary: Vocabulary, compiled: Callable[[Iterable[Schema]], tuple[Clause, ...]]
    ) -> None:
        self._vocabulary = vocabulary
        self._compiled = compiled
        known = {**vocabulary.signatures, **BUILT_IN}
        self._forms = Forms(lambda text: self._load(text, "<form>"), known.__contains__)

    def prepare(self, adaptation: Adaptation) -> Prepared:
        """Read and check the text of an adaptation. Raises nothing: what is wrong is the `refusal`."""
        file = f"<adaptation {adaptation.id}>"
        found = key_of(adaptation.definitions)
        if found is not None and (form := self._forms.get(found[0])) is not None:
            return self._of_form(adaptation, form, filling(found[1], found[2], file))
        try:
            program = self._load(adaptation.definitions, file)
        except RSError as problem:
            return Prepared(adaptation, refusal=RefusedError("text", str(problem)))
        reactions = {}
        for schema in program.schemas:
            if (reaction := reaction_of(schema)) is None:
                refusal = RefusedError("labels", f"{schema.name} is no reaction, expected clauses P[n] = …")
                return Prepared(adaptation, refusal=refusal)
            reactions[reaction.label] = reaction
        printed = {label: show(reaction.schema) for label, reaction in reactions.items()}
        needed = sum([size(reaction.schema.body) for reaction in reactions.values()])
        if found is not None:
            self._forms.met(found[0], needed)
        compiled = self._compiled([reaction.schema for reaction in reactions.values()])
        return Prepared(adaptation, reactions, printed, compiled, needed)

    def _of_form(self, adaptation: Adaptation, form: Form, made_of: Filling) -> Prepared:
        made = [make(made_of) for make in form.reactions]
        return Prepared(
            adaptation,
            {reaction.label: reaction for reaction in made},
            {reaction.label: show(made_of) for reaction, show in zip(made, form.printed, strict=True)},
            self._compiled([reaction.schema for reaction in made]),
            form.needed,
            durations={r.label: known for r, known in zip(made, form.durations, strict=False)},
        )

    def _load(self, text: str, file: str) -> Program:
        known = self._vocabulary
        return load(
            text, file=file, signatures=known.signatures, functions=known.functions, given=known.equation
        )
