# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Builds wheels of mneme, for pip and `python3 -m build` (PEP 517), without a network.

A wheel holds the Python module, the program, robots and scenes, and the shared libraries that
Debian does not install by default. It needs the C library and libstdc++ of Debian 12 or newer.
OMPL and PostgreSQL are left out. CMake builds in build/wheel; `pip install . -C build=DIRECTORY`
takes what is built there instead. `mneme_wheel.py FOLDER aarch64` cross-compiles, in
build/wheel-aarch64, with what `script/setup --arm` unpacks, and writes to FOLDER.
"""
import base64
import dataclasses
import hashlib
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
# Every Linux with Python has them, and they must be one with those of the interpreter.
OF_THE_SYSTEM = re.compile(r"(libc|libm|libdl|libpthread|librt|libresolv|libgcc_s|libstdc\+\+)\.so\."
                           r"|ld-linux|linux-vdso")
PARTS_LEFT_OUT = ["-DMNEME_BUILD_TESTS=OFF", "-DMNEME_BENCH=OFF", "-DMNEME_WITH_OMPL=OFF",
                  "-DCMAKE_DISABLE_FIND_PACKAGE_PostgreSQL=ON"]


@dataclasses.dataclass(frozen=True)
class Machine:
    """What a wheel is for. Defaults are those of the machine at hand."""
    tag: str = re.sub("[-.]", "_", sysconfig.get_platform())
    build: str = "build/wheel"
    options: tuple = ()  # of CMake
    emulator: tuple = ()  # what runs its programs
    lister: tuple = ("ldd",)  # prints which shared libraries the loader finds for a binary
    strip: str = "strip"
    root: pathlib.Path = pathlib.Path("/")  # where its libraries and Python are
    setup: str = "script/setup --all"  # installs the tools


SYSROOT = SOURCE / "build/aarch64-sysroot"
QEMU = ("qemu-aarch64", "-L", SYSROOT)
PYTHON = f"python{sys.version_info.major}.{sys.version_info.minor}"
# On an ARM machine its own tools replace the cross compiler.
MACHINES = {
    "aarch64": Machine(tag="linux_aarch64", build="build/wheel-aarch64",
                       options=(f"-DCMAKE_TOOLCHAIN_FILE={SOURCE}/cmake/aarch64.cmake",),
                       emulator=QEMU,
                       lister=(*QEMU, SYSROOT / "lib/ld-linux-aarch64.so.1", "--list"),
                       strip="aarch64-linux-gnu-strip", root=SYSROOT, setup="script/setup --arm"),
    platform.machine(): Machine()}


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def version():
    text = (SOURCE / "CMakeLists.txt").read_text()
    return re.search(r"project\(mneme VERSION (\S+)", text).group(1)


def tag(machine):
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{machine.tag}"


def metadata():
    return (f"Metadata-Version: 2.1\nName: mneme\nVersion: {version()}\n"
            "Summary: Motion planning from memory\nLicense: BSD-3-Clause\n"
            f"Requires-Python: =={sys.version_info.major}.{sys.version_info.minor}.*\n"
            "Requires-Dist: numpy\nDescription-Content-Type: text/markdown\n\n"
            + (SOURCE / "README.md").read_text())


def build_program_and_module(machine):
    """Returns the build directory."""
    build = SOURCE / machine.build
    run("cmake", "-S", SOURCE, "-B", build, "-DCMAKE_BUILD_TYPE=Release", *PARTS_LEFT_OUT,
        f"-DPython3_EXECUTABLE={sys.executable}", *machine.options)
    run("cmake", "--build", build, "--parallel", os.cpu_count(), "--target", "mneme_cli",
        "mneme_python")
    return build


def needed_libraries(binary, machine):
    """Returns the shared libraries that `binary` loads, directly or not, but for the system's."""
    lines = re.findall(r"([^\s/]+) => /(\S+)", run(*machine.lister, binary))
    return {name: next(root / path for root in (machine.root, pathlib.Path("/"))
                       if (root / path).exists())
            for name, path in lines if not OF_THE_SYSTEM.match(name)}


