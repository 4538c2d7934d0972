// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_cloud_scale PROBLEMS.json [POINTS]: the problems' solids as a cloud of points on their
// surfaces with 2 mm noise: what indexing, replacing, checking and planning take.
#include "mneme/collision.h"
#include "mneme/pipeline.h"
#include "mneme/problem.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>
#include <time.h>

namespace mneme::bench {
namespace {

constexpr double kNoise = 0.002;   // metres, standard deviation
constexpr double kRadius = 0.005;  // metres
constexpr int kReplaced = 1000;

/// Seconds of this thread's processor time since it was made: what else runs does not count.
class CpuWatch {
 public:
  [[nodiscard]] double elapsed_s() const { return now() - begin_; }

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double begin_ = now();
};

/// A random point on a surface.
struct OnSurface {
  Rng& rng;

  Vec3 operator()(const Box& box) const {
    const Vec3 areas = areas_of(box);
    double pick = rng.uniform(0, areas.sum());
    int axis = 0;
    while (axis < 2 && pick > areas[axis]) pick -= areas[axis++];
    Vec3 p{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    p[axis] = rng.index(2) == 0 ? -1 : 1;
    return box.pose * Vec3(p.cwiseProduct(box.half_extents));
  }
  Vec3 operator()(const Cylinder& c) const {
    const double angle = rng.uniform(0, 2 * std::numbers::pi);
    const Vec3 around(std::cos(angle), std::sin(angle), 0);
    const double end = c.radius / (c.radius + c.length);
    const bool is_end = rng.uniform() < end;
    const double r = is_end ? c.radius * std::sqrt(rng.uniform()) : c.radius;
    const double z = is_end ? (rng.index(2) == 0 ? -0.5 : 0.5) : rng.uniform(-0.5, 0.5);
    return c.pose * Vec3(r * around + c.length * z * Vec3::UnitZ());
  }
  Vec3 operator()(const Sphere& s) const {
    return s.center + s.radius * Vec3{rng.normal(), rng.normal(), rng.normal()}.normalized();
  }
  template <class Other>
  Vec3 operator()(const Other&) const {
    return Vec3::Zero();
  }

  /// Returns the area of both faces across each axis.
  static Vec3 areas_of(const Box& box) {
    const Vec3& h = box.half_extents;
    return 8 * Vec3(h.y() * h.z(), h.x() * h.z(), h.x() * h.y());
  }
};

struct Area {
  double operator()(const Box& box) const { return OnSurface::areas_of(box).sum(); }
  double operator()(const Cylinder& c) const {
    return 2 * std::numbers::pi * c.radius * (c.radius + c.length);
  }
  double operator()(const Sphere& s) const { return 4 * std::numbers::pi * s.radius * s.radius; }
  template <class Other>
  double operator()(const Other&) const {
    return 0;
  }
};

std::vector<CloudPoint> sample(const Scene& scene, std::size_t count, Rng& rng) {
  std::vector<const Shape*> shapes;
  std::vector<double> areas;
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      shapes.push_back(&shape);
      areas.push_back((areas.empty() ? 0 : areas.back()) + std::visit(Area{}, shape));
    }
  }
  std::vector<CloudPoint> points;
  while (points.size() < count && !shapes.empty()) {
    const auto at = std::ranges::upper_bound(areas, rng.uniform(0, areas.back()));
    const auto i =
        std::min<std::size_t>(static_cast<std::size_t>(at - areas.begin()), shapes.size() - 1);
    const Vec3 noise{rng.normal(), rng.normal(), rng.normal()};
    const Eigen::Vector3f p =
        (std::visit(OnSurface{rng}, *shapes[i]) + kNoise * noise).cast<float>();
    points.push_back({p.x(), p.y(), p.z()});
  }
  return points;
}

class Times {
 public:
  void add(double seconds) { values_.push_back(seconds); }
  void print(const char* what, double unit, const char* name) {
    if (values_.empty()) return;
    std::ranges::sort(values_);
    const auto at = [&](double share) {
      const auto last = static_cast<double>(values_.size() - 1);
      return unit * values_[static_cast<std::size_t>(share * last + 0.5)];
    };
    std::printf("%-34s n %5zu  p50 %9.2f  p95 %9.2f  max %9.2f %s\n", what, values_.size(), at(0.5),
                at(0.95), at(1), name);
  }

