"""Publish the flange's poses at the best grasp, for ROS 2: `python ros2_publisher.py table.grasps.json`."""

import json
import sys
from pathlib import Path

import rclpy
from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Header

document = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
if document["status"] != "ok":
    sys.exit(f"no grasp: {document['reason']}")
message = PoseArray(header=Header(frame_id=document["frame_id"]))
for name in ("pre_grasp", "pose", "lift"):
    pose = document["objects"][0]["grasps"][0]["flange"][name]
    place, turn = Point(**dict(zip("xyz", pose["position"]))), Quaternion(**dict(zip("xyzw", pose["orientation"])))
    message.poses.append(Pose(position=place, orientation=turn))

rclpy.init()
node = rclpy.create_node("grasp")
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_publisher(PoseArray, "grasp", latched).publish(message)
rclpy.spin(node)
