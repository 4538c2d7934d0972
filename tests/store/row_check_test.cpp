// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/fixtures.h"
#include "store/row_check.h"
#include "support/support.h"

#include <limits>

namespace mneme::test {
namespace {

/// Returns the flaw of a sound row after `change`.
std::string flaw_after(const std::function<void(Experience&)>& change) {
  Rng rng(41);
  Experience experience = random_experience(rng);
  change(experience);
  return internal::describe_flaw(experience, arm_signature()).value_or("");
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a row whose sizes fit and whose numbers are finite is sound") {
    CHECK(flaw_after([](Experience&) {}).empty());
    CHECK(flaw_after([](Experience& e) { e.sampler().sources.clear(); }).empty());
    CHECK(flaw_after([](Experience& e) {
            e.sampler().factor_rows.clear();
            e.sampler().factors.clear();
          }).empty());
  }

  TEST_CASE("an empty sampler is sound whether or not it says for how many joints") {
    CHECK(flaw_after([](Experience& e) { e.sampler() = {}; }).empty());
    CHECK(flaw_after([](Experience& e) {
            e.sampler() = {};
            e.sampler().joint_count = 3;
          }).empty());
  }

  TEST_CASE("a kind is a short text without control characters") {
    for (const std::string kind : {"", "a\tb", "\x7f", "\xc2\x85", "caf\xe9", "a\xff"}) {
      CHECK(flaw_after([&](Experience& e) { e.kind = kind; }).find("its kind is not a text") == 0);
    }
    CHECK(!flaw_after([](Experience& e) { e.kind = std::string(65, 'k'); }).empty());
    CHECK(!flaw_after([](Experience& e) { e.kind = std::string("a\0b", 3); }).empty());
    CHECK(flaw_after([](Experience& e) { e.kind = std::string(64, 'k'); }).empty());
    CHECK(flaw_after([](Experience& e) { e.kind = "caf\xc3\xa9/1"; }).empty());
  }

  TEST_CASE("only rows of a kind of paths hold paths, and they hold nothing else") {
    Rng rng(42);
    Experience row = random_path(rng);
    CHECK(!internal::describe_flaw(row, arm_signature()));
    row.kind = "pairs/1";
    CHECK(internal::describe_flaw(row, arm_signature()) ==
          "it holds a path, which rows of kind 'pairs/1' cannot");
    CHECK(flaw_after([](Experience& e) { e.kind = "paths/1"; }) ==
          "it holds a sampler, which rows of kind 'paths/1' cannot");
  }

  TEST_CASE("a path has a clearance per waypoint, and near misses only with clearances") {
    Rng rng(43);
    const auto flaw_of = [&](const std::function<void(RememberedPath&)>& change) {
      Experience row = random_path(rng);
      row.kind = "motions/1";
      change(row.path());
      return internal::describe_flaw(row, arm_signature()).value_or("");
    };
    CHECK(flaw_of([](RememberedPath&) {}).empty());
    CHECK(flaw_of([](RememberedPath& path) {
            path.clearances.clear();
            path.near_misses.clear();
          }).empty());
    CHECK(flaw_of([](RememberedPath& path) { path.clearances.clear(); }) ==
          "it has 0 clearances for 5 waypoints");
    CHECK(flaw_of([](RememberedPath& path) { path.clearances.pop_back(); }) ==
          "it has 4 clearances for 5 waypoints");
    CHECK(flaw_of([](RememberedPath& path) { path.near_misses.pop_back(); }) ==
          "its 5 near misses are not a multiple of 3");
    CHECK(flaw_of([](RememberedPath& path) { path.clearances[1] = NAN; }).find("number 1 of") == 0);
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
    CHECK(flaw_after([](Experience& e) { e.sampler().joint_count = 4; }) ==
          "its means are for 4 joints; expected 3");
    CHECK(flaw_after([](Experience& e) { e.sampler().means.pop_back(); }) ==
          "its 14 means are not a multiple of 3");
    CHECK(flaw_after([](Experience& e) { e.sampler().sources.pop_back(); }) ==
          "it has 4 sources for 5 components");
    CHECK(flaw_after([](Experience& e) { e.sampler().factor_rows.push_back(0); }) ==
          "it has 6 factor rows for 5 components");
    CHECK(flaw_after([](Experience& e) { e.sampler().factors.pop_back(); }) ==
          "its 5 factor values are not a multiple of 6");
    CHECK(flaw_after([](Experience& e) { e.sampler().factor_rows[3] = 1; }) ==
          "it refers to factor row 1 of 1");
    CHECK(flaw_after([](Experience& e) { e.sampler().factor_rows[3] = -2; }) ==
          "it refers to factor row -2 of 1");
  }

