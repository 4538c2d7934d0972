// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Many clients of one service for long: whatever they ask, send and leave, each answer is right,
/// and the process neither grows nor keeps files open.
///
///   service_soak [--seconds S] [--clients N] [--seed N]
#include "mneme/service.h"

#include "soak/endurance.h"
#include "support/planar_circles.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <numbers>
#include <string>
#include <thread>
#include <vector>
#include <unistd.h>

namespace mneme::soak {
namespace {

using Json = nlohmann::json;

struct Options {
  double seconds = 4;
  int clients = 8;
  std::uint64_t seed = 1;
};

constexpr int kRequestsPerRound = 60;  // of each client
constexpr int kMostRememberedRounds = 2;
constexpr std::int64_t kMostGrown = std::int64_t{8} << 20;
constexpr int kProblems = 12;

/// A problem of the planar arm, and what is known about it in this process.
struct Known {
  Problem problem;
  CollisionChecker checker;
};

/// The keys of a compact file for the only problem in it.
Json problem_keys(const std::string& compact_file) {
  return Json::parse(compact_file)["problems"][0];
}

Json scene_keys(const Scene& scene) {
  Json keys = problem_keys(to_compact_json({scene, ""}));
  keys.erase("name");
  return keys;
}

/// Counts of outcomes, and flaws.
class Ledger {
 public:
  void count(const std::string& what) {
    const std::lock_guard lock(mutex_);
    ++counts_[what];
  }
  void complain(const std::string& what) {
    const std::lock_guard lock(mutex_);
    if (complaints_.size() < 20) complaints_.push_back(what);
    ++complaint_count_;
  }
  void add_remembered() { ++remembered_; }
  [[nodiscard]] int remembered() const { return remembered_; }

  /// The number of complaints.
  int print() const {
    for (const auto& [what, count] : counts_) fmt::print("{:10} {}\n", count, what);
    for (const std::string& complaint : complaints_) fmt::print("  WRONG: {}\n", complaint);
    return complaint_count_;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, int> counts_;
  std::vector<std::string> complaints_;
  int complaint_count_ = 0;
  std::atomic<int> remembered_ = 0;
};

/// One client's requests of one round.
class Visit {
 public:
  Visit(const std::string& address, const std::vector<Known>& known, Ledger& ledger,
        std::uint64_t seed, int round)
      : address_(address), known_(known), ledger_(ledger), rng_(seed), seed_(seed), round_(round) {}

  void run() {
    httplib::Client client = connect(std::chrono::seconds(100));
    for (int i = 0; i < kRequestsPerRound; ++i) {
      const Known& known = known_[rng_.index(kProblems)];
      switch (i % 8) {
        case 3:
          check(client, known);
          break;
        case 4:
          reach(client, known);
          break;
        case 5:
          use_scene(client, known);
          break;
        case 6:
          leave();
          break;
        case 7:
          send_what_is_wrong(client, i);
          break;
        default:
          plan(client, known, i);
      }
    }
  }

 private:
  template <class Duration>
  [[nodiscard]] httplib::Client connect(Duration read_timeout) const {
    httplib::Client client(address_);
    client.set_keep_alive(true);
    client.set_tcp_nodelay(true);
    client.set_read_timeout(read_timeout);
    return client;
  }

  /// The answer, or null if it is not one of status 200, which is complained about.
  [[nodiscard]] Json ask(httplib::Client& client, const std::string& method,
                         const std::string& path, const Json& body) const {
    httplib::Request request;
    request.method = method;
    request.path = path;
    request.headers = {{"Content-Type", "application/json"}};
    request.body = body.dump();
    const auto answer = client.send(request);
    if (answer && answer->status == 200) return Json::parse(answer->body);
    complain(fmt::format("{} {}: {}", method, path, answer ? answer->body : "no answer"));
    return nullptr;
  }

  void complain(const std::string& what) const {
    ledger_.complain(fmt::format("round {}, seed {}: {}", round_, seed_, what));
  }

  /// True if there is a path, which this process finds free.
  void check_plan(const Known& known, const Json& plan) const {
    if (plan.is_null()) return;
    ledger_.count("plans, " + plan["status"].get<std::string>());
    if (!plan["solved"]) return;
    const auto path = plan["path"].get<Path>();
    CheckCounters counters;
    const bool is_free = find_invalid_motion(known.checker, path, counters) < 0;
    const bool is_whole = path.front() == known.problem.robot.normalized(known.problem.start);
    if (!is_free || !is_whole) complain("a path that is not free, or of another problem");
  }

