"""Runs the commands of a bus, the client and a C example on the SocketCAN of a real kernel: virtual buses in QEMU.

Give the Debian package of a kernel for x86-64, for example from `apt-get download linux-image-6.1.0-56-amd64`; nothing of it
is installed. The machine sees the files of this computer, but cannot change them. The exit status is 1 if a check fails.
"""

from __future__ import annotations

import argparse
import gzip
import io
import re
import subprocess
import sys
import tarfile
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import can

from ..cli.live import MG, NEW, OLD, package, simulated
from ..compilers import ZIG_COMMAND
from ..spec_texts import ROOT
from ..tools import tool

MODULES = ("virtio_pci", "9pnet_virtio", "9p", "can-raw", "vcan")
"""What the machine needs for the files of this computer and for SocketCAN; what they depend on is added."""
BUSES = {"vcan0": NEW, "vcan1": OLD}
PASSED = "all checks passed"
MINUTES = 10

INIT = """\
#!/bin/busybox sh
for module in {modules}; do /bin/busybox insmod /modules/$module.ko; done
/bin/busybox mkdir -p /proc /host
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t 9p -o trans=virtio,version=9p2000.L,ro,cache=loose host /host
/bin/busybox mount -t proc proc /host/proc
/bin/busybox mount -t sysfs sysfs /host/sys
/bin/busybox mount -t devtmpfs devtmpfs /host/dev
/bin/busybox mount -t tmpfs tmpfs /host/run
for bus in lo {buses}; do
  [ $bus = lo ] || /bin/busybox ip link add $bus type vcan
  /bin/busybox ip link set $bus up
done
/bin/busybox chroot /host /bin/sh -c 'cd {root} && TMPDIR=/run HOME=/run {python} -B -m tests.verification.socketcan --guest {program}'
/bin/busybox poweroff -f
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kernel", type=Path, nargs="?", help="the Debian package")
    parser.add_argument("--guest", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.guest:
        return _checked(given.guest)
    if given.kernel is None:
        parser.error("give the Debian package of a kernel, from `apt-get download linux-image-...-amd64`")
    with tempfile.TemporaryDirectory(prefix="canwright-") as folder:
        return _boot(given.kernel, Path(folder))


def _boot(kernel: Path, folder: Path) -> int:
    """Boots the kernel, and prints what the checks print."""
    emulator, busybox = tool("qemu-system-x86_64"), Path(tool("busybox"))
    program, image, files = folder / "example", folder / "vmlinuz", folder / "initrd"
    include, example = ROOT / "generated/c/include", ROOT / "generated/c/examples/mwd_motor_v2_35_socketcan.c"
    compiler = [*ZIG_COMMAND, "cc", "-target", "x86_64-linux-musl", "-static", f"-I{include}", example, "-o", program]
    subprocess.run(compiler, check=True)
    modules = _unpack(kernel, image)
    init = INIT.format(
        modules=" ".join(modules), buses=" ".join(BUSES), root=ROOT, python=sys.executable, program=program
    )
    contents = {"bin/busybox": busybox.read_bytes(), "init": init.encode()}
    contents |= {f"modules/{name}.ko": content for name, content in modules.items()}
    files.write_bytes(gzip.compress(_cpio(contents)))
    share = "local,path=/,mount_tag=host,security_model=none,readonly=on"
    command = [emulator, "-cpu", "max", "-m", "1024", "-smp", "2", "-nographic", "-no-reboot", "-virtfs", share]
    command += ["-kernel", image, "-initrd", files, "-append", "console=ttyS0 quiet loglevel=3 panic=-1"]
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60 * MINUTES, check=False
    )
    print(done.stdout)
    return 0 if PASSED in done.stdout else 1


def _unpack(kernel: Path, image: Path) -> dict[str, bytes]:
    """Writes the kernel of a package; returns its modules by name, each after those that it depends on."""
    archive = subprocess.run([tool("dpkg-deb"), "--fsys-tarfile", kernel], capture_output=True, check=True).stdout
    modules: dict[str, tarfile.TarInfo] = {}
    with tarfile.open(fileobj=io.BytesIO(archive)) as packed:
        for member in packed:
            if "/boot/vmlinuz-" in member.name:
                image.write_bytes(_content(packed, member))
            elif member.name.endswith(".ko"):
                modules[Path(member.name).stem.replace("-", "_")] = member

        needed: dict[str, bytes] = {}

        def add(name: str) -> None:
            content = _content(packed, modules[name])
            depends = re.search(rb"\0depends=([^\0]*)\0", content)
            for other in depends[1].decode().split(",") if depends and depends[1] else ():
                if other.replace("-", "_") not in needed:
                    add(other.replace("-", "_"))
            needed[name] = content

        for name in MODULES:
            if name.replace("-", "_") in modules:  # else it is built in
                add(name.replace("-", "_"))
    return needed


def _content(packed: tarfile.TarFile, member: tarfile.TarInfo) -> bytes:
    file = packed.extractfile(member)
    assert file is not None
    return file.read()


def _cpio(contents: dict[str, bytes]) -> bytes:
    """Files as an archive that the kernel unpacks."""
    folders = dict.fromkeys(str(parent) for name in contents for parent in list(Path(name).parents)[-2::-1])
    entries = [(name, 0o40755, b"") for name in folders] + [(name, 0o100755, data) for name, data in contents.items()]
    packed = io.BytesIO()
    for number, (name, mode, data) in enumerate([*entries, ("TRAILER!!!", 0, b"")], 1):
        fields = (number, mode, 0, 0, 1, 0, len(data), 0, 0, 0, 0, len(name) + 1, 0)
        packed.write(b"070701" + b"".join(b"%08X" % field for field in fields) + name.encode() + b"\0")
        packed.write(bytes(-packed.tell() % 4) + data)
        packed.write(bytes(-packed.tell() % 4))
    return packed.getvalue()


def _checked(program: Path) -> int:
    """Runs the checks in the machine, and prints each result."""
    failed = 0
    for check in (_commands, _own_frames, _no_loopback, _example, _lost):
        try:
            for line in check(program):
                print(f"{check.__name__.strip('_')}: {line}", flush=True)
        except Exception as error:  # each is reported
            failed += 1
            print(f"{check.__name__.strip('_')}: FAILED: {type(error).__name__}: {error}", flush=True)
    print(f"{failed} checks failed" if failed else PASSED, flush=True)
    return bool(failed)


def _run(*arguments: str) -> str:
    command = [sys.executable, "-B", "-m", "canwright", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def _commands(_: Path) -> Iterator[str]:
    """`scan` and `request` on both buses."""
    for bus, edition in BUSES.items():
        where = ("-i", "socketcan", "-c", bus)
        with simulated(edition, "voltage=48", "--node", "1..2", *MG, *where):
            scanned = _run("scan", "--node", "1..4", "--timeout", "0.5", *where)
            assert "mwd_motor, nodes 1..2, " in scanned and f"fits {edition}" in scanned, scanned
            asked = _run("request", "read_status_1", "--node", "1", "--edition", edition, "--timeout", "2", *where)
            assert "48.0 V" in asked, asked
            motion = ("request", "set_torque", "iq=2.5", "--node", "1", "--edition", edition, "--allow", "motion")
            _run(*motion, *MG, "--timeout", "2", *where)
            yield f"{bus}: scan fits {edition}, read_status_1 has 48.0 V, set_torque is answered"


def _own_frames(_: Path) -> Iterator[str]:
    """The client, where the bus object returns own frames and where it does not."""
    client_module = package()["client"]
    for bus, edition in BUSES.items():
        module = package()["v2_35" if edition == OLD else "v2_36_2025_03"]
        known = module.Parameters(series=module.Series.MG, encoder_bits=14)
        node = package()["nodes"].Node(module, 1, known)
        for own in (False, True):
            with (
                simulated(edition, "voltage=48", "--node", "1", *MG, "-i", "socketcan", "-c", bus),
                can.Bus(bus, interface="socketcan", receive_own_messages=own) as host,
                client_module.Client(host, [node], timeout=2) as client,
            ):
                start = time.monotonic()
                voltages = {client.request(module.ReadStatus1Request(node=1)).voltage for _ in range(1000)}
                seconds = time.monotonic() - start
            assert voltages == {48}, voltages
            counters = client.counters
            assert counters.unproven == counters.foreign == counters.missing == 0, counters
            yield f"{bus}, own frames {'on' if own else 'off'}: 1000 of 1000 replies, {seconds:.2f} ms each"


def _no_loopback(_: Path) -> Iterator[str]:
    """Without loopback in the kernel, nothing on this computer receives a frame of the client."""
    client_module, module = package()["client"], package()["v2_36_2025_03"]
    node = package()["nodes"].Node(module, 1)
    with (
        simulated(NEW, "--node", "1", "-i", "socketcan", "-c", "vcan0"),
        can.Bus("vcan0", interface="socketcan", local_loopback=False) as host,
        client_module.Client(host, [node]) as client,
    ):
        error = client.cycle([module.ReadStatus1Request(node=1)])[0].error
    assert isinstance(error, client_module.ClientError), error
    yield f"{type(error).__name__}: {error}"


def _example(program: Path) -> Iterator[str]:
    """The C example."""
    with simulated(OLD, "--node", "1", *MG, "-i", "socketcan", "-c", "vcan1"):
        done = subprocess.run([program, "vcan1"], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "reply" in done.stdout, done.stdout + done.stderr
    yield done.stdout.strip()


def _lost(_: Path) -> Iterator[str]:
    """The interface goes down while a client and a command use it."""
    client_module, module = package()["client"], package()["v2_36_2025_03"]
    with (
        can.Bus("vcan0", interface="socketcan") as host,
        client_module.Client(host, [package()["nodes"].Node(module, 1)]) as client,
    ):
        command = (sys.executable, "-B", "-m", "canwright", "decode", "-i", "socketcan", "-c", "vcan0")
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT) as decode:
            time.sleep(5)
            subprocess.run([tool("ip"), "link", "set", "vcan0", "down"], check=True)
            error = client.cycle([module.ReadStatus1Request(node=1)])[0].error
            assert isinstance(error, client_module.BusLost), error
            yield f"client: {error}"
            _, text = decode.communicate(timeout=60)
            assert decode.returncode == 2 and text.count("\n") == 1, text
            yield f"decode: {text.strip()}"


if __name__ == "__main__":
    sys.exit(main())
