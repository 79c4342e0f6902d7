"""Start the explainer: `ros2 launch mirror_explainer explainer.launch.py params_file:=...`."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Return one node with its namespace, parameters and log level as arguments."""
    share = Path(get_package_share_directory('mirror_explainer'))
    arguments = [
        DeclareLaunchArgument('namespace', default_value='', description="the robot's namespace"),
        DeclareLaunchArgument(
            'params_file',
            default_value=str(share / 'config' / 'explainer.yaml'),
            description='parameters of the node',
        ),
        DeclareLaunchArgument('log_level', default_value='info', description='debug, info, ...'),
        DeclareLaunchArgument(
            'use_sim_time', default_value='false', description='stamps from /clock'
        ),
    ]
    node = Node(
        package='mirror_explainer',
        executable='explainer_node',
        name='mirror_explainer',
        namespace=LaunchConfiguration('namespace'),
        parameters=[
            LaunchConfiguration('params_file'),
            {'use_sim_time': LaunchConfiguration('use_sim_time')},
        ],
        arguments=['--log-level', LaunchConfiguration('log_level')],
        output='screen',
    )
    return LaunchDescription([*arguments, node])
