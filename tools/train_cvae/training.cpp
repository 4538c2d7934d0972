// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "training.h"

#include "mneme/base.h"

#include <torch/torch.h>

#include <cmath>
#include <memory>
#include <utility>

namespace mneme::cvae {
namespace {

using torch::Tensor;

constexpr int kCheckSteps = 200;
constexpr int kPatience = 4;  // checks
constexpr int kHalvings = 4;

/// Two hidden layers with rectifiers.
struct NetworkImpl : torch::nn::Module {
  NetworkImpl(int inputs, int hidden, int outputs)
      : first(register_module("first", torch::nn::Linear(inputs, hidden))),
        second(register_module("second", torch::nn::Linear(hidden, hidden))),
        output(register_module("output", torch::nn::Linear(hidden, outputs))) {}
  Tensor forward(const Tensor& input) {
    return output(torch::relu(second(torch::relu(first(input)))));
  }
  torch::nn::Linear first, second, output;
};
TORCH_MODULE(Network);

/// Examples of a few scenes.
struct Batch {
  Tensor images;  ///< scenes x pixels
  Tensor owners;  ///< per example its row of `images`
  Tensor ends;    ///< examples x 2 joints
  Tensor configurations;
};

/// Refers to `values`.
template <class T>
Tensor to_rows(const std::vector<T>& values, std::int64_t columns, torch::ScalarType type) {
  const std::int64_t rows = static_cast<std::int64_t>(values.size()) / columns;
  return torch::from_blob(const_cast<T*>(values.data()), {rows, columns}, torch::dtype(type));
}

/// Batches of examples. Refers to them.
class Batches {
 public:
  Batches(const Examples& examples, const Sizes& sizes)
      : examples_(examples),
        images_(to_rows(examples.images, std::int64_t{sizes.cells} * sizes.cells, torch::kUInt8)),
        ends_(to_rows(examples.ends, 2 * sizes.joints, torch::kFloat32)),
        configurations_(to_rows(examples.configurations, sizes.joints, torch::kFloat32)) {}

  Batch random(int scene_count, int example_count, Rng& rng) const {
    std::vector<std::int64_t> scenes, owners, examples;
    for (int i = 0; i < scene_count; ++i) {
      const std::size_t scene = rng.index(static_cast<std::uint32_t>(examples_.scene_count()));
      const std::int64_t begin = examples_.begins[scene];
      const auto count = static_cast<std::uint32_t>(examples_.begins[scene + 1] - begin);
      scenes.push_back(static_cast<std::int64_t>(scene));
      for (int j = 0; j < example_count; ++j) {
        owners.push_back(i);
        examples.push_back(begin + rng.index(count));
      }
    }
    return make(scenes, owners, examples);
  }

  Batch whole_scene(std::size_t scene) const {
    std::vector<std::int64_t> examples;
    for (std::int64_t i = examples_.begins[scene]; i < examples_.begins[scene + 1]; ++i) {
      examples.push_back(i);
    }
    const std::vector<std::int64_t> owners(examples.size(), 0);
    return make({static_cast<std::int64_t>(scene)}, owners, examples);
  }

 private:
  Batch make(const std::vector<std::int64_t>& scenes, const std::vector<std::int64_t>& owners,
             const std::vector<std::int64_t>& examples) const {
    std::vector<std::int64_t> paths;
    for (const std::int64_t example : examples) {
      paths.push_back(examples_.paths[static_cast<std::size_t>(example)]);
    }
    const Tensor images = images_.index_select(0, torch::tensor(scenes));
    return {images.to(torch::kFloat32) / 255, torch::tensor(owners),
            ends_.index_select(0, torch::tensor(paths)),
            configurations_.index_select(0, torch::tensor(examples))};
  }

