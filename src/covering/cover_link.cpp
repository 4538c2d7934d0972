// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/covering.h"

#include <cmath>

#include <fmt/format.h>

#include "covering/cover_solid.h"
#include "covering/link_surface.h"

namespace mneme {

Result<LinkCover> cover_link(const Link& link, const CoverSettings& settings) {
  if (!(settings.excess > 0 && std::isfinite(settings.excess)) || settings.max_spheres <= 0) {
    return fail(ErrorCode::invalid,
                fmt::format("an excess of {} m and at most {} spheres per link were asked for, "
                            "expected more than 0 of both",
                            settings.excess, settings.max_spheres));
  }
  return internal::link_surface(link).map([&](const internal::TriangleMesh& surface) {
    LinkCover cover = internal::cover_solid(surface, settings);
    cover.link = link.name;
    return cover;
  });
}

}  // namespace mneme