  void plan(httplib::Client& client, const Known& known, int number) {
    Json body = problem_keys(to_compact_json(known.problem, ""));
    body["settings"] = {{"seed", rng_.index(1000000)},
                        {"max-iterations", 20000},
                        {"timeout", 50},
                        {"threads", number % 16 == 0 ? 2 : 1},
                        {"kind", "paths"}};
    if (round_ >= kMostRememberedRounds) body["settings"]["sampler"] = "uniform";
    const Json plan = ask(client, "POST", "/v1/plan", body);
    check_plan(known, plan);
    if (!plan.is_null() && plan["remembered"] == "queued") ledger_.add_remembered();
  }

  void check(httplib::Client& client, const Known& known) {
    Json body = scene_keys(known.problem.scene);
    body["configurations"] = Json::array();
    std::vector<Configuration> asked(20, Configuration(8));
    for (Configuration& q : asked) {
      for (double& value : q) value = rng_.uniform(-3, 3);
      body["configurations"].push_back(q);
    }
    const Json answer = ask(client, "POST", "/v1/check", body);
    if (answer.is_null()) return;
    ledger_.count("checks");
    const Json& states = answer["states"];
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const bool expected = known.checker.is_valid(std::span<const double>(asked[i]));
      if (states.at(i)["valid"] != expected) complain("check: another answer than here");
    }
  }

  void reach(httplib::Client& client, const Known& known) {
    PoseGoal goal;
    goal.link = "link_8";
    goal.pose.translation = {rng_.uniform(-9, 9), rng_.uniform(-9, 9), 0};
    goal.cone = goal.turn = std::numbers::pi;
    Json body = scene_keys(known.problem.scene);
    body["near"] = known.problem.start;
    body["goal"] = Json::parse(to_json(goal));
    const Json found = ask(client, "POST", "/v1/ik", body);
    if (found.is_null()) return;
    ledger_.count("inverse kinematics");
    for (const Json& solution : found["solutions"]) {
      const auto q = solution["q"].get<Configuration>();
      const bool is_there = pose_error(known.problem.robot, goal, q).position < 2e-4;
      const bool is_free = known.checker.is_valid(std::span<const double>(q));
      if (!is_there || !is_free) complain("ik: a configuration that is elsewhere or in contact");
    }
  }

  void use_scene(httplib::Client& client, const Known& known) {
    const std::string id = fmt::format("s{}", seed_), path = "/v1/scenes/" + id;
    if (ask(client, "PUT", path, scene_keys(known.problem.scene)).is_null()) return;
    const Json body = {
        {"start", known.problem.start},
        {"goals", known.problem.goals},
        {"scene", id},
        {"settings",
         {{"sampler", "uniform"}, {"seed", rng_.index(1000000)}, {"max-iterations", 20000}}}};
    check_plan(known, ask(client, "POST", "/v1/plan", body));
    static_cast<void>(ask(client, "PATCH", path, {{"circles", {{"far", {25, 0, 1}}}}}));
    static_cast<void>(ask(client, "DELETE", path, Json::object()));
    ledger_.count("scenes");
  }

  /// A client that loses patience while it is planned for.
  void leave() const {
    Json body = scene_keys(test::ring_with_two_windows());
    body["start"] = body["goal"] = Configuration(8, 0.0);
    body["goal"][0] = std::numbers::pi / 2;
    body["settings"] = {{"planner", "prm"}, {"sampler", "uniform"}, {"timeout", 50}};
    httplib::Client client = connect(std::chrono::milliseconds(20));
    if (client.Post("/v1/plan", body.dump(), "application/json")) {
      complain("a plan that nobody can find");
    }
    ledger_.count("clients that left");
  }

  void send_what_is_wrong(httplib::Client& client, int number) {
    static constexpr std::array kBodies = {
        "{", "[]", R"({"start": [0], "goal": [0], "gaol": 1})",
        R"({"start": [0], "goal": [0], "obstacles": [{"name": "a", "type": "mesh", "file": "/etc/passwd"}]})",
        R"({"start": "home", "goal": {"link": "moon", "position": [1, 2, 3]}})"};
    const char* body = kBodies[static_cast<std::size_t>(number) / 8 % kBodies.size()];
    const auto answer =
        client.Post(number % 16 < 8 ? "/v1/plan" : "/v1/ik", body, "application/json");
    if (!answer || answer->status != 400) complain("what is wrong was not refused");
    ledger_.count("wrong requests");
  }

