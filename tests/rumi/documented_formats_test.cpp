// SPDX-License-Identifier: BSD-3-Clause
// Tests that every format is read that the README and docs/ name: each name in their lists has an input here.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <functional>
#include <map>
#include <opencv2/videoio.hpp>
#include <regex>
#include <set>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "formats/camera/camera_file.h"
#include "formats/truth/truth.h"
#include "tests/formats/bag/write_bag.h"
#include "tests/formats/recording.h"

namespace rumi {
namespace {

using namespace testing;

const char* const kMatrix = "fx: 50\nfy: 51\ncx: 32\ncy: 24\n";

// A file of each tool that docs/calibration.md names.
const std::map<std::string, std::string>& camera_files() {
  static const std::map<std::string, std::string> kFiles = {
      {"ROS",
       "image_width: 64\nimage_height: 48\ncamera_name: a\ncamera_matrix: {rows: 3, cols: 3, data: [50, 0, 32, 0, 51, "
       "24, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, "
       "0]}\n"},
      {"Kalibr",
       "cam0:\n  camera_model: pinhole\n  intrinsics: [50, 51, 32, 24]\n  distortion_model: radtan\n  "
       "distortion_coeffs: [0, 0, 0, 0]\n  resolution: [64, 48]\n"},
      {"OpenCV",
       "%YAML:1.0\nimage_width: 64\nimage_height: 48\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: "
       "d\n   data: [50, 0, 32, 0, 51, 24, 0, 0, 1]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: "
       "5\n   dt: d\n   data: [0, 0, 0, 0, 0]\n"},
      {"EuRoC",
       "sensor_type: camera\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [50, 51, 32, 24]\n"
       "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n"},
      {"ORB-SLAM2 and 3",
       "%YAML:1.0\nCamera.fx: 50\nCamera.fy: 51\nCamera.cx: 32\nCamera.cy: 24\nCamera.k1: 0\nCamera.k2: 0\nCamera.p1: "
       "0\nCamera.p2: 0\nCamera.width: 64\nCamera.height: 48\n"},
      {"OpenVSLAM and stella_vslam",
       "Camera:\n  setup: monocular\n  model: perspective\n  fx: 50\n  fy: 51\n  cx: 32\n  cy: 24\n  k1: 0\n  k2: 0\n  "
       "p1: 0\n  p2: 0\n  k3: 0\n  cols: 64\n  rows: 48\n"},
      {"VINS",
       "%YAML:1.0\nmodel_type: PINHOLE\ncamera_name: camera\nimage_width: 64\nimage_height: 48\n"
       "distortion_parameters:\n   k1: 0\n   k2: 0\n   p1: 0\n   p2: 0\nprojection_parameters:\n   fx: 50\n   fy: 51\n "
       "  cx: 32\n   cy: 24\n"},
      {"Basalt",
       R"({"value0": {"intrinsics": [{"camera_type": "pinhole", "intrinsics": {"fx": 50, "fy": 51, "cx": 32, "cy": 24}}],
 "resolution": [[64, 48]]}})"},
      {"DepthAI",
       R"({"cameraData": [[0, {"cameraType": 0, "distortionCoeff": [0, 0, 0, 0, 0], "height": 48, "width": 64,
 "intrinsicMatrix": [[50, 0, 32], [0, 51, 24], [0, 0, 1]]}]]})"},
      {"Gyroflow",
       R"({"calib_dimension": {"w": 64, "h": 48}, "fisheye_params": {"camera_matrix": [[50, 0, 32], [0, 51, 24], [0, 0, 1]],
 "distortion_coeffs": [0, 0, 0, 0]}})"},
      {"COLMAP", "# CAMERA_ID, MODEL\n1 PINHOLE 64 48 50 51 32.5 24.5\n"},
      {"nerfstudio and instant-ngp",
       R"({"fl_x": 50, "fl_y": 51, "cx": 32.5, "cy": 24.5, "w": 64, "h": 48, "frames": []})"},
      {"what `rs-enumerate-devices -c` prints",
       " Intrinsic of \"Color\" / 64x48 / {RGB8}\n  Width:      \t64\n  Height:     \t48\n  PPX:        \t32\n  PPY:   "
       " "
       "    \t24\n  Fx:         \t50\n  Fy:         \t51\n  Distortion: \tBrown Conrady\n  Coeffs:     \t0  0  0  0  "
       "0\n"},
  };
  return kFiles;
}

