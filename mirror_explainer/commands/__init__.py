"""What is run in a terminal, without ROS."""
