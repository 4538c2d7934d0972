// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "training.h"

#include <torch/torch.h>

namespace mneme::cvae {
namespace {

using torch::Tensor;

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

struct Loss {
  Tensor error;       ///< sum of squares per example
  Tensor divergence;  ///< nats per example
};

class Autoencoder {
 public:
  Autoencoder(const Sizes& sizes, int hidden)
      : latents_(sizes.latents),
        encoder(sizes.joints + sizes.pixels, hidden, 2 * sizes.latents),
        decoder(sizes.latents + sizes.pixels, hidden, sizes.joints) {}

  Loss loss(const Tensor& q, const Tensor& image) {
    const Tensor code = encoder(torch::cat({q, image}, 1));
    const Tensor mean = code.slice(1, 0, latents_);
    const Tensor log_variance = code.slice(1, latents_, 2 * latents_);
    const Tensor latent = mean + torch::exp(0.5 * log_variance) * torch::randn_like(mean);
    const Tensor decoded = decoder(torch::cat({latent, image}, 1));
    const Tensor divergence =
        -0.5 * (1 + log_variance - mean.square() - log_variance.exp()).sum(1).mean();
    return {(decoded - q).square().sum(1).mean(), divergence};
  }

  std::vector<Tensor> parameters() {
    std::vector<Tensor> all = encoder->parameters();
    for (const Tensor& parameter : decoder->parameters()) all.push_back(parameter);
    return all;
  }

 private:
  int latents_;

 public:
  Network encoder, decoder;
};

std::vector<float> to_floats(const Tensor& tensor) {
  const Tensor plain = tensor.detach().contiguous();
  return {plain.data_ptr<float>(), plain.data_ptr<float>() + plain.numel()};
}

/// Refers to `values`.
Tensor to_rows(const std::vector<float>& values, int columns) {
  return torch::from_blob(const_cast<float*>(values.data()),
                          {static_cast<std::int64_t>(values.size()) / columns, columns});
}

}  // namespace

TrainedDecoder train(const Sizes& sizes, const Examples& examples, const TrainingSettings& settings,
                     const std::function<void(int step, double loss)>& on_step) {
  constexpr int kReportSteps = 100;
  torch::manual_seed(settings.seed);
  const Tensor images = to_rows(examples.images, sizes.pixels);
  const Tensor configurations = to_rows(examples.configurations, sizes.joints);
  const Tensor scenes = torch::tensor(examples.scenes);
  Autoencoder autoencoder(sizes, sizes.hidden);
  torch::optim::Adam optimizer(autoencoder.parameters(),
                               torch::optim::AdamOptions(settings.learning_rate));
  TrainedDecoder trained;
  double error = 0, divergence = 0;
  for (int step = 1; step <= settings.steps; ++step) {
    const Tensor rows = torch::randint(configurations.size(0), {settings.batch}, torch::kLong);
    const Loss loss = autoencoder.loss(configurations.index_select(0, rows),
                                       images.index_select(0, scenes.index_select(0, rows)));
    const Tensor total = loss.error + settings.divergence_weight * loss.divergence;
    optimizer.zero_grad();
    total.backward();
    optimizer.step();
    error += loss.error.item<double>();
    divergence += loss.divergence.item<double>();
    if (step % kReportSteps != 0) continue;
    trained.error = error / (kReportSteps * sizes.joints);
    trained.divergence = divergence / kReportSteps;
    error = divergence = 0;
    on_step(step, total.item<double>());
  }
  trained.first_layer = to_floats(autoencoder.decoder->first->weight);
  trained.first_bias = to_floats(autoencoder.decoder->first->bias);
  trained.second_layer = to_floats(autoencoder.decoder->second->weight);
  trained.second_bias = to_floats(autoencoder.decoder->second->bias);
  trained.output_layer = to_floats(autoencoder.decoder->output->weight);
  trained.output_bias = to_floats(autoencoder.decoder->output->bias);
  return trained;
}

}  // namespace mneme::cvae