 private:
  std::vector<double> values_;
};

Scene cloud_of(const Scene& solids, std::size_t points, Rng& rng) {
  Scene scene{solids.name, {}};
  const auto parts = std::make_shared<Parts<CloudPoint>>(sample(solids, points, rng));
  (void)scene.add({"cloud", {PointCloud{{}, parts, kRadius}}});
  return scene;
}

struct Measured {
  Times index, remake, replace_near, replace_anywhere, states_solid, states_cloud, plan_solid,
      plan_cloud;
  int refused = 0;
};

void measure_edits(const Problem& problem, Scene& scene, Rng& rng, Measured& to) {
  const auto* cloud = std::get_if<PointCloud>(&scene.obstacles[0].shapes[0]);
  const std::vector<CloudPoint> fresh = sample(problem.scene, kReplaced, rng);
  const std::size_t first = rng.index(static_cast<std::uint32_t>(cloud->parts->list().size()) / 2);
  std::vector<CloudPoint> shaken(
      cloud->parts->list().begin() + static_cast<std::ptrdiff_t>(first),
      cloud->parts->list().begin() + static_cast<std::ptrdiff_t>(first) + kReplaced);
  for (CloudPoint& p : shaken) p[2] += static_cast<float>(kNoise * rng.normal());
  CpuWatch near;
  (void)scene.replace_points("cloud", first, shaken);
  to.replace_near.add(near.elapsed_s());
  CpuWatch anywhere;
  (void)scene.replace_points("cloud", first, fresh);
  to.replace_anywhere.add(anywhere.elapsed_s());
  CpuWatch again;
  const auto checker = CollisionChecker::make(problem.robot, scene);
  to.remake.add(again.elapsed_s());
}

void measure_states(const Problem& problem, const Scene& scene, const std::vector<float>& rows,
                    Times& to) {
  const auto checker = CollisionChecker::make(problem.robot, scene);
  if (!checker) return;
  std::vector<std::uint8_t> is_valid(rows.size() / problem.start.size());
  CpuWatch watch;
  checker->check_states(rows, is_valid);
  to.add(watch.elapsed_s() / static_cast<double>(is_valid.size()));
}

std::vector<float> random_rows(const Robot& robot, int count, Rng& rng) {
  std::vector<float> rows;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < robot.joint_count(); ++j) {
      const Joint& joint = robot.group_joint(j);
      rows.push_back(static_cast<float>(rng.uniform(joint.lower, joint.upper)));
    }
  }
  return rows;
}

bool measure_plan(const Problem& problem, std::uint64_t seed, Times& to) {
  SolveSettings settings;
  settings.plan.seed = seed;
  const auto result = solve(problem, nullptr, settings);
  if (!result || result->plan.status != PlanStatus::solved) return false;
  to.add(result->planning_time_s);
  return true;
}

void measure(const Problem& problem, std::size_t points, Rng& rng, Measured& to) {
  Problem clouded = problem;
  clouded.scene = cloud_of(problem.scene, points, rng);
  // The robot's own tables are made once, by the first checker.
  (void)CollisionChecker::make(problem.robot, problem.scene);
  CpuWatch watch;
  const auto checker = CollisionChecker::make(problem.robot, clouded.scene);
  if (!checker) return;
  to.index.add(watch.elapsed_s());
  const std::vector<float> rows = random_rows(problem.robot, 4000, rng);
  measure_states(problem, problem.scene, rows, to.states_solid);
  measure_states(problem, clouded.scene, rows, to.states_cloud);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    if (!measure_plan(clouded, seed, to.plan_cloud)) {
      ++to.refused;
    } else {
      measure_plan(problem, seed, to.plan_solid);
    }
  }
  Scene edited = cloud_of(problem.scene, points, rng);
  (void)CollisionChecker::make(problem.robot, edited);
  measure_edits(problem, edited, rng, to);
}

int run(const std::string& file, std::size_t points) {
  const auto names = list_problems(file);
  if (!names) return std::fprintf(stderr, "%s\n", names.error().message.c_str()), 1;
  Rng rng(1);
  Measured measured;
  for (const std::string& name : *names) {
    const auto problem = load_problem(file + "#" + name, {});
    if (!problem) return std::fprintf(stderr, "%s\n", problem.error().message.c_str()), 1;
    measure(*problem, points, rng, measured);
  }
  measured.index.print("checker with a new cloud", 1e3, "ms");
  measured.remake.print("checker after an edit", 1e6, "us");
  measured.replace_near.print("1000 points moved by noise", 1e6, "us");
  measured.replace_anywhere.print("1000 points replaced anywhere", 1e6, "us");
  measured.states_solid.print("random state, solids", 1e9, "ns");
  measured.states_cloud.print("random state, cloud", 1e9, "ns");
  measured.plan_solid.print("planning, solids", 1e6, "us");
  measured.plan_cloud.print("planning, cloud", 1e6, "us");
  std::printf("not solved with the cloud: %d\n", measured.refused);
  return 0;
}

}  // namespace
}  // namespace mneme::bench

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: mneme_cloud_scale PROBLEMS [POINTS]\n"), 2;
  return mneme::bench::run(argv[1], argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 100000);
}
