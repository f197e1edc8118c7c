"""The books: balanced after every event; and every comparison can fail, shown by a seeded defect for each."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from planner_reactor.trace import Event
from planner_reactor.workcell.audit import audit
from planner_reactor.workcell.things import Part

from .driving import Rig, build_kits, careful_kit, trusting_kit

Defect = Callable[[Rig], None]


def loses_a_part_on_the_belt(rig: Rig) -> None:
    rig.plant.belt.remove(next(iter(rig.plant.belt.parts["cap"].values())))


def forgets_to_book_an_arrival(rig: Rig) -> None:
    rig.plant.belt.put(Part(9999, "cap", "cap_a"), 0.1)


def drops_what_is_held(rig: Rig) -> None:
    rig.plant.gripper = None


def empties_a_slot(rig: Rig) -> None:
    next(iter(rig.plant.area.values())).slots.clear()


def loses_a_tray(rig: Rig) -> None:
    rig.plant.stack.pop()


def doubles_a_standing_tray(rig: Rig) -> None:
    (tray,) = rig.plant.area.values()
    rig.plant.area[9999] = tray


def books_a_part_twice(rig: Rig) -> None:
    part = next(iter(rig.plant.belt.parts["cap"].values()))
    rig.plant.books.part_arrived(part, "passed", at="passed")
    rig.plant.books.parts_arrived -= 1


def books_a_tray_twice(rig: Rig) -> None:
    rig.plant.books.trays["shipped"] += 1


SEEN_AS = {
    loses_a_part_on_the_belt: "parts on the belt",
    forgets_to_book_an_arrival: "parts on the belt",
    drops_what_is_held: "parts held",
    empties_a_slot: "parts in trays",
    loses_a_tray: "trays stacked",
    doubles_a_standing_tray: "trays in the area",
    books_a_part_twice: "parts: arrived",
    books_a_tray_twice: "trays: arrived",
}


@pytest.mark.parametrize("defect", SEEN_AS)
def test_a_seeded_defect_is_found_at_the_next_event(defect: Defect) -> None:
    rig = Rig()
    rig.run("FindGetInsert", "motor", rig.tray())
    rig.held("cap")
    assert rig.world.balanced()
    defect(rig)
    rig.plant.happened()
    assert rig.world.findings, "nothing was found"
    assert any(SEEN_AS[defect] in finding.message for finding in rig.world.findings)
    assert not rig.world.balanced()
    assert rig.world.report()["findings"]
    assert rig.trace is not None
    assert next(rig.trace.of("violation")).data["law"] == "ledger"


@pytest.mark.parametrize("kit", [trusting_kit, careful_kit])
def test_the_books_balance_after_every_event(kit: object) -> None:
    rig = Rig(target=10)
    assert rig.trace is not None

    def check(event: Event) -> None:
        parts, trays = rig.world.ledger(), rig.world.trays()
        assert parts["arrived"] == sum(parts.values()) - parts["arrived"]
        assert trays["arrived"] == sum(trays.values()) - trays["arrived"]

    rig.trace.sinks.append(check)
    build_kits(rig, kit)
    assert rig.world.balanced()


def test_an_auditor_who_sees_only_the_trace_comes_to_the_same_books() -> None:
    rig = Rig(target=20, seed=7)
    build_kits(rig, careful_kit)
    assert rig.trace is not None
    audited = audit(rig.trace.events)
    assert audited.mistakes == []
    assert audited.ledger() == rig.world.ledger()
    assert audited.tray_ledger() == rig.world.trays()
    assert (audited.accepted, audited.rejected) == (20, 0)


ARRIVED = Event(1, 0.0, "part_arrived", {"part": 1, "at": "belt"})
OTHER = Event(2, 0.0, "part_arrived", {"part": 2, "at": "belt"})


def moved(part: int, source: str, target: str) -> Event:
    return Event(3, 1.0, "part_moved_to", {"part": part, "source": source, "target": target})


@pytest.mark.parametrize(
    ("events", "mistake"),
    [
        ([ARRIVED, ARRIVED], "arrives a second time"),
        ([moved(1, "belt", "gripper")], "never arrived"),
        ([ARRIVED, moved(1, "gripper", "tag1:cap")], "leaves gripper, but is in belt"),
        ([ARRIVED, moved(1, "belt", "passed"), moved(1, "passed", "belt")], "comes back from passed"),
        ([ARRIVED, OTHER, moved(1, "belt", "gripper"), moved(2, "belt", "gripper")], "which is not empty"),
        (
            [Event(1, 0.0, "tray_moved_to", {"tray": 1, "source": "stack", "target": "gripper"})],
            "never arrived",
        ),
    ],
)
def test_the_auditor_sees_what_cannot_be(events: list[Event], mistake: str) -> None:
    found = audit(events).mistakes
    assert len(found) == 1
    assert mistake in found[0]
