// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "upkeep/json_rows.h"
#include "engines/fixtures.h"

#include <limits>

namespace mneme::test {
namespace {

using internal::json_of;
using internal::parse_row;
using internal::parse_signature;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a signature and a row are lines that others can read") {
    CHECK(json_of(arm_signature()) ==
          R"({"format":"mneme experience 3","robot_name":"arm","kinematics_hash":"",)"
          R"("model_hash":"0123456789abcdef","joint_count":3})");
    Experience row;
    row.kind = "pairs/1";
    row.key = {1, 0.1};
    row.sampler() = {{2, {0.1f, -1, 2, 3}, {-1, 0}, {1, 0, 1}, {}}};
    row.provenance = {"mneme", "say \"hi\"", std::numeric_limits<std::uint64_t>::max(), "2020"};
    const std::string line = json_of(row);
    CHECK(
        line.substr(line.find("\"kind\"")) ==
        R"("kind":"pairs/1","key":[1,0.1],"means":[[0.1,-1],[2,3]],"factor_rows":[-1,0],"factors":[[1,0,1]],)"
        R"("sources":[],"is_complete":true,"settings":"say \"hi\"","seed":18446744073709551615,"tool":"mneme",)"
        R"("time":"2020"})");
  }

  TEST_CASE("a line that is not as expected is refused with the field's name") {
    Rng rng(8);
    const Experience row = random_experience(rng);
    const std::string sound = json_of(row);
    const auto error_of = [](const std::string& line) {
      const auto parsed = parse_row(line);
      return parsed ? std::string() : parsed.error().message;
    };
    CHECK(error_of(sound).empty());
    CHECK(contains(error_of("[1]"), "not a JSON object"));
    CHECK(contains(error_of(sound.substr(1)), "not a JSON object"));
    for (const std::string name : {"kind", "key", "means", "factor_rows", "factors", "sources",
                                   "is_complete", "settings", "seed", "tool", "time"}) {
      CHECK(contains(error_of(replaced(sound, "\"" + name + "\"", "\"x\"")), "'" + name + "'"));
      const std::size_t value = sound.find("\"" + name + "\":") + name.size() + 3;
      CHECK(!error_of(sound.substr(0, value) + "{}," + sound.substr(value)).empty());
    }
    CHECK(contains(error_of(replaced(sound, "\"seed\":", "\"seed\":-")), "'seed'"));
    CHECK(contains(error_of(replaced(sound, "\"sources\":[0", "\"sources\":[5000000000")),
                   "'sources'"));
    CHECK(contains(error_of(replaced(sound, "\"sources\":[0", "\"sources\":[1")), "'content'"));
    CHECK(error_of("{" + sound.substr(sound.find("\"kind\""))).empty());
    CHECK(contains(
        error_of(replaced(sound, "\"factor_rows\":[", "\"factor_rows\":[18446744073709551615,")),
        "'factor_rows'"));
    const std::string alone =
        R"({"kind":"k","key":[1],"means":[],"factor_rows":[],"factors":[[0,1,2,3]],)"
        R"("sources":[],"is_complete":true,"settings":"","seed":1,"tool":"","time":""})";
    CHECK(error_of(alone) == "a row of 'factors' has 4 numbers; expected 6");
    CHECK(parse_row(replaced(alone, ",3]", "]"))->sampler().joint_count == 2);
  }

  TEST_CASE("deep nesting and numbers beyond what they count are refused") {
    Rng rng(4);
    const std::string sound = json_of(random_experience(rng, 2));
    for (const std::string bracket : {"[", "{\"key\":"}) {
      std::string nested;
      for (int i = 0; i < 1'000'000; ++i) nested += bracket;
      CHECK(!parse_row(nested).has_value());
      CHECK(!parse_signature(nested).has_value());
    }
    const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
    for (const std::string& number : {deep, std::string("1e999"), std::string("1e28")}) {
      CHECK(!parse_row(replaced(sound, "\"key\":[", "\"key\":[" + number + ",")).has_value());
    }
    const std::string space = json_of(arm_signature());
    CHECK(!parse_signature(replaced(space, "\"joint_count\":3", "\"joint_count\":2147483648"))
               .has_value());
  }

  TEST_CASE("a first line of another kind is refused") {
    const std::string sound = json_of(arm_signature());
    CHECK(parse_signature(sound).has_value());
    CHECK(contains(parse_signature(replaced(sound, "experience 3", "experience 2")).error().message,
                   "expected 'mneme experience 3'"));
    CHECK(!parse_signature("").has_value());
    CHECK(
        !parse_signature(replaced(sound, "\"joint_count\":3", "\"joint_count\":6e99")).has_value());
    CHECK(!parse_signature(replaced(sound, "\"format\"", "\"f\"")).has_value());
  }

  TEST_CASE("zeros keep their sign, which is part of the content") {
    Rng rng(5);
    Experience row = random_experience(rng, 1);
    row.key[1] = -0.0;
    row.key[2] = 0.0;
    row.sampler().means[0] = -0.0F;
    row.sampler().means[1] = 0.0F;
    const auto parsed = require(parse_row(json_of(row)));
    CHECK(std::signbit(parsed.key[1]));
    CHECK(!std::signbit(parsed.key[2]));
    CHECK(std::signbit(parsed.sampler().means[0]));
    CHECK(!std::signbit(parsed.sampler().means[1]));
  }
}

TEST_SUITE("law") {
  TEST_CASE("every number comes back to its last bit") {
    Rng rng(9);
    for (int i = 0; i < 300; ++i) {
      Experience row = random_experience(rng, static_cast<int>(rng.index(6)));
      for (float& mean : row.sampler().means)
        mean *= std::exp2(static_cast<float>(rng.index(60)) - 40);
      const auto parsed = require(parse_row(json_of(row)));
      REQUIRE(parsed.kind == row.kind);
      REQUIRE(parsed.key == row.key);
      REQUIRE(parsed.sampler().means == row.sampler().means);
      REQUIRE(parsed.sampler().factors == row.sampler().factors);
      REQUIRE(parsed.provenance.seed == row.provenance.seed);
    }
  }
}

}  // namespace mneme::test
