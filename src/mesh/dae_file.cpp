// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Reads the surfaces of COLLADA 1.4 and 1.5. Nodes may instance others, so that a small file could
// expand without end: depth, steps and triangles are limited. Elements with several references are
// read once, so that time stays linear in the size of the file.
#include "base/fail.h"
#include "base/text.h"
#include "mesh/line_reader.h"
#include "mesh/mesh_file.h"
#include "mesh/surface_builder.h"

#include <tinyxml2.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace mneme::internal {
namespace {

using tinyxml2::XMLElement;

constexpr int kMostDepth = 100;
/// Elements that are visited when all instances are expanded.
constexpr std::size_t kMostSteps = 200'000;
/// Characters of a name or a reference that count as one step more, because each visit reads them.
constexpr std::size_t kStepCharacters = 256;

/// An affine transform.
struct Placement {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Vec3 offset = Vec3::Zero();

  Placement operator*(const Placement& o) const {
    return {linear * o.linear, linear * o.offset + offset};
  }
  Vec3 operator*(const Vec3& p) const { return linear * p + offset; }
};

class DaeReader {
 public:
  DaeReader(const tinyxml2::XMLDocument& document, SurfaceBuilder& surface)
      : root_(*document.RootElement()), surface_(surface) {
    index_ids(root_);
  }

  void read() {
    Placement scale;
    scale.linear *= find_unit();
    const XMLElement* scene = root_.FirstChildElement("scene");
    const XMLElement* instance =
        scene == nullptr ? nullptr : scene->FirstChildElement("instance_visual_scene");
    const XMLElement* library = root_.FirstChildElement("library_visual_scenes");
    const XMLElement* visual_scene = instance != nullptr ? &target(*instance, "url")
                                     : library != nullptr
                                         ? library->FirstChildElement("visual_scene")
                                         : nullptr;
    if (visual_scene != nullptr) return visit_children(*visual_scene, scale);
    // Without a scene, each geometry stands where it was modelled.
    for (const auto& [id, element] : elements_) {
      if (is_named(*element, "geometry")) add(*element, scale);
    }
  }

 private:
  static bool is_named(const XMLElement& element, std::string_view name) {
    return element.Name() == name;
  }

  template <class... Args>
  [[noreturn]] void fail(const XMLElement& element, fmt::format_string<Args...> what,
                         Args&&... args) const {
    throw_failure(ErrorCode::parse, "{}:{}: <{}>: {}", surface_.source(), element.GetLineNum(),
                  excerpt(element.Name()), fmt::format(what, std::forward<Args>(args)...));
  }

  void index_ids(const XMLElement& element) {
    if (const char* id = element.Attribute("id")) elements_.emplace(id, &element);
    for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      index_ids(*child);
    }
  }

  [[nodiscard]] double find_unit() const {
    const XMLElement* asset = root_.FirstChildElement("asset");
    const XMLElement* unit = asset == nullptr ? nullptr : asset->FirstChildElement("unit");
    const double meter = unit == nullptr ? 1 : attribute_or(*unit, "meter", 1.0);
    if (!(meter > 0 && std::isfinite(meter))) fail(*unit, "expected a positive length in metres");
    return meter;
  }

  template <class Number>
  [[nodiscard]] Number attribute_or(const XMLElement& element, const char* name,
                                    Number fallback) const {
    const char* text = element.Attribute(name);
    if (text == nullptr) return fallback;
    const auto number = parse_number<Number>(text);
    if (!number) fail(element, "{} is \"{}\", expected a number", name, excerpt(text));
    return *number;
  }

  /// The element that `attribute` refers to: "#ID".
  [[nodiscard]] const XMLElement& target(const XMLElement& element, const char* attribute) {
    const char* value = element.Attribute(attribute);
    const std::string_view reference = value == nullptr ? "" : value;
    count_steps(element, reference.size() / kStepCharacters);
    if (!reference.starts_with('#')) {
      fail(element, "{} is \"{}\", expected the id of an element in this file, such as \"#mesh\"",
           attribute, excerpt(reference));
    }
    const auto found = elements_.find(reference.substr(1));
    if (found == elements_.end())
      fail(element, "there is no element with the id in \"{}\"", excerpt(reference));
    return *found->second;
  }

  /// The text of all parts, with CDATA, between comments.
  [[nodiscard]] std::string text_of(const XMLElement& element) const {
    std::string text;
    for (const auto* node = element.FirstChild(); node != nullptr; node = node->NextSibling()) {
      if (node->ToText() != nullptr) text += node->Value();
      if (node->ToElement() != nullptr) {
        fail(element, "expected numbers, got <{}>", excerpt(node->Value()));
      }
    }
    return text;
  }

