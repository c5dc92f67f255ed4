"""Go to the pose before the best grasp with MoveIt: `python moveit_goal.py table.grasps.json`."""

import json
import sys
from pathlib import Path

from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion
from moveit.planning import MoveItPy
from std_msgs.msg import Header

document = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
if document["status"] != "ok":
    sys.exit(f"no grasp: {document['reason']}")
pose = document["objects"][0]["grasps"][0]["flange"]["pre_grasp"]
place, turn = Point(**dict(zip("xyz", pose["position"]))), Quaternion(**dict(zip("xyzw", pose["orientation"])))
goal = PoseStamped(header=Header(frame_id=document["frame_id"]), pose=Pose(position=place, orientation=turn))

moveit = MoveItPy(node_name="grasp")
arm = moveit.get_planning_component("ur_manipulator")
arm.set_start_state_to_current_state()
arm.set_goal_state(pose_stamped_msg=goal, pose_link="tool0")
moveit.execute(arm.plan().trajectory, controllers=[])
