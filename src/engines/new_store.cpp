// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "engines/database_file.h"
#include "engines/open_store.h"
#include "engines/sqlite_store.h"
#include "store/row_check.h"

#include <unistd.h>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace mneme::internal {
namespace {

/// A store whose file is created with its first row, by this process or another one.
class NewStore final : public Store {
 public:
  NewStore(std::string name, RobotSignature robot, const std::atomic<bool>* stop)
      : name_(std::move(name)), path_(lasting_url(name_)), robot_(std::move(robot)), stop_(stop) {}

  const std::string& name() const override { return name_; }
  Result<int> schema_version() override {
    std::error_code error;
    if (file_ == nullptr && !std::filesystem::exists(path_, error)) return 0;
    MNEME_TRY(open());
    return file_->schema_version();
  }
  Result<RobotSignature> signature() override {
    MNEME_TRY(open());
    return file_->signature();
  }
  Result<void> create(const RobotSignature&) override { return open(); }
  Result<std::unique_ptr<StoreTransaction>> begin(Kind kind) override {
    MNEME_TRY(open());
    return file_->begin(kind);
  }
  Result<std::int64_t> bytes() override { return file_ == nullptr ? 0 : file_->bytes(); }
  const std::optional<std::string>& loss() const override { return loss_; }
  Result<void> check_structure(std::vector<Damage>& damages) override {
    MNEME_TRY(open());
    return file_->check_structure(damages);
  }
  Result<void> reclaim() override {
    MNEME_TRY(open());
    return file_->reclaim();
  }
  Result<void> set_signature(const RobotSignature& robot) override {
    MNEME_TRY(open());
    return file_->set_signature(robot);
  }

 private:
  /// Opens the file, and creates it unless another process already did.
  Result<void> open() {
    if (file_ != nullptr) return {};
    auto file = MNEME_TRY(
        open_sqlite_store(path_, OpenMode::create, LossCheck::refuse, kMigrationTimeoutMs, stop_));
    MNEME_TRY(file->create(robot_));
    const auto found = MNEME_TRY(file->signature());
    if (!is_same_robot(found, robot_)) return refuse_robot(name_, found, robot_);
    file_ = std::move(file);
    return {};
  }

  std::string name_;
  std::string path_;
  RobotSignature robot_;
  const std::atomic<bool>* stop_;
  std::unique_ptr<Store> file_;  // null until there is a file
  std::optional<std::string> loss_;
};

}  // namespace

Result<std::unique_ptr<Store>> new_sqlite_store(const std::string& path,
                                                const RobotSignature& robot,
                                                const std::atomic<bool>* stop) {
  MNEME_TRY(check_files(path));
  const auto directory = std::filesystem::path(lasting_url(path)).parent_path();
  if (::access(directory.c_str(), W_OK | X_OK) != 0) {
    return fail(ErrorCode::io, "{}: cannot be created in {}: {}; expected a writable directory",
                path, directory.string(), std::generic_category().message(errno));
  }
  return std::make_unique<NewStore>(path, robot, stop);
}

}  // namespace mneme::internal
