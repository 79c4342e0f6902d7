"""PlanSys2's messages for the tests, built once from `plansys2_interfaces/` where there are none.

Building takes a minute, in a folder beside the environment's other files, and needs a compiler
and the wheels of ROS's generators, which get an environment of their own. As a program, this
builds them ahead of the tests.
"""

import contextlib
import fcntl
import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

SOURCES = Path(__file__).parent / 'plansys2_interfaces'
# Of what the wheels need, those that say so, and those that do not.
GENERATORS = [
    'catkin_pkg',
    'empy<4',
    'lark',
    'numpy',
    'setuptools<80',
    *(
        f'ros-jazzy-{name}'
        for name in (
            'ament-cmake',
            'ament-cmake-export-definitions',
            'ament-cmake-export-link-flags',
            'ament-cmake-export-targets',
            'ament-cmake-gmock',
            'ament-cmake-gtest',
            'ament-cmake-include-directories',
            'ament-cmake-pytest',
            'ament-cmake-ros',
            'ament-package',
            'fastcdr',
            'fastrtps',
            'fastrtps-cmake-module',
            'python-cmake-module',
            'rosidl-core-generators',
            'rosidl-default-generators',
            'std-msgs',
        )
    ),
]
# What Python needs of the package: the two libraries of functions in C that it loads by name.
TARGETS = [f'plansys2_msgs_s__rosidl_typesupport_{name}' for name in ('c', 'fastrtps_c')]
# In the wheels' CMake files: where Python and numpy were on the machine that built them.
BUILT_WITH = '/opt/python/cp{0}{1}-cp{0}{1}'.format(*sys.version_info)


def environment() -> dict[str, str]:
    """Return the variables under which a process finds `plansys2_msgs`; skip where it cannot."""
    if importlib.util.find_spec('plansys2_msgs') is not None:
        return {}
    if importlib.util.find_spec('ros_wheels_bootstrapper') is None and 'ROS_DISTRO' in os.environ:
        pytest.skip('needs PlanSys2 (sudo apt install ros-jazzy-plansys2-msgs)')
    for program in ('cmake', 'make', 'c++'):
        if shutil.which(program) is None:
            pytest.skip(f"needs {program}, to build PlanSys2's messages")
    build = _built() / 'build'
    added = {'PYTHONPATH': build / 'rosidl_generator_py', 'LD_LIBRARY_PATH': build}
    return {
        name: os.pathsep.join(filter(None, (str(path), os.environ.get(name))))
        for name, path in added.items()
    }


def _built() -> Path:
    """Return the folder of the workspace, in which the package is built."""
    digest = hashlib.sha256(sys.version.encode() + ' '.join(GENERATORS).encode())
    for file in sorted(SOURCES.rglob('*.*')):
        digest.update(file.read_bytes())
    workspace = Path(sys.prefix) / 'plansys2_msgs' / digest.hexdigest()[:12]
    workspace.mkdir(parents=True, exist_ok=True)
    with (workspace / 'lock').open('w') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # tests may run in several processes
        if not (workspace / 'done').exists():
            _build(workspace)
            (workspace / 'done').touch()
    return workspace


def _build(workspace: Path) -> None:
    """Install the generators in an environment of their own, and build with them."""
    build, prefix = workspace / 'build', workspace / 'generators'
    shutil.rmtree(build, ignore_errors=True)  # by a build that failed
    python = prefix / 'bin' / 'python'
    _run([sys._base_executable, '-m', 'venv', '--clear', '--without-pip', prefix])
    try:
        _run([sys.executable, '-m', 'pip', '--python', python, 'install', '-qq', *GENERATORS])
    except AssertionError as error:
        pytest.skip(f'needs the wheels of the generators of messages: {error}')
    version = 'python{}.{}'.format(*sys.version_info)
    moved = {
        f'{BUILT_WITH}/include/{version}': sysconfig.get_path('include'),
        f'{BUILT_WITH}/lib/{version}/site-packages': f'{prefix}/lib/{version}/site-packages',
    }
    for file in (prefix / 'share').rglob('*.cmake'):
        text = file.read_text()
        if BUILT_WITH in text:
            for there, here in moved.items():
                text = text.replace(there, here)
            file.write_text(text)
    inside = {
        'VIRTUAL_ENV': str(prefix),
        'AMENT_PREFIX_PATH': str(prefix),
        'CMAKE_PREFIX_PATH': str(prefix),
        'PATH': f'{prefix / "bin"}:{os.environ["PATH"]}',
    }
    inside = _plain_environment() | inside
    _run(['cmake', '-S', SOURCES, '-B', build, '-DBUILD_TESTING=OFF'], env=inside)
    _run(['cmake', '--build', build, '--parallel', '2', '--target', *TARGETS], env=inside)


def _plain_environment() -> dict[str, str]:
    """Return the variables without what the tests' own environment of ROS has set."""
    ours = (
        'PYTHONPATH',
        'LD_LIBRARY_PATH',
        'COLCON_PREFIX_PATH',
        '_ROS_WHEELS_BOOTSTRAP_COMPLETE',
    )
    return {name: value for name, value in os.environ.items() if name not in ours}


def _run(command: list[object], **how: object) -> None:
    how = {'env': _plain_environment()} | how
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, **how)
    assert done.returncode == 0, (done.stdout + done.stderr)[-2000:]


if __name__ == '__main__':
    with contextlib.suppress(pytest.skip.Exception):  # the tests will say why
        environment()
