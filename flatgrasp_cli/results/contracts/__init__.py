"""The contract `flatgrasp.plan/1`: the models that a document is made of, and its JSON Schema."""

from flatgrasp_cli.results.contracts.grasps import (
    CagePart,
    ClosurePart,
    GraspPart,
    JointsPart,
    MetricsPart,
    PosePart,
    PosesPart,
    ReachPart,
)
from flatgrasp_cli.results.contracts.objects import (
    AabbPart,
    BoxPart,
    FingersPart,
    GravityPart,
    MissPart,
    ObjectPart,
    SilhouettePart,
    StagePart,
)
from flatgrasp_cli.results.contracts.plan import (
    SCHEMA_ID,
    Document,
    SensorPart,
    SourcePart,
    SupportPlanePart,
    TimingPart,
    WarningPart,
    json_schema,
)

__all__ = [
    "SCHEMA_ID",
    "AabbPart",
    "BoxPart",
    "CagePart",
    "ClosurePart",
    "Document",
    "FingersPart",
    "GraspPart",
    "GravityPart",
    "JointsPart",
    "MetricsPart",
    "MissPart",
    "ObjectPart",
    "PosePart",
    "PosesPart",
    "ReachPart",
    "SensorPart",
    "SilhouettePart",
    "SourcePart",
    "StagePart",
    "SupportPlanePart",
    "TimingPart",
    "WarningPart",
    "json_schema",
]
