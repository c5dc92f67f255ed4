"""What a depth image's camera says: its model, its lens, and which of several is meant."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from flatgrasp_cli.recordings.messages import (
    CameraInfo,
    DepthCameras,
    MessageError,
    MissingCameraInfo,
    info_topics_for,
)
from tests.recordings.clouds import record
from tests.recordings.depth_images import (
    CX,
    CY,
    DEPTH_MM,
    HEIGHT,
    IMAGE,
    INFO,
    NO_ROI,
    WIDTH,
    F,
    decode,
    expected,
    image,
    info,
)


def test_ros_1_names_and_rectified_images() -> None:
    old = info(d=np.full(5, 0.1), p=np.array([2 * F, 0, CX, 0, 0, 2 * F, CY, 0, 0, 0, 1, 0]))
    for name in "kdrp":
        setattr(old, name.upper(), old.__dict__.pop(name))
    decoded = decode(image(), old, "/camera/depth/image_rect_raw")
    np.testing.assert_allclose(decoded.points[:, :2], expected()[:, :2] / 2, rtol=1e-12)


def test_binning_and_region_of_interest() -> None:
    """Pixel (1, 2) of a 2 × binned region that starts at (4, 6) is sensor pixel (6, 10)."""
    region = record(**{**NO_ROI, "x_offset": 4, "y_offset": 6, "width": 16, "height": 12})
    binned = info(width=64, height=48, binning_x=2, binning_y=2, roi=region)
    point = decode(image(), binned).points[2 * WIDTH + 1]
    z = DEPTH_MM[2, 1] / 1000
    np.testing.assert_allclose(point, [(6 - CX) / F * z, (10 - CY) / F * z, z], rtol=1e-12)


@pytest.mark.parametrize(
    ("model", "d"),
    [
        ("plumb_bob", [0.1, -0.05, 0.001, -0.002, 0.01]),
        ("rational_polynomial", [0.1, -0.05, 0.001, -0.002, 0.01, 0.02, 0.003, 0.001]),
        ("equidistant", [0.01, -0.02, 0.003, -0.001]),
        ("equidistant", [0, 0, 0, 0]),
    ],
)
def test_distortion_is_undone(model: str, d: list[float]) -> None:
    points = decode(image(), info(distortion_model=model, d=np.array(d))).points
    rays, k = points / points[:, 2:], np.array([[F, 0, CX], [0, F, CY], [0, 0, 1]])
    x, y = rays[:, :2].T
    r = np.hypot(x, y)
    if model == "equidistant":
        theta = np.arctan(r)
        bent = theta * (1 + sum(c * theta ** (2 * i + 2) for i, c in enumerate(d)))
        x, y = x * bent / r, y * bent / r
    else:
        k1, k2, p1, p2, k3, k4, k5, k6 = (*d, 0, 0, 0)[:8]
        radial = (1 + k1 * r**2 + k2 * r**4 + k3 * r**6) / (1 + k4 * r**2 + k5 * r**4 + k6 * r**6)
        x, y = (
            x * radial + 2 * p1 * x * y + p2 * (r**2 + 2 * x**2),
            y * radial + p1 * (r**2 + 2 * y**2) + 2 * p2 * x * y,
        )
    u, v, _ = k @ np.array([x, y, np.ones_like(x)])
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    np.testing.assert_allclose(u, columns.ravel(), atol=1e-6)
    np.testing.assert_allclose(v, rows.ravel(), atol=1e-6)


def test_pixels_whose_distortion_has_no_inverse_are_dropped() -> None:
    decoded = decode(image(), info(d=np.array([-5.0, 0, 0, 0, 0])))
    assert 0 < len(decoded.points) < WIDTH * HEIGHT
    assert len(decoded.points) + decoded.dropped == WIDTH * HEIGHT
    assert np.isfinite(decoded.points).all()


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"k": np.zeros(9), "p": np.zeros(12)}, "not calibrated; give --intrinsics fx,fy,cx,cy"),
        (
            {"width": 16, "height": 12},
            "its CameraInfo is for 16 × 12, 2 times as large, and names no binning",
        ),
        ({"width": 9}, "the image is 8 × 6, but its CameraInfo is for 9 × 6; .* --intrinsics$"),
        ({"distortion_model": "magic", "d": np.ones(5)}, "distortion model 'magic'"),
        (
            {"distortion_model": "Inverse Brown Conrady", "d": np.full(5, 0.1)},
            "'inverse brown conrady' .* --intrinsics",
        ),
        ({"distortion_model": "Ftheta"}, "distortion model 'ftheta'"),
        ({"d": np.ones(3)}, "plumb_bob takes 4 or 5 numbers"),
    ],
)
def test_cameras_that_do_not_fit_say_how(changes: dict[str, Any], text: str) -> None:
    with pytest.raises(MessageError, match=text):
        decode(image(), info(**changes))


def test_infos_are_found_beside_the_image_or_by_frame_and_size() -> None:
    cameras = DepthCameras()
    with pytest.raises(MissingCameraInfo, match=f"no CameraInfo for {IMAGE}: expected on {INFO}"):
        cameras.decode(IMAGE, image())
    cameras.add_info("/other/camera_info", info(width=9))
    with pytest.raises(MissingCameraInfo, match="CameraInfos seen so far: /other/camera_info"):
        cameras.decode(IMAGE, image())
    cameras.add_info("/elsewhere/camera_info", info())
    np.testing.assert_allclose(cameras.decode(IMAGE, image()).points, expected(), rtol=1e-12)


def test_the_info_nearest_in_time_counts() -> None:
    cameras = DepthCameras()
    for second, focal in ((3, F), (9, 2 * F)):
        late = info(k=np.array([focal, 0, CX, 0, focal, CY, 0, 0, 1]))
        late.header = record(stamp=record(sec=second, nanosec=0), frame_id="camera")
        cameras.add_info(INFO, late)
    np.testing.assert_allclose(cameras.decode(IMAGE, image()).points, expected(), rtol=1e-12)


def test_topics_of_infos() -> None:
    topics = [INFO, "/camera/rgb/camera_info", "/sim/intrinsics"]
    assert info_topics_for(IMAGE, topics) == (INFO,)
    assert info_topics_for(IMAGE + "/compressedDepth", topics) == (INFO,)
    assert info_topics_for("/depth", topics) == tuple(topics)
    assert info_topics_for("/sim/depth", ["/sim/depth/camera_info"]) == ("/sim/depth/camera_info",)


@pytest.mark.parametrize(
    ("topic", "rectified"),
    [
        ("/camera/depth/image_raw", False),
        ("/camera/depth_registered/image_raw", False),  # in the raw colour image
        ("/camera/depth/correct", False),
        ("/camera/depth/image_unrectified", False),
        ("/camera/depth/image_rect", True),
        ("/camera/depth/image_rect_raw/compressedDepth", True),
        ("/stereo/depth_rect", True),
        ("/kinect/rect/depth", True),
        ("/camera/rectified_depth/image", True),
        ("/camera/aligned_depth_to_color/image_raw", True),
        ("/zed/zed_node/depth/depth_registered", True),
    ],
)
def test_what_is_rectified_is_not_undistorted(topic: str, rectified: bool) -> None:
    projection = np.array([2 * F, 0, CX, 0, 0, 2 * F, CY, 0, 0, 0, 1, 0])
    cameras = DepthCameras()
    cameras.add_info("/other/camera_info", info(d=np.full(5, 0.1), p=projection))
    points = cameras.decode(topic, image()).points
    halved = expected()[:, :2] / 2
    assert (len(points) == len(halved) and np.allclose(points[:, :2], halved)) == rectified


def test_a_camera_with_a_projection_alone_is_rectified() -> None:
    decoded = decode(image(), info(k=np.zeros(9), d=np.full(5, 0.1)))
    np.testing.assert_allclose(decoded.points, expected(), rtol=1e-12)


@pytest.mark.parametrize("model", ["", "None", "Brown Conrady", "Inverse Brown Conrady", "Modified Brown Conrady"])
def test_without_coefficients_the_sdks_models_are_pinholes(model: str) -> None:
    np.testing.assert_allclose(decode(image(), info(distortion_model=model)).points, expected(), rtol=1e-12)


@pytest.mark.parametrize(
    ("theirs", "ours", "d"),
    [
        ("Brown Conrady", "plumb_bob", [0.1, -0.05, 0.001, 0.002, 0.01]),
        ("Kannala Brandt4", "equidistant", [0.1, 0, 0, 0]),
    ],
)
def test_models_that_the_sdk_calls_otherwise(theirs: str, ours: str, d: list[float]) -> None:
    same = decode(image(), info(distortion_model=ours, d=np.array(d))).points
    np.testing.assert_array_equal(decode(image(), info(distortion_model=theirs, d=np.array(d))).points, same)
    fifth = info(distortion_model=theirs, d=np.array([*d, 0.0][:5]))
    np.testing.assert_array_equal(decode(image(), fifth).points, same)


def test_stated_intrinsics_count_before_all_others_and_without_any() -> None:
    stated = CameraInfo.from_message(info(k=np.array([2 * F, 0, CX, 0, 2 * F, CY, 0, 0, 1])))
    cameras = DepthCameras(stated)
    halved = expected() / [2, 2, 1]
    np.testing.assert_allclose(cameras.decode(IMAGE, image()).points, halved, rtol=1e-12)
    cameras.add_info(INFO, info())
    np.testing.assert_allclose(cameras.decode(IMAGE, image()).points, halved, rtol=1e-12)


def test_stated_intrinsics_of_another_size_are_doubted_and_recorded_ones_are_not() -> None:
    other = info(k=np.array([F, 0, 2 * WIDTH, 0, F, CY, 0, 0, 1]))
    stated, recorded = DepthCameras(CameraInfo.from_message(other)), DepthCameras()
    recorded.add_info(INFO, other)
    for cameras, codes in ((stated, ["intrinsics_doubted"]), (recorded, [])):
        assert [item.code for item in cameras.decode(IMAGE, image()).assumptions] == codes


def test_equal_calibrations_are_one_key() -> None:
    assert hash(CameraInfo.from_message(info())) == hash(CameraInfo.from_message(info()))
