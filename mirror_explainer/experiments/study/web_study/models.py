"""The tables: the study's design, participants, and each step that was shown to one of them."""

from django.db import models


class Study(models.Model):
    """The one study of a database. `design` is design.to_json()."""

    design = models.TextField()


class Participant(models.Model):
    """Somebody who takes part.

    `name`, random, is what the tables call them; `code`, random and secret, is what
    they come back with. `number` counts from 0 and decides who hears what; `turns`
    are [scenario, strategy] in the order in which they are met, the practice first.
    """

    name = models.CharField(max_length=16, unique=True)
    code = models.CharField(max_length=32, unique=True)
    number = models.PositiveIntegerField(unique=True)
    turns = models.JSONField()


class Step(models.Model):
    """A step of a scenario: shown to a participant, and then answered, once.

    `step` counts from 1. `shown_at` is when its page was first asked for, and `pages`
    how often it was sent. `answer` is a goal's name or DONT_KNOW, and `seconds` the time from
    `shown_at` until it came; both are None before.
    """

    participant = models.ForeignKey(Participant, on_delete=models.CASCADE)
    scenario = models.CharField(max_length=64)
    step = models.PositiveIntegerField()
    shown_at = models.DateTimeField()
    pages = models.PositiveIntegerField(default=0)
    answer = models.CharField(max_length=200, null=True)
    seconds = models.FloatField(null=True)

    class Meta:
        """Nothing is answered twice."""

        constraints = [
            models.UniqueConstraint(
                fields=['participant', 'scenario', 'step'], name='one_answer_a_step'
            )
        ]
