// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "spheres/approximate_robot.h"
#include "spheres/small_parts.h"
#include "spheres/solids.h"
#include "support/environment.h"
#include "support/no_threads.h"

#include <filesystem>
#include <set>

namespace mneme::test {
namespace {

using internal::sphere_key;
using internal::SphereCache;

const std::string kKey = "0123456789abcdef0123456789abcdef";

LinkSpheres make_spheres() {
  return {"arm",
          {{{0.1, -0.2, 1e-5}, 0.3}, {{0, 0, 0}, 1.0 / 3}},
          {{{0, 0, 0.1}, {0, 1.0 / 3, 0}, 0.05}},
          0,
          0.01,
          0.02};
}

std::vector<std::string> files_in(const std::string& directory) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    files.push_back(entry.path().string());
  }
  return files;
}

TEST_SUITE("unit") {
  TEST_CASE("spheres come back as they were stored, in directories that had to be made") {
    const TemporaryDirectory files;
    const SphereCache cache(files / "a/b");
    CHECK_FALSE(cache.find(kKey).has_value());
    REQUIRE(cache.store(kKey, make_spheres()));
    const auto found = require(cache.find(kKey));
    REQUIRE(found.spheres.size() == 2);
    CHECK(found.spheres[0].center == Vec3(0.1, -0.2, 1e-5));
    CHECK(found.spheres[1].radius == 1.0 / 3);
    CHECK(found.capsules == make_spheres().capsules);
    CHECK(found.mean_excess == 0.01);
    CHECK(found.max_excess == 0.02);
    CHECK(files_in(files / "a/b").size() == 1);
  }

  TEST_CASE("a damaged file is not found, and is replaced") {
    const TemporaryDirectory files;
    const SphereCache cache(files / "cache");
    REQUIRE(cache.store(kKey, make_spheres()));
    const std::string path = files_in(files / "cache").front();
    const std::string good = read_file(path);
    std::string other_number = good;
    other_number[other_number.find("0.3")] = '9';
    for (const std::string& bad :
         {std::string(), good.substr(0, good.size() / 2), good.substr(0, good.size() - 2),
          other_number, "{}\n" + good, std::string(1000, '\0')}) {
      write_file(path, bad);
      CHECK_FALSE(cache.find(kKey).has_value());
    }
    REQUIRE(cache.store(kKey, make_spheres()));
    CHECK(cache.find(kKey).has_value());
  }

  TEST_CASE("an entry under another key's name is not found") {
    const TemporaryDirectory files;
    const SphereCache cache(files / "cache");
    REQUIRE(cache.store(kKey, make_spheres()));
    const std::string path = files_in(files / "cache").front();
    std::string other = kKey;
    other[0] = 'f';
    std::string other_path = path;
    other_path.replace(path.find(kKey), kKey.size(), other);
    std::filesystem::rename(path, other_path);
    CHECK_FALSE(cache.find(other).has_value());
  }

  TEST_CASE("where nothing can be written, storing says so") {
    const TemporaryDirectory files;
    write_file(files / "file", "");
    CHECK_FALSE(SphereCache(files / "file").store(kKey, make_spheres()));
    CHECK_FALSE(SphereCache(files / "file/below").store(kKey, make_spheres()));
    CHECK_FALSE(SphereCache("").store(kKey, make_spheres()));
    CHECK_FALSE(SphereCache("").find(kKey).has_value());
    std::filesystem::create_directories(files / ("cache/spheres-" + kKey + ".json/in the way"));
    CHECK_FALSE(SphereCache(files / "cache").store(kKey, make_spheres()));
    CHECK(files_in(files / "cache").size() == 1);
  }

  TEST_CASE("the key depends on the surface and on each setting") {
    const auto mesh = internal::triangulate(make_box({1, 2, 3}));
    auto other = mesh;
    other[3].a.y() += 1e-9;
    const std::string key = sphere_key(mesh, {});
    CHECK(key.size() == 32);
    CHECK(key == sphere_key(mesh, {}));
    CHECK(key != sphere_key(other, {}));
    CHECK(key != sphere_key(mesh, {0.02, 16}));
    CHECK(key != sphere_key(mesh, {0.025, 17}));
  }
}

/// l0 has a box and shapes of its own, l1 only shapes, l2 a cylinder.
Robot::Parts make_parts() {
  Robot::Parts parts = make_bare_chain(2);
  parts.links[0].solids = {make_box({0.2, 0.1, 0.1})};
  parts.links[0].spheres = {{{0.5, 0, 0}, 0.1}};
  parts.links[0].capsules = {{{0, 0, 0}, {1, 0, 0}, 0.02}};
  parts.links[1].spheres = {{{0.25, 0, 0}, 0.2}};
  parts.links[2].solids = {Cylinder{{}, 0.05, 0.2}};
  return parts;
}

