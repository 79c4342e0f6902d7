"""What the stand-in for PlanSys2 is to carry out, and a greenhouse's robot for it."""

import json
from dataclasses import asdict, dataclass, field


@dataclass
class Step:
    """An action of the plan, and the facts that it adds and deletes as it starts and ends."""

    time: float
    action: str
    duration: float
    start: dict[str, list[str]] = field(default_factory=dict)
    end: dict[str, list[str]] = field(default_factory=dict)


@dataclass
class Task:
    """What the robot is to do. `objects` are by type; facts and goal are texts of PDDL."""

    domain: str
    objects: dict[str, list[str]]
    facts: list[str]
    goal: str
    plan: list[Step]
    status_period: float = 1.0
    active: bool = True

    def json(self) -> str:
        return json.dumps(asdict(self))

    @classmethod
    def read(cls, text: str) -> 'Task':
        values = json.loads(text)
        return cls(**values | {'plan': [Step(**step) for step in values['plan']]})

    def problem(self, facts: list[str]) -> str:
        """Return the problem as PlanSys2 prints it."""
        name = self.domain.split('domain', 1)[1].split(')')[0].strip()
        objects = ''.join(
            f'\t{" ".join(names)} - {kind}\n' for kind, names in self.objects.items()
        )
        inits = ''.join(f'\t{fact.replace("(", "( ").replace(")", " )")}\n' for fact in facts)
        return (
            f'( define ( problem problem_1 )\n( :domain {name} )\n( :objects\n{objects})\n'
            f'( :init\n{inits})\n( :goal\n\t{self.goal}\n)\n)\n'
        )


GREENHOUSE = """( define ( domain greenhouse )
( :requirements :strips :typing :durative-actions )
( :types
	bed - object
	cart - object
	tool - object
)
( :predicates
	( at_bed ?c - cart ?b - bed )
	( lies_at ?t - tool ?b - bed )
	( carries ?c - cart ?t - tool )
)
( :durative-action roll
  :parameters ( ?c - cart ?a - bed ?b - bed )
  :duration (= ?duration 6)
  :condition ( and ( at start ( at_bed ?c ?a ) ) )
  :effect ( and ( at start ( not ( at_bed ?c ?a ) ) ) ( at end ( at_bed ?c ?b ) ) )
)
( :durative-action fetch
  :parameters ( ?c - cart ?t - tool ?b - bed )
  :duration (= ?duration 2)
  :condition ( and ( over all ( at_bed ?c ?b ) ) ( at start ( lies_at ?t ?b ) ) )
  :effect ( and ( at start ( not ( lies_at ?t ?b ) ) ) ( at end ( carries ?c ?t ) ) )
)
)
"""


def roll(time: float, cart: str, here: str, there: str) -> Step:
    return Step(
        time,
        f'(roll {cart} {here} {there})',
        6.0,
        {'delete': [f'(at_bed {cart} {here})']},
        {'add': [f'(at_bed {cart} {there})']},
    )


def fetch(time: float, cart: str, tool: str, bed: str) -> Step:
    return Step(
        time,
        f'(fetch {cart} {tool} {bed})',
        2.0,
        {'delete': [f'(lies_at {tool} {bed})']},
        {'add': [f'(carries {cart} {tool})']},
    )


def greenhouse(**changes: object) -> Task:
    """Return the task of a cart that fetches the rake, and then the hoe."""
    plan = [
        roll(0.0, 'c1', 'gate', 'Beans'),
        fetch(6.001, 'c1', 'rake', 'Beans'),
        roll(8.002, 'c1', 'Beans', 'herbs'),
        fetch(14.003, 'c1', 'hoe', 'herbs'),
    ]
    task = Task(
        domain=GREENHOUSE,
        objects={'bed': ['gate', 'Beans', 'herbs'], 'cart': ['c1'], 'tool': ['rake', 'hoe']},
        facts=['(at_bed c1 gate)', '(lies_at rake Beans)', '(lies_at hoe herbs)'],
        goal='( and ( carries c1 rake ) ( carries c1 hoe ) )',
        plan=plan,
    )
    for name, value in changes.items():
        setattr(task, name, value)
    return task