  const Examples& examples_;
  Tensor images_, ends_, configurations_;
};

struct Loss {
  Tensor error;       ///< sum of squares per example
  Tensor divergence;  ///< nats per example
};

std::vector<float> to_floats(const Tensor& tensor) {
  const Tensor plain = tensor.detach().contiguous();
  return {plain.data_ptr<float>(), plain.data_ptr<float>() + plain.numel()};
}

class Autoencoder {
 public:
  explicit Autoencoder(const Sizes& sizes)
      : sizes_(sizes),
        image_(sizes.cells * sizes.cells, sizes.hidden),
        encoder_(sizes.joints + condition_size(), sizes.hidden, 2 * sizes.latents),
        decoder_(sizes.latents + condition_size(), sizes.hidden, sizes.joints) {}

  /// `noise`: standard normal, examples x latents.
  Loss loss(const Batch& batch, const Tensor& noise) {
    const Tensor features = torch::relu(image_(batch.images)).index_select(0, batch.owners);
    const Tensor condition = torch::cat({features, batch.ends}, 1);
    const Tensor code = encoder_(torch::cat({batch.configurations, condition}, 1));
    const Tensor mean = code.slice(1, 0, sizes_.latents);
    const Tensor log_variance = code.slice(1, sizes_.latents, 2 * sizes_.latents);
    const Tensor latent = mean + torch::exp(0.5 * log_variance) * noise;
    const Tensor decoded = decoder_(torch::cat({latent, condition}, 1));
    const Tensor divergence =
        -0.5 * (1 + log_variance - mean.square() - log_variance.exp()).sum(1).mean();
    return {(decoded - batch.configurations).square().sum(1).mean(), divergence};
  }

  /// A feature sums over all pixels of an image. The smaller these are, the less each of their
  /// weights may move in a step.
  std::vector<torch::optim::OptimizerParamGroup> parameter_groups(double learning_rate) const {
    std::vector<Tensor> others = encoder_->parameters();
    for (const Tensor& parameter : decoder_->parameters()) others.push_back(parameter);
    std::vector<torch::optim::OptimizerParamGroup> groups;
    groups.emplace_back(image_->parameters(), std::make_unique<torch::optim::AdamOptions>(
                                                  learning_rate * sizes_.cell_area));
    groups.emplace_back(others, std::make_unique<torch::optim::AdamOptions>(learning_rate));
    return groups;
  }

  /// The decoder.
  internal::CvaeWeights weights() const {
    const Tensor first = decoder_->first->weight;
    const int features_end = sizes_.latents + sizes_.hidden;
    internal::CvaeWeights weights;
    weights.joints = sizes_.joints;
    weights.latents = sizes_.latents;
    weights.cells = sizes_.cells;
    weights.hidden = sizes_.hidden;
    weights.image_layer = to_floats(image_->weight.t());
    weights.image_bias = to_floats(image_->bias);
    weights.latent_layer = to_floats(first.slice(1, 0, sizes_.latents));
    weights.feature_layer = to_floats(first.slice(1, sizes_.latents, features_end));
    weights.ends_layer = to_floats(first.slice(1, features_end, first.size(1)));
    weights.first_bias = to_floats(decoder_->first->bias);
    weights.second_layer = to_floats(decoder_->second->weight);
    weights.second_bias = to_floats(decoder_->second->bias);
    weights.output_layer = to_floats(decoder_->output->weight);
    weights.output_bias = to_floats(decoder_->output->bias);
    return weights;
  }

 private:
  /// Features of the image, start and goal.
  int condition_size() const { return sizes_.hidden + 2 * sizes_.joints; }

  Sizes sizes_;
  torch::nn::Linear image_;
  Network encoder_, decoder_;
};

class Trainer {
 public:
  Trainer(const Sizes& sizes, const Examples& training, const Examples& held_out,
          const TrainingSettings& settings)
      : sizes_(sizes),
        settings_(settings),
        held_out_(held_out),
        training_batches_(training, sizes),
        held_out_batches_(held_out, sizes),
        held_out_noise_(make_noise(held_out.example_count())),
        rng_(settings.seed),
        autoencoder_(sizes),
        optimizer_(autoencoder_.parameter_groups(settings.learning_rate)),
        learning_rate_(settings.learning_rate) {}

