"""What planning and selection take where nobody says otherwise: node, commands and library."""

PLANNER = 'fast-downward-opt'  # unified-planning's name of the engine
WORKERS = 2  # planning processes at a time
PLANNING_TIMEOUT = 10.0  # seconds, for each belief
MEMORY_LIMIT = 1024  # MiB, for each search
DEADLINE = 60.0  # seconds, for the planning of a whole update (the library has none)
PLANS_PER_BELIEF = 300
MAX_BELIEFS = 1024
SENTENCES = 3  # N
SELECTION_BUDGET = 0.5  # seconds, to prove the best choice
