"""Files that are read and watched."""

from pathlib import Path

from mirror_explainer.text_files import TextFiles


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