  Trained run(const std::function<void(const Check&)>& on_check) {
    double sum = 0;
    int count = 0;
    for (int step = 1; step <= settings_.steps; ++step) {
      sum += train_step();
      ++count;
      const bool is_late = stopwatch_.elapsed_s() >= 60 * settings_.minutes;
      if (step % kCheckSteps != 0 && step != settings_.steps && !is_late) continue;
      const Check check = check_after(step, sum / count);
      sum = count = 0;
      on_check(check);
      trained_.steps = step;
      const bool is_number = std::isfinite(check.loss);
      const bool is_converged = is_number && judge(check);
      if (is_number && !is_converged && !is_late) continue;
      trained_.ending = !is_number     ? Ending::diverged
                        : is_converged ? Ending::converged
                                       : Ending::time_limit;
      break;
    }
    return std::move(trained_);
  }

 private:
  Tensor make_noise(std::size_t examples) const {
    return torch::randn({static_cast<std::int64_t>(examples), std::int64_t{sizes_.latents}});
  }

  double train_step() {
    const Batch batch = training_batches_.random(settings_.scenes, settings_.examples, rng_);
    const auto examples = static_cast<std::size_t>(settings_.scenes * settings_.examples);
    const Loss loss = autoencoder_.loss(batch, make_noise(examples));
    const Tensor total = loss.error + settings_.divergence_weight * loss.divergence;
    optimizer_.zero_grad();
    total.backward();
    optimizer_.step();
    return total.item<double>();
  }

  /// The loss on all examples held out, with the same noise each time.
  Check check_after(int step, double training_loss) {
    const torch::NoGradGuard no_gradients;
    double error = 0, divergence = 0;
    for (std::size_t scene = 0; scene < held_out_.scene_count(); ++scene) {
      const std::int64_t begin = held_out_.begins[scene], end = held_out_.begins[scene + 1];
      const Loss loss = autoencoder_.loss(held_out_batches_.whole_scene(scene),
                                          held_out_noise_.slice(0, begin, end));
      error += loss.error.item<double>();
      divergence += loss.divergence.item<double>();
    }
    const auto scenes =
        static_cast<double>(held_out_.scene_count());  // equal weights, as in batches
    error /= scenes;
    divergence /= scenes;
    return {step,
            stopwatch_.elapsed_s(),
            learning_rate_,
            training_loss,
            error + settings_.divergence_weight * divergence,
            error / sizes_.joints,
            divergence};
  }

  /// Keeps the best weights, and halves the learning rate where nothing improves. Returns true once
  /// that has not helped either.
  bool judge(const Check& check) {
    if (check.loss < trained_.best.loss) {
      trained_.best = check;
      trained_.weights = autoencoder_.weights();
      checks_in_vain_ = 0;
      return false;
    }
    if (++checks_in_vain_ < kPatience) return false;
    if (halvings_ == kHalvings) return true;
    ++halvings_;
    checks_in_vain_ = 0;
    learning_rate_ /= 2;
    for (auto& group : optimizer_.param_groups()) {
      auto& options = static_cast<torch::optim::AdamOptions&>(group.options());
      options.lr(options.lr() / 2);
    }
    return false;
  }

  Stopwatch stopwatch_;
  Sizes sizes_;
  const TrainingSettings& settings_;
  const Examples& held_out_;
  Batches training_batches_, held_out_batches_;
  Tensor held_out_noise_;
  Rng rng_;
  Autoencoder autoencoder_;
  torch::optim::Adam optimizer_;
  double learning_rate_;
  Trained trained_;
  int checks_in_vain_ = 0;
  int halvings_ = 0;
};

}  // namespace

Trained train(const Sizes& sizes, const Examples& training, const Examples& held_out,
              const TrainingSettings& settings, const std::function<void(const Check&)>& on_check) {
  torch::manual_seed(settings.seed);
  return Trainer(sizes, training, held_out, settings).run(on_check);
}

}  // namespace mneme::cvae
