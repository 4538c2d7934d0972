// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include "apps/run_program.h"

namespace mneme::test {
namespace {

/// A ball on a stem that touches the base at rest only.
const std::string kNodding =
    "<robot name='nod'><link name='base'><collision><origin xyz='0.5 0 0'/><geometry>"
    "<sphere radius='0.1'/></geometry></collision></link>"
    "<link name='neck'><collision><origin xyz='0 0 1'/><geometry><sphere radius='0.05'/></geometry>"
    "</collision></link>"
    "<link name='head'><collision><origin xyz='0.5 0 0'/><geometry><sphere "
    "radius='0.1'/></geometry>"
    "</collision></link>"
    "<joint name='pan' type='revolute'><parent link='base'/><child link='neck'/><axis xyz='0 0 1'/>"
    "<limit lower='-3' upper='3' effort='1' velocity='1'/></joint>"
    "<joint name='nod' type='revolute'><parent link='neck'/><child link='head'/><axis xyz='0 1 0'/>"
    "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";

TEST_SUITE("flow") {
  TEST_CASE("a robot in contact at rest is refused with the ways out, and an SRDF is one") {
    const TemporaryDirectory files;
    write_file(files / "nod.urdf", kNodding);
    write_file(files / "p.yaml",
               "robot: nod.urdf\nscene: {obstacles: []}\nstart: [0, 0]\ngoal: [1, 0]\n");
    const ProgramRun refused = run_program({"plan", files / "p.yaml"});
    CHECK(refused.exit_code != 0);
    CHECK(contains(refused.err, "`allow: [[base, head]]`"));
    CHECK(contains(refused.err, "`mneme robot srdf`"));
    const ProgramRun run = require_run(
        {"robot", "srdf", files / "nod.urdf", "--samples", "300", "-o", files / "nod.srdf"});
    CHECK(contains(run.err, "3 allowed pairs (2 Adjacent, 1 Default)"));
    require_run({"plan", files / "p.yaml"});
  }

  TEST_CASE("all pairs in contact at rest are named at once") {
    const TemporaryDirectory files;
    std::string urdf = kNodding;
    urdf.replace(urdf.find("</robot>"), std::string::npos,
                 "<link name='hat'><collision><origin xyz='0.5 0 0.05'/><geometry><sphere "
                 "radius='0.1'/></geometry></collision></link>"
                 "<joint name='pin' type='fixed'><parent link='head'/><child link='hat'/></joint>"
                 "</robot>");
    write_file(files / "nod.urdf", urdf);
    const std::string problem =
        "robot: nod.urdf\nscene: {obstacles: []}\nstart: [0, 0]\ngoal: [1, 0]\n";
    write_file(files / "p.yaml", problem);
    const ProgramRun refused = run_program({"plan", files / "p.yaml"});
    const std::string allow = "allow: [[base, head], [base, hat]]";
    CHECK(contains(refused.err, "`" + allow + "`"));
    write_file(files / "p.yaml", problem + allow + "\n");
    require_run({"plan", files / "p.yaml"});
  }

  TEST_CASE("contact elsewhere gets no such advice, and rest can be checked") {
    const TemporaryDirectory files;
    write_file(files / "nod.urdf", kNodding);
    const ProgramRun run =
        require_run({"robot", "srdf", files / "nod.urdf", "--samples", "300", "--check-rest"});
    CHECK(contains(run.out, "reason=\"Adjacent\""));
    CHECK_FALSE(contains(run.out, "Default"));
  }
}

}  // namespace
}  // namespace mneme::test