TEST_SUITE("unit") {
  TEST_CASE("solids become spheres; what was sphere or capsule stays") {
    const auto made = require(approximate_robot(make_parts()));
    REQUIRE(made.links.size() == 2);
    CHECK(made.links[0].link == "l0");
    CHECK(made.links[1].link == "l2");
    const auto& links = made.parts.links;
    for (const Link& link : links) CHECK(link.solids.empty());
    CHECK(links[0].spheres[0].center == Vec3(0.5, 0, 0));
    CHECK(links[0].spheres.size() == 1 + made.links[0].spheres.size());
    CHECK(links[0].capsules.size() == 1);
    CHECK(links[1].spheres.size() == 1);
    CHECK(links[2].spheres.size() == made.links[1].spheres.size());
    CHECK_FALSE(links[1].approximation.has_value());
    for (const std::size_t i : {0, 1}) {
      const SphereApproximation& approximation = links[2 * i].approximation.value();
      CHECK(approximation.sphere_count == std::ssize(made.links[i].spheres));
      CHECK(approximation.excess == made.links[i].max_excess);
    }
    CHECK(links[0].approximation->surface.parts->list().size() == 12);
  }

  TEST_CASE("links of equal geometry are approximated once") {
    Robot::Parts parts = make_parts();
    parts.links[1].solids = parts.links[0].solids;
    int calls = 0;
    const auto made = require(internal::approximate_robot(
        parts, {}, SphereCache(""), [&](int done, int total, const std::string&) {
          CHECK(done == ++calls);
          CHECK(total == 2);
        }));
    CHECK(calls == 2);
    REQUIRE(made.robot.links.size() == 3);
    CHECK(made.robot.links[1].link == "l1");
    const auto& links = made.robot.parts.links;
    CHECK(links[1].spheres.size() == links[0].spheres.size());
    CHECK(links[1].approximation->surface == links[0].approximation->surface);
  }

  TEST_CASE("links are approximated by one thread where others are refused") {
    const NoThreads none;
    CHECK(require(approximate_robot(make_parts())).links.size() == 2);
  }

  TEST_CASE("spheres are made once for each settings, and made again if they were damaged") {
    const TemporaryDirectory files;
    const SphereCache cache(files / "cache");
    const Robot::Parts parts = make_parts();
    const SphereSettings coarse{0.1, 16, 0.1};
    const auto key_of = [&](std::size_t link, const SphereSettings& settings) {
      return sphere_key(internal::link_surface(parts.links[link]).value(), settings);
    };
    REQUIRE(cache.store(key_of(0, coarse), make_spheres()));
    REQUIRE(cache.store(key_of(2, {}), make_spheres()));
    const auto first = require(internal::approximate_robot(parts, coarse, cache));
    CHECK(first.found == 1);
    CHECK(first.stored == 1);
    CHECK(first.robot.links[0].link == "l0");
    CHECK(first.robot.links[0].spheres[1].radius == make_spheres().spheres[1].radius);
    const auto second = require(internal::approximate_robot(parts, coarse, cache));
    CHECK(second.found == 2);
    CHECK(second.stored == 0);
    CHECK(second.robot.links[1].link == "l2");
    REQUIRE(first.robot.links[1].capsules.size() == 1);
    CHECK(second.robot.links[1].capsules == first.robot.links[1].capsules);
    write_file(files / ("cache/spheres-" + key_of(2, coarse) + ".json"), "rubbish");
    const auto third = require(internal::approximate_robot(parts, coarse, cache));
    CHECK(third.found == 1);
    CHECK(third.stored == 1);
    CHECK(cache.find(key_of(2, coarse)).has_value());
  }

  TEST_CASE("settings that no spheres can obey are refused") {
    for (const SphereSettings& settings :
         {SphereSettings{0, 64}, SphereSettings{0.02, 0}, SphereSettings{0.02, 64, -1}}) {
      const Error error = require_error(approximate_robot(make_parts(), settings));
      CHECK(error.code == ErrorCode::invalid);
      CHECK(error.message.starts_with("setting '"));
      const Error robot =
          require_error(load_approximated_robot(source_file("robots/planar8.urdf"), {}, settings));
      CHECK(robot.message == error.message);
    }
  }

  TEST_CASE("the first link whose solids are wrong is named") {
    Robot::Parts parts = make_parts();
    parts.links[1].solids = {MeshFile{"/no/first.stl", Vec3::Ones(), {}}};
    parts.links[2].solids = {MeshFile{"/no/second.stl", Vec3::Ones(), {}}};
    CHECK(
        contains(require_error(approximate_robot(parts)).message, "link 'l1': mesh /no/first.stl"));
  }

  TEST_CASE("an arm's last three links and fingers are tips, and approximated more closely") {
    Robot::Parts parts = make_bare_chain(6);
    const std::vector<bool> are_ends = internal::find_arm_ends(parts);
    CHECK(are_ends == std::vector<bool>{false, false, false, false, true, true, true});
    std::ranges::reverse(parts.joints);
    CHECK(internal::find_arm_ends(parts) == are_ends);
    for (Joint& joint : parts.joints) {
      if (joint.child_link == 5) joint.type = JointType::fixed;
    }
    CHECK(internal::find_arm_ends(parts) ==
          std::vector<bool>{false, false, false, false, true, true, true});
    parts = make_bare_chain(5);
    for (const std::size_t link : {1, 4}) parts.links[link].solids = {make_box({0.1, 0.1, 0.1})};
    const auto made =
        require(internal::approximate_robot(parts, {0.02, 200, 0.008}, SphereCache("")));
    CHECK(made.robot.links[0].max_excess > 0.01);
    CHECK(made.robot.links[1].max_excess <= 0.008);
    CHECK(made.robot.links[1].spheres.size() > made.robot.links[0].spheres.size());
  }

  TEST_CASE("short chains, such as a neck, and chains of a loop have no tips") {
    CHECK(internal::find_arm_ends(make_bare_chain(3)) == std::vector<bool>(4, false));
    Robot::Parts loop = make_bare_chain(6);
    loop.joints[0].parent_link = 6;
    CHECK(internal::find_arm_ends(loop).size() == 7);
  }

  TEST_CASE("progress tells of each link once") {
    std::multiset<std::string> links;
    std::vector<int> counts;
    const auto on_approximated = [&](int done, int total, const std::string& link) {
      links.insert(link);
      counts.push_back(done);
      CHECK(total == 2);
    };
    require(internal::approximate_robot(make_parts(), {}, SphereCache(""), on_approximated));
    CHECK(links == std::multiset<std::string>{"l0", "l2"});
    CHECK(counts == std::vector<int>{1, 2});
  }

  TEST_CASE("spheres of robots are kept in the user's cache, which its notes tell") {
    const TemporaryDirectory files;
    const EnvironmentVariable home{"XDG_CACHE_HOME", files / "cache"};
    const auto first = require(approximate_robot(make_parts()));
    REQUIRE(first.notes.size() == 1);
    CHECK_FALSE(contains(first.notes[0], "from the cache"));
    const auto second = require(approximate_robot(make_parts()));
    REQUIRE(second.notes.size() == 1);
    CHECK(contains(second.notes[0], "; 2 from the cache " + files / "cache/mneme"));
  }

  TEST_CASE("a robot without solids stays as it is") {
    const auto made = require(approximate_robot(make_bare_chain(1)));
    CHECK(made.links.empty());
    CHECK(made.notes.empty());
  }
}

