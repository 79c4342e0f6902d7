"""Keeps numpy to one thread, unless the environment says otherwise: to be imported before numpy.

Our matrices are small: numpy's own threads only wait for one another, and take the processors from
the robot. What is a process of its own imports this; the library leaves its user's numpy alone.
"""

import os

os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
