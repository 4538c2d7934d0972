// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"
#include "planning/tree.h"

#include <algorithm>
#include <map>

namespace mneme::test {
namespace {

using Row = std::vector<float>;

/// A tree on a robot in a world, at the range of 0.5.
struct TreeFixture {
  explicit TreeFixture(World world_)
      : world(std::move(world_)),
        checker(make_checker(world)),
        sampler(make_uniform_sampler(world.robot)),
        finisher(checker, settings.finish()),
        run({checker, world.query, *sampler, settings, finisher}),
        tree(run) {}
  static PlanSettings make_settings() {
    PlanSettings settings;
    settings.range = 0.5;
    return settings;
  }

  World world;
  CollisionChecker checker;
  std::unique_ptr<Sampler> sampler;
  PlanSettings settings = make_settings();
  PathFinisher finisher;
  internal::PlannerRun run;
  internal::Tree tree;
};

Row row_of(std::span<const float> q) { return {q.begin(), q.end()}; }

World sliding_world() {
  return {"",
          gantry(),
          {"", {make_box("wall", {0.9, -3, -3}, {1.1, 3, 3})}},
          {{0, 0, 0}, {{0.5, 0, 0}}}};
}

/// Node to parent, as configurations; roots map to themselves. Configurations must differ.
std::map<Row, Row> edges_of(const internal::Tree& tree) {
  std::map<Row, Row> edges;
  for (int node = 0; node < tree.size(); ++node) {
    const internal::FloatPath path = tree.path_to(node);
    REQUIRE(path.back() == row_of(tree[node]));
    edges[path.back()] = path.size() > 1 ? path[path.size() - 2] : path.back();
  }
  return edges;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a step is at most as long as the range and stops at what it is aimed at") {
    TreeFixture f(sliding_world());
    const int root = f.tree.add(Row{0, 0, 0}, -1);
    bool is_reached = true;
    const int step = f.tree.extend(root, Row{0, 1.5f, 0}, is_reached);
    REQUIRE(step == 1);
    CHECK(!is_reached);
    CHECK(row_of(f.tree[step]) == Row{0, 0.5f, 0});
    const int near = f.tree.extend(step, Row{0, 0.7f, 0.1f}, is_reached);
    REQUIRE(near == 2);
    CHECK(is_reached);
    CHECK(row_of(f.tree[near]) == Row{0, 0.7f, 0.1f});
    CHECK(f.tree.extend(root, Row{1, 0, 0}, is_reached) == 3);
    CHECK(f.tree.extend(3, Row{1, 0, 0}, is_reached) == -1);
    CHECK(f.tree.size() == 4);
  }

  TEST_CASE("connecting goes on until it sees its aim or is blocked") {
    TreeFixture f(sliding_world());
    f.tree.add(Row{0, 0, 0}, -1);
    const int last = f.tree.connect(0, Row{0, 1.8f, 0});
    CHECK(last == 3);
    CHECK(f.tree.size() == 4);
    CHECK(f.tree[last][1] == doctest::Approx(1.5));
    CHECK(f.tree.connect(last, Row{0, 1.8f, 0}) == last);
    // Behind the wall at 0.8 m: one step is possible.
    CHECK(f.tree.connect(0, Row{1.9f, 0, 0}) == -1);
    CHECK(f.tree.size() == 5);
    CHECK(f.tree[4][0] == doctest::Approx(0.5));
  }

  TEST_CASE("steps of a continuous joint go through its jump and stay wrapped") {
    TreeFixture f({"", thick_arm({1, 1}), {}, {{3, 0}, {{-2, 0}}}});
    f.tree.add(Row{3, 0}, -1);
    const int last = f.tree.connect(0, Row{-2, 0});
    REQUIRE(last == 2);
    CHECK(f.tree[1][0] == doctest::Approx(3.5 - 2 * kPi));
    CHECK(f.tree[2][0] == doctest::Approx(4.0 - 2 * kPi));
  }