void write_images(const fs::path& folder, const std::vector<std::string>& names) {
  fs::create_directories(folder);
  for (size_t i = 0; i < names.size(); ++i) cv::imwrite((folder / names[i]).string(), picture(static_cast<int>(i)));
}

// Makes a recording in a folder; returns the path to open.
using MakeRecording = std::function<fs::path(const fs::path&)>;

struct Recording {
  const char* in_docs;  // its name in docs/recordings.md
  MakeRecording make;
};

// By the names in the README.
const std::map<std::string, Recording>& recordings() {
  static const std::map<std::string, Recording> kRecordings = {
      {"a folder with `rgb.txt`",
       {"TUM RGB-D",
        [](const fs::path& folder) {
          write_tum(folder, 3);
          return folder;
        }}},
      {"a folder with `mav0/cam0/data.csv`",
       {"EuRoC, TUM-VI",
        [](const fs::path& folder) {
          write_images(folder / "mav0/cam0/data", {"1.png", "2.png"});
          write_file(folder / "mav0/cam0/data.csv", "#timestamp [ns],filename\n1000000000,1.png\n1050000000,2.png\n");
          return folder;
        }}},
      {"a folder of images",
       {"images",
        [](const fs::path& folder) {
          write_images(folder, {"1000.0000.png", "1000.0500.png"});
          return folder;
        }}},
      {"a video",
       {"video",
        [](const fs::path& folder) {
          const fs::path file = folder / "v.avi";
          cv::VideoWriter video(file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, cv::Size(64, 48));
          for (int i = 0; i < 3; ++i) video.write(picture(i, 64, 48, true));
          return file;
        }}},
      {"a ROS bag",
       {"ROS bag",
        [](const fs::path& folder) -> fs::path {
          std::vector<BagMessageToWrite> messages;
          for (int i = 1; i < 4; ++i)
            messages.push_back(
                {"/image", "sensor_msgs/Image", image_message(true, 100'000'000 * i, picture(i), "mono8")});
          return write_bag(folder.string(), "mcap zstd", messages);
        }}},
      {"an lcm log with images on `CAMERA`",
       {"lcm log",
        [](const fs::path& folder) {
          const fs::path file = folder / "l.lcm";
          LogWriter log(file.string());
          for (int i = 1; i < 4; ++i)
            log.write(100'000 * i, "CAMERA", encode_message(make_grey_image(100'000 * i, picture(i))));
          return file;
        }}},
  };
  return kRecordings;
}

const std::map<std::string, std::string>& truths() {
  static const std::map<std::string, std::string> kTruths = {
      {"TUM's lines", "1.0 0 0 0 0 0 0 1\n1.1 1 0 0 0 0 0 1\n"},
      {"EuRoC's and TUM-VI's `data.csv`",
       "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
       "1403636579763555584,0,0,0,1,0,0,0\n1403636579863555584,1,0,0,1,0,0,0\n"},
      {"KITTI's matrices", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n"},
      {"positions only", "1.0 0 0 0\n1.1 1 0 0\n"},
  };
  return kTruths;
}

template <class Map>
std::set<std::string> names_of(const Map& map) {
  std::set<std::string> names;
  for (const auto& [name, input] : map) names.insert(name);
  return names;
}

std::string documentation(const char* file) { return testing::read_file(fs::path(RUMI_SOURCE_DIR) / file); }

// Returns the text between `begin` and `end` in one line, without remarks in brackets.
std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const size_t from = text.find(begin), to = text.find(end, from);
  EXPECT_NE(to, std::string::npos) << begin << " ... " << end;
  if (from == std::string::npos || to == std::string::npos) return {};
  std::string part = text.substr(from + begin.size(), to - from - begin.size());
  part = std::regex_replace(part, std::regex(R"( ?\([^)]*\))"), "");
  return std::regex_replace(part, std::regex(R"(\s+)"), " ");
}

