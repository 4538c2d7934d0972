// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/recall.h"

#include <algorithm>

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

std::shared_ptr<const Sampler> Recall::ask() {
  SolveSettings rest = settings_;
  rest.plan.timeout_s -= stopwatch_.elapsed_s();
  auto gl = create_gl_sampler(problem_, database_, rest);
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
