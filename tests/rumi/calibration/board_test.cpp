// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/board.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>

#include "rumi/calibration/board_detector.h"
#include "rumi/calibration/board_page.h"
#include "rumi/calibration/opencv_aruco.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

const Paper& a4() { return papers().front(); }

Board parsed(const std::string& text) { return parse_board(text).value(); }

std::string refusal(const std::string& text) { return parse_board(text).error_text(); }

TEST(Board, IsWrittenAndReadBack) {
  for (const char* text : {"charuco:9x7:26:19:4X4_50", "charuco:12x9:20.5:15.25:APRILTAG_36h11", "chessboard:8x6:30"})
    EXPECT_EQ(parsed(text).to_string(), text);
  EXPECT_EQ(parsed("charuco:7x5:30:22").dictionary, "4X4_50");
  EXPECT_EQ(parsed("charuco:7x5:30:22:DICT_5X5_100").dictionary, "5X5_100") << "OpenCV's own name";
}

TEST(Board, WhatIsNoneIsRefusedWithItsPart) {
  EXPECT_THAT(refusal(""), HasSubstr("the kind is ''"));
  EXPECT_THAT(refusal("circles:9x7:26"), HasSubstr("the kind is 'circles' and must be charuco or chessboard"));
  EXPECT_THAT(refusal("chessboard:9x7"), HasSubstr("chessboard has 3 parts"));
  EXPECT_THAT(refusal("charuco:9x7:26"), HasSubstr("charuco has 4 or 5 parts"));
  EXPECT_THAT(refusal("chessboard:9:26"), HasSubstr("'9' is not COLUMNSxROWS"));
  EXPECT_THAT(refusal("chessboard:9x7x1:26"), HasSubstr("is not COLUMNSxROWS"));
  EXPECT_THAT(refusal("chessboard:9x2:26"), HasSubstr("rows is 2: must be 3 to 50"));
  EXPECT_THAT(refusal("chessboard:900x7:26"), HasSubstr("columns is 900"));
  EXPECT_THAT(refusal("chessboard:9x7:26mm"), HasSubstr("the square is '26mm'"));
  EXPECT_THAT(refusal("chessboard:9x7:nan"), HasSubstr("the square is nan mm"));
  EXPECT_THAT(refusal("charuco:9x7:26:26"), HasSubstr("the marker is 26 mm: must be 7.8 to 23.4"));
  EXPECT_THAT(refusal("charuco:9x6:26:19"), HasSubstr("rows is 6: a ChArUco board must have an odd number"));
  EXPECT_THAT(refusal("charuco:9x7:26:19:8X8_50"), HasSubstr("the dictionary is '8X8_50': must be one of 4X4_50"));
  EXPECT_THAT(refusal("charuco:15x11:10:7:4X4_50"), HasSubstr("needs 82 markers: dictionary 4X4_50 has 50"));
}

// The printed board has the same pixels as the one that cv::aruco draws and looks for.
TEST(Board, IsThatOfOpenCv) {
  for (const char* text : {"charuco:9x7:40:30:4X4_50", "charuco:6x5:40:28:5X5_50"}) {
    const Board board = parsed(text);
    cv::Mat ours(static_cast<int>(board.height_mm()), static_cast<int>(board.width_mm()), CV_8U, cv::Scalar(255));
    for (const cv::Rect2d& r : board.black_mm()) ours(cv::Rect(r)) = 0;
    const MarkerDictionary dictionary = marker_dictionary(dictionary_number(board.dictionary));
    const cv::Mat theirs = board_picture(
        charuco_board({board.columns, board.rows}, 40, static_cast<float>(board.marker_mm), dictionary), ours.size());
    EXPECT_EQ(cv::countNonZero(ours != theirs), 0) << text;
  }
}

