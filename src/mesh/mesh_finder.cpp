// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_finder.h"

#include "base/fail.h"
#include "base/files.h"
#include "base/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>

namespace mneme::internal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPackageText = std::size_t{1} << 20;

/// The rest of `text` after `prefix`, or nothing.
std::optional<std::string_view> after(std::string_view text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return std::nullopt;
  return text.substr(prefix.size());
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// `name` in `directory`, or where that is no file, what the name says as part of a URI.
fs::path find_decoded(const fs::path& directory, const fs::path& name) {
  const std::string decoded = percent_decoded(name.string());
  const bool is_name = decoded.find('\0') == std::string::npos;
  if (!is_file(directory / name) && is_name && is_file(directory / decoded)) {
    return directory / decoded;
  }
  return directory / name;
}

/// Without a slash at the end, so that its last component is a name.
fs::path as_directory(const fs::path& path) {
  std::error_code failure;
  const fs::path absolute = fs::absolute(path, failure).lexically_normal();
  if (failure) return path;
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

/// True if a relative path stays below where it starts.
bool stays_inside(const fs::path& path) {
  if (path.is_absolute()) return false;
  const fs::path normal = path.lexically_normal();
  return !normal.empty() && *normal.begin() != "..";
}

Result<std::string> no_file(const std::vector<std::string>& tried) {
  std::error_code ignored;
  for (const std::string& path : tried) {
    if (fs::is_directory(path, ignored)) {
      return fail(ErrorCode::io, "expected a file; {} is a directory", path);
    }
    if (fs::exists(path, ignored)) return fail(ErrorCode::io, "{}: expected a regular file", path);
  }
  return fail(ErrorCode::io, "there is no such file; searched: {}", fmt::join(tried, ", "));
}

}  // namespace

MeshFinder::MeshFinder(const std::string& urdf_path, const std::vector<std::string>& package_paths)
    : urdf_directory_(as_directory(fs::path(urdf_path).parent_path()).string()),
      package_paths_(package_paths) {
  for (const char* variable : {"ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"}) {
    std::ranges::move(directories_of_variable(variable), std::back_inserter(package_paths_));
  }
}

Result<std::string> MeshFinder::find(const std::string& name, std::string* unknown) const {
  auto found = find_named(name, unknown);
  if (found || name.find('\\') == std::string::npos) return found;
  std::string with_slashes = name;
  std::ranges::replace(with_slashes, '\\', '/');
  auto on_windows = find_named(with_slashes, unknown);
  return on_windows ? on_windows : found;
}

Result<std::string> MeshFinder::find_named(const std::string& name, std::string* unknown) const {
  for (const char* scheme : {"package://", "model://"}) {
    if (const auto rest = after(name, scheme)) return find_in_package(*rest, unknown);
  }
  fs::path path = find_decoded(urdf_directory_, name);
  if (auto rest = after(name, "file:")) {
    if (const auto local = after(*rest, "//localhost")) rest = local;
    if (const auto local = after(*rest, "//")) rest = local;
    if (!rest->starts_with('/')) {
      return fail(ErrorCode::unsupported, "expected an absolute path as file:///PATH");
    }
    path = find_decoded("", *rest);
  } else if (name.find("://") != std::string::npos) {
    return fail(ErrorCode::unsupported, "expected package://NAME/PATH, file:///PATH or a path");
  }
  if (!is_file(path)) return no_file({path.lexically_normal().string()});
  return path.lexically_normal().string();
}

namespace {

/// The <name> of DIRECTORY/package.xml; empty without one.
std::string package_name(const fs::path& directory) {
  if (!is_file(directory / "package.xml")) return {};
  tinyxml2::XMLDocument document;
  const auto text = read_text_file((directory / "package.xml").string(), kMaxPackageText);
  if (!text || find_costly_xml(*text)) return {};
  if (document.Parse(text->data(), text->size()) != tinyxml2::XML_SUCCESS) return {};
  const tinyxml2::XMLElement* root = document.RootElement();
  const tinyxml2::XMLElement* name = root ? root->FirstChildElement("name") : nullptr;
  return std::string(trimmed(name && name->GetText() ? name->GetText() : ""));
}

/// Folders of the package that `directory` is or contains.
std::vector<fs::path> package_folders(const fs::path& directory, const fs::path& package) {
  std::vector<fs::path> folders = {directory / package, directory / "share" / package,
                                   directory / package / "share" / package};
  if (directory.filename() == package || package_name(directory) == package) {
    folders.push_back(directory);
  }
  constexpr int kMostEntries = 10'000;
  std::vector<fs::path> below;
  std::error_code failure;
  fs::directory_iterator at(directory, failure);
  for (int i = 0; !failure && at != fs::end(at) && i < kMostEntries; at.increment(failure), ++i) {
    if (package_name(at->path()) == package) below.push_back(at->path());
  }
  std::ranges::sort(below);
  folders.insert(folders.end(), below.begin(), below.end());
  return folders;
}

/// Packages at any depth below `directory`, as rospack finds them: not within other packages.
/// Bounded for the case that a home directory is named.
std::vector<fs::path> find_below(const fs::path& directory, const fs::path& package) {
  constexpr int kMostLevels = 8, kMostEntries = 100'000;
  std::vector<fs::path> below;
  std::error_code failure;
  constexpr auto kOptions = fs::directory_options::skip_permission_denied;
  fs::recursive_directory_iterator at(directory, kOptions, failure);
  for (int i = 0; !failure && at != fs::end(at) && i < kMostEntries; at.increment(failure), ++i) {
    std::error_code ignored;
    if (!at->is_directory(ignored)) continue;
    const std::string name = package_name(at->path());
    if (name == package) below.push_back(at->path());
    const bool is_hidden = at->path().filename().string().starts_with('.');
    if (!name.empty() || is_hidden || at.depth() >= kMostLevels) at.disable_recursion_pending();
  }
  std::ranges::sort(below);
  return below;
}

}  // namespace

/// The folders that exist, searched once per package.
const std::vector<std::string>& MeshFinder::folders_of(const std::string& package) const {
  const auto [entry, is_new] = folders_.try_emplace(package);
  if (!is_new) return entry->second;
  std::vector<fs::path> folders;
  for (const std::string& directory : package_paths_) {
    std::ranges::move(package_folders(as_directory(directory), package),
                      std::back_inserter(folders));
  }
  for (fs::path above = urdf_directory_; above.has_relative_path(); above = above.parent_path()) {
    if (above.filename() == package || package_name(above) == package) folders.push_back(above);
  }
  std::error_code ignored;
  for (const fs::path& folder : folders) {
    if (fs::is_directory(folder, ignored)) entry->second.push_back(folder.string());
  }
  for (std::size_t i = 0; entry->second.empty() && i < package_paths_.size(); ++i) {
    for (const fs::path& folder : find_below(as_directory(package_paths_[i]), package)) {
      entry->second.push_back(folder.string());
    }
  }
  return entry->second;
}

/// Folders of the package in few folders above the URDF, the nearest first: packages lie side by
/// side in a workspace and in an install prefix.
const std::vector<std::string>& MeshFinder::folders_beside(const std::string& package) const {
  constexpr int kMostLevels = 6;
  const auto [entry, is_new] = beside_.try_emplace(package);
  fs::path above = urdf_directory_;
  for (int level = 0; is_new && level < kMostLevels && above.has_relative_path(); ++level) {
    for (const fs::path& folder : package_folders(above, package)) {
      std::error_code ignored;
      if (fs::is_directory(folder, ignored)) entry->second.push_back(folder.string());
    }
    above = above.parent_path();
  }
  return entry->second;
}

Result<std::string> MeshFinder::find_in_package(std::string_view name_and_path,
                                                std::string* unknown) const {
  // package:///NAME is common, and means the same.
  name_and_path.remove_prefix(std::min(name_and_path.find_first_not_of('/'), name_and_path.size()));
  const std::size_t slash = std::min(name_and_path.find('/'), name_and_path.size());
  const fs::path package = name_and_path.substr(0, slash);
  name_and_path.remove_prefix(
      std::min(name_and_path.find_first_not_of('/', slash), name_and_path.size()));
  const fs::path path = name_and_path;
  if (package.empty() || package == "." || package == ".." || path.empty()) {
    return fail(ErrorCode::parse, "expected package://NAME/PATH");
  }
  if (!stays_inside(path) || !stays_inside(percent_decoded(path.string()))) {
    return fail(ErrorCode::parse, "the path leaves the package '{}'", package.string());
  }
  std::vector<std::string> tried;
  for (const fs::path folder : folders_of(package.string())) {
    tried.push_back(find_decoded(folder, path).lexically_normal().string());
    if (is_file(tried.back())) return tried.back();
  }
  if (!tried.empty()) return no_file(tried);
  for (const fs::path folder : folders_beside(package.string())) {
    if (fs::path file = find_decoded(folder, path); is_file(file)) {
      return file.lexically_normal().string();
    }
  }
  fs::path above = urdf_directory_;
  for (int level = 0; unknown != nullptr && level < 3; ++level, above = above.parent_path()) {
    *unknown = package;
    if (fs::path file = find_decoded(above, path); is_file(file)) {
      return file.lexically_normal().string();
    }
  }
  return fail(ErrorCode::io,
              "there is no package '{}' in {}; expected its directory as package path "
              "(--package-path, package_paths), in ROS_PACKAGE_PATH or AMENT_PREFIX_PATH",
              package.string(),
              package_paths_.empty() ? "the folders above the URDF"
                                     : fmt::format("{}", fmt::join(package_paths_, ", ")));
}

}  // namespace mneme::internal