std::string link_of(const std::string& name, const std::string& geometry) {
  return "<link name=\"" + name + "\"><collision><geometry>" + geometry +
         "</geometry></collision></link>";
}

/// Three links in a row along x; the second is a mesh file, "part.stl".
std::string make_urdf() {
  const std::string joint =
      "<parent link=\"{}\"/><child link=\"{}\"/><axis xyz=\"0 0 1\"/>"
      "<origin xyz=\"0.4 0 0\"/>"
      "<limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>";
  return "<robot name=\"r\">" + link_of("a", "<box size=\"0.3 0.08 0.08\"/>") +
         link_of("b", "<mesh filename=\"part.stl\"/>") +
         link_of("c", "<cylinder radius=\"0.05\" length=\"0.2\"/>") +
         "<joint name=\"j\" type=\"revolute\">" + fmt::format(fmt::runtime(joint), "a", "b") +
         "<joint name=\"k\" type=\"revolute\">" + fmt::format(fmt::runtime(joint), "b", "c") +
         "</robot>";
}

struct RobotFiles {
  RobotFiles() {
    write_file(files / "r.urdf", make_urdf());
    write_file(files / "part.stl",
               to_binary_stl(internal::triangulate(make_box({0.3, 0.08, 0.08}))));
  }
  [[nodiscard]] ApproximatedRobot load(const RobotOptions& options = {}) const {
    return require(load_approximated_robot(files / "r.urdf", options));
  }
  TemporaryDirectory files;
  EnvironmentVariable home{"XDG_CACHE_HOME", files / "cache"};
};

