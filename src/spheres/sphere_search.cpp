// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/sphere_search.h"

#include "base/as_index.h"
#include "base/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>

namespace mneme::internal {
namespace {

using Key = std::array<int, 3>;
using Groups = std::map<Key, Element>;

Key key_of(const Vec3& point, double size) {
  const Vec3 voxel = (point / size).array().floor();
  return {static_cast<int>(voxel.x()), static_cast<int>(voxel.y()), static_cast<int>(voxel.z())};
}

/// A ball around the mean of the balls' centres.
Sphere bound(std::span<const Sphere> balls) {
  Sphere result;
  for (const Sphere& ball : balls) result.center += ball.center / static_cast<double>(balls.size());
  for (const Sphere& ball : balls) {
    result.radius = std::max(result.radius, (ball.center - result.center).norm() + ball.radius);
  }
  return result;
}

/// True if the sphere, smaller by `margin`, contains the point.
bool holds(const Sphere& sphere, const Vec3& point, double margin) {
  const double reach = sphere.radius - margin;
  return reach >= 0 && (point - sphere.center).squaredNorm() <= reach * reach;
}

void drop_equal(std::vector<Sphere>& balls) {
  const auto key = [](const Sphere& s) {
    return std::array{s.center.x(), s.center.y(), s.center.z(), s.radius};
  };
  std::ranges::sort(balls, {}, key);
  const auto are_equal = [&](const Sphere& a, const Sphere& b) { return key(a) == key(b); };
  balls.erase(std::unique(balls.begin(), balls.end(), are_equal), balls.end());
}

std::vector<Element> elements_of(Groups groups) {
  std::vector<Element> elements;
  for (auto& [key, element] : groups) {
    drop_equal(element.balls);
    element.bound = bound(element.balls);
    elements.push_back(std::move(element));
  }
  return elements;
}

std::vector<Element> cut_surface(const TriangleMesh& mesh, double size) {
  Groups groups;
  for (const Triangle& t : subdivide(mesh, size)) {
    poll_interrupt();
    std::vector<Sphere>& balls = groups[key_of(t.centroid(), size)].balls;
    for (const Vec3& corner : {t.a, t.b, t.c}) balls.push_back({corner, 0});
  }
  return elements_of(std::move(groups));
}

std::vector<Element> cut_inside(const SolidModel& solid, double size) {
  Groups groups;
  const double half_diagonal = 0.5 * std::sqrt(3.0) * solid.voxel_size();
  for (const SolidModel::Voxel& voxel : solid.inner_voxels()) {
    groups[key_of(voxel.center, size)].balls.push_back(
        {voxel.center, voxel.is_whole ? half_diagonal : 0.0});
  }
  return elements_of(std::move(groups));
}

}  // namespace

double Element::reach_from(const Vec3& center) const {
  double reach = 0;
  for (const Sphere& ball : balls) {
    reach = std::max(reach, (ball.center - center).norm() + ball.radius);
  }
  return reach;
}

bool Element::is_within(const Sphere& sphere) const {
  if (!holds(sphere, bound.center, 0)) return false;
  if (holds(sphere, bound.center, bound.radius)) return true;
  return std::ranges::all_of(
      balls, [&](const Sphere& ball) { return holds(sphere, ball.center, ball.radius); });
}

SolidPieces::SolidPieces(const TriangleMesh& mesh, const SolidModel& solid, double size)
    : needed(cut_surface(mesh, size)), spare(cut_inside(solid, size)) {}

std::size_t SolidPieces::need_bare(std::span<const Sphere> spheres) {
  LatestFirst latest_first;
  const auto is_held = [&](const Element& piece) {
    return latest_first.any(spheres, [&](const Sphere& s) { return piece.is_within(s); });
  };
  const auto bare = std::stable_partition(spare.begin(), spare.end(), is_held);
  const auto count = static_cast<std::size_t>(spare.end() - bare);
  std::move(bare, spare.end(), std::back_inserter(needed));
  spare.erase(bare, spare.end());
  return count;
}

namespace {

using Indices = std::vector<int>;

/// Per cent of the effort without a gain after which the search ends: small solids need few steps.
constexpr std::int64_t kPatience = 8;

/// The state of the search: the chosen proposals, and how many of them contain each piece. The cost
/// of a step is the number of entries that it changes.
class SphereSearch {
 public:
  SphereSearch(std::vector<Sphere> proposals, Rng& rng)
      : proposals_(std::move(proposals)),
        rows_(static_cast<Eigen::Index>(proposals_.size()), 4),
        room_(rows_.rows()),
        rng_(rng) {
    for (Eigen::Index p = 0; p < rows_.rows(); ++p) {
      const Sphere& sphere = proposals_[static_cast<std::size_t>(p)];
      // In single precision, rounded up: is_within() decides.
      constexpr float kRoundingUp = 1e-4f;
      rows_.row(p).head<3>() = sphere.center.transpose().array().cast<float>();
      const auto radius = static_cast<float>(sphere.radius) + kRoundingUp;
      rows_(p, 3) = radius * radius;
    }
    held_.resize(proposals_.size());
  }

