// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/outputs/frames_file.h"

#include <fmt/format.h>

#include <optional>

#include "base/files/whole_file.h"
#include "map_server/outputs/frames_by_session.h"

namespace rumi::map_server {

Result<> write_frames_csv(const Atlas& atlas, const std::string& file, int64_t after) {
  WholeFile out(file);
  out.write("utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma,session\n");
  for (const auto& [key, record] : frames_by_session(atlas, after)) {
    const ImageId image = key.second;
    const std::optional<LocatedFrame> located = atlas.locate(image);
    const PoseSigmas sigmas = located ? located->sigmas() : PoseSigmas();
    out.write(fmt::format(
        "{},{},{},{},{},{}\n", image.utime_us, to_string(record->state), located ? located->owner->submap.key.id : 0,
        located && located->owner->in_map ? 1 : 0,
        sigmas.are_known() ? fmt::format("{:.6g},{:.6g},{:.6g}", sigmas.position, sigmas.rotation_rad, sigmas.log_scale)
                           : ",,",
        record->session));
  }
  return out.commit();
}

}  // namespace rumi::map_server
