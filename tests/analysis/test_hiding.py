"""Local processing is a delay to whoever sees only the ports outside (X §4.1.2, §6.4: several ports)."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.denseness import Denseness, Failure, dense, opened
from planner_reactor.analysis.equivalence import branching_bisimilar
from planner_reactor.analysis.hiding import silence
from planner_reactor.analysis.rounds import Irreducible
from planner_reactor.rs.configurations import Label, World
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.prelude import QUANTUM
from planner_reactor.rs.vocabulary import BUILT_IN

TEXT = """
Src = Delay[0.1] ; ((STREAM[x, 1] # Delay[0.04]) ; Src)
Rd = IN[y]<v> :; STOP
ST = (IN[x]<v> ; Delay[0.2]) :; (STREAM[y, v] # Delay[0.05])
Asks = (IN[x]<v> : OUT[q, v] : IN[z]<w>) :; (STREAM[y, w] # Delay[0.05])
Server = IN[q]<a> :; (Delay[0.2] : OUT[z, a])
Slow = IN[q]<a> :; (Delay[0.25] : OUT[z, a])
Both = (IN[x]<v> & IN[w]<u>) :; (STREAM[y, v] # Delay[0.05])
Other = Delay[0.3] ; ((STREAM[w, 1] # Delay[0.02]) ; Other)
Once = IN[x]<v> : OUT[y, v]
Grows[v] = Delay[0.1] ; ((STREAM[y, v] # Delay[0.04]) ; Grows[v + 1])
Pair = ((IN[x]<v> ; Delay[0.1]) & Delay[0.3]) :; (STREAM[y, v] # Delay[0.05])
"""
WORLD = World(parse_program(TEXT), BUILT_IN)


def _unseen(label: Label) -> bool:
    return label[0] == "Delay" or (label[0] == "COM" and label[1][0] in ("q", "z"))


@pytest.mark.parametrize(("network", "same"), [("Asks | Server", True), ("Asks | Slow", False)])
def test_a_server_behind_local_ports_is_a_delay(network: str, same: bool) -> None:
    """`IN[p]<u> : A[u]<v> : OUT[q, v]` is `IN[p]<u> : Delay[t] : OUT[q, f(u)]`, the paper's own example."""
    sides = (parse_process(f"Src | {part} | Rd") for part in (network, "ST"))
    assert branching_bisimilar(*sides, WORLD, hidden=_unseen, limit=20_000) is same


@pytest.mark.parametrize(
    ("process", "ready", "seconds"),
    [
        ("Src", (), 0.1),
        ("ST", ("x",), 0.2),
        ("Asks | Server", ("x",), 0.2),
        ("Asks | Slow", ("x",), 0.25),
        ("Src | ST", (), 0.23),  # Definition 3 bounds it by 0.3: the two periods do not drift
        ("Once", ("x",), float("inf")),
    ],
)
def test_the_silence_is_what_an_eager_reader_waits(process: str, ready: tuple[str, ...], seconds: float) -> None:
    port = "x" if process == "Src" else "y"
    assert silence(parse_process(process), WORLD, port, ready) == pytest.approx(seconds + QUANTUM)


@pytest.mark.parametrize("process", ["Src | ST", "Src | Both | Other", "ST"])
def test_what_is_composed_is_never_less_than_what_is_looked_at(process: str) -> None:
    supplied = {} if "Src" in process else {"x": (0, 0)}
    found = dense(opened(parse_program(TEXT)), process, "y", supplied=supplied)
    assert isinstance(found, Denseness)
    looked = silence(parse_process(process), WORLD, "y", () if "Src" in process else ("x",))
    assert looked <= found.delay + 2 * QUANTUM


def test_what_rounds_do_not_tell_is_looked_at() -> None:
    found = dense(opened(parse_program(TEXT)), "Asks | Server", "y", supplied={"x": (0.1, 0.04)})
    assert isinstance(found, Denseness)
    assert (found.form, found.inputs) == ("every state", ("x",))
    assert (found.delay, found.resolution) == (pytest.approx(0.3), 0.05)
    pair = dense(opened(parse_program(TEXT)), "Pair", "y", supplied={"x": (0, 0)})
    assert isinstance(pair, Denseness)
    assert (pair.form, pair.delay) == ("every state", pytest.approx(0.3))


def test_names_or_data_that_grow_cannot_be_looked_at() -> None:
    text = TEXT.replace("Delay[0.2] : OUT[z", "Delay[t] : OUT[z")
    open_delay = dense(opened(parse_program(text)), "Asks | Server", "y", supplied={"x": (0, 0)})
    assert isinstance(open_delay, Failure)
    assert "waits for itself" in open_delay.why
    with pytest.raises(Irreducible, match="its data grow"):
        silence(parse_process("Grows[0]"), WORLD, "y", limit=500)
