"""Every state of a small reactor is reached and a law asked at every step: is it safe to remove a reaction like this?

    $ python examples/08_explore.py
"""

from planner_reactor.analysis.explore import explore
from planner_reactor.rs.evolves import Config, World, started
from planner_reactor.rs.leaves import Step
from planner_reactor.rs.loading import load, load_process
from planner_reactor.rs.states import Leaf
from planner_reactor.rs.vocabulary import Signature

SIGNATURES = {name: Signature(name, window=(0.0, float("inf"))) for name in ("Call", "Work")}
PROGRAM = load(
    """
    Plant = (E[1] # P[1]) | (E[2] # P[2])
    P[1] = Call :; ASSERT[job]
    P[2] = SIT[job]<k> :; (~(Work : SUCCEED[job, k]) : FAIL[job, k])
    """,
    signatures=SIGNATURES,
)
WORLD = World(PROGRAM, SIGNATURES)  # Call and Work may end at any time, with stop or with abort


def safe(before: Config, step: Step) -> bool:
    """When the script has come to its KILL, nothing is in service."""
    leaves = [spot.leaf for spot in step.after.spots()]
    about_to_kill = any(isinstance(leaf, Leaf) and leaf.name == "KILL" for leaf in leaves)
    return not (about_to_kill and step.after.store.run)


for script in ("WAIT[job] : INHIBIT[job] : KILL[2]", "WAITINHIBIT[job] : KILL[2]", "DRAIN[job] : KILL[2]"):
    config = Config()
    for process in ("Plant", script):
        term = load_process(process, given=PROGRAM, signatures=SIGNATURES)
        config = started(term, WORLD, config=config)
    found = explore(config, WORLD, laws={"safe": safe})
    print(f"{script}: {len(found.states)} states, {'UNSAFE, for example:' if found.violations else 'safe'}")
    for violation in found.violations[:1]:
        for name, arguments, status, values in violation.path:
            print("   ", name, *arguments, status, *values)
