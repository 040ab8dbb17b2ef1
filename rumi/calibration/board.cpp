// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/board.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/text/number_text.h"
#include "rumi/calibration/opencv_aruco.h"

namespace rumi::tool {
namespace {

constexpr int kMinSquares = 3, kMaxSquares = 50;
constexpr double kMinSquareMm = 1, kMaxSquareMm = 1000;
// The side of a marker / the side of its square. A white rim must remain around the marker.
constexpr double kMinMarkerPart = 0.3, kMaxMarkerPart = 0.9;

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

bool within(double value, double min, double max) { return value >= min && value <= max; }  // false if the value is NaN

bool is_black(int column, int row) { return (column + row) % 2 == 0; }

const BoardDictionary* find_dictionary(const std::string& name) {
  for (const BoardDictionary& dictionary : board_dictionaries())
    if (name == dictionary.name) return &dictionary;
  return nullptr;
}

std::string dictionary_names() {
  std::string names;
  for (const BoardDictionary& dictionary : board_dictionaries())
    names += (names.empty() ? "" : ", ") + std::string(dictionary.name);
  return names;
}

// Appends the black cells of marker `id`, whose upper left corner is at `origin`. Adjacent cells of a row become one
// rectangle.
void add_marker(const MarkerDictionary& dictionary, int id, cv::Point2d origin, double marker_mm,
                std::vector<cv::Rect2d>* black) {
  const int cells = dictionary->markerSize + 2;  // per side, with the black border
  const cv::Mat picture = marker_picture(dictionary, id, cells);
  const double cell_mm = marker_mm / cells;
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells;) {
      int end = x;
      while (end < cells && picture.at<uint8_t>(y, end) == 0) ++end;
      if (end > x) black->emplace_back(origin.x + x * cell_mm, origin.y + y * cell_mm, (end - x) * cell_mm, cell_mm);
      x = std::max(end, x + 1);
    }
  }
}

}  // namespace

std::string Board::to_string() const {
  std::string text =
      fmt::format("{}:{}x{}:{}", kind == Kind::kCharuco ? "charuco" : "chessboard", columns, rows, square_mm);
  if (kind == Kind::kCharuco) text += fmt::format(":{}:{}", marker_mm, dictionary);
  return text;
}

Result<> Board::check() const {
  if (columns < kMinSquares || columns > kMaxSquares)
    return Error{fmt::format("columns is {}: must be {} to {} squares", columns, kMinSquares, kMaxSquares)};
  if (rows < kMinSquares || rows > kMaxSquares)
    return Error{fmt::format("rows is {}: must be {} to {} squares", rows, kMinSquares, kMaxSquares)};
  if (!within(square_mm, kMinSquareMm, kMaxSquareMm))
    return Error{fmt::format("the square is {} mm: must be {} to {}", square_mm, kMinSquareMm, kMaxSquareMm)};
  if (kind == Kind::kChessboard) return {};
  // Versions of OpenCV differ in whether such a board begins with a black or a white square.
  if (rows % 2 == 0) return Error{fmt::format("rows is {}: a ChArUco board must have an odd number of rows", rows)};
  if (!within(marker_mm, kMinMarkerPart * square_mm, kMaxMarkerPart * square_mm))
    return Error{fmt::format("the marker is {} mm: must be {:.3g} to {:.3g} for a square of {} mm", marker_mm,
                             kMinMarkerPart * square_mm, kMaxMarkerPart * square_mm, square_mm)};
  const BoardDictionary* known = find_dictionary(dictionary);
  if (!known) return Error{fmt::format("the dictionary is '{}': must be one of {}", dictionary, dictionary_names())};
  const int markers = columns * rows / 2;
  const int available = marker_dictionary(known->number)->bytesList.rows;
  if (markers > available)
    return Error{fmt::format("the board needs {} markers: dictionary {} has {}", markers, dictionary, available)};
  return {};
}

cv::Point2d Board::corner_mm(int corner) const {
  const int column = corner % corner_columns(), row = corner / corner_columns();
  return {(column + 1) * square_mm, (row + 1) * square_mm};
}

