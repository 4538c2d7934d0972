// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/informed_box.h"

#include "path/rest_to_rest.h"
#include "robot/joint_space.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

struct Box {
  std::vector<float> lower, upper;
};

/// How far a joint can go beyond both ends, `distance` apart, in `time_s`; negative if it cannot
/// go from one to the other.
double room_beyond(const RestToRest& joint, double distance, double time_s) {
  constexpr int kBisections = 20;
  if (joint.duration_s(distance) > time_s) return -1;
  double least = 0, most = joint.distance(time_s);
  for (int i = 0; i < kBisections; ++i) {
    const double room = 0.5 * (least + most);
    const double needed_s = joint.duration_s(distance + room) + joint.duration_s(room);
    (needed_s <= time_s ? least : most) = room;
  }
  return most;
}

/// Nothing if no motion reaches `goal` in time.
std::optional<Box> make_box(const Robot& robot, const Configuration& start,
                            const Configuration& goal, const RateLimits& limits, double time_s) {
  const JointSpace space(robot);
  const Configuration end = robot.turned_near(goal, start);
  Box box;
  for (std::size_t j = 0; j < start.size(); ++j) {
    const double room = room_beyond(rest_to_rest(limits, j), std::abs(end[j] - start[j]), time_s);
    if (room < 0) return std::nullopt;
    const auto [least, most] = std::minmax(start[j], end[j]);
    auto lower = static_cast<float>(least - room), upper = static_cast<float>(most + room);
    const auto joint = static_cast<int>(j);
    if (robot.group_joint(joint).type != JointType::continuous) {
      lower = std::max(lower, space.lower(joint));
      upper = std::min(upper, space.upper(joint));
    }
    box.lower.push_back(lower);
    box.upper.push_back(upper);
  }
  return box;
}

class InformedSampler final : public Sampler {
 public:
  InformedSampler(const Robot& robot, std::vector<Box> boxes)
      : space_(robot), boxes_(std::move(boxes)) {}

  [[nodiscard]] std::unique_ptr<SampleStream> start(std::uint64_t seed) const override {
    return std::make_unique<Stream>(*this, seed);
  }

 private:
  class Stream final : public SampleStream {
   public:
    Stream(const InformedSampler& sampler, std::uint64_t seed) : sampler_(sampler), rng_(seed) {}

    SampleSource next(std::span<float> q) override {
      const std::vector<Box>& boxes = sampler_.boxes_;
      const Box& box = boxes[boxes.size() > 1 ? rng_.next() % boxes.size() : 0];
      for (std::size_t j = 0; j < q.size(); ++j) {
        const float fraction = static_cast<float>(rng_.next() >> 40) * 0x1.0p-24f;
        q[j] = sampler_.space_.into_limits(static_cast<int>(j),
                                           box.lower[j] + (box.upper[j] - box.lower[j]) * fraction);
      }
      return kUniformSource;
    }

   private:
    const InformedSampler& sampler_;
    Rng rng_;
  };

  JointSpace space_;
  std::vector<Box> boxes_;
};

}  // namespace

std::unique_ptr<Sampler> make_informed_sampler(const Robot& robot, const PlanQuery& ends,
                                               const RateLimits& limits, double time_s,
                                               const std::function<bool()>& is_over) {
  std::vector<Box> boxes;
  for (const Configuration& goal : ends.goals) {
    if (is_over()) break;
    if (auto box = make_box(robot, ends.start, goal, limits, time_s)) {
      boxes.push_back(*std::move(box));
    }
  }
  if (boxes.empty()) return nullptr;
  return std::make_unique<InformedSampler>(robot, std::move(boxes));
}

}  // namespace mneme::internal
