// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_vary.h"

#include <array>
#include <filesystem>
#include <limits>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mneme/problem.h"
#include "mneme/instances.h"

#include "console.h"
#include "interrupt.h"
#include "options.h"
#include "output_check.h"
#include "output_file.h"
#include "scene_convert.h"

namespace mneme::app {
namespace {

constexpr int kMaxVariants = 1000000;

struct VaryOptions {
  std::string nominal;
  std::string variations;
  std::string output = ".";
  std::uint64_t seed = 1;
  int count = 10;
  bool is_json = false;
};

Result<std::string> write_one(const VaryOptions& options, const FramedScene& nominal,
                              const Variations& variations, int index) {
  Rng rng(derive_seed(options.seed, static_cast<std::uint64_t>(index)));
  Result<Scene> scene = vary(nominal.scene, variations, rng);
  if (!scene) {
    return fail(scene.error().code,
                fmt::format("{}: {}", options.variations, scene.error().message));
  }
  scene->name = fmt::format("{}_{:04}", nominal.scene.name, index);
  const std::string path =
      (std::filesystem::path(options.output) / (scene->name + ".yaml")).string();
  const std::array<ReadFile, 2> inputs = {
      {{"the scene", options.nominal}, {"the file of variations", options.variations}}};
  return check_outputs(std::array{path}, inputs)
      .and_then([&] {
        return write_file(path, to_scene_yaml({std::move(*scene), nominal.frame}));
      })
      .map([&] { return path; });
}

Result<ExitCode> run(const VaryOptions& options) {
  const Result<FramedScene> nominal = extract_scene(options.nominal);
  if (!nominal) return tl::unexpected(nominal.error());
  const Result<Variations> variations = load_variations(options.variations);
  if (!variations) return tl::unexpected(variations.error());
  if (auto made = make_directory(options.output); !made) return tl::unexpected(made.error());
  std::vector<std::string> files;
  for (int i = 1; i <= options.count && !interrupt_flag()->load(); ++i) {
    Result<std::string> file = write_one(options, *nominal, *variations, i);
    if (!file) return tl::unexpected(file.error());
    files.push_back(std::move(*file));
  }
  if (options.is_json) {
    print_json({{"seed", options.seed}, {"files", files}});
  } else {
    fmt::print("wrote {} to {}\n", counted(files.size(), "scene", "scenes"), options.output);
  }
  return interrupt_flag()->load() ? ExitCode::interrupted : ExitCode::done;
}

}  // namespace

void add_scene_vary(CLI::App& group, Action& action) {
  const auto options = std::make_shared<VaryOptions>();
  CLI::App* command = group.add_subcommand("vary", "Write random scenes like a given one");
  command->footer(
      "Example:\n  mneme scene vary scenes/shelf/learn/shelf_1.yaml --variations "
      "scenes/shelf/learn/variations.yaml -n 10 --seed 1 -o shelves");
  command->add_option("SCENE", options->nominal, "scene or problem: YAML file, or FILE.json#NAME")
      ->required();
  command->add_option("--variations", options->variations, "YAML file that says what varies")
      ->required();
  command->add_option("-o,--output", options->output,
                      "directory of the scenes NAME_0001.yaml and so on (default .)");
  add_number(*command, "-n,--count", options->count, 1, kMaxVariants, "scenes to write");
  add_number(*command, "--seed", options->seed, 0, std::numeric_limits<std::uint64_t>::max(),
             "seed of all random numbers; the n-th scene depends on it and on n alone");
  add_json(*command, options->is_json);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace mneme::app
