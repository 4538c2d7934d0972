// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_train_cvae --robot NAME --db FILE.db: trains a CVAE on the configurations that the
// database's mixtures have as means, and writes FILE.db.cvae for the sampler "cvae".
#include <cmath>
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "mneme/memory.h"
#include "baselines/cvae_sampler.h"
#include "baselines/cvae_weights.h"
#include "baselines/scene_image.h"
#include "training.h"

namespace mneme {
namespace {

struct Input {
  std::string robot = "planar8";
  std::string database;
  int latents = 6;
  int cells = 24;
  int hidden = 128;
  cvae::TrainingSettings training;
};

double reach_of(const Robot& robot) {
  double reach = 0;
  for (const Joint& joint : robot.joints()) reach += joint.origin.translation.norm();
  return reach + 2;
}

/// A joint's place in its limits, from -1 to 1.
float place(const Joint& joint, double value) {
  const double middle = 0.5 * (joint.lower + joint.upper);
  return static_cast<float>((value - middle) / (0.5 * (joint.upper - joint.lower)));
}

/// Appends a row as it was learned, and its mirror image, which is as good.
void add_row(const Robot& robot, const Experience& row, const Input& input, double half_extent,
             cvae::Examples& examples, std::int64_t& scene) {
  const LocalSampler& sampler = row.sampler();
  for (const float sign : {1.0f, -1.0f}) {
    const PrimitiveKey circles = moved_key({0, sign < 0}, row.key);
    const Symmetry to_canonical = {-internal::mean_direction(circles), false};
    const auto image =
        internal::draw_image(moved_key(to_canonical, circles), input.cells, half_extent);
    examples.images.insert(examples.images.end(), image.begin(), image.end());
    for (int i = 0; i < sampler.component_count(); ++i) {
      for (int j = 0; j < robot.joint_count(); ++j) {
        const float value = sampler.means[static_cast<std::size_t>(i * robot.joint_count() + j)];
        const double turn = j == 0 ? to_canonical.rotation : 0;
        examples.configurations.push_back(
            place(robot.group_joint(j), std::remainder(sign * value + turn, 2 * M_PI)));
      }
      examples.scenes.push_back(scene);
    }
    ++scene;
  }
}

/// The rows of pairs of circles; those of other kinds cannot be drawn.
Result<cvae::Examples> make_examples(const Robot& robot, const Database& database,
                                     const Input& input, double half_extent) {
  const auto pairs = find_memory_kind("pairs");
  if (!pairs) return tl::unexpected(pairs.error());
  cvae::Examples examples;
  std::int64_t scene = 0;
  const auto read = database.for_each([&](const std::shared_ptr<const Experience>& row) {
    if (row->kind != (*pairs)->version || row->is_path()) return;
    add_row(robot, *row, input, half_extent, examples, scene);
  });
  if (!read) return tl::unexpected(read.error());
  return examples;
}

/// The columns from `begin` to `end` of a matrix with `columns` columns.
std::vector<float> columns_of(const std::vector<float>& matrix, int columns, int begin, int end) {
  std::vector<float> result;
  for (std::size_t row = 0; row < matrix.size(); row += static_cast<std::size_t>(columns)) {
    const auto first = matrix.begin() + static_cast<std::ptrdiff_t>(row);
    result.insert(result.end(), first + begin, first + end);
  }
  return result;
}

internal::CvaeWeights to_weights(const Robot& robot, const Input& input, double half_extent,
                                 cvae::TrainedDecoder trained) {
  internal::CvaeWeights weights;
  weights.robot_hash = robot.hash();
  weights.joints = robot.joint_count();
  weights.latents = input.latents;
  weights.cells = input.cells;
  weights.hidden = input.hidden;
  weights.half_extent = half_extent;
  const int inputs = input.latents + input.cells * input.cells;
  weights.latent_layer = columns_of(trained.first_layer, inputs, 0, input.latents);
  weights.image_layer = columns_of(trained.first_layer, inputs, input.latents, inputs);
  weights.first_bias = std::move(trained.first_bias);
  weights.second_layer = std::move(trained.second_layer);
  weights.second_bias = std::move(trained.second_bias);
  weights.output_layer = std::move(trained.output_layer);
  weights.output_bias = std::move(trained.output_bias);
  return weights;
}

Result<void> run(const Input& input) {
  const auto urdf = find_robot(input.robot);
  const auto robot = load_robot(urdf ? *urdf : input.robot);
  if (!robot) return tl::unexpected(robot.error());
  const auto space = make_signature(*robot);
  const auto database = Database::open(input.database, space, OpenMode::read_only);
  if (!database) return tl::unexpected(database.error());
  if (!robot->is_planar()) return fail(ErrorCode::unsupported, "the CVAE is for planar arms");
  const double half_extent = reach_of(*robot);
  const auto examples = make_examples(*robot, *database, input, half_extent);
  if (!examples) return tl::unexpected(examples.error());
  if (examples->scenes.empty()) return fail(ErrorCode::invalid, "the database has no components");
  std::printf("%zu configurations of %lld rows, with their mirror images\n",
              examples->scenes.size(), static_cast<long long>(database->size()));
  const cvae::Sizes sizes{robot->joint_count(), input.latents, input.cells * input.cells,
                          input.hidden};
  cvae::TrainedDecoder trained =
      cvae::train(sizes, *examples, input.training, [](int step, double loss) {
        if (step % 1000 == 0) std::printf("step %d: loss %.4f\n", step, loss);
      });
  std::printf("mean squared error %.5f of (half the limits)^2 per joint, divergence %.2f nats\n",
              trained.error, trained.divergence);
  const std::string path = internal::cvae_path(*database);
  std::printf("writing %s\n", path.c_str());
  return internal::save_cvae(path, to_weights(*robot, input, half_extent, std::move(trained)));
}

}  // namespace
}  // namespace mneme

int main(int argc, char** argv) {
  mneme::Input input;
  CLI::App app{"Trains the CVAE of Ichter et al. 2018 on a database of mneme"};
  app.add_option("--robot", input.robot, "URDF file or name (default planar8)");
  app.add_option("--db", input.database, "database; the weights are written to DB.cvae")
      ->required();
  app.add_option("--steps", input.training.steps, "batches (default 10000)")
      ->check(CLI::Range(100, 10000000));
  app.add_option("--latents", input.latents, "latent variables (default 6)")
      ->check(CLI::Range(1, 64));
  app.add_option("--divergence-weight", input.training.divergence_weight,
                 "weight of the divergence (default 0.01)")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--seed", input.training.seed, "seed (default 1)");
  CLI11_PARSE(app, argc, argv);
  try {
    const mneme::Result<void> done = mneme::run(input);
    if (done) return 0;
    std::fprintf(stderr, "mneme_train_cvae: %s\n", done.error().message.c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mneme_train_cvae: %s\n", error.what());
  }
  return 1;
}
