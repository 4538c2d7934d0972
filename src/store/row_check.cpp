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
    return fmt::format("its {} factor values are not a multiple of {}", sampler.factors.size(),
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
    if (!decode_utf8(*text)) return fmt::format("its {} is not UTF-8 text without NUL", what);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> describe_key_flaw(const std::string& kind,
                                             const std::vector<double>& key) {
  if (!is_kind(kind)) {
    return fmt::format("its kind is not a text of 1 to {} bytes without control characters",
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

bool holds_paths(std::string_view kind) {
  return kind.starts_with("paths/") || kind.starts_with("motions/") || kind == kTaskRows ||
         kind == kUnsolvedRows;
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

namespace {

std::optional<std::string> describe_joint_flaw(int joint_count, const std::vector<float>& values,
                                               const char* what, const RobotSignature& signature) {
  if (joint_count != signature.joint_count) {
    return fmt::format("its {} are for {} joints; expected {}", what, joint_count,
                       signature.joint_count);
  }
  if (values.size() % static_cast<std::size_t>(joint_count) != 0) {
    return fmt::format("its {} {} are not a multiple of {}", values.size(), what, joint_count);
  }
  return describe_not_finite(values, what);
}

std::optional<std::string> describe_sampler_flaw(const LocalSampler& sampler,
                                                 const RobotSignature& signature) {
  const bool is_blank = sampler.joint_count == 0 && sampler.means.empty();
  const int joint_count = is_blank ? signature.joint_count : sampler.joint_count;
  if (auto flaw = describe_joint_flaw(joint_count, sampler.means, "means", signature)) return flaw;
  const auto joints = static_cast<std::size_t>(joint_count);
  const std::size_t components = sampler.means.size() / joints;
  for (const auto& column : {&sampler.factor_rows, &sampler.sources}) {
    if (!column->empty() && column->size() != components) {
      return fmt::format("it has {} {} for {} components", column->size(),
                         column == &sampler.sources ? "sources" : "factor rows", components);
    }
  }
  return describe_factor_flaw(sampler, joints);
}

std::optional<std::string> describe_path_flaw(const RememberedPath& path,
                                              const RobotSignature& signature) {
  for (const auto& [what, rows] :
       {std::pair("waypoints", &path.waypoints), std::pair("near misses", &path.near_misses)}) {
    if (auto flaw = describe_joint_flaw(path.joint_count, *rows, what, signature)) return flaw;
  }
  const auto waypoints = static_cast<std::size_t>(path.waypoint_count());
  const bool has_surroundings = !path.clearances.empty() || !path.near_misses.empty();
  if (has_surroundings && path.clearances.size() != waypoints) {
    return fmt::format("it has {} clearances for {} waypoints", path.clearances.size(), waypoints);
  }
  return describe_not_finite(path.clearances, "clearances");
}

}  // namespace

std::optional<std::string> describe_flaw(const Experience& experience,
                                         const RobotSignature& signature) {
  if (auto flaw = describe_key_flaw(experience.kind, experience.key)) return flaw;
  if (auto flaw = describe_text_flaw(experience.provenance)) return flaw;
  if (experience.is_path() != holds_paths(experience.kind)) {
    return fmt::format("it holds a {}, which rows of kind '{}' cannot",
                       experience.is_path() ? "path" : "sampler", experience.kind);
  }
  if (!experience.is_path()) return describe_sampler_flaw(experience.sampler(), signature);
  return describe_path_flaw(experience.path(), signature);
}

bool is_same_constraints(std::uint64_t stored, std::uint64_t wanted) {
  constexpr std::uint64_t kNumbersOfSchema3 = 900;
  return stored == wanted || (wanted != 0 && stored == 1 + wanted % kNumbersOfSchema3);
}

std::string describe(const RobotSignature& signature) {
  const bool has_no_kinematics = signature.kinematics_hash.empty();
  return fmt::format("robot '{}' ({} {}, {} joints)", signature.robot_name,
                     has_no_kinematics ? "hash" : "kinematics",
                     has_no_kinematics ? signature.model_hash : signature.kinematics_hash,
                     signature.joint_count);
}

bool has_same_frames(const RobotSignature& a, const RobotSignature& b) {
  constexpr std::size_t kFrameDigits = 8;
  return a.joint_count == b.joint_count && !a.kinematics_hash.empty() &&
         a.kinematics_hash.substr(0, kFrameDigits) == b.kinematics_hash.substr(0, kFrameDigits);
}

bool is_same_robot(const RobotSignature& a, const RobotSignature& b) {
  if (a.joint_count != b.joint_count) return false;
  const bool has_no_kinematics = a.kinematics_hash.empty() || b.kinematics_hash.empty();
  return has_no_kinematics ? a.model_hash == b.model_hash : a.kinematics_hash == b.kinematics_hash;
}

tl::unexpected<Error> refuse_robot(const std::string& url, const RobotSignature& found,
                                   const RobotSignature& wanted) {
  std::string message = fmt::format("{}: holds experience of {}; expected {}", url, describe(found),
                                    describe(wanted));
  if (has_same_frames(found, wanted)) {
    message += "; only joint limits differ: `mneme db adopt` assigns it to this robot";
  }
  return fail(ErrorCode::wrong_robot, std::move(message));
}

}  // namespace mneme::internal
