// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/axis_box.h"
#include "geometry/parts.h"
#include "mesh/mesh_file.h"
#include "spheres/solids.h"
#include "spheres/triangle_mesh.h"

#include <limits>

namespace mneme::test {
namespace {

using internal::TriangleMesh;

TEST_SUITE("unit") {
  TEST_CASE("a box has the area of its faces, its corners as bounds and no rim") {
    const TriangleMesh mesh = internal::triangulate(make_box({0.2, 0.4, 0.6}, {1, 2, 3}));
    CHECK(internal::surface_area(mesh) == doctest::Approx(2 * (0.08 + 0.12 + 0.24)));
    CHECK(internal::box_around(mesh).low.isApprox(Vec3(0.9, 1.8, 2.7)));
    CHECK(internal::box_around(mesh).high.isApprox(Vec3(1.1, 2.2, 3.3)));
    CHECK(internal::is_closed(mesh));
  }

  TEST_CASE("a box follows its pose") {
    Box box = make_box({2, 4, 6});
    box.pose.rotation = rotation_about(Vec3::UnitZ(), std::acos(0.0));
    CHECK(internal::box_around(internal::triangulate(box)).high.isApprox(Vec3(2, 1, 3)));
  }

  TEST_CASE("the prism of a cylinder lies outside it and has no rim") {
    const TriangleMesh mesh = internal::triangulate(Cylinder{{}, 0.5, 2});
    CHECK(internal::is_closed(mesh));
    for (const Triangle& t : mesh) {
      for (const Vec3& middle :
           std::array<Vec3, 3>{0.5 * (t.a + t.b), 0.5 * (t.b + t.c), 0.5 * (t.c + t.a)}) {
        if (std::abs(middle.z()) == 1.0) continue;
        CHECK(middle.head<2>().norm() >= 0.5 - 1e-12);
        CHECK(middle.head<2>().norm() < 0.502);
      }
    }
  }

  TEST_CASE("a missing triangle makes a rim, and so does one that is turned over") {
    TriangleMesh mesh = internal::triangulate(make_box({1, 1, 1}));
    std::swap(mesh[3].a, mesh[3].b);
    CHECK_FALSE(internal::is_closed(mesh));
    mesh.erase(mesh.begin() + 3);
    CHECK_FALSE(internal::is_closed(mesh));
  }
}

TEST_SUITE("law") {
  TEST_CASE("subdivision keeps the area and the rims, and leaves no long edge") {
    const TriangleMesh mesh = internal::triangulate(Cylinder{{}, 0.3, 1});
    const TriangleMesh pieces = internal::subdivide(mesh, 0.05);
    CHECK(pieces.size() > mesh.size());
    CHECK(internal::surface_area(pieces) == doctest::Approx(internal::surface_area(mesh)));
    for (const Triangle& t : pieces) {
      CHECK(std::max({(t.b - t.a).norm(), (t.c - t.b).norm(), (t.a - t.c).norm()}) <= 0.05);
    }
  }
}

Result<internal::TriangleMesh> read_mesh(const MeshFile& file) {
  return internal::read_triangles(file.path, file.scale, file.pose);
}

/// A DAE file with one triangle, (1 0 0) (0 1 0) (0 0 1), in a node with a matrix.
std::string make_dae(const std::string& unit, const std::string& up, const std::string& matrix) {
  return "<?xml version=\"1.0\"?>\n"
         "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">"
         "<asset><unit name=\"u\" meter=\"" +
         unit + "\"/><up_axis>" + up +
         "</up_axis></asset>"
         "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\">"
         "<float_array id=\"a\" count=\"9\">1 0 0 0 1 0 0 0 1</float_array>"
         "<technique_common><accessor source=\"#a\" count=\"3\" stride=\"3\">"
         "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>"
         "<param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
         "<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
         "<p>0 1 2</p></triangles></mesh></geometry></library_geometries>"
         "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\"><matrix>" +
         matrix +
         "</matrix><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
}

/// The same in as many nodes more.
std::string make_deep_dae(int nodes) {
  std::string dae = make_dae("1", "Z_UP", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  for (int i = 0; i < nodes; ++i) {
    dae.insert(dae.find("<node"), "<node>");
    dae.insert(dae.find("</visual_scene>"), "</node>");
  }
  return dae;
}

const TriangleMesh& box_mesh() {
  static const TriangleMesh kMesh = internal::triangulate(make_box({0.2, 0.4, 0.6}));
  return kMesh;
}

TEST_SUITE("unit") {
  TEST_CASE("text and binary STL give the same surface, without a rim") {
    const TemporaryDirectory files;
    write_file(files / "text.stl", to_text_stl(box_mesh()));
    write_file(files / "binary.STL", to_binary_stl(box_mesh()));
    for (const char* name : {"text.stl", "binary.STL"}) {
      const auto mesh = require(read_mesh({files / name, Vec3::Ones(), {}}));
      CHECK(mesh.size() == 12);
      CHECK(internal::is_closed(mesh));
      CHECK(internal::surface_area(mesh) == doctest::Approx(internal::surface_area(box_mesh())));
    }
  }

  TEST_CASE("polygons of an OBJ file become triangles; scale comes before pose") {
    const TemporaryDirectory files;
    write_file(files / "square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    const auto mesh =
        read_mesh({files / "square.obj", {2, 3, 1}, {Eigen::Matrix3d::Identity(), {1, 0, 5}}});
    REQUIRE(mesh.has_value());
    CHECK(mesh->size() == 2);
    CHECK(internal::box_around(*mesh).low.isApprox(Vec3(1, 0, 5)));
    CHECK(internal::box_around(*mesh).high.isApprox(Vec3(3, 3, 5)));
  }

  TEST_CASE("a DAE file's unit and nodes count, its up axis does not") {
    const TemporaryDirectory files;
    const std::string shifted = "1 0 0 10 0 1 0 20 0 0 1 30 0 0 0 1";
    for (const std::string up : {"Z_UP", "Y_UP", "X_UP"}) {
      write_file(files / "t.dae", make_dae("0.01", up, shifted));
      const auto mesh = require(read_mesh({files / "t.dae", Vec3::Ones(), {}}));
      REQUIRE(mesh.size() == 1);
      INFO(up);
      CHECK(internal::box_around(mesh).low.isApprox(Vec3(0.1, 0.2, 0.3), 1e-6));
      CHECK(internal::box_around(mesh).high.isApprox(Vec3(0.11, 0.21, 0.31), 1e-6));
    }
  }

  TEST_CASE("triangles without area, points and lines are left out") {
    const TemporaryDirectory files;
    write_file(files / "m.obj",
               "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\nl 1 2\np 3\n");
    CHECK(require(read_mesh({files / "m.obj", Vec3::Ones(), {}})).size() == 1);
  }

  TEST_CASE("meshes that cannot be used are refused with the file's name and the reason") {
    const TemporaryDirectory files;
    const std::string binary = to_binary_stl(box_mesh());
    TriangleMesh with_nan = box_mesh();
    with_nan[5].b.y() = std::numeric_limits<double>::quiet_NaN();
    TriangleMesh with_infinity = box_mesh();
    with_infinity[5].b.y() = std::numeric_limits<double>::infinity();
    struct Case {
      std::string name;
      std::optional<std::string> text;
      ErrorCode code;
      std::string reason;
    };
    const std::vector<Case> cases = {
        {"missing.stl", std::nullopt, ErrorCode::io, "No such file"},
        {"empty.stl", "", ErrorCode::parse, "is empty"},
        {"short.stl", binary.substr(0, 60), ErrorCode::parse, "ends before"},
        {"truncated.stl", binary.substr(0, binary.size() - 70), ErrorCode::parse, "ends before"},
        {"none.stl", "solid s\nendsolid s\n", ErrorCode::parse,
         "has no triangles, expected a surface"},
        {"zero.stl", binary.substr(0, 80) + std::string(4, '\0'), ErrorCode::parse,
         "has no triangles, expected a surface"},
        {"words.stl", "this is a letter, not a mesh", ErrorCode::parse, "ends before"},
        {"cut.stl", to_text_stl(box_mesh()).substr(0, 90), ErrorCode::parse, ""},
        {"nan.stl", to_binary_stl(with_nan), ErrorCode::parse, "expected coordinates within"},
        {"infinite.stl", to_binary_stl(with_infinity), ErrorCode::parse, "expected coordinates"},
        {"far.obj", "v 0 0 0\nv 5000 0 0\nv 0 1 0\nf 1 2 3\n", ErrorCode::parse, "within 1000 m"},
        {"flat.stl", to_binary_stl({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}}), ErrorCode::parse,
         "no triangle with an area"},
        {"points.obj", "v 0 0 0\nv 1 0 0\n", ErrorCode::parse, ""},
        {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", ErrorCode::parse, ""},
        {"deep.dae", make_deep_dae(300), ErrorCode::parse, "nests its elements too deep"},
        {"broken.dae", "<COLLADA><library_geometries>", ErrorCode::parse, ""},
        {"other.off", "off", ErrorCode::unsupported,
         "expected a file named .stl, .obj, .dae or .ply"},
    };
    for (const Case& c : cases) {
      if (c.text) write_file(files / c.name, *c.text);
      const Error error = require_error(read_mesh({files / c.name, Vec3::Ones(), {}}));
      INFO(c.name);
      INFO(error.message);
      CHECK(error.code == c.code);
      CHECK(contains(error.message, files / c.name));
      CHECK(contains(error.message, c.reason));
    }
    const auto directory = read_mesh({files / ".", Vec3::Ones(), {}});
    CHECK_FALSE(directory.has_value());
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the surface of a link is that of all its solids") {
    Link link;
    link.solids = {make_box({1, 1, 1}), make_box({2, 2, 2}, {5, 0, 0})};
    const auto surface = require(internal::link_surface(link));
    CHECK(internal::surface_area(surface) == doctest::Approx(6 + 24));
  }

  TEST_CASE("a link without a surface, or one that is not finite, is refused by name") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const std::vector<Solid>& solids :
         {std::vector<Solid>{},
          {make_box({0, 0, 0})},
          {Cylinder{{}, 0, 0}},
          {make_box({nan, 1, 1})},
          {make_box({1, 1, 1}), make_box({1, 1, 1}, {nan, 0, 0})}}) {
      Link link;
      link.name = "wrist";
      link.solids = solids;
      const Error error = require_error(internal::link_surface(link));
      CHECK(error.code == ErrorCode::invalid);
      CHECK(contains(error.message, "link 'wrist'"));
    }
  }

  TEST_CASE("a link in millimetres is refused, which would be searched for ever") {
    Link link;
    link.name = "wrist";
    link.solids = {make_box({10, 400, 10})};
    const Error error = require_error(internal::link_surface(link));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(contains(error.message, "link 'wrist': its collision geometry is 400 m long"));
    CHECK(contains(error.message, "scale of 0.001"));
  }
}

}  // namespace
}  // namespace mneme::test
