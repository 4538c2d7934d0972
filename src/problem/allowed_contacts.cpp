// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem_input.h"

#include <fmt/format.h>

#include <array>
#include <set>
#include <span>

namespace mneme::internal {

std::optional<std::string> AllowedContacts::find_fault(const std::string& first,
                                                       const std::string& second) const {
  for (const std::string& name : {first, second}) {
    if (knows(name)) continue;
    return fmt::format("expected a link of robot {}, an attached object or an obstacle, got \"{}\"",
                       robot_.name(), name);
  }
  if (!is_carried(first) && !is_carried(second)) {
    return fmt::format(
        "expected a link or an attached object to touch obstacle \"{}\", got obstacle \"{}\"",
        first, second);
  }
  if (first == second) return fmt::format("expected two names, got \"{}\" twice", first);
  return std::nullopt;
}

std::optional<std::string> AllowedContacts::find_ambiguity(const std::string& name) const {
  if (!is_carried(name) || scene_.find(name) == nullptr) return std::nullopt;
  return find_attached(name) != nullptr
             ? fmt::format("\"{}\" is an attached object and an obstacle; rename one of them", name)
             : fmt::format("\"{}\" is a link of robot {} and an obstacle; rename the obstacle",
                           name, robot_.name());
}

std::optional<std::string> AllowedContacts::find_ambiguity() const {
  const auto find_first = [&](std::span<const std::string> names) {
    std::optional<std::string> fault;
    for (const std::string& name : names) {
      if (!fault) fault = find_ambiguity(name);
    }
    return fault;
  };
  for (const Obstacle& obstacle : scene_.scene().obstacles) {
    if (obstacle.may_touch.empty()) continue;
    if (auto fault = find_ambiguity(obstacle.name)) return fault;
    if (auto fault = find_first(obstacle.may_touch)) return fault;
  }
  for (const EndContact& contact : scene_.scene().end_contacts) {
    if (auto fault = find_first(std::array{contact.first, contact.second})) return fault;
  }
  return std::nullopt;
}

std::optional<std::string> AllowedContacts::allow(const AllowedPair& pair) {
  const std::string &first = pair.first, &second = pair.second;
  for (const std::string& name : {first, second}) {
    if (auto fault = find_ambiguity(name)) return fault;
  }
  if (const auto fault = find_fault(first, second)) return fault;
  if (pair.at_ends) {
    scene_.allow_at_ends(pair);
  } else if (Obstacle* obstacle = scene_.find(second)) {
    scene_.allow(*obstacle, first);
  } else if (Obstacle* other = scene_.find(first)) {
    scene_.allow(*other, second);
  } else if (AttachedObject* object = find_attached(first)) {
    object->may_touch.push_back(second);
  } else if (AttachedObject* held = find_attached(second)) {
    held->may_touch.push_back(first);
  } else {
    link_pairs_.emplace_back(first, second);
  }
  return std::nullopt;
}

bool AllowedContacts::knows(const std::string& name) const {
  return is_carried(name) || scene_.find(name) != nullptr;
}

bool AllowedContacts::is_carried(const std::string& name) const {
  return find_attached(name) != nullptr || robot_.find_link(name).has_value();
}

AttachedObject* AllowedContacts::find_attached(const std::string& name) const {
  const auto found = attached_.find(name);
  return found == attached_.end() ? nullptr : found->second;
}

void read_allowed(const Input& problem, AllowedContacts& contacts) {
  if (const auto fault = contacts.find_ambiguity()) {
    problem.find("scene").value_or(problem).fail(
        ErrorCode::invalid, "contact is allowed of a name with two meanings: {}", *fault);
  }
  const auto list = problem.find("allow");
  if (!list) return;
  for (const Input& pair : list->items()) {
    if (const auto wrong = contacts.allow(read_allowed_pair(pair))) {
      pair.fail(ErrorCode::invalid, *wrong);
    }
  }
}

void read_allowed(const Input& problem, Scene& scene) {
  const auto list = problem.find("allow");
  if (!list) return;
  std::set<std::string> attached;
  if (const auto objects = problem.find("attached")) {
    for (const Input& object : objects->items()) attached.insert(object.at("name").text());
  }
  ObstacleContacts contacts(scene);
  for (const Input& pair : list->items()) {
    const AllowedPair allowed = read_allowed_pair(pair);
    const auto& [first, second, at_ends] = allowed;
    if (at_ends) {
      // Names of links are not known here; a pair of none changes no check of a scene alone.
      contacts.allow_at_ends(allowed);
      continue;
    }
    if (attached.contains(first) || attached.contains(second)) continue;
    if (Obstacle* obstacle = contacts.find(second)) {
      contacts.allow(*obstacle, first);
    } else if (Obstacle* other = contacts.find(first)) {
      contacts.allow(*other, second);
    }
  }
}

}  // namespace mneme::internal