  TEST_CASE("nodes know their roots and ancestors") {
    TreeFixture f(sliding_world());
    const int a = f.tree.add(Row{0, 0, 0}, -1), b = f.tree.add(Row{0, 1, 0}, -1);
    const int a1 = f.tree.add(Row{0, 0, 0.3f}, a), b1 = f.tree.add(Row{0, 1, 0.3f}, b);
    const int a2 = f.tree.add(Row{0, 0, 0.6f}, a1);
    CHECK(f.tree.ancestor_at(a, 0) == a);
    CHECK(f.tree.ancestor_at(a2, 0) == a);
    CHECK(f.tree.ancestor_at(b1, 0) == b);
    CHECK(f.tree.ancestor_at(a2, 0) == a);
    CHECK(f.tree.ancestor_at(a2, 1) == a1);
    CHECK(f.tree.ancestor_at(a2, 2) == a2);
    CHECK(f.tree.path_to(b1) == internal::FloatPath{{0, 1, 0}, {0, 1, 0.3f}});
    CHECK(f.tree.nearest(Row{0, 0.9f, 0.2f}) == b1);
  }

  TEST_CASE("removing a node removes what descends from it and nothing else") {
    TreeFixture f(sliding_world());
    const int root = f.tree.add(Row{0, 0, 0}, -1), other = f.tree.add(Row{0, 1, 0}, -1);
    const int a = f.tree.add(Row{0, 0, 0.1f}, root);
    f.tree.add(Row{0, 1, 0.1f}, other);
    f.tree.add(Row{0, 0, 0.2f}, a);
    f.tree.add(Row{0, 0, 0.3f}, root);
    f.tree.remove(a);
    CHECK(f.tree.size() == 4);
    CHECK(edges_of(f.tree) == std::map<Row, Row>{{{0, 0, 0}, {0, 0, 0}},
                                                 {{0, 1, 0}, {0, 1, 0}},
                                                 {{0, 1, 0.1f}, {0, 1, 0}},
                                                 {{0, 0, 0.3f}, {0, 0, 0}}});
    CHECK(f.tree.ancestor_at(f.tree.nearest(Row{0, 1, 0.1f}), 0) == other);
    f.tree.remove(f.tree.nearest(Row{0, 1, 0.1f}));
    CHECK(f.tree.size() == 3);
    CHECK(f.tree.nearest(Row{0, 1, 0.1f}) == other);
  }
}

TEST_SUITE("law") {
  TEST_CASE("random growth and removal keep every parent valid") {
    Rng rng(31);
    for (int round = 0; round < 20; ++round) {
      INFO("round ", round);
      TreeFixture f(sliding_world());
      f.tree.add(Row{0, 0, 0}, -1);
      f.tree.add(Row{0, 1, 0}, -1);
      for (int step = 0; step < 100; ++step) {
        const Configuration sample = random_configuration(f.world.robot, rng);
        const Row q(sample.begin(), sample.end());
        bool is_reached = false;
        f.tree.extend(f.tree.nearest(q), q, is_reached);
        if (step % 10 != 9 || f.tree.size() < 4) continue;
        std::map<Row, Row> expected = edges_of(f.tree);
        const int node =
            2 + static_cast<int>(rng.index(static_cast<std::uint32_t>(f.tree.size() - 2)));
        const Row removed = row_of(f.tree[node]);
        std::erase_if(expected, [&](const auto& edge) {
          const int end = f.tree.nearest(edge.first);
          const internal::FloatPath path = f.tree.path_to(end);
          return std::find(path.begin(), path.end(), removed) != path.end();
        });
        f.tree.remove(node);
        CHECK(edges_of(f.tree) == expected);
        CHECK(row_of(f.tree[0]) == Row{0, 0, 0});
        CHECK(row_of(f.tree[1]) == Row{0, 1, 0});
        for (int i = 0; i < f.tree.size(); ++i) CHECK(f.tree.ancestor_at(i, 0) <= std::min(i, 1));
      }
    }
  }
}

}  // namespace mneme::test
