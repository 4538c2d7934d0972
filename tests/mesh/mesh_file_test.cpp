// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "geometry/axis_box.h"
#include "mesh/mesh_file.h"
#include "mesh/surface_builder.h"
#include "support/support.h"

#include <fmt/format.h>

#include <sys/stat.h>
#include <cmath>
#include <cstring>
#include <numbers>

namespace mneme::internal {
namespace {

using test::contains;
using test::require;
using test::require_error;

using Surface = std::vector<Triangle>;

double area_of(const Surface& surface) {
  double area = 0;
  for (const Triangle& t : surface) area += t.area();
  return area;
}

Surface read(const std::string& bytes, const std::string& path) {
  return require(parse_triangles(bytes, path, Vec3::Ones(), {}));
}

std::string refusal(const std::string& bytes, const std::string& path) {
  return require_error(parse_triangles(bytes, path, Vec3::Ones(), {})).message;
}

/// A number as `size` bytes, the least significant one first unless `is_big`.
template <class Number>
std::string bytes_of(Number number, bool is_big = false) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  if (is_big) std::ranges::reverse(bytes);
  return bytes;
}

std::string ply_header(const std::string& format, const std::string& count = "4") {
  return "ply\nformat " + format + " 1.0\ncomment c\nelement vertex " + count +
         "\nproperty float x\nproperty uchar red\nproperty double y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string binary_ply(bool is_big) {
  std::string ply = ply_header(is_big ? "binary_big_endian" : "binary_little_endian");
  for (const auto& [x, y] : {std::pair(0.0f, 0.0), {2.0f, 0.0}, {2.0f, 3.0}, {0.0f, 3.0}}) {
    ply += bytes_of(x, is_big) + "\x07" + bytes_of(y, is_big) + bytes_of(0.5f, is_big);
  }
  ply += "\x04";
  for (const int i : {0, 1, 2, 3}) ply += bytes_of(i, is_big);
  return ply;
}

TEST_SUITE("unit") {
  TEST_CASE("A polygon of PLY is the same as text and in both byte orders") {
    const std::string text =
        ply_header("ascii") + "0 7 0 .5\n2 7 0 .5\n2 7 3 .5\n0 7 3 .5\n4 0 1 2 3\n";
    for (const std::string& ply : {text, binary_ply(false), binary_ply(true)}) {
      const Surface surface = read(ply, "a.ply");
      CHECK(surface.size() == 2);
      CHECK(area_of(surface) == doctest::Approx(6));
      CHECK(box_around(surface).low == Vec3(0, 0, 0.5));
    }
  }

  TEST_CASE("Elements of PLY that have no surface are passed over, strips are triangles") {
    const std::string ply =
        "ply\nformat ascii 1.0\nelement camera 2\nproperty list int float a\nproperty int b\n"
        "element empty 123456789012\nelement vertex 4\nproperty int x\nproperty int y\nproperty "
        "int z\n"
        "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
        "2 1.5 2.5 3\n0 3\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n7 0 1 2 3 -1 0 1\n";
    CHECK(area_of(read(ply, "a.ply")) == doctest::Approx(1));
  }

  TEST_CASE("Faces of OBJ may count back, have normals, and go on in the next line") {
    const std::string obj =
        "mtllib m.mtl\r\nv 0 0 0 1.0\r\nv 2 0 0\nv 2 2 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 \\\n 3/1\n"
        "v 0 2 0\ng part\nf -4 -2 -1 # back\nf 1 2\nl 1 2\n";
    CHECK(area_of(read(obj, "a.OBJ")) == doctest::Approx(4));
    CHECK(refusal("v 0 0 0\nv 1 0 0\nf 1 2 3\n", "a.obj") ==
          "mesh a.obj:3: a face has the vertex 3, but there are 2");
    CHECK(refusal("v 0 0\n", "a.obj") == "mesh a.obj:1: expected \"v X Y Z\"");
  }

  TEST_CASE("Faces may come before their vertices") {
    const std::string obj = "f 1 2 3 4\nv 0 0 0\nv 2 0 0\nf 1 2\nv 2 2 0\nf -3 -2 -1\nv 0 2 0\n";
    CHECK(area_of(read(obj, "a.obj")) == doctest::Approx(6));
    CHECK(refusal("v 0 0 0\nf 1 2 3\nv 1 0 0\n", "a.obj") ==
          "mesh a.obj:2: a face has the vertex 3, but there are 2");
    const std::string lists = "property list uchar int vertex_indices\n";
    const std::string ply =
        "ply\nformat ascii 1.0\nelement tristrips 1\n" + lists + "element face 2\n" + lists +
        "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        "4 0 1 3 2\n4 0 1 2 3\n0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n";
    CHECK(area_of(read(ply, "a.ply")) == doctest::Approx(8));
    CHECK(refusal(std::string(ply).replace(ply.find("4 0 1 2 3"), 9, "4 0 1 2 4"), "a.ply") ==
          "mesh a.ply: a face has the vertex 4, but there are 4");
  }

  TEST_CASE("Binary STL of more triangles than it announces is refused") {
    const std::string facet(50, '\1');
    const std::string head = std::string(80, ' ') + std::string("\1\0\0\0", 4) + facet;
    CHECK(refusal(head + facet + facet, "a.stl") ==
          "mesh a.stl: announces 1 triangles, and 100 bytes follow them, enough for 2 more: write "
          "the file anew with the right count, or without these bytes");
  }

  TEST_CASE("STL is text with any letters, or binary whatever its header says") {
    const std::string text =
        "  SOLID a b\r\nFACET NORMAL 0 0 1\nouter loop\nvertex 0 0 0\nvertex +2 0 0\nVertex 0 1e0 "
        "0\n"
        "endloop\nendfacet\nendsolid\nsolid c\nendsolid c\n";
    CHECK(area_of(read(text, "a.stl")) == doctest::Approx(1));
    std::string binary = std::string("solid") + std::string(75, '\0') + bytes_of(1u);
    for (const float x : {0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 1, 0}) binary += bytes_of(x);
    binary += std::string(2, '\0');
    CHECK(area_of(read(binary, "a.stl")) == doctest::Approx(1));
    CHECK(area_of(read(binary + "more", "a.stl")) == doctest::Approx(1));
    CHECK(refusal("solid a\nfacet normal 0 0 1\nvertex 0 0 0\nendfacet\n", "a.stl") ==
          "mesh a.stl:4: expected a facet with 3 vertices, got 1");
  }
}

/// COLLADA with a square of side 2 and `faces` of it, in `nodes`.
std::string make_dae(const std::string& faces, const std::string& nodes) {
  return "<COLLADA><asset><unit meter=\"0.5\"/></asset><library_geometries><geometry "
         "id=\"g\"><mesh>"
         "<source id=\"p\"><float_array id=\"a\" count=\"999\">0 0 0 2 0 0 2 2 0 0 2 "
         "0</float_array>"
         "<technique_common><accessor source=\"#a\" stride=\"3\"/></technique_common></source>"
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>" +
         faces +
         "</mesh></geometry></library_geometries><library_controllers><controller id=\"c\">"
         "<skin source=\"#g\"/></controller></library_controllers><library_nodes>" +
         nodes +
         "</library_nodes><library_visual_scenes><visual_scene id=\"s\"><node>"
         "<instance_node url=\"#n\"/></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}

const std::string kInputs =
    "<input semantic=\"NORMAL\" source=\"#p\" offset=\"0\"/>"
    "<input semantic=\"VERTEX\" source=\"#v\" offset=\"1\"/>";
const std::string kSquare = "<polygons>" + kInputs + "<p>0 0 0 1 0 2 0 3</p></polygons>";
const std::string kNode = "<node id=\"n\"><instance_geometry url=\"#g\"/></node>";

TEST_SUITE("unit") {
  TEST_CASE("Each kind of faces of COLLADA gives the square, in the file's unit") {
    for (const std::string& faces :
         {kSquare,
          "<polylist>" + kInputs + "<vcount>3 3</vcount><p>0 0 0 1 0 2 0 0 0 2 0 3</p></polylist>",
          "<triangles>" + kInputs + "<p>0 0 0 1 0 2 0 0 0 2 0 3</p></triangles>",
          "<tristrips>" + kInputs + "<p>0 0 0 1 0 3 0 2</p></tristrips>",
          "<trifans>" + kInputs + "<p>0 0 0 1 0 2 0 3</p></trifans>"}) {
      CAPTURE(faces);
      const Surface surface = read(make_dae(faces, kNode), "a.dae");
      CHECK(surface.size() == 2);
      CHECK(area_of(surface) == doctest::Approx(1));
    }
  }

  TEST_CASE("Numbers of COLLADA go on after comments and CDATA") {
    for (const char* p : {"<p>0 0 0 1 0 2 0 0<!-- c --> 0 2 0 3</p>",
                          "<p><!-- c -->0 0 0 1 <![CDATA[0 2 0 0 0 2 0]]> 3</p>"}) {
      const std::string faces = "<triangles>" + kInputs + p + "</triangles>";
      CHECK(area_of(read(make_dae(faces, kNode), "a.dae")) == doctest::Approx(1));
    }
  }

  TEST_CASE("COLLADA whose surface would be lost in part is refused with its line") {
    const auto fault = [](const std::string& kind, const std::string& rest) {
      return refusal(make_dae("<" + kind + ">" + kInputs + rest + "</" + kind + ">", kNode),
                     "a.dae");
    };
    CHECK(fault("polylist", "<vcount>3</vcount><p>0 0 0 1 0 2 0 0 0 2 0 3</p>") ==
          "mesh a.dae:1: <polylist>: has 3 vertices more than its <vcount> states");
    CHECK(fault("polylist", "<vcount>3</vcount><p>0 0 0 1 0 2</p><p>0 0 0 1 0 2</p>") ==
          "mesh a.dae:1: <p>: expected one <p> in a <polylist>");
    CHECK(fault("triangles", "<p>0 0 0 1 0 2 0 3</p>") ==
          "mesh a.dae:1: <p>: has 4 vertices, expected 3 per triangle");
    CHECK(fault("triangles", "<p>0 0 0 1 0 2 0</p>") ==
          "mesh a.dae:1: <p>: has 7 indices, expected 2 per vertex");
    CHECK(fault("triangles", "<p>0 0 0 1 0 <b/>2</p>") ==
          "mesh a.dae:1: <p>: expected numbers, got <b>");
    CHECK(fault("polygons", "<ph><p>0 0 0 1 0 2</p><h>0 0 0 1 0 2</h></ph>") ==
          "mesh a.dae:1: <ph>: a polygon with holes is not supported; triangulate the mesh before");
    std::string unit = make_dae(kSquare, kNode);
    unit.replace(unit.find("0.5"), 3, "abc");
    CHECK(refusal(unit, "a.dae") == "mesh a.dae:1: <unit>: meter is \"abc\", expected a number");
    CHECK(refusal("<COLLADA><library_geometries><geometry id=\"g\"><convex_mesh/></geometry>"
                  "</library_geometries></COLLADA>",
                  "a.dae") == "mesh a.dae:1: <convex_mesh>: is not supported; expected a <mesh>");
  }

  TEST_CASE("Nodes place what they instance, transforms apply from the last to the first") {
    const std::string node =
        "<node id=\"n\"><translate>10 0 0</translate><rotate>0 0 1 90</rotate><scale>1 3 1</scale>"
        "<node><matrix>1 0 0 0 0 1 0 0 0 0 1 4 0 0 0 1</matrix>"
        "<instance_controller url=\"#c\"/></node></node>";
    const AxisBox box = box_around(read(make_dae(kSquare, node), "a.dae"));
    // x in 0..2, y in 0..6 turned to x in -6..0, y in 0..2; then moved, and halved by the unit.
    CHECK(box.low.isApprox(Vec3(2, 0, 2), 1e-9));
    CHECK(box.high.isApprox(Vec3(5, 1, 2), 1e-9));
  }

  TEST_CASE("A node that looks at a point has its z axis pointing away from it") {
    const std::string node =
        "<node id=\"n\"><lookat>4 0 0 0 0 0 0 0 1</lookat><instance_geometry url=\"#g\"/></node>";
    const AxisBox box = box_around(read(make_dae(kSquare, node), "a.dae"));
    // x to y, y to z; halved by the unit.
    CHECK(box.low.isApprox(Vec3(2, 0, 0), 1e-9));
    CHECK(box.high.isApprox(Vec3(2, 1, 1), 1e-9));
  }

  TEST_CASE("COLLADA that refers to what is not there is refused with line and element") {
    CHECK(refusal(make_dae(kSquare, ""), "a.dae") ==
          "mesh a.dae:1: <instance_node>: there is no element with the id in \"#n\"");
    CHECK(contains(
        refusal(make_dae(kSquare, "<node id=\"n\"><instance_geometry url=\"b.dae#g\"/></node>"),
                "a.dae"),
        "expected the id of an element in this file"));
    CHECK(refusal(make_dae("<triangles>" + kInputs + "<p>0 0 0 1 0 9</p></triangles>", kNode),
                  "a.dae") == "mesh a.dae:1: <p>: a face has the vertex 9, but there are 4");
    CHECK(contains(refusal("<COLLADA>\n<a></COLLADA>", "a.dae"), ": is no well-formed XML"));
    CHECK(refusal("<svg/>", "a.dae") == "mesh a.dae: expected a <COLLADA> element");
  }

  TEST_CASE("Nodes that instance themselves, or expand without end, are refused at once") {
    CHECK(contains(refusal(make_dae(kSquare,
                                    "<node id=\"n\"><instance_node url=\"#m\"/></node>"
                                    "<node id=\"m\"><instance_node url=\"#n\"/></node>"),
                           "a.dae"),
                   "this node contains an instance of itself"));
    std::string doubling = "<node id=\"n\"><instance_node url=\"#n0\"/></node>";
    for (int i = 0; i < 60; ++i) {
      const std::string next = "<instance_node url=\"#n" + std::to_string(i + 1) + "\"/>";
      doubling += "<node id=\"n" + std::to_string(i) + "\">" + next + next + "</node>";
    }
    CHECK(contains(refusal(make_dae(kSquare, doubling + "<node id=\"n60\"/>"), "a.dae"),
                   "expand to more than"));
    std::string chain = "<node id=\"n\"><instance_node url=\"#n0\"/></node>";
    for (int i = 0; i < 5000; ++i) {
      chain += "<node id=\"n" + std::to_string(i) + "\"><instance_node url=\"#n" +
               std::to_string(i + 1) + "\"/></node>";
    }
    CHECK(contains(refusal(make_dae(kSquare, chain), "a.dae"), "nests its nodes too deep"));
  }

  TEST_CASE("Names, references and comments in nodes with many instances count as steps") {
    // 4096 visits of n12.
    const auto expanded = [](const std::string& content, const std::string& other) {
      std::string nodes =
          "<node id=\"n\"><instance_geometry url=\"#g\"/><instance_node url=\"#n0\"/></node>";
      for (int i = 0; i < 12; ++i) {
        const std::string next = fmt::format("<instance_node url=\"#n{}\"/>", i + 1);
        nodes += fmt::format("<node id=\"n{}\">{}{}</node>", i, next, next);
      }
      return make_dae(kSquare, nodes + "<node id=\"n12\">" + content + "</node>" + other);
    };
    const auto is_refused = [](const std::string& dae) {
      const auto surface = parse_triangles(dae, "a.dae", Vec3::Ones(), {});
      return !surface && surface.error().message.find("expand to more than") != std::string::npos;
    };
    const std::string longest(60000, 'a');
    CHECK_FALSE(is_refused(expanded("<a/><!-- c -->", "")));
    CHECK(is_refused(expanded("<" + longest + "/>", "")));
    CHECK_FALSE(is_refused(expanded("<instance_node url=\"#m\"/>", "<node id=\"m\"/>")));
    CHECK(is_refused(
        expanded("<instance_node url=\"#" + longest + "\"/>", "<node id=\"" + longest + "\"/>")));
    std::string comments;
    for (int i = 0; i < 100; ++i) comments += "<!---->";
    CHECK(is_refused(expanded(comments, "")));
    const std::string controller = "<instance_controller url=\"#k\"/>";
    CHECK(is_refused(expanded(controller, "<controller id=\"k\">" + comments + "</controller>")));
  }

  TEST_CASE("Elements may stand for others only in their own place") {
    const std::string own =
        "<triangles><input semantic=\"VERTEX\" source=\"#w\" offset=\"0\"/><p>0 1 2</p></triangles>"
        "<vertices id=\"w\"><input semantic=\"POSITION\" source=\"#w\"/></vertices>";
    CHECK(contains(refusal(make_dae(own, kNode), "a.dae"), "expected an <accessor>"));
  }

  TEST_CASE("XML that would take a parser for ever is refused before it") {
    std::string attributes = "<COLLADA";
    for (int i = 0; i < 100000; ++i) attributes += " a" + std::to_string(i) + "=\"<\"";
    CHECK(refusal(attributes + "/>", "a.dae") ==
          "mesh a.dae: has an element with more than 100 attributes");
    CHECK(refusal("<!-- ' --><!x ' >" + attributes + "/>", "a.dae") ==
          "mesh a.dae: has an element with more than 100 attributes");
    std::string elements = "<COLLADA>";
    for (int i = 0; i < 2000000; ++i) elements += "<a/>";
    CHECK(contains(refusal(elements + "</COLLADA>", "a.dae"),
                   "XML elements and attributes, expected at most"));
    std::string deep;
    for (int i = 0; i < 20000; ++i) deep += "<node>";
    CHECK(contains(refusal("<COLLADA>" + deep, "a.dae"), "nests its elements too deep"));
  }

  TEST_CASE("Counts and lengths that a file only announces take neither time nor memory") {
    CHECK(refusal(ply_header("ascii", "999999999999") + "0 0 0 0\n", "a.ply") ==
          "mesh a.ply: ends before all elements that it announces");
    CHECK(refusal(ply_header("binary_little_endian", "999999999999") + "0 0 0 0\n", "a.ply") ==
          "mesh a.ply: ends before all elements that it announces");
    const std::string list =
        "ply\nformat binary_big_endian 1.0\nelement face 1\nproperty list uint char "
        "a\nend_header\n";
    CHECK(refusal(list + "\xff\xff\xff\xff..", "a.ply") ==
          "mesh a.ply: ends before all elements that it announces");
    const std::string face =
        "ply\nformat binary_big_endian 1.0\nelement NAME 1\nproperty list uint char "
        "vertex_indices\nend_header\n";
    for (const char* name : {"face", "tristrips"}) {
      const std::string named = std::string(face).replace(face.find("NAME"), 4, name);
      CHECK(refusal(named + "\xff\xff\xff\xff", "a.ply") ==
            "mesh a.ply: has too many triangles, expected at most 1000000");
    }
    const std::string negative =
        "ply\nformat ascii 1.0\nelement face 1\nproperty list int char a\nend_header\n-3 1\n";
    CHECK(refusal(negative, "a.ply") == "mesh a.ply: has a list of length -3");
    const std::string stl = std::string(80, '\0') + "\xff\xff\xff\xff";
    CHECK(refusal(stl, "a.stl") ==
          "mesh a.stl: ends before the 4294967295 triangles that it announces");
    CHECK(
        refusal(ply_header("ascii") + "0 7 0 .5\n2 7 0 .5\n2 7 3 .5\n0 7 3 .5\n3 0 1 4294967295\n",
                "a.ply") == "mesh a.ply: a face has the vertex 4294967295, but there are 4");
  }

  TEST_CASE("A pipe is refused without waiting for it, and a mesh opens no other file") {
    const test::TemporaryDirectory files;
    REQUIRE(mkfifo((files / "pipe.stl").c_str(), 0600) == 0);
    const Error error = require_error(read_triangles(files / "pipe.stl", Vec3::Ones(), {}));
    CHECK(error.code == ErrorCode::io);
    CHECK(error.message == "mesh " + (files / "pipe.stl") + ": expected a regular file");
    REQUIRE(mkfifo((files / "m.mtl").c_str(), 0600) == 0);
    test::write_file(files / "a.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    CHECK(read_triangles(files / "a.obj", Vec3::Ones(), {}).value().size() == 1);
  }

  TEST_CASE("A byte order mark, lines that end with CR, and NULs behind text of STL are no part") {
    const std::string mark = "\xef\xbb\xbf", obj = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 9 9 9\nf 1 2 3\n";
    CHECK(area_of(read(mark + obj, "a.obj")) == doctest::Approx(2));
    std::string carriage = obj;
    std::ranges::replace(carriage, '\n', '\r');
    CHECK(area_of(read(carriage, "a.obj")) == doctest::Approx(2));
    const std::string stl =
        "solid a\nfacet\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 2 0\nendfacet\nendsolid\n";
    CHECK(area_of(read(mark + stl + std::string(100, '\0'), "a.stl")) == doctest::Approx(2));
    CHECK(contains(refusal("# comment\n" + stl + stl, "a.stl"), "does not begin with \"solid\""));
    const std::string ply =
        ply_header("ascii") + "0 7 0 .5\n2 7 0 .5\n2 7 3 .5\n0 7 3 .5\n4 0 1 2 3\n";
    CHECK(area_of(read(mark + ply, "a.ply")) == doctest::Approx(6));
    CHECK(refusal("version https://git-lfs.github.com/spec/v1\noid", "a.stl") ==
          "mesh a.stl: is a pointer of Git LFS; fetch the file: git lfs pull");
  }

  TEST_CASE("Files without a surface are empty, malformed ones are not") {
    const test::TemporaryDirectory files;
    const auto is_empty = [&](const std::string& name, const std::string& bytes) {
      test::write_file(files / name, bytes);
      return is_empty_mesh(files / name);
    };
    const std::string flat = "v 0 0 0\nv 1 0 0\nv 2 0 0\n";
    CHECK(is_empty("a.stl", ""));
    CHECK(is_empty("a.stl", std::string(80, '\0')));
    CHECK(is_empty("a.stl", std::string(84, '\0')));
    CHECK(is_empty("a.stl", "solid a\nendsolid a\n"));
    CHECK(is_empty("a.obj", flat));
    CHECK(is_empty("a.obj", flat + "f 1 2 3\n"));
    CHECK(is_empty("a.ply",
                   "ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int "
                   "vertex_indices\nend_header\n"));
    CHECK(is_empty("a.dae", "<COLLADA/>"));
    CHECK_FALSE(is_empty("a.obj", flat + "v 0 1 0\nf 1 2 4\n"));
    CHECK_FALSE(is_empty("a.obj", flat + "f 1 2 9\n"));
    CHECK_FALSE(is_empty("a.stl", std::string(79, '\0')));
    CHECK_FALSE(is_empty("a.txt", ""));
    CHECK_FALSE(is_empty_mesh(files / "none.stl"));
  }

  TEST_CASE("A concave polygon is covered once, one with very many corners is refused") {
    // An L of area 3.
    const std::string obj = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 3 4 5 6 1 2\n";
    CHECK(area_of(read(obj, "a.obj")) == doctest::Approx(3));
    std::string star, face = "f";
    for (int i = 0; i < 500; ++i) {
      const double angle = 2 * std::numbers::pi * i / 500, r = i % 2 == 0 ? 1 : 2;
      star += fmt::format("v {} {} 0\n", r * std::cos(angle), r * std::sin(angle));
      face += fmt::format(" {}", i + 1);
    }
    CHECK(contains(refusal(star + face, "a.obj"), "concave polygon with 500 corners"));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("Polygons are refused before their triangles are built") {
    const std::string source = "mesh a.obj";
    SurfaceBuilder surface(source, Vec3::Ones(), {});
    const std::vector<Vec3> corners(kMaxTriangles + 3, Vec3::Zero());
    CHECK(surface.triangulate(std::span(corners).first(kMaxTriangles + 2)).size() == kMaxTriangles);
    CHECK_THROWS(static_cast<void>(surface.triangulate(corners)));
  }

  TEST_CASE("The steps to triangulate the concave polygons of a file are limited") {
    // A comb, whose ears are found late.
    std::string vertices, face = "f";
    for (int i = 0; i < 398; ++i) {
      vertices +=
          fmt::format("v {} {} 0\n", 0.01 * (i / 2), (i % 2) * 1.0 + (i % 4 == 1 ? 0.3 : 0));
    }
    vertices += "v 2 -1 0\nv -1 -1 0\n";
    for (int i = 0; i < 400; ++i) face += fmt::format(" {}", i + 1);
    face += "\n";
    const auto faces = [&](int count) {
      std::string obj = vertices;
      for (int i = 0; i < count; ++i) obj += face;
      return obj;
    };
    CHECK_FALSE(read(faces(20), "a.obj").empty());
    CHECK(refusal(faces(1000), "a.obj").find("too many concave polygons") != std::string::npos);
  }
}

TEST_SUITE("law") {
  TEST_CASE("The triangles of a polygon have its area and do not overlap") {
    Rng rng(5);
    for (int round = 0; round < 500; ++round) {
      CAPTURE(round);
      const int count = 3 + static_cast<int>(rng.index(60));
      const Eigen::Matrix3d turn =
          rotation_from_rpy({rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-3, 3)});
      std::vector<Vec3> corners;
      double area = 0;
      for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count, r = rng.uniform(0.1, 1);
        corners.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.0);
      }
      for (int i = 0; i < count; ++i) {
        const Vec3 &p = corners[as_index(i)], &q = corners[as_index((i + 1) % count)];
        area += 0.5 * (p.x() * q.y() - p.y() * q.x());
      }
      for (Vec3& corner : corners) corner = turn * corner + Vec3(1, 2, 3);
      double sum = 0;
      const std::string source = "a";
      const auto triangles = SurfaceBuilder(source, Vec3::Ones(), {}).triangulate(corners);
      CHECK(std::ssize(triangles) == count - 2);
      for (const auto& [a, b, c] : triangles)
        sum += Triangle{corners[a], corners[b], corners[c]}.area();
      CHECK(sum == doctest::Approx(std::abs(area)).epsilon(1e-9));
    }
  }
}

}  // namespace
}  // namespace mneme::internal
