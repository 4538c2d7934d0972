// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/resolve_goals.h"

#include "base/threads.h"
#include "planning/end_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

namespace mneme::internal {
namespace {

IkSettings ik_settings(const Query& query) {
  IkSettings settings = query.settings.ik;
  settings.seed = query.settings.plan.seed;
  settings.is_over = [&query] { return query.is_over(); };
  return settings;
}

/// Turns `refusal` into that of a query that is over: cancelled, or late, with `message`.
void end_early(const Query& query, std::string message, PlanResult& refusal) {
  const bool is_cancelled = is_set(query.settings.plan.cancel);
  refusal.status = is_cancelled ? PlanStatus::cancelled : PlanStatus::timeout;
  refusal.message = is_cancelled ? "cancelled" : std::move(message);
}

/// Explains in `refusal` why no configuration was found for the poses.
void explain_missing_goals(const ResolvedQuery& resolved, PlanResult& refusal) {
  const Query& query = resolved.query;
  if (query.is_over()) {
    end_early(query, "no configuration for the poses of the goal within the time limit", refusal);
  } else {
    refusal.message = resolved.further_goals->describe_failure();
  }
}

/// Goals that are examined at a time: by exact geometry, for contact that may be entered, and with
/// a reason for each that is ignored. Problems with few goals are one block.
constexpr std::size_t kBlock = 64;

/// The start and the goals of the block from number `first` on.
PlanQuery block_of(const Problem& problem, std::size_t first) {
  const std::span<const Configuration> goals = std::span(problem.goals).subspan(first);
  const auto block = goals.first(std::min(kBlock, goals.size()));
  return {problem.start, {block.begin(), block.end()}};
}

/// Resolves the block of goals from one number on; the first block has the problem's poses, too.
class BlockResolver {
 public:
  BlockResolver(const Query& query, CellChecker made, std::size_t first)
      : query_(query),
        problem_(query.problem),
        first_(first),
        made_(std::move(made)),
        ends_(block_of(problem_, first)) {}

  /// Call once. Throws Interrupted.
  Result<ResolvedQuery> run() {
    MNEME_TRY(move_inside());
    const bool wants_poses = !problem_.pose_goals.empty() && first_ == 0;
    if (wants_poses && problem_.robot.is_configuration(ends_.start)) {
      MNEME_TRY(resolve_poses());
      if (ends_.goals.empty()) MNEME_TRY(enter_contact());
    }
    return finish(made_.checked.are_ends_clear && !wants_poses);
  }

 private:
  Result<CellChecker> make_checker() const {
    return make_query_checker(problem_.robot, problem_.scene, query_.checker_settings(), ends_,
                              given_.names(ends_))
        .map([](QueryChecker made) {
          return CellChecker{std::move(made), nullptr};
        });
  }

  [[nodiscard]] bool is_clear_end(const Configuration& q) const {
    return problem_.robot.is_configuration(q) && is_clear(made_.checked.checker, q);
  }

  /// Replaces ends that are barely outside by configurations nearby.
  Result<void> move_inside() {
    const SolveSettings& settings = query_.settings;
    const bool has_tolerance = settings.start_tolerance > 0 || settings.allow_at_ends > 0 ||
                               !problem_.scene.end_contacts.empty();
    if (made_.checked.are_ends_clear || !has_tolerance) return {};
    // The exact geometry may show that start and goals are free.
    const auto is_end_clear = [this](const Configuration& q) { return is_clear_end(q); };
    if (is_end_clear(ends_.start) && std::ranges::all_of(ends_.goals, is_end_clear)) return {};
    given_ = move_ends_inside(query_, made_.checked.checker, ends_, first_);
    if (!given_.empty()) made_ = MNEME_TRY(make_checker());
    return {};
  }

  [[nodiscard]] Result<PoseGoalSource> make_source() const {
    return PoseGoalSource::make(made_.checked.checker, problem_.pose_goals, problem_.start,
                                ik_settings(query_), kVerificationMargin);
  }

  /// Returns a checker with more exact pairs, found at a configuration for a pose where only
  /// spheres are in contact; nothing if there is none.
  [[nodiscard]] Result<std::optional<QueryChecker>> find_exact_checker() const {
    constexpr int kMostSolutions = 64;
    IkSettings settings = ik_settings(query_);
    settings.solutions = std::max(settings.solutions, kMostSolutions);
    for (const PoseGoal& goal : problem_.pose_goals) {
      if (query_.is_over()) return std::nullopt;
      const auto kinematics = MNEME_TRY(
          InverseKinematics::make(problem_.robot, goal.link, made_.checked.checker.isa()));
      const IkResult reached = kinematics.solve(goal, problem_.start, settings);
      for (const Configuration& q : reached.solutions) {
        if (query_.is_over()) return std::nullopt;
        QueryChecker made = MNEME_TRY(make_query_checker(
            problem_.robot, problem_.scene, query_.checker_settings(), {problem_.start, {q}}));
        if (made.notes.size() > made_.checked.notes.size()) return made;
      }
    }
    return std::nullopt;
  }

