// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_finder.h"
#include "support/environment.h"
#include "support/support.h"

#include <filesystem>
#include <string>

namespace mneme {
namespace {

using test::contains;
using test::require_error;

using internal::MeshFinder;
namespace fs = std::filesystem;

/// A variable with package paths for the duration of a test.
struct RosPackagePath : test::EnvironmentVariable {
  explicit RosPackagePath(const std::string& value, const char* name = "ROS_PACKAGE_PATH")
      : EnvironmentVariable(name, value) {}
};

/// src/arm_description/{urdf,meshes/a.stl} and an empty folder, all below a temporary directory.
class Workspace {
 public:
  Workspace() {
    fs::create_directories(directory_ / "src/arm_description/urdf");
    fs::create_directories(directory_ / "src/arm_description/meshes");
    fs::create_directories(directory_ / "empty");
    test::write_file(mesh(), "solid");
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return directory_ / name; }
  [[nodiscard]] std::string mesh() const {
    return fs::path(directory_ / "src/arm_description/meshes/a.stl").lexically_normal();
  }

 private:
  test::TemporaryDirectory directory_;
  RosPackagePath no_ros_1_{""}, no_ros_2_{"", "AMENT_PREFIX_PATH"};
};

constexpr const char* kMesh = "package://arm_description/meshes/a.stl";

std::string refusal(const MeshFinder& meshes, const std::string& name, ErrorCode code) {
  const Error error = require_error(meshes.find(name));
  CHECK(error.code == code);
  return error.message;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a package path is the package's folder or holds it, and the first that fits counts") {
    const Workspace w;
    const std::string urdf = w / "arm.urdf";
    CHECK(MeshFinder(urdf, {w / "src"}).find(kMesh) == w.mesh());
    CHECK(MeshFinder(urdf, {w / "src/"}).find(kMesh) == w.mesh());
    CHECK(MeshFinder(urdf, {w / "src/arm_description"}).find(kMesh) == w.mesh());
    const MeshFinder meshes(urdf, {});
    CHECK(meshes.find("src\\arm_description\\meshes\\a.stl") == w.mesh());
    CHECK(contains(refusal(meshes, "src\\b.stl", ErrorCode::io), "src\\b.stl"));
    CHECK(MeshFinder(urdf, {w / "empty", w / "src/arm_description/"}).find(kMesh) == w.mesh());
    fs::create_directories(w / "empty/arm_description/meshes");
    test::write_file(w / "empty/arm_description/meshes/a.stl", "solid");
    CHECK(MeshFinder(urdf, {w / "empty", w / "src"}).find(kMesh) != w.mesh());
  }

  TEST_CASE("ROS_PACKAGE_PATH and the folders of the URDF are searched too") {
    const Workspace w;
    CHECK(MeshFinder(w / "src/arm_description/urdf/arm.urdf", {}).find(kMesh) == w.mesh());
    const RosPackagePath variable((w / "empty") + "::" + (w / "src") + ":");
    CHECK(MeshFinder(w / "arm.urdf", {}).find(kMesh) == w.mesh());
  }

  TEST_CASE("packages beside the URDF's own are found, by package.xml, name or prefix") {
    const Workspace w;
    fs::create_directories(w / "src/desc/urdf");
    const std::string urdf = w / "src/desc/urdf/arm.urdf";
    CHECK(MeshFinder(urdf, {}).find(kMesh) == w.mesh());
    const std::string renamed = fs::path(w / "src/arm-ros2").lexically_normal();
    fs::rename(w / "src/arm_description", renamed);
    CHECK_FALSE(MeshFinder(urdf, {}).find(kMesh).has_value());
    test::write_file(renamed + "/package.xml", "<package><name>arm_description</name></package>");
    CHECK(MeshFinder(urdf, {}).find(kMesh) == renamed + "/meshes/a.stl");
    // Each package has its own prefix.
    fs::create_directories(w / "src/arm_description/share");
    const std::string prefixed =
        fs::path(w / "src/arm_description/share/arm_description").lexically_normal();
    fs::rename(renamed, prefixed);
    fs::create_directories(w / "src/desc/share/desc/urdf");
    CHECK(MeshFinder(w / "src/desc/share/desc/urdf/arm.urdf", {}).find(kMesh) ==
          prefixed + "/meshes/a.stl");
    // A folder of the name without the file does not count.
    fs::create_directories(w / "src/desc/share/arm_description");
    CHECK(MeshFinder(w / "src/desc/share/desc/urdf/arm.urdf", {}).find(kMesh) ==
          prefixed + "/meshes/a.stl");
  }

