# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Builds wheels of mneme, for pip and `python3 -m build` (PEP 517), without a network.

A wheel holds the Python module, the program, robots and scenes, and the shared libraries that
Debian does not install by default. It needs the C library and libstdc++ of Debian 12 or newer.
OMPL and PostgreSQL are left out. CMake builds in build/wheel; `pip install . -C build=DIRECTORY`
takes what is built there instead.
"""
import base64
import hashlib
import os
import pathlib
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


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def version():
    text = (SOURCE / "CMakeLists.txt").read_text()
    return re.search(r"project\(mneme VERSION (\S+)", text).group(1)


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def metadata():
    return (f"Metadata-Version: 2.1\nName: mneme\nVersion: {version()}\n"
            "Summary: Motion planning from memory\nLicense: BSD-3-Clause\n"
            f"Requires-Python: =={sys.version_info.major}.{sys.version_info.minor}.*\n"
            "Requires-Dist: numpy\nDescription-Content-Type: text/markdown\n\n"
            + (SOURCE / "README.md").read_text())


def build_program_and_module():
    """Returns the build directory."""
    build = SOURCE / "build/wheel"
    run("cmake", "-S", SOURCE, "-B", build, "-DCMAKE_BUILD_TYPE=Release", *PARTS_LEFT_OUT,
        f"-DPython3_EXECUTABLE={sys.executable}")
    run("cmake", "--build", build, "--parallel", os.cpu_count(), "--target", "mneme_cli",
        "mneme_python")
    return build


def needed_libraries(binary):
    """Returns the shared libraries that `binary` loads, directly or not, but for the system's."""
    lines = re.findall(r"(\S+) => (/\S+)", run("ldd", binary))
    return {name: pathlib.Path(path) for name, path in lines if not OF_THE_SYSTEM.match(name)}


def bundle(binaries, libraries):
    """Copies what the binaries load into the folder `libraries`. `binaries`: file -> where it will
    search for them."""
    libraries.mkdir()
    for binary, search in binaries.items():
        run("strip", binary)
        for name, path in needed_libraries(binary).items():
            if not (libraries / name).exists():
                shutil.copy(path, libraries / name)
                run("patchelf", "--set-rpath", "$ORIGIN", libraries / name)
        run("patchelf", "--set-rpath", search, binary)


def stage(build, root):
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
    packages = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"
    bundle({root / "mneme" / module.name: "$ORIGIN/../mneme.libs",
            data / "scripts/mneme": f"$ORIGIN/../{packages}/mneme.libs"}, root / "mneme.libs")


def write_description(root):
    info = root / f"mneme-{version()}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(metadata())
    (info / "WHEEL").write_text("Wheel-Version: 1.0\nGenerator: mneme\nRoot-Is-Purelib: false\n"
                                f"Tag: {tag()}\n")
    shutil.copy(SOURCE / "LICENSE", info)
    return info


def record_of(root, file):
    digest = base64.urlsafe_b64encode(hashlib.sha256(file.read_bytes()).digest()).rstrip(b"=")
    return f"{file.relative_to(root)},sha256={digest.decode()},{file.stat().st_size}\n"


def pack(root, wheel):
    info = write_description(root)
    files = sorted(file for file in root.rglob("*") if file.is_file())
    record = info / "RECORD"
    record.write_text("".join(record_of(root, file) for file in files)
                      + f"{record.relative_to(root)},,\n")
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for file in [*files, record]:
            archive.write(file, file.relative_to(root))


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel and returns its name."""
    built = (config_settings or {}).get("build")
    name = f"mneme-{version()}-{tag()}.whl"
    for tool in ("cmake", "ldd", "strip", "patchelf"):
        if shutil.which(tool) is None:
            raise SystemExit(f"a wheel of mneme needs '{tool}': script/setup --all installs it")
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder) / "wheel"
        root.mkdir()
        stage(pathlib.Path(built) if built else build_program_and_module(), root)
        pack(root, pathlib.Path(wheel_directory) / name)
    return name


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
    os.makedirs(sys.argv[1], exist_ok=True)
    print(pathlib.Path(sys.argv[1]) / build_wheel(sys.argv[1]))