TEST(BoardPage, PngHasItsSizeAndResolution) {
  const TemporaryFolder folder;
  const std::string file = folder / "board.png";
  const Board board = parsed("charuco:9x7:26:19");
  ASSERT_EQ(write_board_page(board, a4(), 300, file).error_text(), "");
  const std::string bytes = testing::read_file(file);
  const size_t phys = bytes.find("pHYs");
  ASSERT_NE(phys, std::string::npos);
  EXPECT_EQ(bytes.substr(phys + 4, 9), std::string("\0\0\x2E\x23\0\0\x2E\x23\x01", 9)) << "11811 per metre: 300 dpi";
  const cv::Mat picture = cv::imread(file, cv::IMREAD_GRAYSCALE);
  EXPECT_EQ(picture.size(), cv::Size(3508, 2480)) << "A4";
  // The corners are where the board's millimetres say.
  const BoardDetection detection = BoardDetector(board).detect(picture);
  ASSERT_EQ(detection.outcome, BoardDetection::Outcome::kFound);
  ASSERT_EQ(detection.view.corners.size(), static_cast<size_t>(board.corners()));
  const double per_mm = 300 / 25.4;
  for (int i = 0; i < board.corners(); ++i) {
    const cv::Point2d expected =
        board.corner_mm(i) * per_mm + cv::Point2d((297 - 234) / 2.0, (210 - 182) / 2.0) * per_mm;
    EXPECT_LT(cv::norm(cv::Point2d(detection.view.pixels[i]) + cv::Point2d(0.5, 0.5) - expected), 0.6) << i;
  }
  // The description is below the board, and nothing is above it.
  const int below = static_cast<int>((105 + 91 + 2) * per_mm);
  EXPECT_GT(cv::countNonZero(picture.rowRange(below, picture.rows) < 200), 1000);
  EXPECT_EQ(cv::countNonZero(picture.rowRange(0, static_cast<int>(13 * per_mm)) < 255), 0);
}

// Returns the content of the first compressed stream, which is the one that draws the page.
std::string page_contents(const std::string& pdf) {
  const size_t begin = pdf.find("stream\n") + 7, end = pdf.find("endstream", begin);
  std::string text(1 << 20, '\0');
  uLongf size = text.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(text.data()), &size, reinterpret_cast<const Bytef*>(pdf.data() + begin),
                       end - begin),
            Z_OK);
  text.resize(size);
  return text;
}

TEST(BoardPage, PdfHasItsSize) {
  const TemporaryFolder folder;
  const std::string file = folder / "board.pdf";
  ASSERT_EQ(write_board_page(parsed("chessboard:7x9:20"), a4(), 300, file).error_text(), "");
  const std::string pdf = testing::read_file(file);
  EXPECT_THAT(pdf, HasSubstr("MediaBox [ 0 0 595.275591 841.889764 ]")) << "A4 upright, in points";
  const std::string contents = page_contents(pdf);
  const std::regex corner("([0-9.]+) ([0-9.]+) [ml]\\s");
  double left = 1e9, right = 0, top = 1e9, bottom = 0;
  for (std::sregex_iterator it(contents.begin(), contents.end(), corner), end; it != end; ++it) {
    left = std::min(left, std::stod((*it)[1])), right = std::max(right, std::stod((*it)[1]));
    top = std::min(top, std::stod((*it)[2])), bottom = std::max(bottom, std::stod((*it)[2]));
  }
  const double points_per_mm = 72 / 25.4;
  EXPECT_NEAR(left / points_per_mm, 35, 0.01);
  EXPECT_NEAR(right / points_per_mm, 175, 0.01);
  EXPECT_NEAR(top / points_per_mm, 58.5, 0.01);
  EXPECT_NEAR(bottom / points_per_mm, 238.5, 0.01);
}

TEST(BoardPage, WhatCannotBeIsRefusedAndLeavesNothing) {
  const TemporaryFolder folder;
  const std::string too_large =
      write_board_page(parsed("chessboard:11x9:26"), a4(), 300, folder / "b.pdf").error_text();
  EXPECT_THAT(too_large, HasSubstr("is 286 x 234 mm and does not fit on a4"));
  EXPECT_EQ(write_board_page(parsed("chessboard:11x9:26"), papers()[1], 72, folder / "a3.png").error_text(), "");
  EXPECT_THAT(write_board_page(Board(), a4(), 300, folder / "b.jpg").error_text(),
              HasSubstr("must end in .pdf or .png"));
  EXPECT_THAT(write_board_page(Board(), a4(), 300, folder / "none/b.pdf").error_text(), HasSubstr("cannot write"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "a3.png only";
}

}  // namespace
}  // namespace rumi::tool
