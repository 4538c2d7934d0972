// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/samplers/InformedStateSampler.h>

namespace mneme::ompl {
namespace {

namespace ob = ::ompl::base;

/// Takes samples of the space's allocator until one may be on a path of the wanted cost.
class RejectionSampler final : public ob::InformedSampler {
 public:
  RejectionSampler(const ob::ProblemDefinitionPtr& definition, unsigned attempts)
      : InformedSampler(definition, attempts), sampler_(space_->allocStateSampler()) {}

  bool sampleUniform(ob::State* state, const ob::Cost& most) override {
    return sampleUniform(state, opt_->identityCost(), most);
  }

  bool sampleUniform(ob::State* state, const ob::Cost& least, const ob::Cost& most) override {
    for (unsigned i = 0; i < numIters_; ++i) {
      sampler_->sampleUniform(state);
      if (!opt_->isFinite(most)) return true;
      const ob::Cost cost = heuristicSolnCost(state);
      if (opt_->isCostBetterThan(cost, most) && !opt_->isCostBetterThan(cost, least)) return true;
    }
    return false;
  }

  bool hasInformedMeasure() const override { return false; }
  double getInformedMeasure(const ob::Cost&) const override { return space_->getMeasure(); }

 private:
  ob::StateSamplerPtr sampler_;
};

class PathLengthObjective final : public ob::PathLengthOptimizationObjective {
 public:
  using PathLengthOptimizationObjective::PathLengthOptimizationObjective;

  ob::InformedSamplerPtr allocInformedStateSampler(const ob::ProblemDefinitionPtr& definition,
                                                   unsigned attempts) const override {
    return std::make_shared<RejectionSampler>(definition, attempts);
  }
};

}  // namespace

ob::OptimizationObjectivePtr make_path_length_objective(
    const ob::SpaceInformationPtr& information) {
  auto objective = std::make_shared<PathLengthObjective>(information);
  objective->setCostToGoHeuristic(&ob::goalRegionCostToGo);
  return objective;
}

}  // namespace mneme::ompl
