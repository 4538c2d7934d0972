// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "robot/kinematics.h"
#include "robot/robot_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

namespace mneme {
namespace {

using internal::as_index;

/// Pairs to check grow with the square of the number of objects that different bodies carry.
constexpr std::size_t kMostPairs = 500'000;

template <class... Args>
tl::unexpected<Error> refusal(const AttachedObject& object, fmt::format_string<Args...> what,
                              Args&&... args) {
  return fail(ErrorCode::invalid, "attached object '{}': {}", object.name,
              fmt::format(what, std::forward<Args>(args)...));
}

/// Indices of links, including attached objects, by name.
using LinkIndices = std::unordered_map<std::string, int>;

/// Adds the object as a link with a fixed joint.
Result<void> add_link(const ApproximatedObject& added, std::vector<Link>& links,
                      std::vector<Joint>& joints, LinkIndices& indices) {
  const AttachedObject& object = added.object;
  if (object.name.empty()) return refusal(object, "it has no name");
  if (!indices.emplace(object.name, static_cast<int>(links.size())).second) {
    return refusal(object, "there is a link or another attached object of this name");
  }
  const auto carrier = indices.find(object.link);
  if (carrier == indices.end() || object.link == object.name) {
    return refusal(object, "there is no link '{}' to carry it", object.link);
  }
  if (added.spheres.empty() && added.capsules.empty()) {
    return refusal(object, "it has no spheres and no capsules; approximate_object makes them");
  }
  Joint joint;
  joint.name = object.name;
  joint.parent_link = carrier->second;
  joint.child_link = static_cast<int>(links.size());
  links.push_back({object.name,
                   static_cast<int>(joints.size()),
                   added.spheres,
                   added.capsules,
                   {},
                   added.approximation});
  if (const auto fault = internal::describe_shape_fault(links.back())) {
    return refusal(object, "{}", *fault);
  }
  joints.push_back(std::move(joint));
  return {};
}

/// Pairs that `may_touch` of an object allows.
Result<internal::LinkPairs> find_allowed(std::span<const ApproximatedObject> objects,
                                         const LinkIndices& indices) {
  internal::LinkPairs allowed;
  for (const ApproximatedObject& added : objects) {
    const AttachedObject& object = added.object;
    for (const std::string& name : object.may_touch) {
      const auto other = indices.find(name);
      if (other == indices.end()) {
        return refusal(object, "it may touch '{}', but no link or attached object has this name",
                       name);
      }
      allowed.push_back(std::minmax({indices.at(object.name), other->second}));
    }
  }
  return allowed;
}

}  // namespace

Result<Robot> Robot::with_attached(std::vector<ApproximatedObject> objects) const {
  Model model = *bare_model();
  model.attached = model_->attached;
  std::ranges::move(objects, std::back_inserter(model.attached));
  const int first = static_cast<int>(model.links.size());
  LinkIndices indices;
  for (int i = 0; i < first; ++i) indices.emplace(model.links[as_index(i)].name, i);
  for (const ApproximatedObject& object : model.attached) {
    MNEME_TRY(add_link(object, model.links, model.joints, indices));
  }
  const internal::LinkPairs allowed = MNEME_TRY(find_allowed(model.attached, indices));
  const internal::LinkPairs pairs = internal::derive_self_pairs(
      model.links, model.joints, model.group, allowed, first, kMostPairs);
  if (pairs.size() > kMostPairs) {
    return fail(ErrorCode::unsupported,
                "robot '{}' would carry {} attached objects with more than {} pairs to check; an "
                "object may have many shapes",
                name(), model.attached.size(), kMostPairs);
  }
  model.self_pairs.insert(model.self_pairs.end(), pairs.begin(), pairs.end());
  model.is_planar =
      model.is_planar && internal::moves_in_plane(model.links, model.joints, model.group);
  model.bare = bare_model();
  return Robot(std::make_shared<const Model>(std::move(model)));
}

bool Robot::is_attached(std::string_view name) const {
  return std::ranges::any_of(attached(), [&](const ApproximatedObject& approximated) {
    return approximated.object.name == name;
  });
}

Result<Robot> Robot::without_attached(const std::string& name) const {
  std::vector<ApproximatedObject> kept;
  for (const ApproximatedObject& object : attached()) {
    if (object.object.name == name) continue;
    kept.push_back(object);
    std::erase(kept.back().object.may_touch, name);
  }
  if (kept.size() == attached().size()) {
    return fail(ErrorCode::invalid, "robot '{}' carries no object '{}'", this->name(), name);
  }
  return kept.empty() ? without_attached() : without_attached().with_attached(std::move(kept));
}

Robot Robot::without_attached() const { return Robot(bare_model()); }

}  // namespace mneme
