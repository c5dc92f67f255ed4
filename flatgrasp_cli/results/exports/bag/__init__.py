"""Plans as ROS messages in a bag, to play beside the recording that they were made of; needs no ROS."""

from flatgrasp_cli.results.exports.bag.topics import CLOUD, DOCUMENT, GRASPS, MARKERS, PRE_GRASPS, TF_STATIC
from flatgrasp_cli.results.exports.bag.writing import Bag

__all__ = ["CLOUD", "DOCUMENT", "GRASPS", "MARKERS", "PRE_GRASPS", "TF_STATIC", "Bag"]
