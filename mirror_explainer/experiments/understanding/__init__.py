"""Who understands what: each listener as speaker, judged by each, many plans a belief."""
