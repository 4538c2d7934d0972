// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A sampler whose configurations a test decides.
#pragma once

#include "support/support.h"

#include <functional>
#include <memory>
#include <utility>

namespace mneme::test {

/// Replays a script, again from its first configuration after the last one. The source of each
/// configuration is its place in the script. The log is of the latest stream.
class ScriptedSampler final : public Sampler {
 public:
  struct Log {
    std::uint64_t drawn = 0;
    std::vector<std::pair<SampleSource, SampleOutcome>> reports;
  };
  using OnDraw = std::function<void(std::uint64_t drawn)>;

  explicit ScriptedSampler(std::vector<Configuration> script, OnDraw on_draw = {})
      : script_(std::move(script)), on_draw_(std::move(on_draw)), log_(std::make_shared<Log>()) {}

  [[nodiscard]] std::unique_ptr<SampleStream> start(std::uint64_t) const override {
    *log_ = {};
    return std::make_unique<Stream>(*this);
  }
  [[nodiscard]] const Log& log() const { return *log_; }

 private:
  class Stream final : public SampleStream {
   public:
    explicit Stream(const ScriptedSampler& sampler) : sampler_(sampler) {}
    SampleSource next(std::span<float> q) override {
      const std::size_t place = sampler_.log_->drawn++ % sampler_.script_.size();
      for (std::size_t j = 0; j < q.size(); ++j) {
        q[j] = static_cast<float>(sampler_.script_[place].at(j));
      }
      if (sampler_.on_draw_) sampler_.on_draw_(sampler_.log_->drawn);
      return static_cast<SampleSource>(place);
    }
    void report(SampleSource source, SampleOutcome outcome) override {
      sampler_.log_->reports.emplace_back(source, outcome);
    }

   private:
    const ScriptedSampler& sampler_;
  };

  std::vector<Configuration> script_;
  OnDraw on_draw_;
  std::shared_ptr<Log> log_;
};

}  // namespace mneme::test
