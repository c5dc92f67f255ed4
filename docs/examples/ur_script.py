"""The best grasp as a program for a UR controller: `python ur_script.py table.grasps.json > grasp.script`."""

import json
import sys
from pathlib import Path

from scipy.spatial.transform import Rotation

if len(sys.argv) != 2:
    sys.exit("usage: python ur_script.py table.grasps.json > grasp.script")
document = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
if document["robot"] is None or document["frame_id"] != "base":
    sys.exit("plan with --robot, and with --base-frame base, which is the controller's")
if document["status"] != "ok":
    sys.exit(f"no grasp: {document['reason']}")
grasp = document["objects"][0]["grasps"][0]

print("def grasp():\n  set_tcp(p[0, 0, 0, 0, 0, 0])  # the poses are the flange's")
print(f"  movej({grasp['reach']['joints_rad']['pre_grasp']})  # open the hand to {grasp['opening_m']} m here")
for name, note in (("pose", "close the hand here"), ("pre_grasp", "back with the object"), ("lift", "up")):
    pose = grasp["flange"][name]
    turn = Rotation.from_quat(pose["orientation"]).as_rotvec().tolist()
    print(f"  movel(p{pose['position'] + turn}, a=0.3, v=0.1)  # {note}")
print("end")
