// SPDX-License-Identifier: BSD-3-Clause
// Decides for each image whether it belongs to the present session, begins another one, or is refused. Some images
// cannot be judged alone: they wait until the images after them have come.
//
//   image                                                decision
//   goes on from the last one                            kTrack
//   the same time as the last one                        kRefused
//   a calibration that is not known, broken, or of       kRefused
//   another size
//   another stream or calibration than the session's     kWaits; ten in a row: kRetake, they begin a session
//   a time that does not go on from the last one         kWaits; enough in a row (see ImageTimes): kRetake, they begin
//                                                        a session, or the session goes on after a pause
//
// Waiting images are refused as soon as an image of another kind comes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "front_tracker/image_times.h"
#include "front_tracker/refused_images.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "slam/geometry/camera.h"

namespace rumi::front_tracker {

struct ArrivedImage {
  image_t image;
  int64_t arrived_us = 0;
};

class SessionGate {
 public:
  struct Decision {
    enum class What {
      kTrack,    // decode it, and call take() if that succeeds
      kRefused,  // it is counted and forgotten
      kWaits,    // the gate keeps a copy
      kRetake,   // judge the images of `next` before any other
    };
    What what = What::kRefused;
    std::optional<Camera> camera = {};    // kTrack: camera of the image
    std::vector<ArrivedImage> next = {};  // kRetake: the images that waited, and this one, in order of arrival
    std::string why_session_ends = {};    // kRetake: empty if no session is open, or if the session goes on
  };

  // If `camera` is not given, the calibration comes with the images.
  explicit SessionGate(const std::optional<Camera>& camera) : given_camera_(camera) {}

  Decision judge(const ArrivedImage& arrived);
  // Notes that the image is used. Later images must be newer.
  void take(const ArrivedImage& arrived);
  // Notes that a session begins with this image. `stream` is that of its images. To be called before take().
  void begin_session(const Camera& camera, const image_t& image, int64_t stream);
  // Refuses an image for a reason that judge() cannot know.
  void refuse(RefusedImages::Kind kind, const std::string& problem);
  // Refuses the images that wait.
  void give_up_waiting();

  // See ImageTimes::last_us().
  int64_t last_us() const { return times_.last_us(); }
  // Returns why the last image was not used; empty if it was.
  const std::string& problem() const { return problem_; }
  const RefusedImages& refused() const { return refused_; }
  bool take_news_of_refused() { return refused_.take_news(); }

 private:
  struct Session {
    Camera camera;            // camera of its images; the tracker's camera may be smaller
    std::string calibration;  // text that came with the images
    int64_t stream = 0;
  };
  Decision refusal(RefusedImages::Kind kind, const std::string& problem);
  Decision judge_time(const ArrivedImage& arrived);
  Decision judge_camera(const ArrivedImage& arrived);
  Decision judge_size(const image_t& image, const Camera& camera);
  Decision wait(RefusedImages::Kind kind, const ArrivedImage& arrived, const std::string& problem);
  Decision wait_as_foreign(const ArrivedImage& arrived, const std::string& problem);
  Decision wait_for_times(const ArrivedImage& arrived, int64_t last_us);
  std::vector<ArrivedImage> stop_waiting();

  std::optional<Camera> given_camera_;
  std::optional<Session> session_;
  ImageTimes times_;
  std::vector<ArrivedImage> waiting_;  // images in a row that wait, all for the reason waiting_kind_
  RefusedImages::Kind waiting_kind_ = RefusedImages::Kind::kNoTime;
  std::string waiting_problem_;
  std::string problem_;
  RefusedImages refused_;
};

}  // namespace rumi::front_tracker
