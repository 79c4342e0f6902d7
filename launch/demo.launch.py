"""Start the warehouse robot and the explainer: `ros2 launch mirror_explainer demo.launch.py`.

Then ask: `ros2 service call /verbalize_plan std_srvs/srv/Trigger`. Arguments of
explainer.launch.py may be given, too.
"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description() -> LaunchDescription:
    """Return both nodes in one namespace."""
    share = Path(get_package_share_directory('mirror_explainer'))
    arguments = [
        DeclareLaunchArgument('namespace', default_value='', description='of both nodes'),
        DeclareLaunchArgument(
            'step_period', default_value='10.0', description='s for each step; 0: stand still'
        ),
        DeclareLaunchArgument(
            'user_model_file',
            default_value=str(share / 'config' / 'warehouse' / 'user_model.yaml'),
            description='YAML: what the listener may believe',
        ),
    ]
    robot = Node(
        package='mirror_explainer',
        executable='warehouse_robot',
        namespace=LaunchConfiguration('namespace'),
        parameters=[
            {'step_period': ParameterValue(LaunchConfiguration('step_period'), value_type=float)}
        ],
        output='screen',
    )
    explainer = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(str(share / 'launch' / 'explainer.launch.py'))
    )
    return LaunchDescription([*arguments, robot, explainer])
