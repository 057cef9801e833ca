"""Runs canwright, the generated client and the generated C example on SocketCAN of a real kernel, in an emulated machine.

    python -m tests.verification.socketcan [KERNEL]

KERNEL is the Debian package of a kernel for x86-64; without it, the newest is downloaded. Nothing of it is installed. The
machine reads the files of this computer, but cannot change them. The checks are those of `socketcan_checks`; the exit status is 1 if one fails.
On Debian: apt-get install qemu-system-x86 busybox-static cpio iproute2
"""

from __future__ import annotations

import argparse
import io
import lzma
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import threading
from collections.abc import Mapping
from pathlib import Path

from ..compilers import ZIG_COMMAND
from ..spec_texts import ROOT
from ..tools import run, tool

MODULES = ("virtio_pci", "9pnet_virtio", "9p", "can_raw", "vcan")
"""What the machine needs for the files of this computer and for SocketCAN; what they depend on is added."""
EDITIONS = ("v2_35", "v2_36_2025_03")
"""Those whose C examples are checked."""
CHECKS = Path(__file__).with_name("socketcan_checks.py")
OPTIONS = (
    *("-cpu", "max", "-smp", "2", "-m", "1024", "-no-reboot", "-display", "none", "-serial", "stdio", "-net", "none"),
    *("-virtfs", "local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap"),
    *("-append", "console=ttyS0 quiet loglevel=3 panic=-1"),
)
PASSED = "exit status 0"
UNUSED = ("test", "tests", "idlelib", "tkinter", "ensurepip", "config-*", "site-packages", "dist-packages")
"""What is left out of Python's modules."""
MINUTES = 40
"""The time limit of the machine."""
INIT = """\
#!/bin/busybox sh
/bin/busybox --install -s /bin
for module in {modules}; do insmod /modules/$module.ko; done
mkdir /host
mount -t 9p -o trans=virtio,version=9p2000.L,ro,cache=loose host /host
mount -t proc proc /host/proc
mount -t sysfs sysfs /host/sys
mount -t devtmpfs devtmpfs /host/dev
mount -t tmpfs tmpfs /host/run
mkdir /host/run/lean
mount -o bind /lean /host/run/lean
export PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/run TMPDIR=/run
export PYTHONHOME=/run/lean PYTHONDONTWRITEBYTECODE=1
chroot /host {python} {checks} {folder}
echo exit status $?
poweroff -f
"""
"""The programs and libraries are those of this computer; Python's modules are in memory, since each read of a file is slow."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kernel", type=Path, nargs="?", help="the Debian package")
    given = parser.parse_args()
    for needed in ("busybox", "cpio", "dpkg-deb", "ip", "qemu-system-x86_64"):
        tool(needed)
    with tempfile.TemporaryDirectory(prefix="canwright-") as name:
        folder, root = Path(name), Path(name) / "root"
        _install_python(root / "lean")
        _compile_examples(folder)
        modules = _unpack(given.kernel or _newest(folder), folder / "vmlinuz")
        python = Path(sys.executable).resolve()
        init = INIT.format(modules=" ".join(modules), folder=folder, checks=CHECKS, python=python)
        files = {"bin/busybox": Path(tool("busybox")).read_bytes(), "init": init.encode()}
        for path, content in {**files, **{f"modules/{module}.ko": modules[module] for module in modules}}.items():
            (root / path).parent.mkdir(exist_ok=True)
            (root / path).write_bytes(content)
            (root / path).chmod(0o755)
        listed = "\n".join(str(path.relative_to(root)) for path in sorted(root.rglob("*")))
        with (folder / "initrd").open("wb") as packed:
            subprocess.run(
                [tool("cpio"), "--quiet", "-oH", "newc"], input=listed.encode(), stdout=packed, cwd=root, check=True
            )
        return 0 if _boot(folder) else 1


def _install_python(prefix: Path) -> None:
    """Writes the modules of Python, and the packages alone that canwright needs."""
    stdlib = Path(sysconfig.get_path("stdlib"))
    modules = prefix / "lib" / stdlib.name
    shutil.copytree(stdlib, modules, ignore=shutil.ignore_patterns(*UNUSED), symlinks=True)
    packages = ROOT, ROOT / "generated/python"
    run(sys.executable, "-m", "pip", "install", "-q", "--target", modules / "site-packages", *packages)


def _compile_examples(folder: Path) -> None:
    include = ROOT / "generated/c/include"
    for edition in EDITIONS:
        example = ROOT / f"generated/c/examples/mwd_motor_{edition}_socketcan.c"
        target = ("-target", "x86_64-linux-musl", "-static", f"-I{include}")
        run(*ZIG_COMMAND, "cc", *target, example, "-o", folder / edition)


def _newest(folder: Path) -> Path:
    """Downloads the newest kernel that apt offers."""
    depends = run(tool("apt-cache"), "depends", "--important", "linux-image-amd64")
    run(tool("apt-get"), "download", re.findall(r"Depends: (\S+)", depends)[0], cwd=folder)
    return next(folder.glob("linux-image-*.deb"))


def _boot(folder: Path) -> bool:
    """Prints what the machine prints, and returns whether all checks passed."""
    command = [
        tool("qemu-system-x86_64"),
        *OPTIONS,
        "-kernel",
        str(folder / "vmlinuz"),
        "-initrd",
        str(folder / "initrd"),
    ]
    has_passed = False
    with subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    ) as machine:
        limit = threading.Timer(60 * MINUTES, machine.kill)
        limit.start()
        try:
            assert machine.stdout
            for line in machine.stdout:
                print(line.rstrip(), flush=True)
                has_passed |= line.strip() == PASSED
        finally:
            limit.cancel()
            machine.kill()
    if machine.returncode:
        print(f"FAILED: the machine did not end after {MINUTES} minutes, or not by itself")
    return has_passed


def _unpack(kernel: Path, image: Path) -> Mapping[str, bytes]:
    """Writes the kernel of a package; returns its modules by name, each after those that it depends on."""
    archive = subprocess.run([tool("dpkg-deb"), "--fsys-tarfile", kernel], capture_output=True, check=True).stdout
    packed: dict[str, tarfile.TarInfo] = {}
    needed: dict[str, bytes] = {}
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:

        def content(member: tarfile.TarInfo) -> bytes:
            file = files.extractfile(member)
            assert file
            return lzma.decompress(file.read()) if member.name.endswith(".xz") else file.read()

        def add(name: str) -> None:
            if name in needed or name not in packed:  # else it is built in
                return
            module = content(packed[name])
            depends = re.search(rb"\0depends=([^\0]+)\0", module)
            for before in depends[1].decode().split(",") if depends else ():
                add(before.replace("-", "_"))
            needed[name] = module

        for member in files:
            if "/boot/vmlinuz-" in member.name:
                image.write_bytes(content(member))
            elif module_name := re.search(r"/([^/]+)\.ko(\.xz)?$", member.name):
                packed[module_name[1].replace("-", "_")] = member
        for name in MODULES:
            add(name)
    return needed


if __name__ == "__main__":
    sys.exit(main())