  TEST_CASE("text that not every store can hold is a flaw") {
    CHECK(contains(flaw_after([](Experience& e) { e.provenance.tool = "caf\xe9"; }), "tool"));
    CHECK(
        contains(flaw_after([](Experience& e) { e.provenance.settings = std::string("a\0b", 3); }),
                 "settings"));
    CHECK(flaw_after([](Experience& e) {
            e.provenance.settings = "'; DROP TABLE x; -- \u00e9";
          }).empty());
  }

  TEST_CASE("a number that is not finite is a flaw") {
    CHECK(flaw_after([](Experience& e) {
            e.sampler().means[4] = kNan;
          }).find("number 4 of its means") == 0);
    CHECK(flaw_after([](Experience& e) {
            e.sampler().factors[1] = kInfinity;
          }).find("number 1 of its factors") == 0);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the signature of a robot is its hashes and its number of joints") {
    const Robot arm = planar8();
    const RobotSignature signature = make_signature(arm);
    CHECK(signature.robot_name == arm.name());
    CHECK(signature.kinematics_hash == arm.kinematics_hash());
    CHECK(signature.model_hash == arm.hash());
    CHECK(signature.joint_count == 8);
  }

  TEST_CASE("the kinematics decide; where one side does not say, the model has to be the same") {
    const std::string model = "0123456789abcdef", other_model = "ffffffffffffffff";
    const RobotSignature known{"arm", "11111111aaaaaaaa", model, 3};
    const auto changed = [&](const std::string& kinematics, const std::string& of, int joints = 3) {
      return compare_robots(known, {"arm", kinematics, of, joints});
    };
    CHECK(changed("11111111aaaaaaaa", model) == RobotDifference::none);
    CHECK(changed("11111111aaaaaaaa", other_model) == RobotDifference::shapes);
    CHECK(changed("11111111bbbbbbbb", model) == RobotDifference::limits);
    CHECK(changed("22222222aaaaaaaa", model) == RobotDifference::frames);
    CHECK(changed("11111111aaaaaaaa", model, 4) == RobotDifference::frames);
    CHECK(changed("", model) == RobotDifference::none);
    CHECK(changed("", other_model) == RobotDifference::frames);
    const RobotSignature limited{"arm", "11111111bbbbbbbb", model, 3};
    CHECK(contains(internal::refuse_robot("a.db", known, limited).value().message, "db adopt"));
  }

  TEST_CASE("paths of schema 3 are under one of 900 numbers that derive from their constraints") {
    CHECK(internal::is_same_constraints(0, 0));
    CHECK(internal::is_same_constraints(123456789012345, 123456789012345));
    CHECK(internal::is_same_constraints(1 + 123456789012345 % 900, 123456789012345));
    CHECK_FALSE(internal::is_same_constraints(0, 900));
    CHECK_FALSE(internal::is_same_constraints(1, 0));
    CHECK_FALSE(internal::is_same_constraints(123456789012345, 246 % 900));
  }

  TEST_CASE("robots are the same but for their names, and refusals describe both") {
    const RobotSignature space{"arm", "", "0123456789abcdef", 3};
    RobotSignature renamed = space;
    renamed.robot_name = "other arm";
    CHECK(internal::is_same_robot(space, renamed));
    std::vector<RobotSignature> others(2, space);
    others[0].model_hash = "f123456789abcdef";
    others[1].joint_count = 4;
    for (const RobotSignature& other : others) {
      CHECK(!internal::is_same_robot(space, other));
      const Error error = internal::refuse_robot("a.db", space, other).value();
      CHECK(error.code == ErrorCode::wrong_robot);
      CHECK(error.message == "a.db: holds experience of " + internal::describe(space) +
                                 "; expected " + internal::describe(other));
    }
  }
}

}  // namespace mneme::test
