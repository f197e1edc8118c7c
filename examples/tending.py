"""The world of tending.itl: a rack of blanks, a lathe, a mill, one arm, a bench with a gauge, a store, and the scrap.

    $ planner-reactor check examples/tending.itl --host examples/tending.py
    $ planner-reactor plan examples/tending.itl --steps 1
    $ planner-reactor plan examples/tending.itl --without SHARP --steps 1
    $ planner-reactor loop examples/tending.itl --host examples/tending.py --until 3600 \
          --faults examples/tending.toml --goals examples/tending.goals.toml --relax PLACED

Every piece is counted: in the rack, in the gripper, in a chuck, on the bench, stored, or scrapped. The robot's side has
a gripper that feels whether it holds something, switches at chucks and doors, lamps, spindle loads, a camera over the
rack, and the gauge. Where blanks lie, how worn a tool is and what a part truly measures it never sees.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from planner_reactor.runtime import Aborted, Host, Scheduler, Signal

MACHINES = {"lathe": 40.0, "mill": 70.0}  # and the seconds of a cycle
WEAR, LIMIT, TOLERANCE = 0.0003, 0.06, 0.05  # millimetres: in a cycle, of a worn tool, of a part


class Machine:
    """A door, a chuck, a tool, a lamp."""

    def __init__(self, cycle_s: float) -> None:
        self.cycle_s, self.slow_until, self.factor, self.sticks = cycle_s, -1.0, 1.0, 0
        self.door, self.chuck, self.cut, self.worn = False, "", False, 0.0
        self.due_s, self.running, self.changed = 0.0, False, Signal("machine")


class Workshop:
    """The truth. A World: it starts, keeps its books, and lets faults strike."""

    faults: Mapping[str, Mapping[str, Any]] = {
        "skewed": {"count": 3}, "slow": {"machine": "mill", "seconds": 300.0, "factor": 1.6},
        "worn": {"machine": "lathe", "seconds": 400.0}, "door_sticks": {"machine": "mill", "count": 2},
    }  # fmt: skip

    def __init__(self, scheduler: Scheduler) -> None:
        self.scheduler, self.chance = scheduler, scheduler.random("measures")
        self.machines = {name: Machine(cycle_s) for name, cycle_s in MACHINES.items()}
        self.pieces = Counter(delivered=0, rack=0, gripper=0, chucks=0, bench=0, stored=0, scrapped=0)
        self.size: dict[str, float] = {}  # of what was cut: how far from what it should measure
        self.out_of_tolerance = self.skewed = self.bumps = self.swept = 0

    def start(self, scheduler: Scheduler) -> None:
        self.deliver()

    def deliver(self) -> None:
        self.pieces.update(delivered=20, rack=20)
        self.scheduler.call_after(600.0, self.deliver)

    def move(self, source: str, target: str) -> None:
        self.pieces.update({source: -1, target: 1})

    def begin(self, machine: Machine) -> None:
        slow = machine.factor if self.scheduler.now < machine.slow_until else 1.0
        machine.door, machine.running, machine.due_s = False, True, self.scheduler.now + machine.cycle_s
        self.scheduler.call_after(machine.cycle_s * slow, lambda: self.end(machine))

    def end(self, machine: Machine) -> None:
        machine.worn += WEAR
        self.size[machine.chuck] = machine.worn + self.chance.gauss(0.0, 0.005)
        machine.running, machine.cut = False, True
        machine.changed.fire()

    def change_tool(self, machine: Machine) -> None:
        machine.worn = 0.0

    def strike(self, kind: str, **parameters: Any) -> bool:
        given = {**self.faults[kind], **parameters}
        if kind == "skewed":
            self.skewed += given["count"]
            return True
        machine = self.machines[given["machine"]]
        if kind == "slow":
            machine.slow_until, machine.factor = self.scheduler.now + given["seconds"], given["factor"]
        elif kind == "worn":
            machine.worn = LIMIT
            self.scheduler.call_after(given["seconds"], lambda: self.change_tool(machine))
        else:
            machine.sticks += given["count"]
        return True

    def ledger(self) -> Mapping[str, int]:
        return dict(self.pieces)

    def balanced(self) -> bool:
        held = self.pieces.total() - self.pieces["delivered"]
        chucks = sum(bool(machine.chuck) for machine in self.machines.values())
        return held == self.pieces["delivered"] and min(self.pieces.values()) >= 0 and self.pieces["chucks"] == chucks

    def finished(self) -> bool:
        return False  # there are always blanks: give the run an end with --until

    def report(self) -> Mapping[str, object]:
        return {
            "pieces": self.ledger(), "out_of_tolerance": self.out_of_tolerance, "bumps": self.bumps, "swept": self.swept
        }  # fmt: skip


class Robot:
    """What the robot knows, and its one arm: who asked first has it first, and holds it while it holds something."""

    def __init__(self, shop: Workshop) -> None:
        self.shop = shop
        self.queue: list[object] = []
        self.freed = Signal("arm")
        self.held = ""  # what is in the gripper
        self.holder: object = None
        self.looked = False  # is it known how the next blank lies?
        self.numbered = 0
        self.on_bench: dict[str, str] = {}  # machine → its part
        self.done: set[str] = set()  # parts that have left

    def take(self) -> Iterator[Any]:
        me = object()
        self.queue.append(me)
        while self.queue[0] is not me or self.held:
            yield self.freed

    def let_go(self) -> None:
        if not self.held:
            self.queue.pop(0)
            self.freed.fire()


def host(scheduler: Scheduler) -> Host:
    """The robot's side of a fresh workshop."""
    made = Host("tending")
    made.world = shop = Workshop(scheduler)
    robot = Robot(shop)
    gauge = scheduler.random("gauge")

    def at_door(name: str) -> Machine:
        machine = shop.machines[name]
        if not machine.door:
            shop.bumps += 1
            made.report("DOORS", False, f"the arm felt the door of the {name}")
            raise Aborted(f"the door of the {name} is not open")
        return machine

    @made.process(window=(2.0, 2.0))
    def OpenDoor(name: str) -> Iterator[float]:
        machine = shop.machines[name]
        yield 2.0
        if machine.sticks:
            machine.sticks -= 1
        elif not machine.running:
            machine.door = True

    @made.process(window=(0.0, 600.0))
    def TakeBlank(name: str) -> Iterator[Any]:
        if shop.machines[name].chuck:
            return  # its switch says that there is something in it
        yield from robot.take()
        yield 4.0
        lies_well = robot.looked or not shop.skewed
        shop.skewed -= bool(shop.skewed)
        robot.looked = False
        if not lies_well or not shop.pieces["rack"]:
            made.report("PLACED", False, "the gripper closed on nothing")
            robot.let_go()
            raise Aborted("no blank where there should be one")
        robot.numbered += 1
        robot.held = f"p{robot.numbered}"
        shop.move("rack", "gripper")

    @made.process(window=(0.0, 5.0))
    def PutIn(name: str) -> Iterator[float]:
        if not robot.held:
            return
        yield 5.0
        at_door(name).chuck = robot.held
        shop.machines[name].cut, robot.held = False, ""
        shop.move("gripper", "chucks")
        robot.let_go()

    @made.process(window=(0.0, 70.0))
    def Run(name: str) -> Iterator[float]:
        machine = shop.machines[name]
        if not machine.cut and not machine.running:
            shop.begin(machine)
        yield max(machine.due_s - scheduler.now, 0.0)

    @made.process(window=(0.0, 120.0))
    def AwaitLamp(name: str) -> Iterator[Signal]:
        while shop.machines[name].running:
            yield shop.machines[name].changed

    @made.process(results=("part",), window=(0.0, 600.0))
    def TakeOut(name: str) -> Iterator[Any]:
        if name in robot.on_bench:
            return robot.on_bench[name]  # it was laid down by somebody who did not come to an end
        yield from robot.take()
        yield 5.0
        try:
            machine = at_door(name)
            if not machine.chuck:
                raise Aborted(f"there is nothing in the {name}")
        except Aborted:
            robot.let_go()
            raise
        robot.held, machine.chuck, machine.cut = machine.chuck, "", False
        shop.move("chucks", "gripper")
        robot.on_bench[name] = robot.held  # where it is going
        return robot.held

    @made.process(window=(0.0, 3.0))
    def LayDown(part: str) -> Iterator[float]:
        if robot.held == part:
            yield 3.0
            robot.held = ""
            shop.move("gripper", "bench")
            robot.let_go()

    @made.process(window=(0.0, 5.0))
    def PutDown() -> Iterator[float]:
        if robot.held:
            yield 5.0
            blank = robot.held not in shop.size
            robot.held = ""
            shop.move("gripper", "rack" if blank else "bench")
            robot.let_go()

    def leave(name: str, part: str, where: str) -> None:
        robot.done.add(part)
        robot.on_bench.pop(name, None)
        shop.move("bench", where)

    @made.process(window=(0.0, 6.0))
    def Gauge(name: str, part: str) -> Iterator[float]:
        if part not in robot.done:
            yield 6.0
            if abs(shop.size[part] + gauge.gauss(0.0, 0.002)) > TOLERANCE:
                leave(name, part, "scrapped")
                raise Aborted(f"{part} is out of tolerance")

    @made.process(window=(0.0, 600.0))
    def Store(part: str) -> Iterator[Any]:
        if part in robot.done:
            return
        yield from robot.take()
        yield 4.0
        shop.out_of_tolerance += abs(shop.size[part]) > TOLERANCE  # the customer will find out
        leave(next(name for name, other in robot.on_bench.items() if other == part), part, "stored")
        robot.let_go()

    @made.process(window=(0.0, 600.0))
    def Sweep(name: str) -> Iterator[Any]:
        yield from robot.take()
        yield 8.0
        shop.swept += 1
        robot.let_go()

    @made.process(window=(3.0, 3.0))
    def LookAtRack() -> Iterator[float]:
        yield 3.0
        robot.looked = True

    @made.process(window=(0.0, 12.0))
    def AwaitDoor(name: str) -> Iterator[float]:
        machine = shop.machines[name]
        for _ in range(4):
            if machine.door or machine.running:
                return
            yield 2.0
            machine.sticks -= bool(machine.sticks)
            machine.door = not machine.sticks
        raise Aborted(f"the door of the {name} is stuck")

    def in_time() -> bool:
        return not any(machine.running and scheduler.now > machine.due_s + 1 for machine in shop.machines.values())

    def sharp() -> bool:
        loads = [machine.worn / LIMIT + gauge.gauss(0.0, 0.05) for machine in shop.machines.values()]
        return max(loads) < 0.95

    made.assumption("INTIME")(in_time)
    made.assumption("SHARP")(sharp)
    made.assumption("PLACED")(lambda: None)  # told by TakeBlank
    made.assumption("DOORS")(lambda: None)  # told by the arm
    return made
