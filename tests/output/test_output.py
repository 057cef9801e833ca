from __future__ import annotations

from pathlib import Path

import pytest
from canwright.output.paths import MANIFEST, OutputError
from canwright.output.writer import Changes, Content, difference, write


def content(
    files: dict[str, str], editions: tuple[str, ...] = ("lamp v1",), targets: tuple[str, ...] = ("c",)
) -> Content:
    return Content(editions, targets, {path: text.encode() for path, text in files.items()})


def tree(out: Path) -> dict[str, str]:
    return {
        f.relative_to(out).as_posix(): f.read_text("utf-8")
        for f in sorted(out.rglob("*"))
        if f.is_file() and f.name != MANIFEST
    }


def test_writes_and_then_finds_nothing_to_do(tmp_path: Path) -> None:
    made = content({"c/a.h": "a\n", "c/x/b.h": "b\n"})
    assert write(tmp_path, made) == Changes(("c/a.h", "c/x/b.h"), (), 0)
    assert tree(tmp_path) == {"c/a.h": "a\n", "c/x/b.h": "b\n"}
    assert write(tmp_path, made) == Changes((), (), 2)
    assert list(difference(tmp_path, made)) == []


def test_removes_what_it_made_and_nothing_else(tmp_path: Path) -> None:
    write(tmp_path, content({"c/a.h": "a\n", "c/x/b.h": "b\n"}))
    (tmp_path / "c/mine.h").write_text("mine\n")
    assert write(tmp_path, content({"c/a.h": "a\n"})) == Changes((), ("c/x/b.h",), 1)
    assert tree(tmp_path) == {"c/a.h": "a\n", "c/mine.h": "mine\n"}
    assert not (tmp_path / "c/x").exists()


def test_leaves_other_targets_alone(tmp_path: Path) -> None:
    write(tmp_path, content({"c/a.h": "a\n"}))
    write(tmp_path, content({"dbc/a.dbc": "d\n"}, targets=("dbc",)))
    assert tree(tmp_path) == {"c/a.h": "a\n", "dbc/a.dbc": "d\n"}


def test_a_target_that_needs_the_folder_for_itself(tmp_path: Path) -> None:
    site = tmp_path / "site"
    first, second = (Content((), ("site",), {name: b"a\n"}, alone=True) for name in ("a/x.html", "y.html"))
    write(site, first)
    assert write(site, second) == Changes(("y.html",), ("a/x.html",), 0)
    for files in (content({"c/a.h": "a\n"}), content({"site/a.h": "a\n"}, targets=("site", "c"))):
        other = tmp_path / str(len(files.targets))
        write(other, files)
        before = tree(other)
        with pytest.raises(OutputError, match="not of an earlier site"):
            write(other, second, force=True)
        assert tree(other) == before


def test_an_edited_file_is_kept_until_forced(tmp_path: Path) -> None:
    write(tmp_path, content({"c/a.h": "a\n", "c/b.h": "b\n"}))
    (tmp_path / "c/a.h").write_text("edited\n")
    with pytest.raises(OutputError, match=r"c/a\.h was edited by hand"):
        write(tmp_path, content({"c/a.h": "new\n", "c/b.h": "new\n"}))
    assert tree(tmp_path) == {"c/a.h": "edited\n", "c/b.h": "b\n"}
    with pytest.raises(OutputError, match=r"c/a\.h was edited by hand"):
        write(tmp_path, content({"c/b.h": "b\n"}))
    write(tmp_path, content({"c/a.h": "new\n", "c/b.h": "new\n"}), force=True)
    assert tree(tmp_path) == {"c/a.h": "new\n", "c/b.h": "new\n"}


def test_a_file_it_did_not_make_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "c").mkdir()
    (tmp_path / "c/a.h").write_text("mine\n")
    with pytest.raises(OutputError, match="was not made by canwright"):
        write(tmp_path, content({"c/a.h": "a\n"}))
    assert tree(tmp_path) == {"c/a.h": "mine\n"}


def test_an_edition_is_not_dropped_unasked(tmp_path: Path) -> None:
    write(tmp_path, content({"c/1.h": "", "c/2.h": ""}, ("lamp v1", "lamp v2")))
    with pytest.raises(OutputError, match="also holds lamp v2"):
        write(tmp_path, content({"c/1.h": ""}, ("lamp v1",)))
    write(tmp_path, content({"c/1.h": ""}, ("lamp v1",)), force=True)
    assert tree(tmp_path) == {"c/1.h": ""}


@pytest.mark.parametrize("path", ["c", "c/x", "c/x/a.h"])
def test_nothing_is_written_through_a_link(tmp_path: Path, path: str) -> None:
    out, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    elsewhere.mkdir()
    (out / path).parent.mkdir(parents=True)
    (out / path).symlink_to(elsewhere)
    with pytest.raises(OutputError, match="symbolic link"):
        write(out, content({"c/x/a.h": "a\n"}), force=True)
    assert list(elsewhere.iterdir()) == []


@pytest.mark.parametrize("path", ["../a.h", "/a.h", "c/../../a.h"])
def test_nothing_is_written_outside(tmp_path: Path, path: str) -> None:
    with pytest.raises(OutputError, match="outside"):
        write(tmp_path / "out", content({path: "a\n"}))
    assert not (tmp_path / "a.h").exists()


def test_the_difference_is_a_unified_diff(tmp_path: Path) -> None:
    write(tmp_path, content({"c/a.h": "one\ntwo\n", "c/b.h": "b\n"}))
    found = list(difference(tmp_path, content({"c/a.h": "one\n2\n"})))
    assert found == [
        f"--- {tmp_path.as_posix()}/c/a.h\n+++ c/a.h as generated\n@@ -1,2 +1,2 @@\n one\n-two\n+2\n",
        f"--- {tmp_path.as_posix()}/c/b.h\n+++ c/b.h as generated\n@@ -1 +0,0 @@\n-b\n",
    ]


def test_a_damaged_manifest_says_what_to_do(tmp_path: Path) -> None:
    (tmp_path / MANIFEST).write_text("{")
    with pytest.raises(OutputError, match="restore it from version control"):
        write(tmp_path, content({"c/a.h": "a\n"}))