  TEST_CASE("install prefixes, package.xml and the spellings of package:// are understood") {
    const Workspace w;
    fs::create_directories(w / "install/share");
    fs::rename(w / "src/arm_description", w / "install/share/arm_description");
    const std::string mesh =
        fs::path(w / "install/share/arm_description/meshes/a.stl").lexically_normal();
    CHECK(MeshFinder(w / "arm.urdf", {w / "install"}).find(kMesh) == mesh);
    CHECK(MeshFinder(w / "arm.urdf", {w / "install"})
              .find("package:///arm_description/meshes/a.stl") == mesh);
    CHECK(
        MeshFinder(w / "arm.urdf", {w / "install"}).find("model://arm_description/meshes/a.stl") ==
        mesh);
    {
      const RosPackagePath variable(w / "install", "AMENT_PREFIX_PATH");
      CHECK(MeshFinder(w / "arm.urdf", {}).find(kMesh) == mesh);
    }
    const std::string renamed = fs::path(w / "src/arm-ros2").lexically_normal();
    fs::rename(w / "install/share/arm_description", renamed);
    test::write_file(renamed + "/package.xml",
                     "<package format=\"3\"><name>arm_description</name></package>");
    for (const std::string& path : {w / "src", renamed}) {
      CHECK(MeshFinder(w / "arm.urdf", {path}).find(kMesh) == renamed + "/meshes/a.stl");
    }
    CHECK(MeshFinder(renamed + "/urdf/arm.urdf", {}).find(kMesh) == renamed + "/meshes/a.stl");
  }

  TEST_CASE("other names are relative to the URDF or absolute after file://") {
    const Workspace w;
    const MeshFinder meshes(w / "src/arm_description/urdf/arm.urdf", {});
    CHECK(meshes.find("../meshes/a.stl") == w.mesh());
    CHECK(meshes.find("file://" + w.mesh()) == w.mesh());
    CHECK(meshes.find(w.mesh()) == w.mesh());
  }

  TEST_CASE("packages are found at any depth of a workspace, but not within other packages") {
    const Workspace w;
    fs::create_directories(w / "ws/src/repo/a/b");
    fs::rename(w / "src/arm_description", w / "ws/src/repo/a/b/folder");
    const std::string folder = fs::path(w / "ws/src/repo/a/b/folder").lexically_normal();
    test::write_file(folder + "/package.xml",
                     "<package>\n<name>\n  arm_description\n</name></package>");
    CHECK(MeshFinder(w / "arm.urdf", {w / "ws/src"}).find(kMesh) == folder + "/meshes/a.stl");
    const RosPackagePath variable(w / "ws/src");
    CHECK(MeshFinder(w / "arm.urdf", {}).find(kMesh) == folder + "/meshes/a.stl");
    test::write_file(w / "ws/src/repo/package.xml", "<package><name>repo</name></package>");
    CHECK_FALSE(MeshFinder(w / "arm.urdf", {w / "ws/src"}).find(kMesh).has_value());
  }

  TEST_CASE("forms of URIs that resource_retriever takes are taken") {
    const Workspace w;
    const std::string spaced =
        fs::path(w / "src/arm_description/meshes/a b.stl").lexically_normal();
    test::write_file(spaced, "solid");
    const MeshFinder meshes(w / "arm.urdf", {w / "src"});
    CHECK(meshes.find("package://arm_description//meshes/a.stl") == w.mesh());
    CHECK(meshes.find("package://arm_description/meshes/a%20b.stl") == spaced);
    CHECK(meshes.find("file://localhost" + w.mesh()) == w.mesh());
    CHECK(meshes.find("file:" + w.mesh()) == w.mesh());
    const std::string coded = fs::path(w / "src/arm_description/meshes/a%20b.stl");
    CHECK(meshes.find("file://" + coded) == spaced);
    test::write_file(coded, "solid");
    CHECK(meshes.find("file://" + coded) == fs::path(coded).lexically_normal().string());
  }

  TEST_CASE("escapes are decoded in every kind of name, and in names of files alone") {
    const Workspace w;
    // A folder whose name looks like an escape.
    fs::create_directories(w / "x%20y/arm_description/meshes");
    const std::string spaced =
        fs::path(w / "x%20y/arm_description/meshes/a b.stl").lexically_normal();
    test::write_file(spaced, "solid");
    const MeshFinder meshes(w / "x%20y/arm_description/arm.urdf", {});
    CHECK(meshes.find("meshes/a%20b.stl") == spaced);
    CHECK(meshes.find("package://arm_description/meshes/a%20b.stl") == spaced);
    CHECK(MeshFinder(w / "arm.urdf", {w / "x%20y"})
              .find("package://arm_description/meshes/a%20b.stl") == spaced);
    std::string unknown;
    CHECK(meshes.find("package://other/meshes/a%20b.stl", &unknown) == spaced);
    CHECK(unknown == "other");
    CHECK_FALSE(meshes.find("meshes/a%20b.stl%00").has_value());
    test::write_file(w / "x%20y/arm_description/meshes/a%20b.stl", "solid");
    CHECK(meshes.find("meshes/a%20b.stl") ==
          fs::path(w / "x%20y/arm_description/meshes/a%20b.stl").lexically_normal().string());
  }

