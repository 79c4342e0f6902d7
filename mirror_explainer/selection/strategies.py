"""How to choose what to say, by name: apart, for a page that offers it loads nothing else."""

STRATEGIES = ('informative', 'increasing', 'decreasing')
