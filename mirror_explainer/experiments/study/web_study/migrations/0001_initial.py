"""The first tables (as Django's makemigrations writes them)."""

import django.db.models.deletion
from django.db import migrations, models


class Migration(migrations.Migration):
    """Participants, the study, and the steps shown."""

    initial = True

    dependencies: list[tuple[str, str]] = []

    operations = [
        migrations.CreateModel(
            name='Participant',
            fields=[
                (
                    'id',
                    models.BigAutoField(
                        auto_created=True, primary_key=True, serialize=False, verbose_name='ID'
                    ),
                ),
                ('name', models.CharField(max_length=16, unique=True)),
                ('code', models.CharField(max_length=32, unique=True)),
                ('number', models.PositiveIntegerField(unique=True)),
                ('turns', models.JSONField()),
            ],
        ),
        migrations.CreateModel(
            name='Study',
            fields=[
                (
                    'id',
                    models.BigAutoField(
                        auto_created=True, primary_key=True, serialize=False, verbose_name='ID'
                    ),
                ),
                ('design', models.TextField()),
            ],
        ),
        migrations.CreateModel(
            name='Step',
            fields=[
                (
                    'id',
                    models.BigAutoField(
                        auto_created=True, primary_key=True, serialize=False, verbose_name='ID'
                    ),
                ),
                ('scenario', models.CharField(max_length=64)),
                ('step', models.PositiveIntegerField()),
                ('shown_at', models.DateTimeField()),
                ('pages', models.PositiveIntegerField(default=0)),
                ('answer', models.CharField(max_length=200, null=True)),
                ('seconds', models.FloatField(null=True)),
                (
                    'participant',
                    models.ForeignKey(
                        on_delete=django.db.models.deletion.CASCADE, to='web_study.participant'
                    ),
                ),
            ],
            options={
                'constraints': [
                    models.UniqueConstraint(
                        fields=('participant', 'scenario', 'step'), name='one_answer_a_step'
                    )
                ],
            },
        ),
    ]