  template <class Number>
  [[nodiscard]] std::vector<Number> numbers_of(const XMLElement& element) const {
    std::vector<Number> numbers;
    const std::string text = text_of(element);
    for (std::string_view rest = text;;) {
      const std::size_t begin = rest.find_first_not_of(" \t\r\n");
      if (begin == rest.npos) return numbers;
      rest.remove_prefix(begin + (rest[begin] == '+' ? 1 : 0));
      Number number{};
      const auto [end, error] = number_from(rest.data(), rest.data() + rest.size(), number);
      if (error != std::errc()) fail(element, "expected numbers, got \"{}\"", rest.substr(0, 20));
      numbers.push_back(number);
      rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    }
  }

  [[nodiscard]] std::vector<double> numbers_of(const XMLElement& element, std::size_t count) const {
    std::vector<double> numbers = numbers_of<double>(element);
    if (numbers.size() != count)
      fail(element, "expected {} numbers, got {}", count, numbers.size());
    return numbers;
  }

  /// The transform of an element of a node; nothing for elements of other kinds.
  [[nodiscard]] std::optional<Placement> read_transform(const XMLElement& element) const {
    Placement X;
    if (is_named(element, "matrix")) {
      const std::vector<double> n = numbers_of(element, 16);
      X.linear << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
      X.offset = {n[3], n[7], n[11]};
    } else if (is_named(element, "translate")) {
      const std::vector<double> n = numbers_of(element, 3);
      X.offset = {n[0], n[1], n[2]};
    } else if (is_named(element, "scale")) {
      const std::vector<double> n = numbers_of(element, 3);
      X.linear = Vec3(n[0], n[1], n[2]).asDiagonal();
    } else if (is_named(element, "rotate")) {
      const std::vector<double> n = numbers_of(element, 4);
      const Vec3 axis(n[0], n[1], n[2]);
      if (axis.norm() > 0)
        X.linear = rotation_about(axis.normalized(), n[3] * std::numbers::pi / 180);
    } else if (is_named(element, "lookat")) {
      const std::vector<double> n = numbers_of(element, 9);
      X.offset = {n[0], n[1], n[2]};
      const Vec3 back = (X.offset - Vec3(n[3], n[4], n[5])).normalized();
      const Vec3 right = Vec3(n[6], n[7], n[8]).cross(back).normalized();
      X.linear << right, back.cross(right), back;
    } else if (is_named(element, "skew")) {
      fail(element, "is not supported; expected other transforms, such as <matrix>");
    } else {
      return std::nullopt;
    }
    return X;
  }

  /// The same, read once; null for elements of other kinds.
  [[nodiscard]] const Placement* find_transform(const XMLElement& element) {
    const auto [found, is_new] = transforms_.try_emplace(&element);
    if (is_new) found->second = read_transform(element);
    return found->second ? &*found->second : nullptr;
  }

  void visit_children(const XMLElement& parent, Placement X) {
    if (std::ssize(path_) >= kMostDepth) {
      fail(parent, "nests its nodes too deep, expected at most {} levels", kMostDepth);
    }
    if (std::ranges::find(path_, &parent) != path_.end())
      fail(parent, "this node contains an instance of itself");
    path_.push_back(&parent);
    for (const XMLElement* child = next_element(parent, parent.FirstChild()); child != nullptr;
         child = next_element(parent, child->NextSibling())) {
      if (const Placement* own = find_transform(*child)) {
        X = X * *own;
      } else if (is_named(*child, "node")) {
        visit_children(*child, X);
      } else if (is_named(*child, "instance_node")) {
        visit_children(target(*child, "url"), X);
      } else if (is_named(*child, "instance_geometry")) {
        add(target(*child, "url"), X);
      } else if (is_named(*child, "instance_controller")) {
        const XMLElement& controller = target(*child, "url");
        const XMLElement* skin = next_element(controller, controller.FirstChild());
        if (skin != nullptr && is_named(*skin, "skin")) add(target(*skin, "source"), X);
      }
    }
    path_.pop_back();
  }

  /// The first element from `node` on. Comments and texts before it are steps, too.
  const XMLElement* next_element(const XMLElement& parent, const tinyxml2::XMLNode* node) {
    for (; node != nullptr; node = node->NextSibling()) {
      const XMLElement* element = node->ToElement();
      const std::size_t length = element == nullptr ? 0 : std::string_view(element->Name()).size();
      count_steps(parent, 1 + length / kStepCharacters);
      if (element != nullptr) return element;
    }
    return nullptr;
  }

