"""Plans as planners and `ros2 topic echo` print them, with all that stands around."""

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.plan_text import read_plan

FF = """
ff: parsing domain file
domain 'HALL' defined
 ... done.
ff: found legal plan as follows

step    0: MOVE A B
        1: GRAB CUP B

time spent:    0.00 seconds instantiating 4 easy, 0 hard action templates
               0.00 seconds total time
"""
POPF = """
Number of literals: 3
Constructing lookup tables: [10%] [20%]
Post filtering unreachable actions:
b (3.000 | 10.000)
; Plan found with metric 20.0
; States evaluated so far: 9
; Time 0.02
0.000: (move a c)  [10.000]
10.001: (move c b)  [10.000]

* All goal deadlines now no later than 20.001

Resorting to best-first search
;;;; Solution Found
; States evaluated: 4
; Cost: 12.001
; Time 0.00
0.000: (move a b)  [10.000]
10.001: (grab cup b)  [2.000]
"""
TFD = """
Solution with original makespan 12 found (ignoring no-moving-targets-rule).
Found new plan:
0.00100000: (move a b) [10.0000]
10.00200000: (grab cup b) [2.0000]
Rescheduled plan
"""
LPG = """
 NUMERIC_THREATS_MODE: 0
Computing mutex... done
Solution number: 1
Total time: 0.01

0.0003:   (MOVE A B) [D:10.00; C:0.10]
10.0005:   (GRAB CUP B) [D:2.00; C:0.10]

 METRIC_VALUE = 2.00
"""
ENHSP = """
Domain parsed
Grounding..
H1 Setup Time (msec): 12
Found Plan:
0.0: (move a b)
1.0: (grab cup b)

Plan-Length:2
Metric (Search):2.0
Planning Time (msec): 100
"""
DOWNWARD = """
INFO     Running search (release).
[t=0.0003s, 10160 KB] New best heuristic value for ff: 2
[t=0.0004s, 10160 KB] Solution found!
[t=0.0004s, 10160 KB] Actual search time: 0.0001s
move a b (1)
grab cup b (1)
[t=0.0004s, 10160 KB] Plan length: 2 step(s).
[t=0.0004s, 10160 KB] Plan cost: 2
"""
STRING = """data: '(move a b)

  (grab cup b)'
---
"""
PLANSYS2 = """items:
- time: 0.0
  action: (move a b)
  duration: 10.0
- time: 10.000999450683594
  action: (grab cup b)
  duration: 2.0
---
"""
OUTPUTS = {
    'FF': FF,
    'POPF': POPF,
    'TFD': TFD,
    'LPG': LPG,
    'ENHSP': ENHSP,
    'Fast Downward': DOWNWARD,
    'a String': STRING,
    'a plan of PlanSys2': PLANSYS2,
    'one line': '(move a b) (grab cup b)\n',
}


@pytest.mark.parametrize('text', OUTPUTS.values(), ids=OUTPUTS)
def test_the_plan_is_found_in_what_is_printed_around_it(text: str) -> None:
    assert [step.action for step in read_plan(text)] == ['(move a b)', '(grab cup b)']


def test_the_times_of_a_plan_in_an_output_are_its_own() -> None:
    for text in (POPF, PLANSYS2):
        first, second = read_plan(text)
        assert (first.start, first.end) == (0.0, 10.0)
        assert second.start == pytest.approx(10.001)


def test_the_lines_of_a_plan_in_an_output_are_those_of_the_text() -> None:
    assert [step.line for step in read_plan(ENHSP)] == [6, 7]


@pytest.mark.parametrize(
    'text',
    ['(move a b)\nx y', 'No solution found for 3 of 4', 'data: 5', 'items: []', 'Found Plan:\n'],
)
def test_what_is_no_plan_stays_refused(text: str) -> None:
    with pytest.raises(InputError, match='this is no action of a plan'):
        read_plan(text)
