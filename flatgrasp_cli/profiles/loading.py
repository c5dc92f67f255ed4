"""Profiles by name or by path, with errors that name the file, the key, the value and what is allowed."""

from __future__ import annotations

import reprlib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.profiles.base import Profile
from flatgrasp_cli.profiles.derived import derived
from flatgrasp_cli.profiles.faults import explained, suggestion
from flatgrasp_cli.profiles.gripper import Gripper
from flatgrasp_cli.profiles.robot import CameraPose, Robot
from flatgrasp_cli.profiles.robot_urdf import resolved
from flatgrasp_cli.profiles.settings import PlannerSettings
from flatgrasp_cli.profiles.yaml_text import NotYamlError, parsed

FOLDERS: dict[str, str] = {"gripper": "grippers", "robot": "robots", "planner": "planner"}
MODELS: dict[str, type[Profile]] = {"gripper": Gripper, "robot": Robot, "planner": PlannerSettings}
POSE_NUMBERS = 7
MAX_BYTES = 1_000_000
P = TypeVar("P", bound=Profile)


def configs_dir() -> Path:
    """Folder of the shipped profiles: beside the modules once installed, beside the package in a checkout."""
    package = Path(__file__).resolve().parent.parent
    installed = package / "configs"
    return installed if installed.is_dir() else package.parent / "configs"


def list_profiles(kind: str) -> list[str]:
    """Names of the shipped profiles of a kind: gripper, robot or planner."""
    return sorted(path.stem for path in (configs_dir() / FOLDERS[kind]).glob("*.yaml"))


def profile_path(kind: str, name_or_path: str) -> Path:
    """The file of a shipped profile's name, or of a path (anything that ends in .yaml or .yml, or has a slash)."""
    if name_or_path.endswith((".yaml", ".yml")) or "/" in name_or_path:
        return Path(name_or_path)
    known = list_profiles(kind)
    if name_or_path not in known:
        raise ProfileError(
            f"no {kind} profile named {name_or_path!r}{suggestion(name_or_path, known)}\n"
            f"known: {_names(kind)}; or give the path of your own .yaml file"
        )
    return configs_dir() / FOLDERS[kind] / f"{name_or_path}.yaml"


def load_gripper(name_or_path: str) -> Gripper:
    """Load a gripper profile by name ("lacquey") or by path ("my_gripper.yaml").

    Raises
    ------
    ProfileError
        If there is no such profile, or it is malformed or out of range.
    """
    return _load(Gripper, "gripper", name_or_path)


def load_robot(name_or_path: str) -> Robot:
    """Load a robot profile by name ("ur5"), by path, or from a URDF; raises `ProfileError` as `load_gripper` does."""
    if name_or_path.endswith(".urdf"):
        path = Path(name_or_path)
        return _validate(Robot, resolved({"profile": "robot", "urdf": {"file": path.name}}, path), path)
    return _load(Robot, "robot", name_or_path)


def load_camera_pose(text: str) -> CameraPose:
    """A camera's pose from "x,y,z,qx,qy,qz,qw", or from a YAML file with `position_m` and `orientation_xyzw`.

    Raises
    ------
    ProfileError
        If there is no such file, or the numbers are not a pose.
    """
    if len(text.split(",")) == POSE_NUMBERS:
        try:
            numbers = [float(part) for part in text.split(",")]
        except ValueError:
            raise ProfileError(f"camera pose {text!r}: seven numbers are wanted, x,y,z,qx,qy,qz,qw") from None
        data: dict[str, Any] = {"position_m": tuple(numbers[:3]), "orientation_xyzw": tuple(numbers[3:])}
        return _validate(CameraPose, data, Path("camera pose"))
    if not Path(text).is_file():
        raise ProfileError(f"camera pose {text!r} is neither a file nor seven numbers x,y,z,qx,qy,qz,qw")
    return _validate(CameraPose, read_yaml(Path(text)), Path(text))


def load_settings(name_or_path: str = "default", overrides: tuple[str, ...] = ()) -> PlannerSettings:
    """Load planner settings by name or by path, then apply `overrides` such as "fingers.step_m=0.004"."""
    path = profile_path("planner", name_or_path)
    data = _extended(read_yaml(path), path)
    for override in overrides:
        _apply(data, override)
    return _validate(PlannerSettings, derived(data), path, "; ".join(f"--set {text}" for text in overrides))


