// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "spheres/solids.h"

namespace mneme::test {
namespace {

/// A folded arm that lies on its stand where its joints are zero.
std::string folded_arm() {
  const auto link = [](const std::string& name, const std::string& at,
                       const std::string& geometry) {
    return "<link name='" + name + "'><collision><origin xyz='" + at + "'/><geometry>" + geometry +
           "</geometry></collision></link>";
  };
  const auto joint = [](const std::string& name, const std::string& parent,
                        const std::string& child, const std::string& rest) {
    return "<joint name='" + name + "' type='revolute'><parent link='" + parent +
           "'/><child link='" + child + "'/>" + rest + "</joint>";
  };
  return "<robot name='folded'>" + link("stand", "0 0 0.05", "<box size='0.3 0.2 0.2'/>") +
         link("turn", "0 0 0.03", "<cylinder radius='0.03' length='0.03'/>") +
         link("arm", "0.16 0 0", "<box size='0.24 0.06 0.06'/>") +
         joint("pan", "stand", "turn",
               "<origin xyz='0 0 0.15'/><axis xyz='0 0 1'/>"
               "<limit lower='-2' upper='2' effort='1' velocity='1'/>") +
         joint("lift", "turn", "arm",
               "<origin xyz='0 0 0.02'/><axis xyz='0 -1 0'/>"
               "<limit lower='0' upper='2.5' effort='1' velocity='1'/>") +
         "</robot>";
}

TEST_SUITE("unit") {
  TEST_CASE("an SRDF is written for a robot that is in contact at rest, and mends that") {
    const TemporaryDirectory files;
    const EnvironmentVariable home{"XDG_CACHE_HOME", files / "cache"};
    const std::string urdf = files / "folded.urdf";
    write_file(urdf, folded_arm());
    CHECK(require(load_approximated_robot(urdf)).robot.self_pairs().size() == 1);
    const auto made =
        derive_srdf(urdf, {}, {.samples = 500, .allow_at_rest = true, .is_exact = true});
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    CHECK(made->reasons == std::vector<std::string>{"Adjacent", "Default", "Adjacent"});
    CHECK(contains(made->text, "link1=\"stand\" link2=\"arm\" reason=\"Default\""));
    write_file(files / "folded.srdf", made->text);
    const auto mended = require(load_approximated_robot(urdf));
    CHECK(mended.robot.self_pairs().empty());
    CHECK(mended.robot.joint_count() == 2);
  }

  TEST_CASE("pairs, groups and states of the SRDF in use are kept") {
    const TemporaryDirectory files;
    const EnvironmentVariable home{"XDG_CACHE_HOME", files / "cache"};
    const std::string urdf = files / "folded.urdf";
    write_file(urdf, folded_arm());
    write_file(files / "folded.srdf",
               "<robot name='folded'><group name='all'><joint name='pan'/><joint name='lift'/>"
               "</group><group_state name='up' group='all'><joint name='pan' value='0'/>"
               "<joint name='lift' value='1.5'/></group_state>"
               "<disable_collisions link1='stand' link2='arm' reason='Mine'/></robot>");
    const auto made =
        derive_srdf(urdf, {}, {.samples = 500, .allow_at_rest = false, .is_exact = true});
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    CHECK(made->reasons == std::vector<std::string>{"Adjacent", "Adjacent", "User"});
    CHECK(contains(made->text, "<group name=\"all\">"));
    CHECK(contains(made->text, "\"up\""));
  }

  TEST_CASE("a robot that cannot move has no SRDF to derive") {
    const TemporaryDirectory files;
    const std::string urdf = files / "r.urdf";
    write_file(urdf, "<robot name='r'><link name='a'/></robot>");
    CHECK(require_error(derive_srdf(urdf)).message.starts_with(urdf + ": "));
    CHECK(derive_srdf(files / "none.urdf").error().code == ErrorCode::io);
  }
}

}  // namespace
}  // namespace mneme::test
