"""`verbalize` on every PUCRS problem, N = 1 … 5, as a user would run it: times and marks.

Run `MIRROR_EXPLAINER_PUCRS=FOLDER scripts/benchmark pucrs [DEADLINE]`. Prints a Markdown
table with one line a problem: the slowest and the mean of its five runs, which include the start
of Python and the reading of PDDL. Exit status 1 if a problem that is not marked hard was not
answered optimally and completely.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SIZES = range(1, 6)


def main() -> int:
    """Print the table; return 1 if a problem that is not hard failed."""
    deadline = sys.argv[1] if len(sys.argv) > 1 else '60'
    dataset = Path(os.environ['MIRROR_EXPLAINER_PUCRS'])
    tiers = {
        entry['instance']: entry['lmcut_tier']
        for entry in json.loads((dataset / 'manifest.json').read_text())['instances']
    }
    failures = 0
    print('| problem | tier | goals | plan | slowest s | mean s | planning s | calls '
          '| optimal | complete | unknown mass |')  # fmt: skip
    print('|---|---|---|---|---|---|---|---|---|---|---|')
    for folder in sorted(path.parent for path in dataset.glob('*/*/domain.pddl')):
        runs = [_run(folder, n, deadline) for n in SIZES]
        answers = [answer for _, answer in runs if answer]
        seconds = [s for s, _ in runs]
        good = len(answers) == len(runs) and all(a['optimal'] and a['complete'] for a in answers)
        failures += not good and tiers[folder.name] != 'hard'
        told = answers[-1] if answers else None
        cells = [folder.name, tiers[folder.name]]
        cells += [len(told['goals']), len(told['plan'])] if told else ['-', '-']
        cells += [f'{max(seconds):.2f}', f'{sum(seconds) / len(seconds):.2f}']
        if told:
            cells += [f'{told["seconds"]["planning"]:.2f}', told['planner_calls']]
            cells += [told['optimal'], told['complete'], f'{told["unknown_mass"]:.2f}']
        print('| ' + ' | '.join(map(str, cells)) + ' |', flush=True)
    return 1 if failures else 0


def _run(folder: Path, n: int, deadline: str) -> tuple[float, dict | None]:
    """Return the seconds of one run of the command, and its answer (None if it failed)."""
    goal = (folder / 'real_hyp.dat').read_text().replace(',', ' ')
    with tempfile.TemporaryDirectory() as temporary:
        problem = Path(temporary) / 'problem.pddl'
        problem.write_text((folder / 'template.pddl').read_text().replace('<HYPOTHESIS>', goal))
        user_model = Path(temporary) / 'user_model.yaml'
        user_model.write_text(f'hyps_file: {json.dumps(str(folder / "hyps.dat"))}\n')
        command = [
            sys.executable,
            '-m',
            'mirror_explainer.commands.verbalize',
            '--json',
            '-n',
            str(n),
        ]
        command += ['--domain', str(folder / 'domain.pddl'), '--problem', str(problem)]
        command += ['--user-model', str(user_model), '--deadline', deadline]
        start = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True)
        seconds = time.perf_counter() - start
    if done.returncode:
        print(f'{folder.name} N={n}: {done.stderr.strip()}', file=sys.stderr)
        return seconds, None
    return seconds, json.loads(done.stdout)


if __name__ == '__main__':
    sys.exit(main())
