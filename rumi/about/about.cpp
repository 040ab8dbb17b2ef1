// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/about/about.h"

#include <cairo.h>
#include <ceres/version.h>
#include <fmt/format.h>
#include <lcm/lcm.h>
#include <microhttpd.h>
#include <sqlite3.h>

#include <Eigen/Core>
#include <opencv2/core/utility.hpp>

#include "base/command_line/about.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace rumi::tool {

namespace {

std::string of_libav(unsigned version) {
  return fmt::format("{}.{}.{}", AV_VERSION_MAJOR(version), AV_VERSION_MINOR(version), AV_VERSION_MICRO(version));
}

// A library that cannot be asked for its version is listed with the version that Rumi was built with.
std::string libraries() {
  return fmt::format(
      "Cairo {}, Ceres {}, Eigen {}.{}.{}, LCM {}.{}.{}, libavcodec {}, libavformat {}, libmicrohttpd {}, OpenCV {}, "
      "SQLite {}",
      cairo_version_string(), CERES_VERSION_STRING, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
      LCM_MAJOR_VERSION, LCM_MINOR_VERSION, LCM_MICRO_VERSION, of_libav(avcodec_version()),
      of_libav(avformat_version()), MHD_get_version(), cv::getVersionString(), sqlite3_libversion());
}

}  // namespace

std::string about() { return fmt::format("{}\nlibraries: {}", rumi::about("rumi"), libraries()); }

}  // namespace rumi::tool