def bundle(binaries, libraries, machine):
    """Copies what the binaries load into the folder `libraries`. `binaries`: file -> where it will
    search for them."""
    libraries.mkdir()
    for binary, search in binaries.items():
        run(machine.strip, binary)
        for name, path in needed_libraries(binary, machine).items():
            if not (libraries / name).exists():
                shutil.copy(path, libraries / name)
                run("patchelf", "--set-rpath", "$ORIGIN", libraries / name)
        run("patchelf", "--set-rpath", search, binary)


def stage(build, root, machine):
    """Lays the contents of a wheel out in the folder `root`."""
    data = root / f"mneme-{version()}.data"
    installed = root.with_name("installed")
    run("cmake", "--install", build, "--prefix", installed, "--component", "cli")
    shutil.copytree(SOURCE / "python/mneme", root / "mneme",
                    ignore=shutil.ignore_patterns("__pycache__"))
    module = next((build / "python/mneme").glob("_mneme.*.so"))
    shutil.copy(module, root / "mneme")
    (data / "scripts").mkdir(parents=True)
    shutil.copy(installed / "bin/mneme", data / "scripts/mneme")
    shutil.copytree(installed / "share/mneme", data / "data/share/mneme")
    bundle({root / "mneme" / module.name: "$ORIGIN/../mneme.libs",
            data / "scripts/mneme": f"$ORIGIN/../lib/{PYTHON}/site-packages/mneme.libs"},
           root / "mneme.libs", machine)


def write_description(root, machine):
    info = root / f"mneme-{version()}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(metadata())
    (info / "WHEEL").write_text("Wheel-Version: 1.0\nGenerator: mneme\nRoot-Is-Purelib: false\n"
                                f"Tag: {tag(machine)}\n")
    shutil.copy(SOURCE / "LICENSE", info)
    return info


def record_of(root, file):
    digest = base64.urlsafe_b64encode(hashlib.sha256(file.read_bytes()).digest()).rstrip(b"=")
    return f"{file.relative_to(root)},sha256={digest.decode()},{file.stat().st_size}\n"


def pack(root, wheel, machine):
    info = write_description(root, machine)
    files = sorted(file for file in root.rglob("*") if file.is_file())
    record = info / "RECORD"
    record.write_text("".join(record_of(root, file) for file in files)
                      + f"{record.relative_to(root)},,\n")
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for file in [*files, record]:
            archive.write(file, file.relative_to(root))


def check_tools(machine):
    for tool in ("cmake", "patchelf", machine.lister[0], machine.strip):
        if shutil.which(tool) is None:
            raise SystemExit(f"a wheel of mneme needs '{tool}': {machine.setup} installs it")
    if machine.emulator and not (machine.root / "usr/include" / PYTHON).exists():
        raise SystemExit(f"{machine.root} has no {PYTHON}, the version of {sys.executable}: "
                         f"{machine.setup} unpacks Debian's version, with which the wheel is built")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel and returns its name."""
    settings = config_settings or {}
    name = settings.get("machine", platform.machine())
    if name not in MACHINES:
        raise SystemExit(f"machine={name}: expected {' or '.join(MACHINES)}")
    machine = MACHINES[name]
    check_tools(machine)
    wheel = f"mneme-{version()}-{tag(machine)}.whl"
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder) / "wheel"
        root.mkdir()
        build = settings.get("build") or build_program_and_module(machine)
        stage(pathlib.Path(build), root, machine)
        pack(root, pathlib.Path(wheel_directory) / wheel, machine)
    return wheel


def build_sdist(sdist_directory, config_settings=None):
    """Writes an archive of the files that git tracks and returns its name."""
    base = f"mneme-{version()}"
    with tarfile.open(pathlib.Path(sdist_directory) / f"{base}.tar.gz", "w:gz") as archive:
        for file in run("git", "-C", SOURCE, "ls-files", "-z").rstrip("\0").split("\0"):
            archive.add(SOURCE / file, f"{base}/{file}")
        description = pathlib.Path(sdist_directory) / "PKG-INFO"
        description.write_text(metadata())
        archive.add(description, f"{base}/PKG-INFO")
        description.unlink()
    return f"{base}.tar.gz"


if __name__ == "__main__":
    out, *names = sys.argv[1:]
    os.makedirs(out, exist_ok=True)
    print(pathlib.Path(out) / build_wheel(out, {"machine": name for name in names}))
