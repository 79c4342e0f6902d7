"""Start the explainer: `ros2 launch mirror_explainer explainer.launch.py user_model_file:=...`.

Only what is given is set, so that what an including launch file sets (`SetParameter`, a
namespace, `use_sim_time`) stays as it is, and all else has the node's own default.
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue

ARGUMENTS = {
    'namespace': "the robot's namespace",
    'params_file': 'parameters of the node, as in config/explainer.yaml',
    'user_model_file': 'YAML: what the listener may believe',
    'domain_file': 'PDDL domain, unless the robot publishes it',
    'use_sim_time': 'true: stamps from /clock',
    'log_level': 'debug, info, warn, error or fatal',
}
# Those that are parameters of the node; they win over the params_file.
PARAMETERS = {'user_model_file': str, 'domain_file': str, 'use_sim_time': bool}
# So that the C library does not keep freed memory for each of the node's threads.
ENVIRONMENT = {'GLIBC_TUNABLES': 'glibc.malloc.tcache_count=0:glibc.malloc.arena_max=2'}


def explainer(context: LaunchContext) -> list[Node]:
    """Return the node, with the arguments that were given."""
    given = {name for name in ARGUMENTS if LaunchConfiguration(name).perform(context)}
    parameters = [
        {name: ParameterValue(LaunchConfiguration(name), value_type=kind)}
        for name, kind in PARAMETERS.items()
        if name in given
    ]
    if 'params_file' in given:
        parameters.insert(0, ParameterFile(LaunchConfiguration('params_file')))
    log_level = ['--log-level', LaunchConfiguration('log_level')]
    return [
        Node(
            package='mirror_explainer',
            executable='explainer_node',
            name='mirror_explainer',
            namespace=LaunchConfiguration('namespace'),
            parameters=parameters,
            arguments=log_level if 'log_level' in given else [],
            additional_env={
                n: context.environment.get(n, value) for n, value in ENVIRONMENT.items()
            },
            output='screen',
        )
    ]


def generate_launch_description() -> LaunchDescription:
    """Return the arguments, and the node."""
    arguments = [
        DeclareLaunchArgument(name, default_value='', description=description)
        for name, description in ARGUMENTS.items()
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=explainer)])
