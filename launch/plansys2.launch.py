"""Start explainer and bridge beside PlanSys2: `ros2 launch mirror_explainer plansys2.launch.py`.

Arguments of explainer.launch.py may be given, too; `namespace` is that of PlanSys2's nodes.
"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Return both nodes in the namespace of PlanSys2."""
    share = Path(get_package_share_directory('mirror_explainer'))
    namespace = DeclareLaunchArgument('namespace', default_value='', description="PlanSys2's")
    bridge = Node(
        package='mirror_explainer',
        executable='plansys2_bridge',
        namespace=LaunchConfiguration('namespace'),
        output='screen',
    )
    explainer = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(str(share / 'launch' / 'explainer.launch.py'))
    )
    return LaunchDescription([namespace, bridge, explainer])