TEST_SUITE("unit") {
  TEST_CASE(
      "a robot of boxes, cylinders and meshes is approximated, and the cache makes no difference") {
    const RobotFiles files;
    const ApproximatedRobot first = files.load();
    REQUIRE(first.notes.size() == 1);
    CHECK(contains(first.notes[0], "approximated the geometry of 3 links by"));
    CHECK_FALSE(contains(first.notes[0], "cache"));
    for (const Link& link : first.robot.links()) CHECK_FALSE(link.spheres.empty());
    const ApproximatedRobot second = files.load();
    REQUIRE(second.notes.size() == 1);
    CHECK(contains(second.notes[0], "; 3 from the cache " + files.files / "cache/mneme"));
    CHECK(second.robot.hash() == first.robot.hash());
  }

  TEST_CASE("a cache that cannot be written is said, and loses nothing else") {
    const RobotFiles files;
    const std::string hash = files.load().robot.hash();
    std::filesystem::remove_all(files.files / "cache");
    write_file(files.files / "cache", "in the way");
    const ApproximatedRobot robot = files.load();
    REQUIRE(robot.notes.size() == 1);
    CHECK(contains(robot.notes[0], "cannot be written"));
    CHECK(robot.robot.hash() == hash);
  }

  TEST_CASE("without an SRDF neighbours may touch; with one only what it allows") {
    const RobotFiles files;
    const Robot alone = files.load().robot;
    REQUIRE(alone.self_pairs().size() == 1);
    CHECK(alone.self_pairs()[0] == std::pair(0, 2));
    write_file(files.files / "r.srdf",
               "<robot name=\"r\"><disable_collisions link1=\"a\" link2=\"c\" reason=\"Never\"/>"
               "</robot>");
    const Robot with_srdf = files.load().robot;
    REQUIRE(with_srdf.self_pairs().size() == 2);
    CHECK(with_srdf.self_pairs()[0] == std::pair(0, 1));
    CHECK(with_srdf.self_pairs()[1] == std::pair(1, 2));
  }

  TEST_CASE("a robot warns of pairs that are not checked because nothing parts them") {
    const TemporaryDirectory files;
    const auto ball = [](const std::string& name) {
      return "<link name=\"" + name +
             "\"><collision><geometry><sphere radius=\"0.3\"/></geometry></collision></link>";
    };
    write_file(files / "r.urdf",
               "<robot name=\"r\">" + ball("a") + ball("b") +
                   "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>"
                   "<limit lower=\"-1\" upper=\"1\" velocity=\"1\"/></joint></robot>");
    write_file(files / "r.srdf", "<robot name=\"r\"/>");
    const auto robot = require(load_approximated_robot(files / "r.urdf"));
    CHECK(robot.robot.self_pairs().empty());
    REQUIRE(robot.robot.warnings().size() == 1);
    CHECK(robot.robot.warnings()[0] ==
          "links 'a' and 'b' touch in every configuration; this pair is not checked");
    CHECK(robot.notes.empty());
  }

  TEST_CASE("a robot that nothing can touch is a warning") {
    const TemporaryDirectory files;
    write_file(
        files / "r.urdf",
        "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>"
        "<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint>"
        "</robot>");
    const auto robot = require(load_approximated_robot(files / "r.urdf"));
    REQUIRE(robot.robot.warnings().size() == 1);
    CHECK(robot.robot.warnings()[0].starts_with(
        "no link that the group of robot r moves has collision geometry"));
  }

  TEST_CASE("a robot without solids is loaded as ever") {
    const auto robot = require(load_approximated_robot(source_file("robots/planar8.urdf")));
    CHECK(robot.notes.empty());
    CHECK(robot.robot.hash() == planar8().hash());
  }

  TEST_CASE("errors name the robot's file") {
    const RobotFiles files;
    write_file(files.files / "part.stl", "rubbish");
    const Error error = require_error(load_approximated_robot(files.files / "r.urdf"));
    CHECK(contains(error.message, files.files / "r.urdf"));
    CHECK(contains(error.message, "link 'b'"));
    CHECK(contains(error.message, files.files / "part.stl"));
    write_file(files.files / "part.stl",
               to_binary_stl(internal::triangulate(make_box({0.3, 0.08, 0.08}))));
    const Error wrong =
        require_error(load_approximated_robot(files.files / "r.urdf", {.joints = {"nobody"}}));
    CHECK(contains(wrong.message, "nobody"));
    CHECK_FALSE(load_approximated_robot(files.files / "missing.urdf").has_value());
  }
}

}  // namespace
}  // namespace mneme::test
