// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/fixtures.h"
#include "store/row_check.h"
#include "support/support.h"

#include <limits>

namespace mneme::test {
namespace {

/// What is wrong with a sound row once `change` was done to it.
std::string flaw_after(const std::function<void(Experience&)>& change) {
  Rng rng(41);
  Experience experience = random_experience(rng);
  change(experience);
  return internal::describe_flaw(experience, arm_space()).value_or("");
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a row whose sizes fit and whose numbers are finite is sound") {
    CHECK(flaw_after([](Experience&) {}).empty());
    CHECK(flaw_after([](Experience& e) { e.sampler.sources.clear(); }).empty());
    CHECK(flaw_after([](Experience& e) {
            e.sampler.factor_rows.clear();
            e.sampler.factors.clear();
          }).empty());
  }

  TEST_CASE("an empty sampler is sound whether or not it says for how many joints") {
    CHECK(flaw_after([](Experience& e) { e.sampler = {}; }).empty());
    CHECK(flaw_after([](Experience& e) {
            e.sampler = {};
            e.sampler.joint_count = 3;
          }).empty());
  }

  TEST_CASE("a kind is a short text without control characters") {
    for (const std::string kind : {"", "a\tb", "\x7f", "\xc2\x85", "caf\xe9", "a\xff"}) {
      CHECK(flaw_after([&](Experience& e) { e.kind = kind; }).find("its kind is no text") == 0);
    }
    CHECK(!flaw_after([](Experience& e) { e.kind = std::string(65, 'k'); }).empty());
    CHECK(!flaw_after([](Experience& e) { e.kind = std::string("a\0b", 3); }).empty());
    CHECK(flaw_after([](Experience& e) { e.kind = std::string(64, 'k'); }).empty());
    CHECK(flaw_after([](Experience& e) { e.kind = "caf\xc3\xa9/1"; }).empty());
  }

  TEST_CASE("a key of the wrong size or with a number that is no length is a flaw") {
    CHECK(flaw_after([](Experience& e) { e.key.clear(); }) == "its key has no numbers");
    internal::KeySizes sizes;
    CHECK(!sizes.check("pairs/1", 6));
    CHECK(!sizes.check("trios/1", 3));
    CHECK(!sizes.check("pairs/1", 6));
    CHECK(sizes.check("pairs/1", 5) ==
          "its key has 5 numbers; expected 6, as others of kind 'pairs/1'");
    CHECK(flaw_after([](Experience& e) { e.key[2] = kNan; }).find("number 2 of its key") == 0);
    CHECK(flaw_after([](Experience& e) { e.key[0] = -kInfinity; }).find("number 0") == 0);
    CHECK(flaw_after([](Experience& e) { e.key[5] = 1.1e6; }).find("number 5") == 0);
  }

  TEST_CASE("a sampler of the wrong shape is a flaw") {
    CHECK(flaw_after([](Experience& e) { e.sampler.joint_count = 4; }) ==
          "its sampler is for 4 joints; expected 3");
    CHECK(flaw_after([](Experience& e) { e.sampler.means.pop_back(); }) ==
          "its 14 mean values are no multiple of 3");
    CHECK(flaw_after([](Experience& e) { e.sampler.sources.pop_back(); }) ==
          "it has 4 origins for 5 components");
    CHECK(flaw_after([](Experience& e) { e.sampler.factor_rows.push_back(0); }) ==
          "it has 6 factor rows for 5 components");
    CHECK(flaw_after([](Experience& e) { e.sampler.factors.pop_back(); }) ==
          "its 5 factor values are no multiple of 6");
    CHECK(flaw_after([](Experience& e) { e.sampler.factor_rows[3] = 1; }) ==
          "it refers to factor row 1 of 1");
    CHECK(flaw_after([](Experience& e) { e.sampler.factor_rows[3] = -2; }) ==
          "it refers to factor row -2 of 1");
  }

  TEST_CASE("text that not every store can hold is a flaw") {
    CHECK(flaw_after([](Experience& e) { e.provenance.tool = "caf\xe9"; }).find("tool") !=
          std::string::npos);
    CHECK(flaw_after([](Experience& e) {
            e.provenance.settings = std::string("a\0b", 3);
          }).find("settings") != std::string::npos);
    CHECK(flaw_after([](Experience& e) {
            e.provenance.settings = "'; DROP TABLE x; -- \u00e9";
          }).empty());
  }

  TEST_CASE("a number that is not finite is a flaw") {
    CHECK(flaw_after([](Experience& e) {
            e.sampler.means[4] = kNan;
          }).find("number 4 of its means") == 0);
    CHECK(flaw_after([](Experience& e) {
            e.sampler.factors[1] = kInfinity;
          }).find("number 1 of its factors") == 0);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the space of a robot is its hashes and its number of joints") {
    const Robot arm = planar8();
    const ExperienceSpace space = make_space(arm);
    CHECK(space.robot_name == arm.name());
    CHECK(space.robot_hash == arm.kinematics_hash() + "/" + arm.hash());
    CHECK(hashes_of(space).kinematics == arm.kinematics_hash());
    CHECK(hashes_of(space).model == arm.hash());
    CHECK(space.joint_count == 8);
  }

  TEST_CASE("of two hashes the kinematics decide; an older space has one, which must be the same") {
    const ExperienceSpace space{"arm", "11111111aaaaaaaa/0123456789abcdef", 3};
    const auto changed = [&](const std::string& hashes, int joints = 3) {
      return compare_robots(space, {"arm", hashes, joints});
    };
    CHECK(changed("11111111aaaaaaaa/0123456789abcdef") == RobotDifference::none);
    CHECK(changed("11111111aaaaaaaa/ffffffffffffffff") == RobotDifference::shapes);
    CHECK(changed("11111111bbbbbbbb/0123456789abcdef") == RobotDifference::limits);
    CHECK(changed("22222222aaaaaaaa/0123456789abcdef") == RobotDifference::frames);
    CHECK(changed("11111111aaaaaaaa/0123456789abcdef", 4) == RobotDifference::frames);
    CHECK(changed("0123456789abcdef") == RobotDifference::none);
    CHECK(changed("ffffffffffffffff") == RobotDifference::frames);
    CHECK(hashes_of({"arm", "0123456789abcdef", 3}).kinematics.empty());
    CHECK(hashes_of({"arm", "0123456789abcdef", 3}).model == "0123456789abcdef");
    const ExperienceSpace limited{"arm", "11111111bbbbbbbb/0123456789abcdef", 3};
    CHECK(internal::refuse_space("a.db", space, limited).value().message.find("db adopt") !=
          std::string::npos);
  }

  TEST_CASE("spaces are the same but for the robot's name, and refusals describe both") {
    const ExperienceSpace space{"arm", "0123456789abcdef", 3};
    ExperienceSpace renamed = space;
    renamed.robot_name = "other arm";
    CHECK(internal::is_same_space(space, renamed));
    std::vector<ExperienceSpace> others(2, space);
    others[0].robot_hash = "f123456789abcdef";
    others[1].joint_count = 4;
    for (const ExperienceSpace& other : others) {
      CHECK(!internal::is_same_space(space, other));
      const Error error = internal::refuse_space("a.db", space, other).value();
      CHECK(error.code == ErrorCode::wrong_robot);
      CHECK(error.message == "a.db: holds experience of " + internal::describe(space) +
                                 "; expected that of " + internal::describe(other));
    }
  }
}

}  // namespace mneme::test
