// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/visuals.h"

#include "base/files.h"
#include "mesh/mesh_file.h"
#include "robot/urdf_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

namespace mneme::internal {
namespace {

/// "#rrggbb" of a <material> with an rgba value; empty without one.
std::string color_of(const XmlElement* material) {
  const XmlElement* color = material ? material->FirstChildElement("color") : nullptr;
  const char* text = color ? color->Attribute("rgba") : nullptr;
  if (text == nullptr) return "";
  std::istringstream numbers(text);
  std::string written = "#";
  for (int i = 0; i < 3; ++i) {
    double value = 0;
    if (!(numbers >> value) || !std::isfinite(value)) return "";
    written += fmt::format("{:02x}", std::lround(255 * std::clamp(value, 0.0, 1.0)));
  }
  return written;
}

std::optional<Shape> shape_of(const Solid& solid) {
  const auto* file = std::get_if<MeshFile>(&solid);
  if (file == nullptr) {
    const auto* box = std::get_if<Box>(&solid);
    return box ? Shape(*box) : Shape(std::get<Cylinder>(solid));
  }
  auto triangles = read_triangles(file->path, file->scale, file->pose);
  if (!triangles) return std::nullopt;
  return Mesh{{}, std::make_shared<Parts<Triangle>>(*std::move(triangles)), 0};
}

/// The shape of a <visual> or <collision>.
std::optional<Shape> read_shape(const XmlElement& visual, const MeshFinder& meshes) {
  XmlReader xml("", XmlReader::Mode::lenient);
  Link link;
  if (!without_throwing([&] { read_collision(xml, meshes, visual, link); })) return std::nullopt;
  if (!link.spheres.empty()) return link.spheres.front();
  if (!link.capsules.empty()) return link.capsules.front();
  return link.solids.empty() ? std::nullopt : shape_of(link.solids.front());
}

std::map<std::string, std::string> named_colors(const XmlElement& robot) {
  std::map<std::string, std::string> colors;
  for (const XmlElement* material : children(robot, "material")) {
    if (const char* name = material->Attribute("name")) colors[name] = color_of(material);
  }
  return colors;
}

/// False if nothing was added.
bool add_shapes(const XmlElement& link, const char* kind, const MeshFinder& meshes,
                const std::map<std::string, std::string>& colors, std::vector<Visual>& visuals) {
  const std::size_t before = visuals.size();
  const bool is_checked = std::string_view(kind) == "collision";
  const char* name = link.Attribute("name");
  if (name == nullptr) return false;
  for (const XmlElement* element : children(link, kind)) {
    auto shape = read_shape(*element, meshes);
    // Checked spheres and capsules are displayed anyway.
    if (!shape || (is_checked && (std::holds_alternative<Sphere>(*shape) ||
                                  std::holds_alternative<Capsule>(*shape)))) {
      continue;
    }
    const XmlElement* material = element->FirstChildElement("material");
    std::string color = color_of(material);
    const char* named = material ? material->Attribute("name") : nullptr;
    const auto found = colors.find(named ? named : "");
    if (color.empty() && found != colors.end()) color = found->second;
    visuals.push_back({name, *std::move(shape), std::move(color)});
  }
  return visuals.size() > before;
}

}  // namespace

std::vector<Visual> read_visuals(const std::string& path,
                                 const std::vector<std::string>& package_paths) {
  std::vector<Visual> visuals;
  const auto text = read_text_file(path, kMaxRobotTextSize);
  tinyxml2::XMLDocument document;
  XmlReader xml(path);
  if (!text) return visuals;
  const auto robot = without_throwing([&] { return &xml.read_root(document, *text, "robot"); });
  if (!robot) return visuals;
  const MeshFinder meshes(path, package_paths);
  const auto colors = named_colors(**robot);
  for (const XmlElement* link : children(**robot, "link")) {
    if (!add_shapes(*link, "visual", meshes, colors, visuals)) {
      add_shapes(*link, "collision", meshes, colors, visuals);
    }
  }
  return visuals;
}

}  // namespace mneme::internal