  const std::string& address_;
  const std::vector<Known>& known_;
  Ledger& ledger_;
  Rng rng_;
  std::uint64_t seed_;
  int round_;
};

Result<std::vector<Known>> make_problems(const Robot& robot, std::uint64_t seed) {
  std::vector<Known> known;
  Rng rng(seed);
  const auto random = [&] {
    Configuration q(8);
    for (double& value : q) value = rng.uniform(-2, 2);
    return q;
  };
  while (known.size() < kProblems) {
    std::vector<std::array<double, 3>> circles;
    for (int i = 0; i < 4; ++i) {
      circles.push_back({rng.uniform(-8, 8), rng.uniform(-8, 8), rng.uniform(0.3, 1.2)});
    }
    Problem problem{.name = fmt::format("p{}", known.size()),
                    .robot = robot,
                    .scene = make_circle_scene("c", circles),
                    .start = random(),
                    .goals = {random()}};
    auto checker = CollisionChecker::make(robot, problem.scene);
    if (!checker) return tl::unexpected(checker.error());
    if (refuse_query(*checker, {problem.start, problem.goals})) continue;
    known.push_back({std::move(problem), *std::move(checker)});
  }
  return known;
}

void run_round(const std::string& address, const std::vector<Known>& known, const Options& options,
               int round, Ledger& ledger) {
  std::vector<std::jthread> clients;
  for (int i = 0; i < options.clients; ++i) {
    const auto number = static_cast<std::uint64_t>(round * options.clients + i);
    clients.emplace_back([&, number] {
      Visit(address, known, ledger, derive_seed(options.seed, number), round).run();
    });
  }
}

Round measure_round() {
  Round round;
  round.cpu_s = 1;
  round.rss = resident_bytes();
  round.open_files = open_files();
  return round;
}

/// Rounds until the time is over, at least kLeastRounds.
std::vector<Round> run_rounds(const std::string& address, const std::vector<Known>& known,
                              const Options& options, Ledger& ledger) {
  const Stopwatch stopwatch;
  std::vector<Round> rounds;
  while (rounds.size() < kLeastRounds || stopwatch.elapsed_s() < options.seconds) {
    run_round(address, known, options, static_cast<int>(rounds.size()), ledger);
    rounds.push_back(measure_round());
  }
  return rounds;
}

/// Errors: what could not even begin.
Result<int> soak_service(const Options& options, const std::string& directory) {
  const auto robot =
      find_robot("planar8").and_then([](const std::string& path) { return load_robot(path); });
  if (!robot) return tl::unexpected(robot.error());
  const auto known = make_problems(*robot, options.seed);
  if (!known) return tl::unexpected(known.error());
  auto opened = Database::open(directory + "/m.db", make_signature(*robot), OpenMode::create);
  if (!opened) return tl::unexpected(opened.error());
  const auto database = std::make_shared<Database>(*std::move(opened));
  ServiceSettings settings;
  settings.listen = "127.0.0.1:0";
  settings.threads = 2;
  settings.queue = 2 * options.clients;
  settings.remember_after = 200;
  auto service = Service::start(*robot, database, settings);
  if (!service) return tl::unexpected(service.error());

  Ledger ledger;
  const std::vector<Round> rounds = run_rounds(service->address(), *known, options, ledger);
  service->stop();
  const Drift drift = drift_of(rounds);
  fmt::print("{} rounds of {} clients; resident {:.1f} MiB, grown by {} bytes and {} files\n",
             rounds.size(), options.clients, static_cast<double>(rounds.back().rss) / (1 << 20),
             drift.grown_bytes, drift.grown_files);
  // Clients that left have not heard what their plans left in memory.
  const bool is_stored = database->flush().has_value() && database->queued_rows().lost == 0;
  if (!is_stored || database->size() < database->queued_rows().stored ||
      (database->size() == 0 && ledger.remembered() > 0)) {
    ledger.complain("memory lost what was answered");
  }
  int wrong = ledger.print();
  if (drift.grown_bytes > kMostGrown || drift.grown_files > 2) ++wrong;
  return wrong;
}

}  // namespace
}  // namespace mneme::soak

int main(int count, char** arguments) {
  mneme::soak::Options options;
  CLI::App app("Many clients of one service for long");
  app.add_option("--seconds", options.seconds, "how long, at least four rounds");
  app.add_option("--clients", options.clients, "at a time");
  app.add_option("--seed", options.seed, "of everything");
  CLI11_PARSE(app, count, arguments);
  std::string directory = (std::filesystem::temp_directory_path() / "mneme-soak-XXXXXX").string();
  if (::mkdtemp(directory.data()) == nullptr) return 2;
  const auto wrong = mneme::soak::soak_service(options, directory);
  std::filesystem::remove_all(directory);
  if (!wrong) return fmt::print(stderr, "soak: {}\n", wrong.error().message), 2;
  return *wrong == 0 ? 0 : 1;
}
