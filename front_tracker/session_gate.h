// SPDX-License-Identifier: BSD-3-Clause
// Decides for each image whether it belongs to the present session, begins another one, or is refused. Some images it
// cannot judge alone: they wait until the images after them have come.
//
//   image                                                decision
//   goes on from the last one                            kTrack
//   the same time as the last one                        kRefused
//   no calibration, a broken one, or one of another size kRefused
//   another stream or calibration than the session's     kWaits; ten in a row: kRetake, they begin a session
//   a time that does not go on from the last one         kWaits; enough in a row (see ImageTimes): kRetake, they begin
//   a
//                                                        session, or the session goes on after a pause
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
    std::optional<Camera> camera = {};    // kTrack: the camera of the image
    std::vector<ArrivedImage> next = {};  // kRetake: those that waited, and this one, in the order in which they came
    std::string why_session_ends = {};    // kRetake: empty if no session is open, or if it goes on
  };

  // The images have their calibration with them unless `camera` is given.
  explicit SessionGate(const std::optional<Camera>& camera) : given_camera_(camera) {}

  Decision judge(const ArrivedImage& arrived);
  // The image is used. Later images must be newer.
  void take(const ArrivedImage& arrived);
  // A session begins with this image. `stream` is that of its images. Call it before take().
  void begin_session(const Camera& camera, const image_t& image, int64_t stream);
  // Refuses an image for a reason that judge() does not know.
  void refuse(RefusedImages::Kind kind, const std::string& problem);
  // Refuses the images that wait.
  void give_up_waiting();

  // The time of the last image that was used; ImageTimes::kNever if there is none.
  int64_t last_us() const { return times_.last_us(); }
  // What is wrong with the last image; empty if it was used.
  const std::string& problem() const { return problem_; }
  const RefusedImages& refused() const { return refused_; }
  bool take_news_of_refused() { return refused_.take_news(); }

 private:
  struct Session {
    Camera camera;            // of its images; the tracker's may be smaller
    std::string calibration;  // as it came with the images
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
  std::vector<ArrivedImage> waiting_;  // a row of one kind
  RefusedImages::Kind waiting_kind_ = RefusedImages::Kind::kNoTime;
  std::string waiting_problem_;
  std::string problem_;
  RefusedImages refused_;
};

}  // namespace rumi::front_tracker
