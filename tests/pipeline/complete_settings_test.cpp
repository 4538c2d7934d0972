// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/complete_settings.h"

#include "support/lifting_arm.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("what is left to the robot gets the defaults of planar arms or of arms in space") {
    const SolveSettings planar = internal::complete_settings({}, planar8());
    CHECK(planar.sigma == 0.05);
    CHECK(planar.similarity == 0.5);
    CHECK(planar.retrieve_after == 0);
    CHECK(planar.first_components == 0);
    CHECK(planar.lambda == 0.5);
    CHECK(planar.max_matches == 8);
    CHECK(planar.drop_invalid_means);
    const SolveSettings spatial = internal::complete_settings({}, lifting_arm());
    CHECK(spatial.sigma == 0.3);
    CHECK(spatial.similarity == 0.05);
    CHECK(spatial.retrieve_after == 1500);
    CHECK(spatial.first_components == 20);
    CHECK_FALSE(spatial.drop_invalid_means);
  }

  TEST_CASE("the decomposer that was asked for decides, otherwise that of the database") {
    const Robot robot = lifting_arm();
    SolveSettings settings;
    settings.decompose.decomposer = "paths";
    CHECK(internal::complete_settings(settings, robot).max_matches == 50);
    CHECK(internal::complete_settings(settings, robot).lambda == 0.7);
    TemporaryDirectory directory;
    auto database = Database::open(directory / "m.db", make_space(robot), OpenMode::create);
    REQUIRE(database.has_value());
    CHECK(internal::complete_settings({}, robot, &*database).decompose.decomposer == "body_pairs");
    SolveSettings remembering;
    remembering.remember_after = 0;
    CHECK(internal::complete_settings(remembering, robot, &*database).decompose.decomposer ==
          "paths");
    const Configuration q(static_cast<std::size_t>(robot.joint_count()));
    REQUIRE(database->insert(learn_whole_paths(robot, std::vector<Path>{{q, q}})));
    const SolveSettings found = internal::complete_settings({}, robot, &*database);
    CHECK(found.decompose.decomposer == "paths");
    CHECK(found.sigma == 0.4);
    settings.decompose.decomposer = "body_pairs";
    CHECK(internal::complete_settings(settings, robot, &*database).sigma == 0.3);
  }

  TEST_CASE("what is set stays, and so does all that has one default") {
    SolveSettings settings;
    settings.sigma = 0.01;
    settings.similarity = 1e-300;
    settings.retrieve_after = 0;
    settings.first_components = 0;
    settings.lambda = 0.25;
    settings.max_matches = 3;
    settings.plan.seed = 7;
    for (const Robot& robot : {planar8(), lifting_arm()}) {
      const SolveSettings complete = internal::complete_settings(settings, robot);
      CHECK(complete.sigma == 0.01);
      CHECK(complete.similarity == 1e-300);
      CHECK(complete.retrieve_after == 0);
      CHECK(complete.first_components == 0);
      CHECK(complete.lambda == 0.25);
      CHECK(complete.max_matches == 3);
      CHECK(complete.component_growth == settings.component_growth);
      CHECK(complete.plan.seed == 7);
    }
  }

  TEST_CASE("the declared sentences name the defaults that are taken") {
    SolveSettings settings;
    const auto contains = [](const std::string& text, double value) {
      std::stringstream number;
      number << value;
      return text.find(number.str()) != std::string::npos;
    };
    const SolveSettings planar = internal::complete_settings({}, planar8());
    const SolveSettings spatial = internal::complete_settings({}, lifting_arm());
    int checked = 0;
    visit_settings(settings, [&](const std::string& name, auto&, auto, auto, const char* sentence) {
      const auto check = [&](double of_planar, double of_spatial) {
        CHECK_MESSAGE(contains(sentence, of_planar), sentence);
        CHECK_MESSAGE(contains(sentence, of_spatial), sentence);
        ++checked;
      };
      if (name == "sigma") check(planar.sigma, spatial.sigma);
      if (name == "similarity") check(planar.similarity, spatial.similarity);
      if (name == "retrieve-after") check(planar.retrieve_after, spatial.retrieve_after);
      if (name == "first-components") check(planar.first_components, spatial.first_components);
    });
    CHECK(checked == 4);
  }

  TEST_CASE("the declared sentence of retrieve-after names the defaults of all decomposers") {
    SolveSettings settings;
    std::string declared;
    visit_settings(settings, [&](const std::string& name, auto&, auto, auto, const char* sentence) {
      if (name == "retrieve-after") declared = sentence;
    });
    for (const std::string& decomposer : decomposer_names()) {
      settings.decompose.decomposer = decomposer;
      const int samples = internal::complete_settings(settings, planar8()).retrieve_after;
      const std::size_t at = declared.find(std::to_string(samples) + " for ");
      REQUIRE_MESSAGE(at != std::string::npos, declared);
      const std::string clause = declared.substr(at, declared.find_first_of(",)", at) - at);
      CHECK_MESSAGE(clause.find(decomposer) != std::string::npos, declared);
      CHECK(default_max_matches(decomposer) ==
            internal::complete_settings(settings, planar8()).max_matches);
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("complete settings are complete") {
    for (const Robot& robot : {planar8(), lifting_arm()}) {
      const SolveSettings once = internal::complete_settings({}, robot);
      const SolveSettings twice = internal::complete_settings(once, robot);
      CHECK(once.sigma == twice.sigma);
      CHECK(once.similarity == twice.similarity);
      CHECK(once.retrieve_after == twice.retrieve_after);
      CHECK(once.first_components == twice.first_components);
    }
  }
}

}  // namespace mneme::test
