// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme view: makes a page of a trace.
#include "mneme/report.h"

#include "commands.h"
#include "options.h"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <string>

namespace mneme::app {
namespace {

struct ViewOptions {
  std::string trace;
  std::string beside;
  std::string page;
};

Result<ExitCode> run_view(const ViewOptions& options) {
  const std::array<ReadFile, 2> inputs = {
      {{"the trace", options.trace}, {"the trace beside it", options.beside}}};
  Result<std::string> beside = "";
  if (!options.beside.empty()) beside = read_file(options.beside, kMaxTraceBytes);
  if (!beside) return tl::unexpected(beside.error());
  return check_outputs(std::array{options.page}, inputs)
      .and_then([&] { return read_file(options.trace, kMaxTraceBytes); })
      .and_then([&](const std::string& json) { return to_page(json, options.trace, *beside); })
      .and_then([&](const std::string& page) { return write_file(options.page, page); })
      .map([&] {
        fmt::print("{}\n", options.page);
        return ExitCode::done;
      });
}

}  // namespace

void add_view(CLI::App& program, Action& action) {
  const auto options = std::make_shared<ViewOptions>();
  CLI::App& command = add_command(program, action, "view", "Make a page from a saved trace",
                                  "plan scenes/planar/scenario1.yaml --trace s1.json\n"
                                  "  mneme view s1.json -o s1.html",
                                  options, run_view);
  command.add_option("TRACE", options->trace, "file of 'mneme plan --trace'")->required();
  command.add_option("--beside", options->beside,
                     "trace of another plan of the same problem, shown beside the first");
  command.add_option("-o,--output", options->page, "page to write; it needs no other file")
      ->required();
}

}  // namespace mneme::app
