"""What a study has that is sent to people: its texts, languages, checks, and times of browsers."""

from typing import Any

from django.db import migrations, models


def _field(model: str, name: str, field: Any) -> Any:
    return migrations.AddField(model_name=model, name=name, field=field)


class Migration(migrations.Migration):
    """More of the study, of participants and of steps."""

    dependencies = [('web_study', '0001_initial')]

    operations = [
        _field('study', 'texts', models.TextField(default='{}')),
        _field('study', 'key', models.CharField(max_length=32, default='')),
        _field('participant', 'language', models.CharField(max_length=8, default='en')),
        _field('participant', 'parameters', models.JSONField(default=dict)),
        _field('participant', 'began', models.DateTimeField(null=True)),
        _field('participant', 'checks', models.PositiveIntegerField(default=0)),
        # Who had begun before there were such questions is not asked them in the middle.
        _field('participant', 'checked', models.BooleanField(default=True)),
        migrations.AlterField('participant', 'checked', models.BooleanField(default=False)),
        _field('participant', 'closing', models.JSONField(null=True)),
        _field('step', 'in_browser', models.FloatField(null=True)),
    ]
