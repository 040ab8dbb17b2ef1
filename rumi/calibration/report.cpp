// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "base/this_process/process_name.h"
#include "bus/process/process.h"
#include "bus/wire/calibration.h"

namespace rumi::tool {
namespace {

std::string error_line(const Calibration& calibration) {
  std::string text = fmt::format("reprojection error: {:.3f} px RMS, {} views, {} corners", calibration.rms_px,
                                 calibration.views, calibration.corners);
  if (calibration.check_views > 0)
    text +=
        fmt::format("; {:.3f} px in {} views that were not used", calibration.check_rms_px, calibration.check_views);
  return text;
}

// Returns the first and the last date of the images, or "at unknown times" if their times are not dates.
std::string dates(const std::vector<BoardView>& views) {
  constexpr int64_t kYear2000Us = 946'684'800'000'000;  // earlier times are not counted from 1970
  const auto [first, last] = std::minmax_element(
      views.begin(), views.end(), [](const BoardView& a, const BoardView& b) { return a.utime_us < b.utime_us; });
  if (views.empty() || first->utime_us < kYear2000Us) return "at unknown times";
  const auto text = [](int64_t utime_us) {
    return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::gmtime(static_cast<std::time_t>(utime_us / 1'000'000)));
  };
  return fmt::format("{} to {} UTC", text(first->utime_us), text(last->utime_us));
}

std::string why_nothing_is_taken(const ViewCollector& collector) {
  const ImageCounts& counts = collector.counts();
  const std::string board = collector.board().to_string();
  if (counts.images == 0) return "no image came";
  if (counts.unreadable == counts.images)
    return fmt::format("none of {} images could be read: {}", counts.images, collector.first_unreadable());
  if (counts.with_board() > 0)
    return fmt::format("all {} images with the board are blurred: hold it still, with more light", counts.blurred);
  if (counts.other_board > 0)
    return fmt::format(
        "{} of {} images show markers of the dictionary, but not where {} has them: it is another board, see the "
        "letters "
        "below it and give --board",
        counts.other_board, counts.images, board);
  if (counts.too_little > 0)
    return fmt::format("too little of the board {} was made out in any of {} images: hold it nearer, and sharp", board,
                       counts.images);
  const bool chessboard = collector.board().kind == Board::Kind::kChessboard;
  return fmt::format(
      "the board {} was not found in any of {} images; is it this board ({})? {}", board, counts.images,
      chessboard ? "columns and rows count squares, not corners; one with markers in it is charuco:..."
                 : "see the letters below it; give --board",
      chessboard ? "All of it must be in the image, with a white rim" : "Is it large enough in the image, and sharp?");
}

}  // namespace

std::string why_no_views(const ViewCollector& collector, const std::string& source) {
  return fmt::format("{}: {}", source, why_nothing_is_taken(collector));
}

std::string describe(const Calibration& calibration) {
  std::string text;
  for (const CalibratedParameter& p : calibration.parameters) {
    const bool pixels = p.name[0] == 'f' || p.name[0] == 'c';
    text += fmt::format(fmt::runtime(pixels ? "  {} {:10.3f} +- {:.3f} px\n" : "  {} {:10.5f} +- {:.5f}\n"), p.name,
                        p.value, p.stddev);
  }
  text += error_line(calibration) + "\n";
  for (const std::string& outlier : calibration.outliers) text += "left out because it does not fit: " + outlier + "\n";
  return text;
}

std::string calibration_to_yaml(const Calibration& calibration, const ViewCollector& collector) {
  std::string deviations;
  for (const CalibratedParameter& p : calibration.parameters) deviations += fmt::format(" {} {:.3g}", p.name, p.stddev);
  std::string text = fmt::format("# By rumi calibrate {}, board {}.\n", version(), collector.board().to_string());
  text += "# " + error_line(calibration) + "\n";
  if (!calibration.outliers.empty())
    text += fmt::format("# {} views were left out because they do not fit\n", calibration.outliers.size());
  text += fmt::format("# images taken {}; corners in {:.0f} % of the image\n", dates(collector.taken()),
                      100 * collector.coverage().covered());
  text += "# standard deviations:" + deviations + "\n";
  for (const std::string& doubt : calibration.doubts) text += "# DOUBTFUL: " + doubt + "\n";
  return text + camera_to_yaml(calibration.camera);
}

}  // namespace rumi::tool
