// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/row_check.h"

#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

std::optional<std::string> describe_not_finite(const std::vector<float>& values, const char* what) {
  const auto flaw =
      std::find_if_not(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
  if (flaw == values.end()) return std::nullopt;
  return fmt::format("number {} of its {} is {}; expected a finite one", flaw - values.begin(),
                     what, *flaw);
}

std::optional<std::string> describe_factor_flaw(const LocalSampler& sampler, std::size_t joints) {
  const std::size_t triangle = triangle_size(joints);
  if (sampler.factors.size() % triangle != 0) {
    return fmt::format("its {} factor values are no multiple of {}", sampler.factors.size(),
                       triangle);
  }
  const auto row_count = static_cast<long long>(sampler.factors.size() / triangle);
  for (const int row : sampler.factor_rows) {
    if (row < -1 || row >= row_count) {
      return fmt::format("it refers to factor row {} of {}", row, row_count);
    }
  }
  return describe_not_finite(sampler.factors, "factors");
}

bool is_kind(const std::string& kind) {
  const auto characters = decode_utf8(kind);
  if (!characters || kind.empty() || kind.size() > kMostKindBytes) return false;
  // The ranges that Unicode calls control characters.
  return std::ranges::none_of(*characters, [](char32_t character) {
    return character < 0x20 || (character >= 0x7f && character < 0xa0);
  });
}

std::optional<std::string> describe_text_flaw(const Provenance& provenance) {
  for (const auto& [what, text] :
       {std::pair("tool", &provenance.tool), std::pair("settings", &provenance.settings),
        std::pair("time", &provenance.time)}) {
    if (!decode_utf8(*text)) return fmt::format("its {} is no UTF-8 text without NUL", what);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> describe_key_flaw(const std::string& kind,
                                             const std::vector<double>& key) {
  if (!is_kind(kind)) {
    return fmt::format("its kind is no text of 1 to {} bytes without control characters",
                       kMostKindBytes);
  }
  if (key.empty()) return "its key has no numbers";
  // Written so that a NaN fails it.
  const auto is_length = [](double value) { return std::abs(value) <= kMaxKeyMagnitude; };
  const auto flaw = std::find_if_not(key.begin(), key.end(), is_length);
  if (flaw == key.end()) return std::nullopt;
  return fmt::format("number {} of its key is {}; expected metres, at most {}", flaw - key.begin(),
                     *flaw, kMaxKeyMagnitude);
}

std::optional<std::string> KeySizes::check(std::string_view kind, std::size_t size) {
  const auto known = sizes_.find(kind);
  if (known == sizes_.end()) {
    sizes_.emplace(kind, size);
    return std::nullopt;
  }
  if (known->second == size) return std::nullopt;
  return fmt::format("its key has {} numbers; expected {}, as others of kind '{}'", size,
                     known->second, kind);
}

std::optional<std::string> describe_flaw(const Experience& experience,
                                         const ExperienceSpace& space) {
  if (auto flaw = describe_key_flaw(experience.kind, experience.key)) return flaw;
  if (auto flaw = describe_text_flaw(experience.provenance)) return flaw;
  const LocalSampler& sampler = experience.sampler;
  const bool is_blank = sampler.joint_count == 0 && sampler.means.empty();
  if (!is_blank && sampler.joint_count != space.joint_count) {
    return fmt::format("its sampler is for {} joints; expected {}", sampler.joint_count,
                       space.joint_count);
  }
  const auto joints = static_cast<std::size_t>(space.joint_count);
  if (sampler.means.size() % joints != 0) {
    return fmt::format("its {} mean values are no multiple of {}", sampler.means.size(), joints);
  }
  const std::size_t components = sampler.means.size() / joints;
  for (const auto& column : {&sampler.factor_rows, &sampler.sources}) {
    if (!column->empty() && column->size() != components) {
      return fmt::format("it has {} {} for {} components", column->size(),
                         column == &sampler.sources ? "origins" : "factor rows", components);
    }
  }
  if (auto flaw = describe_not_finite(sampler.means, "means")) return flaw;
  return describe_factor_flaw(sampler, joints);
}

namespace {

constexpr char kBetween = '/';
constexpr std::size_t kFrameDigits = 8;

}  // namespace

std::string join_hashes(std::string_view kinematics, std::string_view model) {
  return fmt::format("{}{}{}", kinematics, kBetween, model);
}

std::string_view kinematics_of(const ExperienceSpace& space) {
  const std::size_t end = space.robot_hash.find(kBetween);
  const std::string_view text = space.robot_hash;
  return end == std::string::npos ? std::string_view() : text.substr(0, end);
}

std::string_view model_of(const ExperienceSpace& space) {
  const std::string_view text = space.robot_hash;
  return text.substr(text.find(kBetween) + 1);
}

std::string describe(const ExperienceSpace& space) {
  const std::string_view kinematics = kinematics_of(space);
  return fmt::format("robot '{}' ({} {}, {} joints)", space.robot_name,
                     kinematics.empty() ? "hash" : "kinematics",
                     kinematics.empty() ? model_of(space) : kinematics, space.joint_count);
}

bool has_same_frames(const ExperienceSpace& a, const ExperienceSpace& b) {
  const std::string_view first = kinematics_of(a).substr(0, kFrameDigits);
  const std::string_view second = kinematics_of(b).substr(0, kFrameDigits);
  return !first.empty() && first == second && a.joint_count == b.joint_count;
}

bool is_same_space(const ExperienceSpace& a, const ExperienceSpace& b) {
  if (a.joint_count != b.joint_count) return false;
  const std::string_view first = kinematics_of(a), second = kinematics_of(b);
  return first.empty() || second.empty() ? model_of(a) == model_of(b) : first == second;
}

tl::unexpected<Error> refuse_space(const std::string& url, const ExperienceSpace& found,
                                   const ExperienceSpace& wanted) {
  std::string message = fmt::format("{}: holds experience of {}; expected that of {}", url,
                                    describe(found), describe(wanted));
  if (has_same_frames(found, wanted)) {
    message += "; only joint limits differ: `mneme db adopt` makes it the other robot's";
  }
  return fail(ErrorCode::wrong_robot, std::move(message));
}

}  // namespace mneme::internal