  /// Adds pieces, and covers them by greed.
  void cover(std::span<const Element> pieces) {
    for (const Element& piece : pieces) {
      poll_interrupt();
      add(piece);
    }
    gains_.resize(proposals_.size(), 0);
    is_marked_.resize(proposals_.size(), false);
    cover_bare(0);
    drop_needless();
  }

  /// Searches for fewer spheres, up to `effort` steps in all.
  void improve(std::int64_t effort) {
    std::int64_t last_gain = steps_;
    while (steps_ < effort && steps_ - last_gain < kPatience * effort / 100 && chosen_.size() > 1) {
      poll_interrupt();
      const Indices before = chosen_;
      take_some_away();
      cover_bare(0.3);
      drop_needless();
      if (chosen_.size() > before.size()) restore(before);
      if (chosen_.size() < before.size()) last_gain = steps_;
    }
  }

  [[nodiscard]] std::vector<Sphere> chosen() const {
    Indices sorted = chosen_;
    std::ranges::sort(sorted);
    std::vector<Sphere> spheres;
    for (const int p : sorted) spheres.push_back(proposals_[as_index(p)]);
    return spheres;
  }

 private:
  /// A piece that no proposal contains becomes a proposal.
  void add(const Element& piece) {
    const int number = static_cast<int>(holders_.size());
    Indices& holders = holders_.emplace_back();
    const Eigen::Vector3f center = piece.bound.center.cast<float>();
    room_ = rows_.col(3) - (rows_.col(0) - center.x()).square() -
            (rows_.col(1) - center.y()).square() - (rows_.col(2) - center.z()).square();
    for (int p = 0; p < static_cast<int>(room_.size()); ++p) {
      if (room_[p] < 0) continue;
      if (piece.is_within(proposals_[as_index(p)])) holders.push_back(p);
    }
    if (holders.empty()) {
      holders.push_back(static_cast<int>(proposals_.size()));
      proposals_.push_back(piece.bound);
      held_.emplace_back();
    }
    int count = 0;
    for (const int p : holders) held_[as_index(p)].push_back(number);
    for (const int p : chosen_) count += std::ranges::binary_search(holders, p) ? 1 : 0;
    counts_.push_back(count);
    if (count == 0) bare_.push_back(number);
  }

  void choose(int proposal) {
    chosen_.push_back(proposal);
    const Indices& held = held_[as_index(proposal)];
    for (const int e : held) ++counts_[as_index(e)];
    steps_ += std::ssize(held);
  }
  void discard(std::size_t position) {
    const int proposal = chosen_[position];
    const Indices& held = held_[as_index(proposal)];
    for (const int e : held) {
      if (--counts_[as_index(e)] == 0) bare_.push_back(e);
    }
    steps_ += std::ssize(held);
    chosen_.erase(chosen_.begin() + static_cast<std::ptrdiff_t>(position));
  }
  void restore(const Indices& chosen) {
    for (const int p : chosen) is_marked_[as_index(p)] = true;
    for (std::size_t i = chosen_.size(); i > 0; --i) {
      const auto p = as_index(chosen_[i - 1]);
      if (!is_marked_[p]) discard(i - 1);
      is_marked_[p] = false;
    }
    for (const int p : chosen) {
      if (is_marked_[as_index(p)]) choose(p);
      is_marked_[as_index(p)] = false;
    }
    chosen_ = chosen;
    bare_.clear();
  }

  /// Discards a random sphere and its nearest neighbours.
  void take_some_away() {
    const auto pick = rng_.index(static_cast<std::uint32_t>(chosen_.size()));
    const Vec3 center = proposals_[as_index(chosen_[pick])].center;
    const std::size_t count = std::min<std::size_t>(2 + rng_.index(4), chosen_.size());
    const auto distance = [&](int p) {
      return std::pair((proposals_[as_index(p)].center - center).squaredNorm(), p);
    };
    std::ranges::partial_sort(chosen_, chosen_.begin() + static_cast<std::ptrdiff_t>(count), {},
                              distance);
    steps_ += std::ssize(chosen_);
    for (std::size_t i = count; i > 0; --i) discard(i - 1);
  }

