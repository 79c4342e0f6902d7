"""What tests of further plans need."""

import pytest

from mirror_explainer.planning.downward.program import find_kstar

needs_kstar = pytest.mark.skipif(not find_kstar(), reason='kstar-planner is not installed')
