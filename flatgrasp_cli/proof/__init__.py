"""Beyond the paper: what can be proved of grasps in the plane, before they are lifted into space."""

from flatgrasp_cli.proof.certification import Certificates, certified, forgiven_m, hands_of, is_caged, why_not

__all__ = ["Certificates", "certified", "forgiven_m", "hands_of", "is_caged", "why_not"]