  TEST_CASE("where a missing file was looked for is said") {
    const Workspace w;
    const std::string missing = "package://arm_description/meshes/b.stl";
    const std::string message =
        refusal(MeshFinder(w / "arm.urdf", {w / "empty", w / "src"}), missing, ErrorCode::io);
    CHECK(contains(message, "no such file; searched: "));
    CHECK_FALSE(contains(message, "/empty/"));
    CHECK(contains(message, "/src/arm_description/meshes/b.stl"));
    const MeshFinder nowhere(w / "arm.urdf", {});
    CHECK(contains(refusal(nowhere, missing, ErrorCode::io),
                   "there is no package 'arm_description' in the folders above the URDF"));
    CHECK(contains(refusal(nowhere, "b.stl", ErrorCode::io), "/b.stl"));
    CHECK(contains(refusal(nowhere, "empty", ErrorCode::io), "is a directory"));
    CHECK(contains(refusal(nowhere, "/dev/null", ErrorCode::io), "expected a regular file"));
  }

  TEST_CASE("files of an unknown package may lie in the folders above the URDF") {
    const Workspace w;
    const MeshFinder meshes(w / "src/arm_description/urdf/arm.urdf", {});
    std::string unknown;
    CHECK(meshes.find("package://old_name/meshes/a.stl", &unknown) == w.mesh());
    CHECK(meshes.find("package:///old_name/meshes/a.stl", &unknown) == w.mesh());
    CHECK(unknown == "old_name");
    CHECK_FALSE(meshes.find("package://old_name/meshes/a.stl"));
    CHECK_FALSE(meshes.find("package://old_name/meshes/b.stl", &unknown));
  }

  TEST_CASE("a package's path must stay in the package") {
    const Workspace w;
    const MeshFinder meshes(w / "arm.urdf", {w / "src", w / "src/arm_description"});
    for (const std::string path :
         {"../secret.stl", "meshes/../../secret.stl", "/../secret.stl", "%2e%2E/secret.stl"}) {
      CAPTURE(path);
      CHECK(contains(refusal(meshes, "package://arm_description/" + path, ErrorCode::parse),
                     "leaves the package 'arm_description'"));
    }
    CHECK(meshes.find("package://arm_description/urdf/../meshes/a.stl") == w.mesh());
    for (const std::string name : {"package://", "package:///a.stl", "package://../src/a.stl",
                                   "package://arm_description", "package://arm_description/"}) {
      CAPTURE(name);
      CHECK(contains(refusal(meshes, name, ErrorCode::parse), "expected package://NAME/PATH"));
    }
  }

  TEST_CASE("symbolic links are followed, out of the package too, and lead nowhere or in circles") {
    const Workspace w;
    test::write_file(w / "shared.stl", "solid");
    const fs::path package = w / "src/arm_description";
    fs::create_symlink(w / "shared.stl", package / "meshes/linked.stl");
    fs::create_directory_symlink(package / "meshes", package / "visual");
    fs::create_symlink(w / "gone.stl", package / "meshes/dangling.stl");
    fs::create_symlink(package / "meshes/circle.stl", package / "meshes/circle.stl");
    fs::create_directory_symlink(package, w / "empty/arm_description");
    const MeshFinder meshes(w / "arm.urdf", {w / "src"});
    // colcon --symlink-install leaves packages of links to the sources.
    CHECK(meshes.find("package://arm_description/meshes/linked.stl").has_value());
    CHECK(meshes.find("package://arm_description/visual/a.stl").has_value());
    CHECK(MeshFinder(w / "arm.urdf", {w / "empty"}).find(kMesh).has_value());
    // A name is made normal before links are followed, so that `..` does not leave through one.
    CHECK(meshes.find("package://arm_description/visual/../meshes/a.stl") == w.mesh());
    for (const char* name : {"dangling", "circle"}) {
      CAPTURE(name);
      CHECK(
          contains(refusal(meshes, "package://arm_description/meshes/" + std::string(name) + ".stl",
                           ErrorCode::io),
                   "no such file"));
    }
  }

  TEST_CASE("other places than files are not supported") {
    const MeshFinder meshes("arm.urdf", {});
    CHECK(contains(refusal(meshes, "http://host/a.stl", ErrorCode::unsupported), "package://"));
    CHECK(contains(refusal(meshes, "file://host/a.stl", ErrorCode::unsupported), "file:///PATH"));
  }
}

}  // namespace mneme
