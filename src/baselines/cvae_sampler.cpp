// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/cvae_sampler.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "baselines/scene_image.h"
#include "robot/joint_space.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace mneme::internal {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXf;

Matrix to_matrix(const std::vector<float>& values, int rows) {
  return Eigen::Map<const Matrix>(values.data(), rows,
                                  static_cast<Eigen::Index>(values.size()) / rows);
}
Vector to_vector(const std::vector<float>& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// The features of a scene of circles in canonical form.
Vector features_of(const PrimitiveKey& circles, const CvaeWeights& weights) {
  const std::vector<float> image = draw_image(circles, weights.cells, weights.half_extent);
  const Eigen::Map<const Eigen::MatrixXf> columns(weights.image_layer.data(), weights.hidden,
                                                  static_cast<Eigen::Index>(image.size()));
  Vector features = to_vector(weights.image_bias);
  // Most of an image is empty.
  for (std::size_t pixel = 0; pixel < image.size(); ++pixel) {
    if (image[pixel] == 0) continue;
    features += image[pixel] * columns.col(static_cast<Eigen::Index>(pixel));
  }
  return features.cwiseMax(0.0f);
}

/// Adds the contributions of features, start and goal to the bias of the layer behind the features.
/// One column per goal.
Eigen::MatrixXf first_biases(const MemoryQuery& query, double direction,
                             const CvaeWeights& weights) {
  const SymmetricJoints joints = find_symmetric_joints(query.robot);
  const auto canonical = [&](const Configuration& q) {
    return to_vector(scaled_to_limits(query.robot, moved_configuration(joints, {-direction}, q)));
  };
  const Vector features = features_of(moved_key({-direction}, circles_of(query.scene)), weights);
  const Vector start = canonical(*query.start);
  const Matrix ends_layer = to_matrix(weights.ends_layer, weights.hidden);
  Vector common = to_vector(weights.first_bias);
  common += to_matrix(weights.feature_layer, weights.hidden) * features;
  common += ends_layer.leftCols(weights.joints) * start;
  Eigen::MatrixXf biases(weights.hidden, static_cast<Eigen::Index>(query.goals.size()));
  for (std::size_t i = 0; i < query.goals.size(); ++i) {
    const Vector goal = canonical(query.goals[i]);
    biases.col(static_cast<Eigen::Index>(i)) = common + ends_layer.rightCols(weights.joints) * goal;
  }
  return biases;
}

/// A decoder for one query.
struct Decoder {
  JointSpace space;
  int turn = -1;       ///< index of the joint that turns the arm, or -1
  float rotation = 0;  ///< rotation of that joint, radians
  Matrix latent_layer, second_layer, output_layer;
  Eigen::MatrixXf goal_biases;  ///< see first_biases()
  Vector second_bias, output_bias;

  Decoder(const MemoryQuery& query, const CvaeWeights& weights)
      : space(query.robot),
        turn(find_symmetric_joints(query.robot).turn),
        latent_layer(to_matrix(weights.latent_layer, weights.hidden)),
        second_layer(to_matrix(weights.second_layer, weights.hidden)),
        output_layer(to_matrix(weights.output_layer, weights.joints)),
        second_bias(to_vector(weights.second_bias)),
        output_bias(to_vector(weights.output_bias)) {
    const double direction = turn < 0 ? 0 : mean_direction(circles_of(query.scene));
    rotation = static_cast<float>(direction);
    goal_biases = first_biases(query, direction, weights);
  }

  float to_joint(int joint, float scaled) const {
    const float middle = 0.5f * (space.lower(joint) + space.upper(joint));
    const float half = 0.5f * (space.upper(joint) - space.lower(joint));
    // Finite weights may overflow; fmax also replaces what is no number.
    const float bounded = std::fmin(std::fmax(scaled, -2.0f), 2.0f);
    return space.into_limits(joint, middle + half * bounded + (joint == turn ? rotation : 0.0f));
  }
};

class CvaeStream final : public SampleStream {
 public:
  CvaeStream(const Decoder& decoder, std::uint64_t seed)
      : decoder_(decoder), rng_(seed), latent_(decoder.latent_layer.cols()) {}

  SampleSource next(std::span<float> q) override {
    const std::uint32_t goal = rng_.index(static_cast<std::uint32_t>(decoder_.goal_biases.cols()));
    for (float& value : latent_) value = static_cast<float>(rng_.normal());
    first_.noalias() = decoder_.latent_layer * latent_;
    first_ = (first_ + decoder_.goal_biases.col(goal)).cwiseMax(0.0f);
    second_.noalias() = decoder_.second_layer * first_;
    second_ = (second_ + decoder_.second_bias).cwiseMax(0.0f);
    output_.noalias() = decoder_.output_layer * second_;
    output_ += decoder_.output_bias;
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i] = decoder_.to_joint(static_cast<int>(i), output_[static_cast<Eigen::Index>(i)]);
    }
    return 0;
  }

 private:
  const Decoder& decoder_;
  Rng rng_;
  Vector latent_, first_, second_, output_;
};

class CvaeSampler final : public Sampler {
 public:
  CvaeSampler(const MemoryQuery& query, const CvaeWeights& weights) : decoder_(query, weights) {}
  std::unique_ptr<SampleStream> start(std::uint64_t seed) const override {
    return std::make_unique<CvaeStream>(decoder_, seed);
  }

 private:
  Decoder decoder_;
};

bool has_ends(const MemoryQuery& query) {
  const auto is_configuration = [&](const Configuration& q) {
    return query.robot.is_configuration(q);
  };
  return query.start != nullptr && is_configuration(*query.start) && !query.goals.empty() &&
         std::ranges::all_of(query.goals, is_configuration);
}

}  // namespace

Result<std::shared_ptr<const Sampler>> make_cvae_sampler(const MemoryQuery& query,
                                                         const CvaeWeights& weights) {
  const Robot& robot = query.robot;
  if (weights.robot_hash != robot.hash() || weights.joints != robot.joint_count()) {
    return fail(ErrorCode::wrong_robot,
                "the CVAE was trained for another robot than '{}'; train it anew", robot.name());
  }
  if (!has_ends(query)) {
    return fail(ErrorCode::invalid, "the CVAE needs a start and goals within the limits of '{}'",
                robot.name());
  }
  return std::make_shared<const CvaeSampler>(query, weights);
}

std::vector<float> scaled_to_limits(const Robot& robot, std::span<const double> q) {
  const Configuration within = robot.normalized(q);
  std::vector<float> scaled;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.group_joint(i);
    const double half = 0.5 * (joint.upper - joint.lower);
    const double offset = within[as_index(i)] - 0.5 * (joint.lower + joint.upper);
    scaled.push_back(half > 0 ? static_cast<float>(offset / half) : 0.0f);
  }
  return scaled;
}

std::string cvae_path(const Database& database) { return database.info().url + ".cvae"; }

}  // namespace mneme::internal
