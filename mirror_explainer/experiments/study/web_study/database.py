"""Opening a study's database: what it was designed as, or a design made for a new one."""

import secrets
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from mirror_explainer.errors import InputError
from mirror_explainer.experiments.study.web_study.design import Design, from_json, to_json
from mirror_explainer.experiments.study.web_study.study_file import StudyFile
from mirror_explainer.web.address import Address
from mirror_explainer.web.site import Site, configure


def open_database(
    file: Path,
    make: Callable[[], Design] | None = None,
    address: Address | None = None,
    texts: StudyFile | None = None,
) -> tuple[Design, StudyFile, str]:
    """Return the design that the database holds, its texts, and the researcher's key.

    The design is made by `make` where there is none yet; `texts` replace those of before.
    Without `make` a missing database or an empty one is an InputError, and so is
    always a file that is no database, or that of something else.
    """
    if make is None and not file.is_file():
        raise InputError(str(file), 'there is no such file', cure='"serve" makes one.')
    from django.db import DatabaseError

    try:
        _check(file)
        configure(Site('study', 'mirror_explainer.experiments.study.web_study', file), address)
        from mirror_explainer.experiments.study.web_study.models import Study

        study = Study.objects.first()
        if study is None:
            if make is None:
                raise InputError(str(file), 'no study was served from it yet')
            key = secrets.token_urlsafe(16)
            defaults = {'design': to_json(make()), 'key': key}
            study, _ = Study.objects.get_or_create(pk=1, defaults=defaults)
        if make and not study.key:  # of a version that had no such page
            study.key = secrets.token_urlsafe(16)
        if texts is not None:
            study.texts = texts.model_dump_json()
        if make:
            study.save()
    except (DatabaseError, sqlite3.DatabaseError) as error:
        raise InputError(str(file), f'it cannot be used as a database ({error})') from error
    return from_json(study.design), StudyFile.model_validate_json(study.texts), study.key


def _check(file: Path) -> None:
    """Raise InputError for a database that has tables, but not ours; it is left as it is."""
    if not file.exists():
        return
    with closing(sqlite3.connect(f'{file.resolve().as_uri()}?mode=ro', uri=True)) as database:
        found = database.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
    if found and ('web_study_study',) not in found:
        raise InputError(str(file), "it is not a study's", cure='Name another --database.')
