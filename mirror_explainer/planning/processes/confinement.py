"""What a planning process may see and use of the computer, and how it ranks beside others.

Set in a worker, it holds for every engine and search that the worker starts.
"""

import contextlib
import math
import os
import resource

# All that workers and engines get to see of the environment.
_VARIABLES = (
    'HOME',
    'JAVA_HOME',
    'LANG',
    'LC_ALL',
    'LD_LIBRARY_PATH',
    'PATH',
    '_ROS_WHEELS_BOOTSTRAP_COMPLETE',
)

# Added to the niceness of the program that plans: where processors are short, a planning process
# gets a third of what others get. More would mean no answers on a robot that is always busy.
_NICENESS = 5

_MOST_OPEN_FILES = 4096

# A search ends by the clock. This many seconds of processor time later it ends even if
# whoever watches the clock is gone.
_PROCESSOR_GRACE = 10
_LONGEST = 10**9


def environment(directory: str, python_path: str) -> dict[str, str]:
    """Return the environment of a worker whose files go to a directory."""
    kept = {name: os.environ[name] for name in _VARIABLES if name in os.environ}
    # The processes are what runs side by side, not threads of numerical libraries in them.
    return kept | {
        'OMP_NUM_THREADS': '1',
        'PYTHONHASHSEED': '0',  # the same input, the same answer
        'PYTHONPATH': python_path,
        'TMPDIR': directory,
    }


def confine() -> None:
    """Let this process stand back behind others, leave no core dumps, and open few files."""
    niceness = os.nice(_NICENESS)
    # Where Linux groups processes by session, niceness counts within the group only.
    with contextlib.suppress(OSError), open('/proc/self/autogroup', 'w') as group:
        group.write(str(niceness))
    _limit(resource.RLIMIT_CORE, 0)
    _limit(resource.RLIMIT_NOFILE, _MOST_OPEN_FILES)


def limit_memory(mebibytes: int) -> None:
    """Limit the data of this process, and of each it starts, and the size of their files."""
    _limit(resource.RLIMIT_DATA, mebibytes << 20)
    _limit(resource.RLIMIT_FSIZE, mebibytes << 20)


def limit_search(pid: int, seconds: float) -> None:
    """Limit the processor time of a search that may take so many seconds."""
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    limit = _lower(math.ceil(min(seconds, _LONGEST)) + _PROCESSOR_GRACE, hard)
    # It may have ended already.
    with contextlib.suppress(ProcessLookupError):
        resource.prlimit(pid, resource.RLIMIT_CPU, (limit, limit))


def limit_engine(seconds: float | None) -> None:
    """Limit the processor time of this process from now on, None: no more.

    An engine within it, or started by it, may use all processors for so many seconds.
    """
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    soft = hard
    if seconds is not None:
        usage = resource.getrusage(resource.RUSAGE_SELF)
        processors = os.cpu_count() or 1
        used = usage.ru_utime + usage.ru_stime + min(seconds, _LONGEST) * processors
        soft = _lower(math.ceil(used) + _PROCESSOR_GRACE, hard)
    resource.setrlimit(resource.RLIMIT_CPU, (soft, hard))


def _limit(what: int, most: int) -> None:
    """Lower a limit for good, unless it is lower already."""
    lower = _lower(most, resource.getrlimit(what)[1])
    resource.setrlimit(what, (lower, lower))


def _lower(limit: int, other: int) -> int:
    return limit if other == resource.RLIM_INFINITY else min(limit, other)
