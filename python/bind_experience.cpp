// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "mneme/upkeep.h"
#include "mneme/pipeline.h"

#include "arrays.h"
#include "bindings.h"
#include "interruptible.h"
#include "memory.h"
#include "origins.h"
#include "pickling.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>

namespace mneme::python {
namespace {

OpenMode parse_mode(const std::string& mode) {
  if (mode == "read_only") return OpenMode::read_only;
  if (mode == "read_write") return OpenMode::read_write;
  if (mode == "create") return OpenMode::create;
  raise_invalid(
      fmt::format("mode: expected 'read_only', 'read_write' or 'create', got '{}'", mode));
}

Memory open(const std::filesystem::path& path, const std::optional<Robot>& robot,
            const std::string& mode, std::int64_t memory_mib) {
  const OpenMode open_mode = parse_mode(mode);
  if (!robot && open_mode != OpenMode::read_only) {
    raise_invalid("robot: needed for the modes 'read_write' and 'create'");
  }
  if (memory_mib < 0 || memory_mib > 1'000'000) raise_invalid("memory_mib: expected 0 to 1000000");
  const DatabaseSettings kept{memory_mib << 20};
  Memory memory(unwrap(run_interruptible([&] {
    return robot ? Database::open(path.string(), make_signature(*robot), open_mode, kept)
                 : Database::inspect(path.string(), kept);
  })));
  set_origin(memory.get(), {{"the memory", path.string()}});
  return memory;
}

const std::vector<float>& numbers_of(const Experience& row) {
  return row.is_path() ? row.path().waypoints : row.sampler().means;
}

py::array_t<float> means_of(const Experience& row) {
  const std::vector<float>& numbers = numbers_of(row);
  const int columns = row.is_path() ? row.path().joint_count : row.sampler().joint_count;
  py::array_t<float> means({py::ssize_t{row.component_count()}, py::ssize_t{columns}});
  std::copy(numbers.begin(), numbers.end(), means.mutable_data());
  return means;
}

py::dict to_dict(const Experience& experience) {
  py::dict row;
  row["id"] = experience.id;
  row["kind"] = experience.kind;
  row["key"] = to_array(experience.key);
  row["means"] = means_of(experience);
  row["is_path"] = experience.is_path();
  if (experience.is_path()) {
    row["constraints"] = experience.path().constraints;
    row["planning_states"] = experience.path().planning_states;
    row["clearances"] = experience.path().clearances;
    row["near_misses"] = experience.path().near_misses;
  } else {
    row["is_complete"] = experience.sampler().is_complete;
  }
  row["tool"] = experience.provenance.tool;
  row["settings"] = experience.provenance.settings;
  row["seed"] = experience.provenance.seed;
  row["time"] = experience.provenance.time;
  return row;
}

template <class Number>
py::array_t<Number> array_of(const std::vector<Number>& numbers) {
  return py::array_t<Number>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

/// One array of all rows, and per row the place behind its last number.
template <class Number>
struct Column {
  std::vector<Number> numbers;
  std::vector<std::int64_t> ends;

  template <class Numbers>
  void add(const Numbers& row) {
    numbers.insert(numbers.end(), row.begin(), row.end());
    ends.push_back(static_cast<std::int64_t>(numbers.size()));
  }
  /// Rows of `width` numbers each count as one.
  void write(py::dict& arrays, const std::string& name, std::int64_t width = 1) const {
    std::vector<std::int64_t> row_ends = ends;
    for (std::int64_t& end : row_ends) end /= width;
    py::object flat = array_of(numbers);
    if (width > 1) flat = flat.attr("reshape")(-1, width);
    arrays[py::str(name + "s")] = flat;
    arrays[py::str(name + "_ends")] = array_of(row_ends);
  }
};

py::dict to_arrays(const Memory& memory) {
  const std::shared_ptr<Database> database = memory.get();
  py::dict arrays;
  py::list kinds, settings;
  std::vector<std::int64_t> ids;
  std::vector<std::uint64_t> seeds, constraints, planning_states;
  std::vector<std::uint8_t> is_path, is_complete;
  Column<double> keys;
  Column<float> means, factors;
  Column<int> factor_rows, sources;
  unwrap(database->for_each([&](const std::shared_ptr<const Experience>& row) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    ids.push_back(row->id);
    seeds.push_back(row->provenance.seed);
    kinds.append(row->kind);
    settings.append(row->provenance.settings);
    keys.add(row->key);
    means.add(numbers_of(*row));
    const LocalSampler sampler = row->is_path() ? LocalSampler() : row->sampler();
    factors.add(sampler.factors);
    factor_rows.add(sampler.factor_rows);
    sources.add(sampler.sources);
    is_complete.push_back(sampler.is_complete);
    is_path.push_back(row->is_path());
    constraints.push_back(row->constraints());
    planning_states.push_back(row->is_path() ? row->path().planning_states.value_or(0) : 0);
  }));
  const std::int64_t joints = database->signature().joint_count;
  arrays["ids"] = array_of(ids);
  arrays["kinds"] = py::module_::import("numpy").attr("array")(kinds, py::arg("dtype") = "U");
  keys.write(arrays, "key");
  means.write(arrays, "mean", joints);
  factors.write(arrays, "factor", joints * (joints + 1) / 2);
  factor_rows.write(arrays, "factor_row");
  sources.write(arrays, "source");
  arrays["is_path"] = array_of(is_path).attr("astype")("bool");
  arrays["is_complete"] = array_of(is_complete).attr("astype")("bool");
  arrays["constraints"] = array_of(constraints);
  arrays["planning_states"] = array_of(planning_states);
  arrays["seeds"] = array_of(seeds);
  arrays["settings"] = py::module_::import("numpy").attr("array")(settings, py::arg("dtype") = "U");
  return arrays;
}

py::dict get(const Memory& memory, std::int64_t position) {
  const std::shared_ptr<Database> database = memory.get();
  if (position < 0) position += database->size();
  if (position < 0 || position >= database->size()) {
    throw py::index_error(fmt::format("the database has {} rows", database->size()));
  }
  return to_dict(unwrap(database->get(position)));
}

py::list find(const Memory& memory, const LocalPrimitive& primitive,
              std::optional<double> similarity, int max_matches, bool mirror) {
  const std::shared_ptr<Database> database = memory.get();
  const MemoryKind* kind = memory_kind_of(primitive.kind);
  if (kind == nullptr) raise_invalid("primitive: its kind of memory is unknown");
  const double threshold = similarity.value_or(kind->defaults.similarity);
  if (!(threshold > 0)) raise_invalid("similarity: expected more than 0");
  if (max_matches < 0) raise_invalid("max_matches: expected 0 or more");
  py::list rows;
  for (const Match& match :
       unwrap(find_matches(*database, *kind, primitive, {threshold, max_matches, mirror}))) {
    py::dict row = to_dict(*match.experience);
    row["similarity_error"] = match.similarity_error;
    rows.append(row);
  }
  return rows;
}

py::dict info(const Memory& memory) {
  const DatabaseInfo info = memory.get()->info();
  py::dict row;
  row["url"] = info.url;
  row["robot_name"] = info.signature.robot_name;
  row["robot_hash"] = info.signature.model_hash;
  row["kinematics_hash"] = info.signature.kinematics_hash;
  row["joint_count"] = info.signature.joint_count;
  py::list kinds;
  for (const KindInfo& info_of_kind : info.kinds) {
    py::dict kind;
    kind["kind"] = info_of_kind.kind;
    kind["key_size"] = info_of_kind.key_size;
    kind["samplers"] = info_of_kind.samplers;
    kind["components"] = info_of_kind.components;
    kinds.append(kind);
  }
  row["kinds"] = kinds;
  row["samplers"] = info.samplers;
  row["components"] = info.components;
  row["bytes"] = info.bytes;
  row["schema_version"] = info.schema_version;
  return row;
}

py::list verify_file(const std::filesystem::path& path) {
  py::list rows;
  for (const Damage& damage :
       unwrap(run_interruptible([&] { return verify_database(path.string()); }))) {
    rows.append(py::make_tuple(damage.id, damage.what));
  }
  return rows;
}

}  // namespace

void bind_experience(py::module_& module) {
  py::class_<Memory> memory(
      module, "Database",
      "An append-only store of local samplers. Safe to use from several threads.");
  refuse_pickling(memory, "open it in each process");
  memory
      .def_static(
          "open", &open, py::arg("path"), py::arg("robot") = py::none(), py::kw_only(),
          py::arg("mode") = "read_only",
          py::arg("memory_mib") = DatabaseSettings{}.memory_bytes >> 20,
          "Opens the database of a robot. Without a robot: opens any database, to inspect it.\n\n"
          "mode: 'read_only', 'read_write', or 'create', which also makes a missing file.\n"
          "memory_mib: a larger database stays on disk, and rows are read when they match.")
      .def_static("verify", &verify_file, py::arg("path"),
                  "Returns damaged rows as (id, what). id 0: damage to the file. Empty: no damage.")
      .def(
          "find", &find, py::arg("primitive"), py::kw_only(), py::arg("similarity") = py::none(),
          py::arg("max_matches") = 8, py::arg("mirror") = true,
          "Returns the rows whose similarity error, the squared key distance to the primitive, is\n"
          "below similarity (m^2). Nearest first. max_matches: 0 returns all.\n"
          "mirror: mirror images of the primitive match, too.")
      .def("to_arrays", &to_arrays,
           "Returns all rows as a dict of NumPy arrays, for numpy.savez: ids, kinds, keys, means,\n"
           "factors, factor_rows, sources, seeds, settings. Row i has "
           "keys[key_ends[i-1]:key_ends[i]],\n"
           "row 0 keys[:key_ends[0]]; likewise means, factors, factor_rows and sources.")
      .def("info", &info,
           "Returns a dict: robot, kinds of rows, numbers of samplers and components, bytes.")
      .def(
          "flush",
          [](const Memory& self, double timeout) {
            if (!(timeout >= 0)) {
              raise_invalid(fmt::format("timeout: expected seconds, 0 or more, got {}", timeout));
            }
            const std::shared_ptr<Database> database = self.get();
            unwrap(Memory::flush(*database, timeout));
          },
          py::arg("timeout") = 30.0,
          "Waits, at most timeout seconds, until what plan() has remembered is stored. Raises\n"
          "mneme.Error if rows still wait then.")
      .def(
          "close", &Memory::close,
          "Stores what plan() has remembered, for up to 30 s, and closes the file. Plans made "
          "with\n"
          "it stay valid. Raises mneme.Error if rows could not be stored; Control-C gives them up.")
      .def("__len__", [](const Memory& self) { return self.get()->size(); })
      .def("__getitem__", &get, py::arg("position"),
           "Returns a row: id, kind, key, means of shape (components, joint_count), float32, and "
           "its\n"
           "provenance. The means of a path (is_path) are its waypoints.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](Memory& self, const py::args&) { self.close(); })
      .def("__repr__", [](const Memory& self) {
        if (self.is_closed()) return std::string("<mneme.Database, closed>");
        const DatabaseInfo held = self.get()->info();
        return fmt::format("<mneme.Database '{}' of robot '{}', {} samplers>", held.url,
                           held.signature.robot_name, held.samplers);
      });
}

}  // namespace mneme::python
