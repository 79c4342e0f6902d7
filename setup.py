from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = 'mirror_explainer'
SHARE = f'share/{PACKAGE}'


def data_files(folder):
    """Return (target, files) pairs that install a folder as it is."""
    folders = [Path(folder), *(path for path in Path(folder).rglob('*') if path.is_dir())]
    return [
        (f'{SHARE}/{path}', [str(file) for file in path.iterdir() if file.is_file()])
        for path in folders
    ]


setup(
    name=PACKAGE,
    version='0.1.0',
    packages=find_packages(include=[PACKAGE, f'{PACKAGE}.*']),
    package_data={'': ['static/*', 'templates/*', 'templates/*/*', 'texts/*']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{PACKAGE}']),
        (SHARE, ['package.xml', 'LICENSE']),
        *data_files('config'),
        *data_files('launch'),
    ],
    python_requires='>=3.11',
    install_requires=[
        # up-fast-downward brings it, but what we use of its inside may change with any version.
        'fast-downward-translate>=26.6,<27',
        'lemminflect>=0.2.3',
        'numpy>=1.26',
        'pydantic>=2.5',
        'pyyaml>=6.0',
        'setuptools',
        'unified-planning>=1.3,<1.4',
        'up-fast-downward>=1.0,<2',
    ],
    extras_require={
        'experiments': ['matplotlib>=3.7', 'pandas', 'rich>=13', 'scipy', 'tabulate', 'tqdm'],
        'plans': ['kstar-planner>=1.6,<2'],
        'web': [
            'Django>=5.2,<6',
            'django-htmx>=1.29',
            'markdown-it-py>=3',
            'waitress>=3',
            'whitenoise>=6.9',
        ],
        'docs': ['furo', 'myst-parser', 'sphinx', 'sphinxcontrib-mermaid'],
        'test': [
            'axe-playwright-python',
            'hypothesis',
            'import-linter',
            'mypy',
            'playwright',
            'psutil',
            'py-trees',
            'pytest',
            'pytest-benchmark',
            'pytest-timeout',
            'pytest-xdist',
            'ruff',
            'pandas-stubs',
            'types-PyYAML',
            'types-psutil',
            'types-tqdm',
            'up-pyperplan',
        ],
    },
    zip_safe=False,  # templates and static files are read from where they lie
    maintainer='mirror_explainer maintainers',
    maintainer_email='maintainers@users.noreply.h-seed-a46baa60.example',
    description="Says the few actions of a robot's plan that tell the listener most.",
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'compare = mirror_explainer.commands.compare:main',
            'draft_user_model = mirror_explainer.commands.draft_user_model:main',
            'explainer_node = mirror_explainer.node.explainer_node:main',
            'operator_page = mirror_explainer.web.operator.operator_page:main',
            'plansys2_bridge = mirror_explainer.node.plansys2_bridge:main',
            'pucrs_benchmark = mirror_explainer.experiments.benchmark.pucrs:main',
            'task_list_robot = mirror_explainer.demo.task_list_robot:main',
            'user_study = mirror_explainer.experiments.study.user_study:main',
            'verbalize = mirror_explainer.commands.verbalize:main',
            'warehouse_robot = mirror_explainer.demo.warehouse_robot:main',
            'who_understands = mirror_explainer.experiments.understanding.who_understands:main',
        ],
    },
)