// Splits "A, B and C". A name that contains " and " must be among `known`.
std::set<std::string> list(std::string text, const std::set<std::string>& known) {
  std::set<std::string> names;
  for (const std::string& name : known)
    if (const size_t at = text.find(name); at != std::string::npos && name.find(" and ") != std::string::npos) {
      names.insert(name);
      text.erase(at, name.size());
    }
  text = std::regex_replace(text, std::regex(" and "), ", ");
  for (size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = std::min(text.find(',', begin), text.size());
    const std::string name = std::regex_replace(text.substr(begin, end - begin), std::regex("^ +| +$"), "");
    if (!name.empty()) names.insert(name);
  }
  return names;
}

// Returns the first column of the table between `begin` and `end`, without its heading and remarks in brackets.
std::set<std::string> rows_between(const std::string& text, const std::string& begin, const std::string& end) {
  const size_t from = text.find(begin), to = text.find(end, from);
  EXPECT_NE(to, std::string::npos) << begin << " ... " << end;
  if (from == std::string::npos || to == std::string::npos) return {};
  const std::string part = text.substr(from, to - from);
  const std::regex row(R"(\n\| ([^|]+?)(?: \([^|)]*\))? \|)");
  std::set<std::string> names;
  for (std::sregex_iterator it(part.begin(), part.end(), row), last; it != last; ++it) names.insert((*it)[1]);
  names.erase("what");
  return names;
}

TEST(FormatsInTheDocs, CameraFilesAreRead) {
  const std::set<std::string> known = names_of(camera_files());
  const std::string page = documentation("docs/calibration.md");
  EXPECT_EQ(list(between(page, "also reads, as they are, the files of ", ". Of several"), known), known);
  const TemporaryFolder folder;
  for (const auto& [name, text] : camera_files()) {
    const Result<CameraFile> read = read_camera_file(folder.write("camera", text));
    EXPECT_EQ(read.error_text(), "") << name;
    EXPECT_EQ(read->camera.fy, 51) << name;
    EXPECT_EQ(read->camera.cx, 32) << name;
    EXPECT_EQ(read->camera.height, 48) << name;
  }
  EXPECT_TRUE(read_camera_file(folder.write("own", std::string(kMatrix) + "width: 64\nheight: 48\n")).has_value());
}

TEST(FormatsInTheDocs, RecordingsAreRead) {
  EXPECT_EQ(rows_between(documentation("README.md"), "`RECORDING` is one of", "Odd times"), names_of(recordings()));
  std::set<std::string> in_docs;
  for (const auto& [name, recording] : recordings()) in_docs.insert(recording.in_docs);
  EXPECT_EQ(rows_between(documentation("docs/recordings.md"), "# Recordings", "Not read"), in_docs);
  for (const auto& [name, recording] : recordings()) {
    const TemporaryFolder folder;
    write_file(folder / "calibration.yaml", kCalibration);
    const camera_driver::OpenedSource opened =
        camera_driver::open_recording(recording.make(folder.path()).string(), {});
    ASSERT_EQ(opened.error_text(), "") << name;
    EXPECT_TRUE((*opened)->next()) << name;
  }
}

TEST(FormatsInTheDocs, TruthsAreRead) {
  const std::set<std::string> known = names_of(truths());
  EXPECT_EQ(list(between(documentation("docs/evaluation.md"), "Read are ", ", with any separator"), known), known);
  for (const auto& [name, text] : truths()) {
    const TemporaryFolder folder;
    folder.write("times.txt", "0\n0.1\n");
    // The truth of EuRoC is of the body, so the camera's pose on the body is read, too.
    write_file(folder / "mav0/cam0/sensor.yaml", "T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n");
    write_file(folder / "mav0/state_groundtruth_estimate0/data.csv", text);
    const std::string file = name.find("EuRoC") != std::string::npos
                                 ? folder / "mav0/state_groundtruth_estimate0/data.csv"
                                 : folder.write("truth.txt", text);
    const TruthFile read = read_groundtruth(file, {});
    EXPECT_TRUE(read.ok()) << name << ": " << read.error;
    EXPECT_EQ(read.poses.size(), 2u) << name;
  }
}

}  // namespace
}  // namespace rumi