  /// Chooses proposals with the largest gain until no piece is bare. Gains vary by the fraction
  /// `noise`.
  void cover_bare(double noise) {
    Indices useful;
    for (const int e : bare_) {
      for (const int p : holders_[as_index(e)]) {
        if (gains_[as_index(p)]++ == 0) useful.push_back(p);
      }
      steps_ += 2 * std::ssize(holders_[as_index(e)]);
    }
    std::size_t bare = bare_.size();
    bare_.clear();
    while (bare > 0) {
      poll_interrupt();
      const int best = most_useful(useful, noise);
      for (const int e : held_[as_index(best)]) {
        if (counts_[as_index(e)] > 0) continue;
        --bare;
        for (const int p : holders_[as_index(e)]) --gains_[as_index(p)];
      }
      choose(best);
    }
  }

  /// Returns the proposal with the largest gain. Drops those without any from `useful`.
  [[nodiscard]] int most_useful(Indices& useful, double noise) {
    steps_ += std::ssize(useful);
    int best = -1;
    double best_gain = 0;
    std::erase_if(useful, [&](int p) { return gains_[as_index(p)] == 0; });
    for (const int p : useful) {
      if (gains_[as_index(p)] <= best_gain) continue;
      const double gain = gains_[as_index(p)] * (1 - noise * rng_.uniform());
      if (gain <= best_gain) continue;
      best = p;
      best_gain = gain;
    }
    return best;
  }

  void drop_needless() {
    for (std::size_t i = chosen_.size(); i > 0; --i) {
      const auto& held = held_[as_index(chosen_[i - 1])];
      if (std::ranges::all_of(held, [&](int e) { return counts_[as_index(e)] > 1; }))
        discard(i - 1);
    }
    steps_ += 2 * std::ssize(chosen_);
  }

  std::vector<Sphere> proposals_;
  Eigen::Array<float, Eigen::Dynamic, 4> rows_;  ///< the first proposals' centres, squared radii
  Eigen::ArrayXf room_;
  std::vector<Indices> holders_;  ///< per piece the proposals that contain it
  std::vector<Indices> held_;     ///< per proposal the pieces that it contains
  Indices counts_;                ///< per piece the number of chosen holders
  Indices gains_;                 ///< per proposal the number of bare pieces in it; 0 between steps
  Indices chosen_;
  std::vector<bool> is_marked_;  ///< per proposal; used by restore()
  Indices bare_;                 ///< pieces that no chosen proposal contains
  std::int64_t steps_ = 0;
  Rng& rng_;
};

constexpr std::size_t kMostProposals = 8000;
constexpr std::size_t kMostSurfaceProposals = 500;

/// Returns `count` random `items`.
template <class T>
std::vector<T> thin_out(std::vector<T> items, std::size_t count, Rng& rng) {
  for (std::size_t i = 0; i < count && count < items.size(); ++i) {
    const auto rest = static_cast<std::uint32_t>(items.size() - i);
    std::swap(items[i], items[i + rng.index(rest)]);
  }
  items.resize(std::min(items.size(), count));
  return items;
}

}  // namespace

std::vector<Sphere> propose_spheres(const SolidModel& solid, std::vector<Sphere> medial_balls,
                                    std::span<const Element> elements, double excess, Rng& rng) {
  std::vector<Sphere> proposals = thin_out(std::move(medial_balls), kMostProposals, rng);
  for (Sphere& sphere : proposals) sphere.radius += excess;
  std::vector<const Element*> skin;
  for (const Element& element : elements) skin.push_back(&element);
  for (const Element* element : thin_out(std::move(skin), kMostSurfaceProposals, rng)) {
    const double radius = solid.depth(element->bound.center) + excess;
    if (radius > 0) proposals.push_back({element->bound.center, radius});
  }
  return proposals;
}

std::vector<Sphere> choose_spheres(std::vector<Sphere> proposals, SolidPieces& pieces,
                                   std::int64_t effort, Rng& rng) {
  SphereSearch search(std::move(proposals), rng);
  search.cover(pieces.needed);
  for (const std::int64_t steps : {std::int64_t{0}, effort}) {
    search.improve(steps);
    while (const std::size_t count = pieces.need_bare(search.chosen())) {
      search.cover(std::span(pieces.needed).last(count));
    }
  }
  return search.chosen();
}

namespace {

constexpr int kRounds = 3;
constexpr double kFirstStep = 0.02;
constexpr double kLastStep = 0.0005;
constexpr double kRounding = 1e-9;

using Pieces = std::vector<const Element*>;

/// Radius of the sphere around `center` that contains the ball.
double reach_of(const Sphere& ball, const Vec3& center) {
  return (ball.center - center).norm() + ball.radius;
}

/// Assigns each piece to the sphere that contains it with most room to spare.
std::vector<Pieces> share_out(std::span<const Sphere> spheres, std::span<const Element> elements) {
  std::vector<Pieces> shares(spheres.size());
  std::size_t owner = 0;  // a neighbour's first: it leaves few others to look at
  for (const Element& element : elements) {
    poll_interrupt();
    double most_room = spheres[owner].radius - element.reach_from(spheres[owner].center);
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const double more = spheres[i].radius - most_room;
      if (more <= 0 || (element.bound.center - spheres[i].center).squaredNorm() >= more * more) {
        continue;
      }
      const double room = spheres[i].radius - element.reach_from(spheres[i].center);
      if (room <= most_room) continue;
      most_room = room;
      owner = i;
    }
    shares[owner].push_back(&element);
  }
  return shares;
}

/// How far a sphere that contains some pieces sticks out, by its centre. The balls and points of
/// the surface that bound reach and depth at one centre are bounds at all others: most centres that
/// are no better cost no search.
class StickOut {
 public:
  StickOut(const Pieces& pieces, const SolidModel& solid) : pieces_(pieces), solid_(solid) {}

