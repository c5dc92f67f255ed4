"""Recorded messages: the containers that they lie in, and what is in those with points, images and calibrations.

`containers` opens MCAP files and ROS bags and yields decoded messages in order of time, also from damaged files;
`messages` turns one message into arrays. Neither knows what the points are wanted for.
"""
