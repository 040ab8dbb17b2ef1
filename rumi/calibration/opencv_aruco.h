// SPDX-License-Identifier: BSD-3-Clause
// One interface to OpenCV's boards with markers. From version 4.7 on OpenCV has values instead of pointers and members
// instead of functions; versions up to 4.6 (Debian 12) are supported, too.
#pragma once

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/core/version.hpp>
#include <vector>

namespace rumi::tool {

using MarkerDictionary = cv::Ptr<cv::aruco::Dictionary>;
using CharucoBoard = cv::Ptr<cv::aruco::CharucoBoard>;

#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7

inline MarkerDictionary marker_dictionary(int number) {
  return cv::makePtr<cv::aruco::Dictionary>(cv::aruco::getPredefinedDictionary(number));
}
inline cv::Mat marker_picture(const MarkerDictionary& dictionary, int id, int side_px) {
  cv::Mat picture;
  dictionary->generateImageMarker(id, side_px, picture);
  return picture;
}
inline CharucoBoard charuco_board(cv::Size squares, float square, float marker, const MarkerDictionary& dictionary) {
  return cv::makePtr<cv::aruco::CharucoBoard>(squares, square, marker, *dictionary);
}
inline const std::vector<std::vector<cv::Point3f>>& marker_corners(const CharucoBoard& board) {
  return board->getObjPoints();
}
inline cv::Mat board_picture(const CharucoBoard& board, cv::Size size_px) {
  cv::Mat picture;
  board->generateImage(size_px, picture);
  return picture;
}

#else

inline MarkerDictionary marker_dictionary(int number) { return cv::aruco::getPredefinedDictionary(number); }
inline cv::Mat marker_picture(const MarkerDictionary& dictionary, int id, int side_px) {
  cv::Mat picture;
  dictionary->drawMarker(id, side_px, picture);
  return picture;
}
inline CharucoBoard charuco_board(cv::Size squares, float square, float marker, const MarkerDictionary& dictionary) {
  return cv::aruco::CharucoBoard::create(squares.width, squares.height, square, marker, dictionary);
}
inline const std::vector<std::vector<cv::Point3f>>& marker_corners(const CharucoBoard& board) {
  return board->objPoints;
}
inline cv::Mat board_picture(const CharucoBoard& board, cv::Size size_px) {
  cv::Mat picture;
  board->draw(size_px, picture);
  return picture;
}

#endif

}  // namespace rumi::tool