def load_profile(path: Path) -> Profile:
    """Load a profile of any kind; its own `profile:` key says which."""
    data = _whole(path)
    return _validate(MODELS[_kind_of(data, path)], data, path)


def _kind_of(data: dict[str, Any], path: Path) -> str:
    kind = data.get("profile")
    if not isinstance(kind, str) or kind not in MODELS:
        raise ProfileError(
            f"{path}: profile: {reprlib.repr(kind)} is not a kind of profile; use one of {', '.join(MODELS)}"
        )
    return kind


def _load(model: type[P], kind: str, name_or_path: str) -> P:
    path = profile_path(kind, name_or_path)
    return _validate(model, _whole(path), path)


def _whole(path: Path) -> dict[str, Any]:
    """A profile with what it leaves to another file."""
    data = resolved(_extended(read_yaml(path), path), path)
    return derived(data) if data.get("profile") == "planner" else data


def read_yaml(path: Path, kind: str = "profile") -> dict[str, Any]:
    """The `key: value` lines of a YAML file that is no larger than people write.

    Raises
    ------
    ProfileError
        If it cannot be read, is no strict YAML, or holds something else; `kind` is what it is called then.
    """
    try:
        with path.open("rb") as file:  # what a device or a pipe holds has no size to ask for
            content = file.read(MAX_BYTES + 1)
        if len(content) > MAX_BYTES:
            raise ProfileError(f"{path}: more than {MAX_BYTES} bytes are too many for a {kind}")
        data = parsed(content.decode("utf-8-sig"))
    except OSError as error:
        raise ProfileError(f"{path}: cannot read the {kind}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ProfileError(f"{path}: not a text file in UTF-8 (byte {error.start})") from error
    except NotYamlError as error:
        raise ProfileError(f"{path}{error.place}: not valid YAML: {error}") from error
    if data is None:  # empty, or nothing but comments
        return {}
    if not isinstance(data, dict):
        raise ProfileError(f"{path}: a {kind} is a list of `key: value` lines, this is {type(data).__name__}")
    return data


def _extended(data: dict[str, Any], path: Path) -> dict[str, Any]:
    """A planner profile with the keys that it leaves to the shipped one it `extends`."""
    if data.get("profile") != "planner" or "extends" not in data:
        return data
    own = dict(data)
    name = own.pop("extends")
    if name not in list_profiles("planner"):
        raise ProfileError(
            f"{path}: extends: {reprlib.repr(name)} is no shipped profile; use one of {_names('planner')}"
        )
    base = read_yaml(profile_path("planner", name))
    if "extends" in base:
        raise ProfileError(f"{path}: extends: {name!r} extends another profile itself; extend that one")
    return _merged(base, own)


def _merged(base: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in own.items():
        below = merged.get(key)
        merged[key] = _merged(below, value) if isinstance(below, dict) and isinstance(value, dict) else value
    return merged


def _apply(data: dict[str, Any], override: str) -> None:
    """Put one "section.key=value" into `data`; the model judges key and value afterwards."""
    dotted, equals, text = override.partition("=")
    if not equals or not dotted:
        raise ProfileError(f"--set {override}: give it as section.key=value, e.g. --set fingers.step_m=0.004")
    *sections, key = dotted.strip().split(".")
    for section in sections:
        data = data.setdefault(section, {})
        if not isinstance(data, dict):
            raise ProfileError(f"--set {override}: {section} is a value, not a section")
    try:
        data[key] = parsed(text)
    except NotYamlError as error:
        raise ProfileError(f"--set {override}: {text!r} is not a YAML value: {error}") from error


def _validate(model: type[P], data: dict[str, Any], path: Path, overrides: str = "") -> P:
    try:
        return model.model_validate(data)
    except ValidationError as error:
        problems = explained(model, error)
        place = f"{path} with {overrides}" if overrides else str(path)
        listed = "" if overrides else f"; `flatgrasp profiles check {path}` lists all"  # which knows no overrides
        more = f"\n(and {len(problems) - 1} more{listed})" if len(problems) > 1 else ""
        raise ProfileError(f"{place}: {problems[0]}{more}") from error


def problems_in(path: Path) -> list[str]:
    """Every fault of a profile, a line each; empty when it is sound. Raises `ProfileError` when it is no profile."""
    data = _whole(path)
    model = MODELS[_kind_of(data, path)]
    try:
        model.model_validate(data)
    except ValidationError as error:
        return explained(model, error)
    return []


def _names(kind: str) -> str:
    return ", ".join(list_profiles(kind))
