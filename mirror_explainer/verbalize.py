"""`python3 -m mirror_explainer.verbalize` is `ros2 run mirror_explainer verbalize`."""

import sys

from mirror_explainer.commands.verbalize import main

if __name__ == '__main__':
    sys.exit(main())
