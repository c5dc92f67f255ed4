"""Will a gripper hold it? A simulated table, camera, arm and hand, as in the paper's section IV.

`trials` puts things on the table, `trial` looks, plans and grasps, `execution` carries a grasp out, in a `World` of
MuJoCo's. `solids`, `samples`, `things` and `meshes` are what is grasped; `jaws` the hand, `arm` and `carriers` what
moves it; `camera` and `looking` the sensor, and `document` and `summary` what comes of it.
"""