  void count_steps(const XMLElement& element, std::size_t steps) {
    steps_ += steps;
    if (steps_ > kMostSteps) {
      fail(element,
           "all <node> and <instance_node> together expand to more than {} elements, comments and "
           "parts of long names",
           kMostSteps);
    }
  }

  void add(const XMLElement& geometry, const Placement& X) {
    const auto [found, is_new] = corners_.try_emplace(&geometry);
    if (is_new) found->second = read_geometry(geometry);
    const std::vector<Vec3>& corners = found->second;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      surface_.add(X * corners[i], X * corners[i + 1], X * corners[i + 2]);
    }
  }

  /// Three corners per triangle.
  [[nodiscard]] std::vector<Vec3> read_geometry(const XMLElement& geometry) {
    std::vector<Vec3> corners;
    const XMLElement* mesh = geometry.FirstChildElement("mesh");
    if (mesh == nullptr) {
      const XMLElement* other = geometry.FirstChildElement();
      if (other != nullptr && !is_named(*other, "spline")) {
        fail(*other, "is not supported; expected a <mesh>");
      }
      return corners;
    }
    for (const XMLElement* child = mesh->FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      for (const std::string_view kind :
           {"triangles", "polylist", "polygons", "tristrips", "trifans"}) {
        if (is_named(*child, kind)) read_faces(*child, corners);
      }
    }
    return corners;
  }

  /// Points among the numbers of an array.
  struct Points {
    const std::vector<double>* numbers = nullptr;
    std::size_t offset = 0, stride = 3;

    [[nodiscard]] std::size_t size() const {
      return numbers->size() < offset ? 0 : (numbers->size() - offset) / stride;
    }
    [[nodiscard]] Vec3 operator[](std::size_t i) const {
      return Eigen::Map<const Vec3>(numbers->data() + offset + i * stride);
    }
  };
  /// Vertices, and where their indices are among the numbers of <p>.
  struct VertexInput {
    Points vertices;
    std::size_t offset = 0, stride = 1;
  };

  [[nodiscard]] VertexInput read_inputs(const XMLElement& faces) {
    VertexInput result;
    const XMLElement* vertices = nullptr;
    for (const XMLElement* input = faces.FirstChildElement("input"); input != nullptr;
         input = input->NextSiblingElement("input")) {
      const auto offset = attribute_or<std::size_t>(*input, "offset", 0);
      if (offset > 100) fail(*input, "expected an offset of at most 100");
      result.stride = std::max<std::size_t>(result.stride, offset + 1);
      if (input->Attribute("semantic", "VERTEX") == nullptr) continue;
      result.offset = offset;
      vertices = &target(*input, "source");
    }
    if (vertices == nullptr) fail(faces, "expected an <input> with the semantic VERTEX");
    const auto [found, is_new] = vertices_.try_emplace(vertices);
    if (is_new) found->second = read_vertices(*vertices);
    result.vertices = found->second;
    return result;
  }

  [[nodiscard]] Points read_vertices(const XMLElement& vertices) {
    for (const XMLElement* input = vertices.FirstChildElement("input"); input != nullptr;
         input = input->NextSiblingElement("input")) {
      if (input->Attribute("semantic", "POSITION") == nullptr) continue;
      const XMLElement& source = target(*input, "source");
      const auto [found, is_new] = sources_.try_emplace(&source);
      if (is_new) found->second = read_source(source);
      return found->second;
    }
    fail(vertices, "expected an <input> with the semantic POSITION");
  }

  [[nodiscard]] Points read_source(const XMLElement& source) {
    const XMLElement* technique = source.FirstChildElement("technique_common");
    const XMLElement* accessor =
        technique == nullptr ? nullptr : technique->FirstChildElement("accessor");
    if (accessor == nullptr) fail(source, "expected an <accessor>");
    const auto stride = attribute_or<std::size_t>(*accessor, "stride", 1);
    const auto offset = attribute_or<std::size_t>(*accessor, "offset", 0);
    if (stride < 3) fail(*accessor, "expected a stride of at least 3");
    const XMLElement& array = target(*accessor, "source");
    const auto [found, is_new] = arrays_.try_emplace(&array);
    if (is_new) found->second = numbers_of<double>(array);
    return {&found->second, offset, stride};
  }

  void read_faces(const XMLElement& faces, std::vector<Vec3>& corners) {
    if (const XMLElement* holed = faces.FirstChildElement("ph")) {
      fail(*holed, "a polygon with holes is not supported; triangulate the mesh before");
    }
    const VertexInput input = read_inputs(faces);
    std::vector<Vec3> all;
    const auto read_vertices = [&](const XMLElement& p) {
      all.clear();
      const auto indices = numbers_of<std::size_t>(p);
      if (indices.size() % input.stride != 0) {
        fail(p, "has {} indices, expected {} per vertex", indices.size(), input.stride);
      }
      for (std::size_t i = input.offset; i < indices.size(); i += input.stride) {
        if (indices[i] >= input.vertices.size()) {
          fail(p, "a face has the vertex {}, but there are {}", indices[i], input.vertices.size());
        }
        all.push_back(input.vertices[indices[i]]);
        if (all.size() > 6 * kMaxTriangles) surface_.fail_too_many();
      }
    };
    for (const XMLElement* p = faces.FirstChildElement("p"); p != nullptr;
         p = p->NextSiblingElement("p")) {
      read_vertices(*p);
      if (is_named(faces, "triangles")) {
        if (all.size() % 3 != 0) fail(*p, "has {} vertices, expected 3 per triangle", all.size());
        for (std::size_t i = 0; i + 2 < all.size(); i += 3) append(all, {i, i + 1, i + 2}, corners);
      } else if (is_named(faces, "tristrips")) {
        for (std::size_t i = 0; i + 2 < all.size(); ++i) append(all, {i, i + 1, i + 2}, corners);
      } else if (is_named(faces, "trifans")) {
        for (std::size_t i = 1; i + 1 < all.size(); ++i) append(all, {0, i, i + 1}, corners);
      } else if (is_named(faces, "polygons")) {
        append_polygon(all, corners);
      } else {
        if (const XMLElement* second = p->NextSiblingElement("p")) {
          fail(*second, "expected one <p> in a <polylist>");
        }
        append_polygons(faces, all, corners);
      }
    }
  }

  /// A <polylist>, which has one <p>: <vcount> has the number of corners of each polygon.
  void append_polygons(const XMLElement& faces, std::span<const Vec3> all,
                       std::vector<Vec3>& corners) {
    const XMLElement* counts = faces.FirstChildElement("vcount");
    if (counts == nullptr) fail(faces, "expected a <vcount>");
    for (const std::size_t count : numbers_of<std::size_t>(*counts)) {
      if (count > all.size()) fail(faces, "has fewer vertices than its <vcount> states");
      append_polygon(all.first(count), corners);
      all = all.subspan(count);
    }
    if (!all.empty()) fail(faces, "has {} vertices more than its <vcount> states", all.size());
  }

  void append_polygon(std::span<const Vec3> polygon, std::vector<Vec3>& corners) {
    for (const auto& triangle : surface_.triangulate(polygon)) {
      append(polygon, triangle, corners);
    }
  }

  void append(std::span<const Vec3> all, const std::array<std::size_t, 3>& triangle,
              std::vector<Vec3>& corners) {
    if (++triangles_ > kMaxTriangles) surface_.fail_too_many();
    for (const std::size_t i : triangle) corners.push_back(all[i]);
  }

  const XMLElement& root_;
  SurfaceBuilder& surface_;
  std::map<std::string_view, const XMLElement*> elements_;  ///< by id
  // Read so far:
  std::map<const XMLElement*, std::vector<double>> arrays_;
  std::map<const XMLElement*, Points> sources_, vertices_;
  std::map<const XMLElement*, std::optional<Placement>> transforms_;
  std::map<const XMLElement*, std::vector<Vec3>> corners_;  ///< of <geometry>
  std::vector<const XMLElement*> path_;                     ///< from the scene to a node
  std::size_t steps_ = 0, triangles_ = 0;
};

}  // namespace

void read_dae(std::string_view bytes, SurfaceBuilder& surface) {
  if (const auto flaw = find_costly_xml(bytes)) {
    throw_failure(ErrorCode::unsupported, "{}: {}", surface.source(), *flaw);
  }
  tinyxml2::XMLDocument document;
  if (document.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) {
    const bool is_deep = document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    throw_failure(ErrorCode::parse, "{}:{}: {}", surface.source(), document.ErrorLineNum(),
                  is_deep ? fmt::format("nests its elements too deep, expected at most {} levels",
                                        TINYXML2_MAX_ELEMENT_DEPTH)
                          : std::string("is no well-formed XML: ") + document.ErrorName());
  }
  if (document.RootElement() == nullptr ||
      document.RootElement()->Name() != std::string_view("COLLADA")) {
    throw_failure(ErrorCode::parse, "{}: expected a <COLLADA> element", surface.source());
  }
  DaeReader(document, surface).read();
}

}  // namespace mneme::internal
