"""What the examples' robots say, from beginning to end: `scripts/benchmark transcripts`.

Prints the tables of docs/transcripts.md.
"""

from whole_tasks import CONFIG, EXAMPLES, table, transcript


def main() -> None:
    """Print them."""
    for name in EXAMPLES:
        print(f'## {name}\n\n{table(transcript(CONFIG / name))}\n')


if __name__ == '__main__':
    main()
