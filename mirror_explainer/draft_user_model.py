"""What `python3 -m mirror_explainer.draft_user_model` runs."""

import sys

from mirror_explainer.commands.draft_user_model import main

if __name__ == '__main__':
    sys.exit(main())
