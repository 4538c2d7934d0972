// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/recall.h"

#include <algorithm>

#include "pipeline/baseline_samplers.h"
#include "pipeline/cvae_sampler.h"
#include "pipeline/valid_components.h"

namespace mneme::internal {

std::shared_ptr<const Sampler> make_sampler(const Robot& robot, const SolveSettings& settings,
                                            const GlSampler& gl) {
  if (settings.sampler == "halton") return make_halton_sampler(robot);
  std::shared_ptr<const Sampler> uniform = make_uniform_sampler(robot);
  if (gl.mixture == nullptr || gl.mixture->component_count() == 0) return uniform;
  // The mixture is drawn from in a fraction lambda of the iterations.
  const Widening widening{settings.first_components,
                          settings.component_growth / std::max(settings.lambda, 1e-3)};
  return make_mixed_sampler(
      settings.lambda, make_mixture_sampler(robot, gl.mixture, settings.sigma, widening), uniform);
}

std::shared_ptr<const Sampler> Recall::make_sampler() {
  if (settings_.retrieve_after == 0) return recalled();
  return make_lazy_sampler(make_uniform_sampler(problem_.robot), settings_.retrieve_after,
                           [this] { return recalled(); });
}

std::shared_ptr<const Sampler> Recall::recalled() {
  const std::lock_guard lock(mutex_);
  if (!sampler_) sampler_ = ask();
  return sampler_;
}

bool is_memory_sampler(std::string_view sampler) {
  return sampler == "gl" || sampler == "pooled" || sampler == "nearest_scenes" || sampler == "cvae";
}

Result<GlSampler> Recall::recall() const {
  if (settings_.sampler == "gl") {
    SolveSettings rest = settings_;
    rest.plan.timeout_s = std::max(0.0, rest.plan.timeout_s - stopwatch_.elapsed_s());
    return create_gl_sampler(problem_, database_, rest);
  }
  const Stopwatch stopwatch;
  Result<GaussianMixture> mixture =
      settings_.sampler == "pooled"
          ? pool_all(problem_.robot, database_)
          : recall_nearest_scenes(problem_.robot, problem_.scene, database_, settings_);
  if (!mixture) return tl::unexpected(mixture.error());
  GlSampler gl;
  gl.mixture = std::make_shared<const GaussianMixture>(std::move(*mixture));
  gl.retrieval_time_s = stopwatch.elapsed_s();
  return gl;
}

Result<std::shared_ptr<const Sampler>> Recall::decode() {
  const Stopwatch stopwatch;
  const auto weights = load_cvae(cvae_path(database_));
  if (!weights) return tl::unexpected(weights.error());
  auto decoder = make_cvae_sampler(problem_.robot, problem_.scene, *weights);
  if (!decoder) return tl::unexpected(decoder.error());
  gl_.retrieval_time_s = stopwatch.elapsed_s();
  return make_mixed_sampler(settings_.lambda, *std::move(decoder),
                            make_uniform_sampler(problem_.robot));
}

std::shared_ptr<const Sampler> Recall::ask() {
  if (settings_.sampler == "cvae") {
    auto decoder = decode();
    if (decoder) return *decoder;
    failure_ = decoder.error();
    return make_uniform_sampler(problem_.robot);
  }
  auto gl = recall();
  if (!gl) {
    failure_ = gl.error();
    return make_uniform_sampler(problem_.robot);
  }
  gl_ = std::move(*gl);
  if (settings_.drop_invalid_means) {
    gl_.mixture =
        std::make_shared<const GaussianMixture>(keep_valid_components(checker_, *gl_.mixture));
  }
  return internal::make_sampler(problem_.robot, settings_, gl_);
}

}  // namespace mneme::internal
