"""Files that are read and watched."""

import os
import stat
from pathlib import Path

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.text_files import TextFiles, read_text


def test_a_change_shows_once_even_if_the_file_was_read_again_before_anybody_looked(
    tmp_path: Path,
) -> None:
    path = tmp_path / 'model.yaml'
    path.write_text('first')
    files = TextFiles()
    files.read(str(path))
    before = files.changed()
    path.write_text('second one')

    text = files.read(str(path))

    assert text == 'second one'
    assert [before, files.changed(), files.changed()] == [False, True, False]


def test_a_file_that_would_be_waited_for_is_no_text_yet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As some files in /proc, which count as regular ones.
    path = tmp_path / 'model.yaml'
    os.mkfifo(path)
    monkeypatch.setattr(stat, 'S_ISREG', lambda mode: True)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    writer = os.open(path, os.O_WRONLY)
    try:
        with pytest.raises(InputError, match='there is nothing in it yet'):
            read_text(str(path))
    finally:
        os.close(reader)
        os.close(writer)
