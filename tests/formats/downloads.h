// SPDX-License-Identifier: BSD-3-Clause
// Writes small versions of public datasets as one unpacks them: with the same files, names and forms.
#pragma once

#include "tests/formats/recording.h"

namespace rumi::testing {

inline constexpr size_t kImagesOfDownload = 12;

// Returns the i-th position of the path that all of them have: 0.1 m and a little more from image to image.
inline std::string download_pose(size_t i) {
  const auto x = static_cast<double>(i);
  return fmt::format("{:.6f} {:.6f} {:.6f}", 0.1 * x, 0.01 * x * x, 0.002 * x * x * x);
}

// Writes the content of rgbd_dataset_freiburg1_xyz.tgz.
inline fs::path write_tum_download(const fs::path& parent) {
  const fs::path folder = parent / "rgbd_dataset_freiburg1_xyz";
  const std::string heading = "# color images\n# file: 'rgbd_dataset_freiburg1_xyz.bag'\n# timestamp filename\n";
  std::string rgb = heading, depth = heading, truth = "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n";
  fs::create_directories(folder / "rgb");
  fs::create_directories(folder / "depth");
  for (size_t i = 0; i < kImagesOfDownload; ++i) {
    const std::string time = fmt::format("{:.6f}", 1305031102.175304 + 0.033 * static_cast<double>(i));
    cv::imwrite((folder / "rgb" / (time + ".png")).string(), picture(static_cast<int>(i), 64, 48, true));
    cv::imwrite((folder / "depth" / (time + ".png")).string(), cv::Mat(48, 64, CV_16UC1, cv::Scalar(5000)));
    rgb += fmt::format("{} rgb/{}.png\n", time, time);
    depth += fmt::format("{} depth/{}.png\n", time, time);
    truth += fmt::format("{} {} 0 0 0 1\n", time, download_pose(i));
  }
  write_file(folder / "rgb.txt", rgb);
  write_file(folder / "depth.txt", depth);
  write_file(folder / "groundtruth.txt", truth);
  write_file(folder / "accelerometer.txt", "# accelerometer data\n# timestamp ax ay az\n1305031098.69 0 9.8 0\n");
  return folder;
}

inline std::string euroc_sensor(const std::string& more) {
  return "%YAML:1.0\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n" + more;
}

// Writes the content of MH_01_easy.zip, in a folder of its name.
inline fs::path write_euroc_download(const fs::path& parent) {
  const fs::path folder = parent / "MH_01_easy", mav = folder / "mav0";
  std::string list = "#timestamp [ns],filename\r\n";
  std::string truth =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n";
  for (const char* camera : {"cam0", "cam1"}) {
    fs::create_directories(mav / camera / "data");
    write_file(
        mav / camera / "sensor.yaml",
        euroc_sensor("sensor_type: camera\nrate_hz: 20\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: "
                     "[50, 51, 32, 24]\ndistortion_model: radial-tangential\ndistortion_coefficients: [0.1, 0, "
                     "0, 0]\n"));
  }
  for (size_t i = 0; i < kImagesOfDownload; ++i) {
    const int64_t time_ns = 1403636579763555584 + 50'000'000 * static_cast<int64_t>(i);
    for (const char* camera : {"cam0", "cam1"})
      cv::imwrite((mav / camera / "data" / fmt::format("{}.png", time_ns)).string(), picture(static_cast<int>(i)));
    list += fmt::format("{0},{0}.png\r\n", time_ns);
    std::string pose = download_pose(i);
    std::replace(pose.begin(), pose.end(), ' ', ',');
    truth += fmt::format("{},{},1,0,0,0\n", time_ns, pose);
  }
  write_file(mav / "cam0/data.csv", list);
  write_file(mav / "cam1/data.csv", list);
  write_file(mav / "imu0/data.csv", "#timestamp [ns],w_RS_S_x [rad s^-1]\n1403636579758555392,0\n");
  write_file(mav / "state_groundtruth_estimate0/data.csv", truth);
  write_file(mav / "state_groundtruth_estimate0/sensor.yaml", euroc_sensor("sensor_type: visual-inertial\n"));
  write_file(mav / "body.yaml", "%YAML:1.0\ncomment: VI-Sensor\n");
  return folder;
}

// Writes the content of living_room_traj0_frei_png.tar.gz, in a folder of its name.
inline fs::path write_icl_download(const fs::path& parent) {
  const fs::path folder = parent / "living_room_traj0_frei_png";
  std::string associations, truth;
  fs::create_directories(folder / "rgb");
  fs::create_directories(folder / "depth");
  for (size_t i = 0; i < kImagesOfDownload; ++i) {
    cv::imwrite((folder / fmt::format("rgb/{}.png", i)).string(), picture(static_cast<int>(i), 64, 48, true));
    cv::imwrite((folder / fmt::format("depth/{}.png", i)).string(), cv::Mat(48, 64, CV_16UC1, cv::Scalar(5000)));
    associations += fmt::format("{0} depth/{0}.png {0} rgb/{0}.png\n", i);
    truth += fmt::format("{} {} 0 0 0 1\n", i, download_pose(i));
  }
  write_file(folder / "associations.txt", associations);
  write_file(folder / "livingRoom0.gt.freiburg", truth);
  return folder;
}

}  // namespace rumi::testing
