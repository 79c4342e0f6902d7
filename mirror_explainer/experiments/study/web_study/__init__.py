"""The user study with people: its pages, and the database that holds what they answer.

A Django app on the foundation of `mirror_explainer.web`. The same scenarios, strategies,
steps and measures as the simulated study's: those functions are used, none is repeated.
"""