  /// Adds configurations for the problem's poses.
  Result<void> resolve_poses() {
    further_goals_ = MNEME_TRY(make_source());
    std::vector<Configuration> found = further_goals_->more();
    if (found.empty() && ends_.goals.empty()) {
      if (auto exact = MNEME_TRY(find_exact_checker())) {
        made_ = {*std::move(exact), nullptr};
        further_goals_ = MNEME_TRY(make_source());
        found = further_goals_->more();
      }
    }
    std::ranges::move(found, std::back_inserter(ends_.goals));
    return {};
  }

  /// Takes configurations for the poses in which an attached object touches what it is put on, or a
  /// pair of Scene::end_contacts touches.
  Result<void> enter_contact() {
    const bool holds = query_.settings.allow_at_ends > 0 && !problem_.robot.attached().empty();
    if (!holds && problem_.scene.end_contacts.empty()) return {};
    PlanQuery tried{ends_.start, further_goals_->blocked()};
    GivenEnds entered = move_ends_inside(query_, made_.checked.checker, tried);
    if (entered.goals.empty()) return {};
    for (const GivenEnds::Goal& goal : entered.goals) ends_.goals.push_back(goal.inside);
    std::ranges::move(entered.goals, std::back_inserter(given_.goals));
    std::ranges::move(entered.notes, std::back_inserter(given_.notes));
    made_ = MNEME_TRY(make_checker());
    return {};
  }

  /// Drops invalid goals and says why nothing is left.
  ResolvedQuery finish(bool are_ends_clear) {
    const bool has_exact_pairs = !made_.checked.notes.empty();
    ResolvedQuery resolved{.query = query_,
                           .ends = std::move(ends_),
                           .given = std::move(given_),
                           .checker = std::move(made_.checked.checker),
                           .cell = std::move(made_.cell),
                           .further_goals = std::move(further_goals_),
                           .has_exact_pairs = has_exact_pairs};
    add_notes(resolved.given.notes, resolved);
    add_notes(std::move(made_.checked.notes), resolved);
    const bool has_poses = resolved.further_goals.has_value();
    // Without any goal the refusal explains it.
    if (has_poses && !resolved.ends.goals.empty()) {
      add_notes(resolved.further_goals->describe_unreached(), resolved);
    }
    add_notes(drop_invalid_goals(resolved.checker, resolved.ends.goals, are_ends_clear, first_),
              resolved);
    resolved.refusal = refuse_query(resolved.checker, resolved.ends, are_ends_clear);
    if (resolved.refusal) explain_refusal(resolved);
    return resolved;
  }

  static void add_notes(std::vector<std::string> notes, ResolvedQuery& resolved) {
    std::ranges::move(notes, std::back_inserter(resolved.notes));
  }

  static void explain_refusal(ResolvedQuery& resolved) {
    PlanResult& refusal = *resolved.refusal;
    if (refusal.status == PlanStatus::invalid_goal) {
      if (resolved.further_goals && resolved.ends.goals.empty()) {
        explain_missing_goals(resolved, refusal);
      }
    } else if (refusal.status == PlanStatus::invalid_start) {
      if (!resolved.given.start_failure.empty()) refusal.message = resolved.given.start_failure;
    }
  }

