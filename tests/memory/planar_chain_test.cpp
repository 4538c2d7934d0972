// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"
#include "support/threaded.h"
#include "memory/planar_chain.h"

namespace mneme::test {
namespace {

using internal::PlanarChain;
using internal::Vec2;

void check_refused(const std::string& urdf, const std::string& word) {
  const Error error = require_error(PlanarChain::make(require_arm(urdf)));
  CHECK(error.code == ErrorCode::unsupported);
  CHECK_MESSAGE(contains(error.message, word), error.message);
}

/// A robot of two links; the second is `link`, and hangs on the first by `joint`.
std::string two_links(const std::string& link, const std::string& joint) {
  const std::string capsule =
      R"(<collision><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
         <geometry><capsule radius="0.01" length="1"/></geometry></collision>)";
  return R"(<robot name="bent"><link name="base"/><link name="upper">)" + capsule +
         R"(</link><link name="lower">)" + (link.empty() ? capsule : link) +
         R"(</link><joint name="a" type="continuous"><parent link="base"/><child link="upper"/>
            <axis xyz="0 0 1"/></joint>)" +
         joint + "</robot>";
}

std::string joint_xml(const std::string& xyz, const std::string& axis = "0 0 1",
                      const std::string& parent = "upper") {
  return R"(<joint name="b" type="continuous"><parent link=")" + parent +
         R"("/><child link="lower"/><origin xyz=")" + xyz + R"("/><axis xyz=")" + axis +
         R"("/></joint>)";
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("points are where the robot's kinematics put the ends of its links") {
    const Robot robot = planar8();
    const PlanarChain chain = require(internal::PlanarChain::make(robot));
    REQUIRE(chain.link_count() == 8);
    CHECK(chain.reach() == doctest::Approx(11.6));
    Rng rng(1);
    for (int round = 0; round < 200; ++round) {
      const Configuration q = random_configuration(robot, rng);
      const std::vector<Transform> poses = robot.link_poses(q);
      std::vector<Vec2> points;
      chain.points(q, points);
      REQUIRE(points.size() == 9);
      CHECK(points[0].norm() == 0);
      for (int i = 0; i < 8; ++i) {
        const int link = robot.group_joint(i).child_link;
        const Vec3 end = poses[static_cast<std::size_t>(link)] * Vec3(chain.length(i), 0, 0);
        CHECK((points[static_cast<std::size_t>(i) + 1] - end.head<2>()).norm() < 1e-9);
      }
    }
  }

  TEST_CASE("joint values lead back to the directions of the links") {
    const PlanarChain chain = require(internal::PlanarChain::make(planar8()));
    Rng rng(2);
    for (int round = 0; round < 200; ++round) {
      std::vector<double> directions;
      for (int i = 0; i < 8; ++i) directions.push_back(rng.uniform(-9, 9));
      const Configuration q = chain.joint_values(directions);
      std::vector<Vec2> points;
      chain.points(q, points);
      for (std::size_t i = 0; i < 8; ++i) {
        const Vec2 along(std::cos(directions[i]), std::sin(directions[i]));
        CHECK((points[i + 1] - points[i] - chain.length(static_cast<int>(i)) * along).norm() <
              1e-9);
        CHECK(q[i] >= -kPi);
        CHECK(q[i] <= kPi);
      }
    }
  }

  TEST_CASE("a direction and a joint value are each other's inverse, within the limits") {
    const PlanarChain chain =
        require(internal::PlanarChain::make(limited_arm({1, 2, 1.5}, 0.5, 6.5)));
    Rng rng(5);
    for (int round = 0; round < 200; ++round) {
      const double before = rng.uniform(-9, 9), value = rng.uniform(0.5, 6.5);
      const double back = chain.joint_value(2, chain.direction(2, value, before), before);
      CHECK(chain.limits(2).contains(back));
      CHECK(std::abs(std::remainder(back - value, 2 * kPi)) < 1e-9);
    }
    // Where no number of turns leads within the limits, there is only the nearest to zero.
    CHECK(chain.joint_value(1, 0.3, 0) == doctest::Approx(0.3));
    CHECK(!chain.limits(1).contains(0.3));
  }

  TEST_CASE("segments that cross do so in whichever order they are given") {
    Rng rng(3);
    int crossing = 0;
    for (int round = 0; round < 2000; ++round) {
      const auto point = [&] { return Vec2{rng.uniform(-1, 1), rng.uniform(-1, 1)}; };
      const Vec2 a = point(), b = point(), c = point(), d = point();
      // The intersection of the lines, by their parameters.
      Eigen::Matrix2d system;
      system.col(0) = b - a;
      system.col(1) = c - d;
      const double determinant = system(0, 0) * system(1, 1) - system(0, 1) * system(1, 0);
      const Vec2 r = c - a;
      const double s = (r.x() * system(1, 1) - system(0, 1) * r.y()) / determinant;
      const double t = (system(0, 0) * r.y() - r.x() * system(1, 0)) / determinant;
      const bool expected = s >= 0 && s <= 1 && t >= 0 && t <= 1;
      crossing += expected;
      CHECK(internal::do_segments_cross(a, b, c, d) == expected);
      CHECK(internal::do_segments_cross(b, a, c, d) == expected);
      CHECK(internal::do_segments_cross(d, c, a, b) == expected);
    }
    CHECK(crossing > 200);
  }

  TEST_CASE("segments on one line cross if and only if they overlap") {
    Rng rng(4);
    int apart = 0;
    for (int round = 0; round < 2000; ++round) {
      const double angle = rng.uniform(-kPi, kPi);
      // Axes too: there the points lie on the line exactly.
      const Vec2 along = round % 3 == 0 ? Vec2(0, 1) : Vec2(std::cos(angle), std::sin(angle));
      const auto place = [&] { return rng.uniform(-1, 1); };
      const double a = place(), b = place(), c = place(), d = place();
      const bool is_apart = std::max(a, b) < std::min(c, d) || std::max(c, d) < std::min(a, b);
      apart += is_apart;
      if (is_apart) {
        CHECK(!internal::do_segments_cross(a * along, b * along, c * along, d * along));
      } else if (round % 3 == 0) {
        CHECK(internal::do_segments_cross(a * along, b * along, c * along, d * along));
      }
    }
    CHECK(apart > 300);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("links may be bent: a capsule that does not lie along the x axis") {
    const Robot robot = require_arm(two_links("", joint_xml("1 0 0")));
    const PlanarChain straight = require(internal::PlanarChain::make(robot));
    std::vector<Vec2> points;
    straight.points(Configuration{0, 0}, points);
    CHECK((points[2] - Vec2(2, 0)).norm() < 1e-9);

    const std::string up = R"(<collision>
      <origin xyz="0 0.5 0" rpy="-1.5707963267948966 0 0"/>
      <geometry><capsule radius="0.01" length="1"/></geometry></collision>)";
    const PlanarChain bent =
        require(internal::PlanarChain::make(require_arm(two_links(up, joint_xml("1 0 0")))));
    bent.points(Configuration{0, 0}, points);
    CHECK((points[2] - Vec2(1, 1)).norm() < 1e-9);
    CHECK(std::abs(bent.joint_values(std::vector<double>{0, kPi / 2})[1]) < 1e-9);
  }

  TEST_CASE("robots of another build are refused by name") {
    const std::string ball =
        R"(<collision><geometry><sphere radius="0.1"/></geometry></collision>)";
    check_refused(two_links(ball, joint_xml("1 0 0")), "'lower'");
    check_refused(two_links("", joint_xml("0.9 0 0")), "'b'");
    check_refused(two_links("", joint_xml("1 0 0", "0 0 -1")), "'b'");
    check_refused(two_links("", joint_xml("1 0 0", "0 0 1", "base")), "'b'");
    check_refused(two_links("", joint_xml("1 0 0", "0 1 0")), "plane");
    CHECK(contains(require_error(PlanarChain::make(upright_arm())).message, "'upright'"));
  }

  TEST_CASE("the gap is the segment between the surfaces on the line of centres") {
    const internal::GapSegment gap = internal::gap_segment(PrimitiveKey{0, 3, 1, 0, -2, 1.5});
    CHECK((gap.a - Vec2(0, 2)).norm() < 1e-12);
    CHECK((gap.b - Vec2(0, -0.5)).norm() < 1e-12);
  }

  TEST_CASE("segments that touch cross, parallel ones do not") {
    using internal::do_segments_cross;
    CHECK(do_segments_cross({0, 0}, {2, 0}, {1, 0}, {1, 1}));
    CHECK(do_segments_cross({0, 0}, {2, 0}, {2, 0}, {3, 1}));
    CHECK(!do_segments_cross({0, 0}, {2, 0}, {0, 0.1}, {2, 0.1}));
    CHECK(!do_segments_cross({0, 0}, {2, 0}, {1, 0.1}, {1, 1}));
    CHECK(!do_segments_cross({0, 0}, {2, 0}, {3, -1}, {3, 1}));
    CHECK(!do_segments_cross({0, 0}, {1, 0}, {2, 0}, {3, 0}));
    CHECK(do_segments_cross({0, 0}, {1, 0}, {1, 0}, {3, 0}));
  }
}

}  // namespace mneme::test
