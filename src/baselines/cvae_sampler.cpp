// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/cvae_sampler.h"

#include "base/fail.h"
#include "baselines/scene_image.h"
#include "robot/joint_space.h"

#include <Eigen/Core>

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

/// A decoder for one image, with the image's part of the first layer precomputed.
struct Decoder {
  JointSpace space;
  int turn = -1;       ///< index of the joint that turns the arm, or -1
  float rotation = 0;  ///< rotation of that joint, radians
  Matrix latent_layer, second_layer, output_layer;
  Vector first_bias, second_bias, output_bias;  ///< first_bias: with the image's part

  Decoder(const Robot& robot, const Scene& scene, const CvaeWeights& weights)
      : space(robot),
        turn(find_symmetric_joints(robot).turn),
        latent_layer(to_matrix(weights.latent_layer, weights.hidden)),
        second_layer(to_matrix(weights.second_layer, weights.hidden)),
        output_layer(to_matrix(weights.output_layer, weights.joints)),
        second_bias(to_vector(weights.second_bias)),
        output_bias(to_vector(weights.output_bias)) {
    const PrimitiveKey circles = circles_of(scene);
    const double direction = turn < 0 ? 0 : mean_direction(circles);
    rotation = static_cast<float>(direction);
    const Vector image =
        to_vector(draw_image(moved_key({-direction}, circles), weights.cells, weights.half_extent));
    first_bias =
        to_vector(weights.first_bias) + to_matrix(weights.image_layer, weights.hidden) * image;
  }

  float to_joint(int joint, float place) const {
    const float middle = 0.5f * (space.lower(joint) + space.upper(joint));
    const float half = 0.5f * (space.upper(joint) - space.lower(joint));
    return space.into_limits(joint, middle + half * place + (joint == turn ? rotation : 0.0f));
  }
};

class CvaeStream final : public SampleStream {
 public:
  CvaeStream(const Decoder& decoder, std::uint64_t seed)
      : decoder_(decoder), rng_(seed), latent_(decoder.latent_layer.cols()) {}

  SampleSource next(std::span<float> q) override {
    for (float& value : latent_) value = static_cast<float>(rng_.normal());
    first_.noalias() = decoder_.latent_layer * latent_;
    first_ = (first_ + decoder_.first_bias).cwiseMax(0.0f);
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
  CvaeSampler(const Robot& robot, const Scene& scene, const CvaeWeights& weights)
      : decoder_(robot, scene, weights) {}
  std::unique_ptr<SampleStream> start(std::uint64_t seed) const override {
    return std::make_unique<CvaeStream>(decoder_, seed);
  }

 private:
  Decoder decoder_;
};

}  // namespace

Result<std::shared_ptr<const Sampler>> make_cvae_sampler(const Robot& robot, const Scene& scene,
                                                         const CvaeWeights& weights) {
  if (weights.robot_hash != robot.hash() || weights.joints != robot.joint_count()) {
    return fail(ErrorCode::wrong_robot,
                "the CVAE was trained for another robot than '{}'; train it anew", robot.name());
  }
  return std::make_shared<const CvaeSampler>(robot, scene, weights);
}

std::string cvae_path(const Database& database) { return database.info().url + ".cvae"; }

}  // namespace mneme::internal
