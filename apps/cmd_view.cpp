// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme view: makes a page of a trace.
#include <array>
#include <fstream>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "mneme/report.h"

#include "commands.h"
#include "options.h"
#include "output_file.h"

namespace mneme::app {
namespace {

struct ViewOptions {
  std::string trace;
  std::string page;
};

Result<std::string> read_trace(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  std::array<char, 65536> block{};
  while (text.size() <= kMaxTraceBytes &&
         (file.read(block.data(), block.size()) || file.gcount() > 0)) {
    text.append(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (text.empty()) {
    return fail(ErrorCode::io, path +
                                   ": cannot be read, or is empty: expected a trace of "
                                   "'mneme plan PROBLEM --trace FILE'");
  }
  return text;
}

Result<ExitCode> run_view(const ViewOptions& options) {
  return read_trace(options.trace)
      .and_then([&](const std::string& json) { return to_page(json, options.trace); })
      .and_then([&](const std::string& page) { return write_file(options.page, page); })
      .map([&] {
        fmt::print("{}\n", options.page);
        return ExitCode::done;
      });
}

}  // namespace

void add_view(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("view", "Make a page that shows a trace of a plan");
  command->footer(
      "Example:\n  mneme plan scenes/planar/scenario1.yaml --trace s1.json\n"
      "  mneme view s1.json -o s1.html");
  const auto options = std::make_shared<ViewOptions>();
  command->add_option("TRACE", options->trace, "trace that 'mneme plan --trace' wrote")->required();
  command->add_option("-o,--output", options->page, "page to write; it needs no other file")
      ->required();
  command->callback([options, &action] { action = [options] { return run_view(*options); }; });
}

}  // namespace mneme::app