  /// Returns metres, or nothing if they are not less than `limit`.
  [[nodiscard]] std::optional<double> less_than(double limit, const Vec3& center) {
    double reach = -std::numeric_limits<double>::infinity(), away = -reach;
    for (const Sphere& ball : balls_) reach = std::max(reach, reach_of(ball, center));
    for (const Vec3& point : points_) away = std::min(away, (point - center).norm());
    if (reach - away >= limit) return std::nullopt;
    reach = find_reach(center, reach);
    if (reach - away >= limit) return std::nullopt;
    const Vec3 nearest = solid_.nearest(center, away + kRounding);
    away = (nearest - center).norm();
    add(nearest, points_);
    if (reach - away >= limit) return std::nullopt;
    const double result = solid_.contains(center) ? reach - away : reach + away;
    return result < limit ? std::optional(result) : std::nullopt;
  }

  /// Radius of the smallest sphere around `center` that contains the pieces. Precondition: it is at
  /// least `reach`.
  [[nodiscard]] double find_reach(const Vec3& center, double reach) {
    const Sphere* farthest = nullptr;
    for (const Element* piece : pieces_) {
      // The bounding ball rules out most pieces that are not the farthest.
      if (reach_of(piece->bound, center) <= reach) continue;
      for (const Sphere& ball : piece->balls) {
        if (reach_of(ball, center) <= reach) continue;
        reach = reach_of(ball, center);
        farthest = &ball;
      }
    }
    if (farthest != nullptr) add(*farthest, balls_);
    return reach;
  }

 private:
  /// Replaces the oldest of the objects if there are many.
  template <class Object>
  static void add(const Object& object, std::vector<Object>& objects) {
    constexpr std::size_t kMost = 8;
    if (objects.size() == kMost) objects.erase(objects.begin());
    objects.push_back(object);
  }

  const Pieces& pieces_;
  const SolidModel& solid_;
  std::vector<Sphere> balls_;  ///< of the pieces
  std::vector<Vec3> points_;   ///< of the surface
};

/// Minimizes how far the sphere sticks out: descends along the axes with shrinking steps.
Sphere fit(const Vec3& start, const Pieces& pieces, const SolidModel& solid) {
  StickOut stick_out(pieces, solid);
  Vec3 center = start;
  double least = stick_out.less_than(std::numeric_limits<double>::infinity(), center).value();
  for (double step = kFirstStep; step >= kLastStep; step *= 0.5) {
    for (bool has_moved = true; has_moved;) {
      has_moved = false;
      for (int i = 0; i < 6; ++i) {
        const Vec3 next = center + (i % 2 == 0 ? step : -step) * Vec3::Unit(i / 2);
        const auto better = stick_out.less_than(least - 0.01 * step, next);
        if (!better) continue;
        least = *better;
        center = next;
        has_moved = true;
      }
    }
  }
  return {center, stick_out.find_reach(center, 0)};
}

std::vector<Sphere> refine(std::vector<Sphere> spheres, std::span<const Element> elements,
                           const SolidModel& solid) {
  std::vector<Pieces> fitted(spheres.size());
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Pieces> shares = share_out(spheres, elements);
    if (shares == fitted) break;
    std::vector<Sphere> next;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      poll_interrupt();
      if (shares[i].empty()) continue;
      // A sphere that fits its pieces already stays.
      next.push_back(shares[i] == fitted[i] ? spheres[i]
                                            : fit(spheres[i].center, shares[i], solid));
    }
    spheres = std::move(next);
    std::erase(shares, Pieces());
    fitted = std::move(shares);
  }
  return spheres;
}

}  // namespace

std::vector<Sphere> refine(const std::vector<Sphere>& spheres, SolidPieces& pieces,
                           const SolidModel& solid) {
  std::vector<Sphere> result;
  do {
    result = refine(spheres, pieces.needed, solid);
  } while (pieces.need_bare(result) > 0);
  return result;
}

}  // namespace mneme::internal
