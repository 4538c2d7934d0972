// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include "ompl/states.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace mneme::ompl {
namespace {

namespace ob = ::ompl::base;

class MotionValidity final : public ob::MotionValidator {
 public:
  MotionValidity(const ob::SpaceInformationPtr& information, const CollisionChecker& checker,
                 std::shared_ptr<WorkCounters> counters, const MotionDetail& detail,
                 const MotionVerifier* verifier = nullptr)
      : MotionValidator(information),
        checker_(checker),
        values_(information->getStateSpace().get()),
        counters_(std::move(counters)),
        detail_(detail),
        verifier_(verifier) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    const bool is_valid = is_motion_valid(from, to);
    // Not OMPL's counters: they are not atomic, but parallel planners share a validator.
    std::atomic_ref(is_valid ? valid_ : invalid_).fetch_add(1, std::memory_order_relaxed);
    return is_valid;
  }

  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_valid) const override {
    if (checkMotion(from, to)) return true;
    last_valid.second = valid_fraction();
    if (last_valid.first != nullptr) {
      si_->getStateSpace()->interpolate(from, to, last_valid.second, last_valid.first);
    }
    return false;
  }

 private:
  static constexpr int kBatch = 16;
  static constexpr int kHalvings = 10;

  /// Writes both ends to the scratch slots 0 and 1.
  bool is_motion_valid(const ob::State* from, const ob::State* to) const {
    const std::span<float> a = scratch<0>(checker_.robot());
    const std::span<float> b = scratch<1>(checker_.robot());
    values_.read(from, a);
    values_.read(to, b);
    CheckCounters work;
    const bool is_valid = si_->satisfiesBounds(to) &&
                          checker_.is_motion_valid(a, b, work, detail_) &&
                          (verifier_ == nullptr || verifier_->is_free(a, b, {true, true}, work));
    count_motion(counters_, work.states);
    return is_valid;
  }

  /// The free fraction of the invalid motion between the scratch slots. With a verifier it is
  /// halved until that part passes verification.
  double valid_fraction() const {
    const Robot& robot = checker_.robot();
    const std::span<const float> from = scratch<0>(robot);
    const std::span<const float> to = scratch<1>(robot);
    const Configuration first(from.begin(), from.end()), end(to.begin(), to.end());
    const Configuration difference = robot.difference(first, end);
    const std::vector<float> delta(difference.begin(), difference.end());
    const auto length = static_cast<float>(robot.distance(first, end));
    std::vector<float> last(from.size());
    double fraction = free_states_fraction(from, delta, length);
    if (verifier_ == nullptr) return fraction;
    for (int halving = 0; halving < kHalvings; ++halving, fraction /= 2) {
      for (std::size_t j = 0; j < last.size(); ++j) {
        last[j] = from[j] + static_cast<float>(fraction) * delta[j];
      }
      CheckCounters work;
      const bool is_free = verifier_->is_free(from, last, {true, true}, work);
      count_motion(counters_, work.states);
      if (is_free) return fraction;
    }
    return 0;
  }

  /// Checks states in order: the raked motion check does not find the first one in contact.
  double free_states_fraction(std::span<const float> from, std::span<const float> delta,
                              float length) const {
    const std::size_t joints = from.size();
    std::vector<float> states(kBatch * joints);
    const int count = std::max(
        1, static_cast<int>(std::ceil(length * detail_.refinement / checker_.resolution())));
    std::array<std::uint8_t, kBatch> is_valid;
    for (int first = 1; first <= count; first += kBatch) {
      const int size = std::min(kBatch, count - first + 1);
      for (int i = 0; i < size; ++i) {
        const float t = static_cast<float>(first + i) / static_cast<float>(count);
        for (std::size_t j = 0; j < joints; ++j) {
          states[static_cast<std::size_t>(i) * joints + j] = from[j] + t * delta[j];
        }
      }
      const auto used = static_cast<std::size_t>(size);
      checker_.check_states(std::span(states).first(used * joints),
                            std::span(is_valid).first(used));
      count_states(counters_, used);
      for (int i = 0; i < size; ++i) {
        if (is_valid[static_cast<std::size_t>(i)] == 0) return (first + i - 1.0) / count;
      }
    }
    // The contact is between the checked states: stop short of the end.
    return (count - 1.0) / count;
  }

  CollisionChecker checker_;
  JointValues values_;
  std::shared_ptr<WorkCounters> counters_;
  MotionDetail detail_;
  const MotionVerifier* verifier_;  ///< may be null
};

}  // namespace

ob::MotionValidatorPtr make_motion_validity(const ob::SpaceInformationPtr& information,
                                            const CollisionChecker& checker,
                                            std::shared_ptr<WorkCounters> counters,
                                            const MotionDetail& detail) {
  return std::make_shared<MotionValidity>(information, checker, std::move(counters), detail);
}

ob::MotionValidatorPtr make_verified_motion_validity(const ob::SpaceInformationPtr& information,
                                                     const CollisionChecker& checker,
                                                     std::shared_ptr<WorkCounters> counters,
                                                     const MotionVerifier& verifier) {
  return std::make_shared<MotionValidity>(information, checker, std::move(counters), MotionDetail(),
                                          &verifier);
}

std::shared_ptr<ob::SpaceInformation> make_space_information(
    const CollisionChecker& checker, std::shared_ptr<WorkCounters> counters) {
  const auto space = std::make_shared<JointStateSpace>(checker.robot());
  const double extent = space->getMaximumExtent();
  space->setLongestValidSegmentFraction(std::min(1.0, checker.resolution() / extent));
  auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker(make_state_validity(information, checker, counters));
  information->setMotionValidator(make_motion_validity(information, checker, counters));
  information->setup();
  return information;
}

}  // namespace mneme::ompl