std::vector<cv::Rect2d> Board::black_mm() const {
  std::vector<cv::Rect2d> black;
  MarkerDictionary markers;
  if (kind == Kind::kCharuco) markers = marker_dictionary(dictionary_number(dictionary));
  const double rim_mm = (square_mm - marker_mm) / 2;
  int id = 0;  // number of the next marker; they are numbered row by row
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const cv::Point2d corner(column * square_mm, row * square_mm);
      if (is_black(column, row))
        black.emplace_back(corner.x, corner.y, square_mm, square_mm);
      else if (markers)
        add_marker(markers, id++, corner + cv::Point2d(rim_mm, rim_mm), marker_mm, &black);
    }
  }
  return black;
}

Result<Board> parse_board(const std::string& text) {
  const auto refuse = [&text](const std::string& why) {
    return Error{why, fmt::format("board is '{}'", text),
                 fmt::format("write {}, such as {} or chessboard:9x7:26", kBoardSyntax, Board().to_string())};
  };
  const std::vector<std::string> parts = split(text, ':');
  Board result;
  if (parts[0] == "chessboard")
    result.kind = Board::Kind::kChessboard;
  else if (parts[0] != "charuco")
    return refuse(fmt::format("the kind is '{}' and must be charuco or chessboard", parts[0]));
  const bool charuco = result.kind == Board::Kind::kCharuco;
  const size_t fewest = charuco ? 4 : 3, most = charuco ? 5 : 3;
  if (parts.size() < fewest || parts.size() > most)
    return refuse(fmt::format("{} has {} parts", parts[0], charuco ? "4 or 5" : "3"));
  const std::vector<std::string> sides = split(parts[1], 'x');
  const std::optional<int> columns = parse_number<int>(sides[0]);
  const std::optional<int> rows = sides.size() == 2 ? parse_number<int>(sides[1]) : std::nullopt;
  if (!columns || !rows) return refuse(fmt::format("'{}' is not COLUMNSxROWS", parts[1]));
  const std::optional<double> square = parse_number<double>(parts[2]);
  if (!square) return refuse(fmt::format("the square is '{}' and must be a number of mm", parts[2]));
  result.columns = *columns, result.rows = *rows, result.square_mm = *square;
  if (charuco) {
    const std::optional<double> marker = parse_number<double>(parts[3]);
    if (!marker) return refuse(fmt::format("the marker is '{}' and must be a number of mm", parts[3]));
    result.marker_mm = *marker;
    if (parts.size() > 4) result.dictionary = parts[4].starts_with("DICT_") ? parts[4].substr(5) : parts[4];
  }
  if (const Result<> usable = result.check(); !usable) return refuse(usable.error().text());
  return result;
}

const std::vector<BoardDictionary>& board_dictionaries() {
  using namespace cv::aruco;
  static const std::vector<BoardDictionary> kAll = {{"4X4_50", DICT_4X4_50},
                                                    {"4X4_100", DICT_4X4_100},
                                                    {"4X4_250", DICT_4X4_250},
                                                    {"4X4_1000", DICT_4X4_1000},
                                                    {"5X5_50", DICT_5X5_50},
                                                    {"5X5_100", DICT_5X5_100},
                                                    {"5X5_250", DICT_5X5_250},
                                                    {"5X5_1000", DICT_5X5_1000},
                                                    {"6X6_50", DICT_6X6_50},
                                                    {"6X6_100", DICT_6X6_100},
                                                    {"6X6_250", DICT_6X6_250},
                                                    {"6X6_1000", DICT_6X6_1000},
                                                    {"7X7_50", DICT_7X7_50},
                                                    {"7X7_100", DICT_7X7_100},
                                                    {"7X7_250", DICT_7X7_250},
                                                    {"7X7_1000", DICT_7X7_1000},
                                                    {"ARUCO_ORIGINAL", DICT_ARUCO_ORIGINAL},
                                                    {"APRILTAG_16h5", DICT_APRILTAG_16h5},
                                                    {"APRILTAG_25h9", DICT_APRILTAG_25h9},
                                                    {"APRILTAG_36h10", DICT_APRILTAG_36h10},
                                                    {"APRILTAG_36h11", DICT_APRILTAG_36h11}};
  return kAll;
}

int dictionary_number(const std::string& name) { return find_dictionary(name)->number; }

}  // namespace rumi::tool
