"""What sources are called: text in UTF-8, whatever bytes a file system has in its names."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from flatgrasp_cli.source_names import in_utf8, name_of, path_of

BYTES = st.binary(min_size=1).filter(lambda name: rb"\x" not in name)


def test_a_name_is_the_path_and_bytes_that_are_no_utf_8_stand_as_such() -> None:
    assert name_of("./größe #1\n.pcd") == "./größe #1\n.pcd"
    assert name_of("gr\udcf6\udcdfe.pcd") == r"gr\xf6\xdfe.pcd"
    assert (name_of("-"), in_utf8("-")) == ("stdin", "-")


@given(BYTES)
def test_a_name_can_be_written_and_leads_back_to_its_path(name: bytes) -> None:
    path = name.decode("utf-8", "surrogateescape")
    called = in_utf8(path)
    assert called.encode().decode("utf-8", "backslashreplace") == called
    assert path_of(called) == path
    assert called == path or called == name.decode("utf-8", "backslashreplace")


@given(st.text(st.characters(categories=["Cs", "L"])))
def test_half_a_pair_of_windows_can_be_written_too(path: str) -> None:
    in_utf8(path).encode()
