"""The tables: the study's design, participants, and each step that was shown to one of them."""

from django.db import models


class Study(models.Model):
    """The one study of a database.

    `design` is design.to_json(); `texts` is the StudyFile it was last served with, as JSON;
    `key`, random and secret, is what the researcher's page is opened with.
    """

    design = models.TextField()
    texts = models.TextField(default='{}')
    key = models.CharField(max_length=32, default='')


class Participant(models.Model):
    """Somebody who takes part.

    `name`, random, is what the tables call them; `code`, random and secret, is what
    they come back with. `number` counts from 0 and decides who hears what; `turns`
    are [scenario, strategy, order of the choices] as they are met, the practice first.
    `parameters` are those of the address that the study keeps, `checks` counts the
    tries at the questions after the practice, and `checked` says that one was right;
    `closing` are the answers to the last page, None before.
    """

    name = models.CharField(max_length=16, unique=True)
    code = models.CharField(max_length=32, unique=True)
    number = models.PositiveIntegerField(unique=True)
    turns = models.JSONField()
    language = models.CharField(max_length=8, default='en')
    parameters = models.JSONField(default=dict)
    began = models.DateTimeField(null=True)
    checks = models.PositiveIntegerField(default=0)
    checked = models.BooleanField(default=False)
    closing = models.JSONField(null=True)


class Step(models.Model):
    """A step of a scenario: shown to a participant, and then answered, once.

    `step` counts from 1. `shown_at` is when its page was first asked for, and `pages`
    how often it was sent. `answer` is a goal's name or DONT_KNOW, and `seconds` the time from
    `shown_at` until it came; `in_browser` is the time that it took there, in seconds, None
    without scripts. All are None before.
    """

    participant = models.ForeignKey(Participant, on_delete=models.CASCADE)
    scenario = models.CharField(max_length=64)
    step = models.PositiveIntegerField()
    shown_at = models.DateTimeField()
    pages = models.PositiveIntegerField(default=0)
    answer = models.CharField(max_length=200, null=True)
    seconds = models.FloatField(null=True)
    in_browser = models.FloatField(null=True)

    class Meta:
        """Nothing is answered twice."""

        constraints = [
            models.UniqueConstraint(
                fields=['participant', 'scenario', 'step'], name='one_answer_a_step'
            )
        ]
