"""A ROS 2 node that plans on every cloud it gets; `flatgrasp serve --listen 127.0.0.1:5555` runs beside it."""

import base64
import json
import socket

import rclpy
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import PointCloud2
from sensor_msgs_py.point_cloud2 import read_points_numpy

HEAD = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH {}\nHEIGHT {}\nPOINTS {}\nDATA binary\n"


def plan(cloud):
    """Publish where the flange goes to grasp what a cloud shows."""
    points = read_points_numpy(cloud, ["x", "y", "z"]).astype("<f4")
    pcd = HEAD.format(cloud.width, cloud.height, len(points)).encode() + points.tobytes()
    print(json.dumps({"data": base64.b64encode(pcd).decode()}), file=server, flush=True)
    answer = json.loads(server.readline())
    if answer["status"] != "ok":
        node.get_logger().warn(answer["error"]["text"] if answer["error"] else answer["documents"][0]["reason"])
        return
    pose = answer["documents"][0]["objects"][0]["grasps"][0]["flange"]["pose"]
    place, turn = Point(**dict(zip("xyz", pose["position"]))), Quaternion(**dict(zip("xyzw", pose["orientation"])))
    grasps.publish(PoseStamped(header=cloud.header, pose=Pose(position=place, orientation=turn)))


server = socket.create_connection(("127.0.0.1", 5555)).makefile("rw")
rclpy.init()
node = rclpy.create_node("flatgrasp")
grasps = node.create_publisher(PoseStamped, "grasp", 1)
newest = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
node.create_subscription(PointCloud2, "points", plan, newest)
rclpy.spin(node)
