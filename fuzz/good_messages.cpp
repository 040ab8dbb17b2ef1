// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/good_messages.h"

#include <random>

#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/jpeg_image.h"
#include "bus/wire/pose.h"

namespace rumi::fuzz {
namespace {

constexpr int kLandmarks = 12;
constexpr double kStep = 0.1;  // sideways, between two keyframes, in the submap's unit
constexpr int64_t kFrame_us = 100'000;

cv::Mat texture(int64_t utime_us) {
  cv::Mat grey(kHeight, kWidth, CV_8U);
  for (int i = 0; i < grey.rows * grey.cols; ++i)
    grey.data[i] = static_cast<uint8_t>((int64_t{i} * i + utime_us / 1000) % 251);
  return grey;
}

Descriptor descriptor_of(int id) {
  std::mt19937_64 random(static_cast<uint64_t>(id));
  return {random(), random(), random(), random()};
}

// Returns keypoints of the landmarks that a camera at `x` sees, and appends the ids of these landmarks to `seen`.
std::shared_ptr<Features> features_at(const Submap& map, double x, std::vector<int>* seen) {
  auto features = std::make_shared<Features>();
  for (const auto& [id, landmark] : map.landmarks) {
    const Eigen::Vector3d in_camera = landmark.position - Eigen::Vector3d(x, 0, 0);
    const Eigen::Vector2d pixel = map.camera.project_undistorted(in_camera);
    if (!map.camera.contains(pixel)) continue;
    features->keypoints.push_back({pixel.cast<float>(), 0, 0});
    features->descriptors.push_back(descriptor_of(id));
    seen->push_back(id);
  }
  features->undistort(map.camera);
  return features;
}

}  // namespace

Camera good_camera() {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 50;
  camera.cx = kWidth / 2.0;
  camera.cy = kHeight / 2.0;
  return camera;
}

image_t good_image(int64_t utime_us) {
  image_t image = make_grey_image(utime_us, texture(utime_us));
  set_metadata(&image, kCalibrationKey, camera_to_yaml(good_camera()));
  return image;
}

image_t good_jpeg(int64_t utime_us) {
  image_t image = make_jpeg_image(utime_us, texture(utime_us), 30);
  set_metadata(&image, kCalibrationKey, camera_to_yaml(good_camera()));
  return image;
}

Submap good_submap(SubmapKey key, int keyframes) {
  Submap map;
  map.key = key;
  map.kind = key.id > 0 ? SubmapKind::kFront : SubmapKind::kBack;
  map.camera = good_camera();
  map.revision = keyframes;
  std::mt19937 random(static_cast<unsigned>(key.id));
  const auto uniform = [&](double size) { return size * (static_cast<double>(random() % 1000) / 500 - 1); };
  for (int id = 0; id < kLandmarks; ++id) {
    Landmark& landmark = map.landmarks[id];
    landmark.id = id;
    landmark.position = {uniform(0.6), uniform(0.5), 2 + uniform(0.5)};
    landmark.descriptor = descriptor_of(id);
    landmark.revision = 1;
  }
  for (int id = 0; id < keyframes; ++id) {
    Keyframe& kf = map.keyframes[id];
    kf.id = id;
    kf.utime_us = kSession + kFrame_us * (id + 1);
    kf.cam_from_submap.translation.x() = -kStep * id;
    std::vector<int> seen;
    kf.features = features_at(map, kStep * id, &seen);
    kf.landmark_ids.assign(kf.features->size(), kNone);
    kf.revision = kf.created_revision = id + 1;
    map.frames.set({kf.utime_us, id, SE3(), id + 1});
    for (size_t i = 0; i < seen.size(); ++i) map.add_observation(seen[i], id, static_cast<int>(i));
  }
  return map;
}

track_t good_track(int64_t utime_us, int8_t state, int32_t submap_id) {
  track_t track{};
  track.utime = utime_us;
  track.session = kSession;
  track.sequence = utime_us / kFrame_us;
  track.state = state;
  track.submap_id = submap_id;
  track.is_keyframe = submap_id != 0;
  track.cam_from_keyframe = track.cam_from_submap = to_wire(SE3());
  track.position_sigma = track.rotation_sigma_rad = track.log_scale_sigma = 0.01F;
  track.keypoints = 200;
  track.inliers = 100;
  return track;
}

mask_t good_mask(int64_t utime_us) {
  cv::Mat pixels(kHeight, kWidth, CV_8U, cv::Scalar(255));
  pixels.rowRange(kHeight - 8, kHeight) = 0;
  const std::string png = encode_mask(pixels);
  mask_t mask{};
  mask.utime = utime_us;
  mask.stream = mask.session = kSession;
  mask.width = kWidth;
  mask.height = kHeight;
  mask.left_out = 8.0 / kHeight;
  mask.size = static_cast<int32_t>(png.size());
  mask.png.assign(png.begin(), png.end());
  return mask;
}

map_status_t good_status(const std::vector<SubmapKey>& submaps) {
  map_status_t status{};
  status.map_revision = 2;
  for (const SubmapKey& key : submaps) {
    submap_summary_t& s = status.submaps.emplace_back();
    s = {};
    s.session = key.session;
    s.submap_id = key.id;
    s.kind = key.id > 0 ? submap_update_t::FRONT : submap_update_t::BACK;
    s.closed = s.in_map = true;
    s.revision = 3;
    s.keyframes = 3;
    s.map_from_submap = to_wire(Sim3());
  }
  status.nsubmaps = static_cast<int32_t>(status.submaps.size());
  if (submaps.size() > 1) {
    link_t& link = status.links.emplace_back();
    link = {};
    link.session_a = submaps[0].session, link.submap_a = submaps[0].id;
    link.session_b = submaps[1].session, link.submap_b = submaps[1].id;
    link.accepted = true;
  }
  status.nlinks = status.links_in_all = status.links_accepted = static_cast<int32_t>(status.links.size());
  return status;
}

map_request_t good_request(int8_t what, SubmapKey key) {
  map_request_t request{};
  request.requester = "somebody";
  request.request_id = 1 + what;
  request.what = what;
  request.session = key.session;
  request.submap_id = key.id;
  request.radius = 5;
  return request;
}

chunk_ack_t good_ack(int64_t transfer_id, int8_t status) {
  chunk_ack_t ack{};
  ack.sender = "somebody";
  ack.receiver = "map_server";
  ack.transfer_id = transfer_id;
  ack.status = status;
  ack.next_index = 1;
  return ack;
}

}  // namespace rumi::fuzz
