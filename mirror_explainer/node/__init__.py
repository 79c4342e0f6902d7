"""What the explainer's node is made of; rclpy itself is in `explainer_node.py` alone."""
