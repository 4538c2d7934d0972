// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_train_cvae --robot NAME --db FILE.db: plans among the pairs of circles of a database,
// trains a CVAE on the paths, and writes FILE.db.cvae for the sampler "cvae".
#include "mneme/experience.h"

#include "baselines/cvae_sampler.h"
#include "baselines/cvae_weights.h"
#include "lessons.h"
#include "training.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <string>

namespace mneme {
namespace {

struct Input {
  std::string robot = "planar8";
  std::string database;
  int latents = 6;
  int hidden = 128;
  cvae::LessonSettings lessons;
  cvae::TrainingSettings training;
};

void print(const cvae::Lessons& lessons) {
  std::printf("%d rows with their mirror images, %d skipped; %d of %d local queries solved\n",
              lessons.rows, lessons.skipped_rows, lessons.solved_queries, lessons.queries);
  std::printf("%zu examples in %zu scenes to train on, %zu in %zu held out\n",
              lessons.training.example_count(), lessons.training.scene_count(),
              lessons.held_out.example_count(), lessons.held_out.scene_count());
  std::printf("images of %d x %d pixels for %.1f m around the base\n", lessons.cells, lessons.cells,
              lessons.half_extent);
  std::fflush(stdout);
}

void print(const cvae::Check& check) {
  std::printf(
      "step %d, %.0f s: training loss %.4f, held out %.4f (error %.5f, divergence %.2f), learning "
      "rate %.2g\n",
      check.step, check.time_s, check.training_loss, check.loss, check.error, check.divergence,
      check.learning_rate);
  std::fflush(stdout);
}

const char* describe(cvae::Ending ending) {
  switch (ending) {
    case cvae::Ending::converged:
      return "the loss of held-out examples no longer falls";
    case cvae::Ending::step_limit:
      return "the limit of steps, not converged";
    case cvae::Ending::time_limit:
      return "the limit of time, not converged";
    case cvae::Ending::diverged:
      return "the loss is no number, diverged";
  }
  return "";
}

void print(const cvae::Trained& trained) {
  std::printf("ended after %d steps: %s\n", trained.steps, describe(trained.ending));
  std::printf(
      "best at step %d, of held-out examples: mean squared error %.5f of (half the limits)^2 per "
      "joint, divergence %.2f nats\n",
      trained.best.step, trained.best.error, trained.best.divergence);
}

Result<void> run(const Input& input) {
  const std::string file = MNEME_TRY(robot_file(input.robot));
  const Robot robot = MNEME_TRY(load_robot(file));
  const Database database =
      MNEME_TRY(Database::open(input.database, make_signature(robot), OpenMode::read_only));
  const cvae::Lessons lessons = MNEME_TRY(cvae::make_lessons(robot, database, input.lessons));
  print(lessons);
  const double cell = 2 * lessons.half_extent / lessons.cells;
  const cvae::Sizes sizes{robot.joint_count(), input.latents, lessons.cells, input.hidden,
                          cell * cell};
  cvae::Trained trained = cvae::train(sizes, lessons.training, lessons.held_out, input.training,
                                      [](const cvae::Check& check) { print(check); });
  print(trained);
  if (trained.best.step == 0) {
    return fail(ErrorCode::invalid, "the losses are no numbers; train with another --seed");
  }
  trained.weights.robot_hash = robot.hash();
  trained.weights.half_extent = lessons.half_extent;
  const std::string path = internal::cvae_path(database);
  std::printf("writing %s\n", path.c_str());
  return internal::save_cvae(path, trained.weights);
}

void add_options(CLI::App& app, Input& input) {
  app.add_option("--robot", input.robot, "URDF file or name (default planar8)");
  app.add_option("--db", input.database, "database; the weights are written to DB.cvae")
      ->required();
  app.add_option("--cell", input.lessons.cell, "largest side of a pixel, metres (default 0.1)")
      ->check(CLI::Range(0.05, 5.0));
  app.add_option("--queries", input.lessons.queries, "local queries per row (default 20)")
      ->check(CLI::Range(1, 1000));
  app.add_option("--latents", input.latents, "latent variables (default 6)")
      ->check(CLI::Range(1, 64));
  app.add_option("--hidden", input.hidden,
                 "features of an image, and neurons of a hidden layer (default 128)")
      ->check(CLI::Range(8, 256));
  app.add_option("--steps", input.training.steps, "most batches (default 60000)")
      ->check(CLI::Range(1, 10000000));
  app.add_option("--minutes", input.training.minutes,
                 "most time of training, without the local queries (default 60)")
      ->check(CLI::Range(0.0, 10000.0));
  app.add_option("--divergence-weight", input.training.divergence_weight,
                 "weight of the divergence (default 0.01)")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--seed", input.training.seed, "seed (default 1)");
}

}  // namespace
}  // namespace mneme

int main(int argc, char** argv) {
  mneme::Input input;
  CLI::App app{"Trains the CVAE of Ichter et al. 2018 on a database of mneme"};
  mneme::add_options(app, input);
  CLI11_PARSE(app, argc, argv);
  input.lessons.seed = input.training.seed;
  try {
    const mneme::Result<void> done = mneme::run(input);
    if (done) return 0;
    std::fprintf(stderr, "mneme_train_cvae: %s\n", done.error().message.c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mneme_train_cvae: %s\n", error.what());
  }
  return 1;
}