  const Query& query_;
  const Problem& problem_;
  std::size_t first_;
  CellChecker made_;
  PlanQuery ends_;
  GivenEnds given_;
  std::optional<PoseGoalSource> further_goals_ = {};
};

/// Resolves a block, or returns nothing if the query is over before. What can be refused at once is
/// refused with its reason, however short the limit is.
std::optional<Result<ResolvedQuery>> resolve_in_time(const Query& query, CellChecker made,
                                                     std::size_t first) {
  constexpr double kAtOnce = 0.05;  // seconds
  const Stopwatch stopwatch;
  const auto is_over = [&] { return query.is_over() && stopwatch.elapsed_s() > kAtOnce; };
  const InterruptScope scope(is_over);
  try {
    return BlockResolver(query, std::move(made), first).run();
  } catch (const Interrupted&) {
    if (!is_over()) throw;  // a scope of the caller is over
    return std::nullopt;
  }
}

/// Resolves the first block.
Result<ResolvedQuery> resolve_first(const Query& query, const CellChecker& made) {
  if (auto resolved = resolve_in_time(query, made, 0)) return *std::move(resolved);
  PlanResult late;
  end_early(query, "the time limit was over before start and goals were examined", late);
  return ResolvedQuery{.query = query,
                       .ends = block_of(query.problem, 0),
                       .checker = made.checked.checker,
                       .cell = made.cell,
                       .has_exact_pairs = !made.checked.notes.empty(),
                       .refusal = std::move(late)};
}

/// Adds the valid ones of the goals from number `first` on, for a tenth of the time left: planning
/// begins with those that were checked by then.
void add_valid_goals(std::size_t first, ResolvedQuery& resolved) {
  constexpr double kShare = 0.1;
  const Query& query = resolved.query;
  const std::vector<Configuration>& goals = query.problem.goals;
  const double limit_s = kShare * query.remaining_s();
  const Stopwatch stopwatch;
  std::size_t ignored = 0, next = first;
  for (; next < goals.size(); ++next) {
    poll_interrupt();
    if (stopwatch.elapsed_s() >= limit_s) break;
    if (is_valid_end(resolved.checker, goals[next])) {
      resolved.ends.goals.push_back(goals[next]);
    } else {
      ++ignored;
    }
  }
  if (ignored > 0) {
    resolved.notes.push_back(
        fmt::format("{} of the goals from goal {} on are ignored: they are in contact, or outside "
                    "of limits or constraints",
                    ignored, first + 1));
  }
  if (next < goals.size()) {
    resolved.notes.push_back(fmt::format(
        "the goals from goal {} on are ignored: a tenth of the time limit was over before they "
        "were checked",
        next + 1));
  }
}

/// Resolves further blocks until one has a goal, where the first block has none.
Result<ResolvedQuery> resolve_further(ResolvedQuery none) {
  const Query& query = none.query;
  const std::size_t count = query.problem.goals.size();
  std::size_t first = kBlock;
  for (; first < count && !query.is_over(); first += kBlock) {
    QueryChecker checked = MNEME_TRY(
        make_query_checker(none.checker, query.checker_settings(), block_of(query.problem, first)));
    // A cell belongs to its checker.
    auto cell = checked.notes.empty() ? none.cell : nullptr;
    auto resolved = resolve_in_time(query, {std::move(checked), std::move(cell)}, first);
    if (!resolved) break;
    ResolvedQuery found = MNEME_TRY(*std::move(resolved));
    if (found.refusal) continue;
    found.notes.insert(found.notes.begin(),
                       fmt::format("goals 1 to {} are ignored: {}", first, none.refusal->message));
    found.has_exact_pairs = found.has_exact_pairs || none.has_exact_pairs;
    add_valid_goals(first + kBlock, found);
    return found;
  }
  if (first < count) {
    end_early(query,
              fmt::format("no valid goal among the first {} of {} within the time limit: {}", first,
                          count, none.refusal->message),
              *none.refusal);
  } else {
    none.refusal->message += fmt::format("; no other of the {} goals is valid either", count);
  }
  return none;
}

}  // namespace

Result<ResolvedQuery> resolve_goals(const Query& query) {
  const Problem& problem = query.problem;
  const Stopwatch preparing;
  const CellChecker made = MNEME_TRY(find_or_make_checker(
      problem.robot, problem.scene, query.checker_settings(), block_of(problem, 0)));
  const double preparation_time_s = preparing.elapsed_s();
  query.stopwatch = Stopwatch();
  ResolvedQuery resolved = MNEME_TRY(resolve_first(query, made));
  resolved.preparation_time_s = preparation_time_s;
  if (problem.goals.size() <= kBlock) return resolved;
  if (!resolved.refusal) {
    add_valid_goals(kBlock, resolved);
  } else if (resolved.refusal->status == PlanStatus::invalid_goal) {
    Result<ResolvedQuery> further = resolve_further(std::move(resolved));
    if (further) further->preparation_time_s = preparation_time_s;
    return further;
  }
  return resolved;
}

SolveResult describe(const ResolvedQuery& resolved) {
  SolveResult result;
  result.goals = resolved.ends.goals;
  for (const GivenEnds::Goal& goal : resolved.given.goals) {
    std::ranges::replace(result.goals, goal.inside, goal.given);
  }
  result.notes = resolved.notes;
  if (resolved.has_exact_pairs) result.scene = resolved.checker.scene();
  result.preparation_time_s = resolved.preparation_time_s;
  result.planner = resolved.query.planner.name;
  result.sampler = resolved.query.sampler.name;
  result.seed = resolved.query.settings.plan.seed;
  result.isa = resolved.checker.isa();
  return result;
}

}  // namespace mneme::internal
